// SPDX-License-Identifier: MIT
// The words that the value of a flag can be: what is refused, and what completion offers, come from
// one list.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "cli/terminal/cli11_forward.h"

namespace batten::internal {

// The option takes one of these words only. Any other is refused while the command line is read,
// the nearest named; those among `later` as of a later version (CheckChoice).
void Allow(CLI::Option& option,
           std::vector<std::string> words,
           const std::vector<std::string>& later = {});

// The option takes these words besides others.
void Suggest(CLI::Option& option, std::vector<std::string> words);

// The words depend on what has been typed of them; a word that ends in '=' or ':' goes on.
using WordsFor = std::function<std::vector<std::string>(const std::string& typed)>;
void SuggestFor(CLI::Option& option, WordsFor words);

// What was said of the option; nothing where nothing was.
const WordsFor* OfferedWords(const CLI::Option& option);

}  // namespace batten::internal
