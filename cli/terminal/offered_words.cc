// SPDX-License-Identifier: MIT
#include "cli/terminal/offered_words.h"

#include <map>
#include <utility>

#include "cli/terminal/cli11.h"
#include "cli/terminal/parse_values.h"

namespace batten::internal {
namespace {

// Options live as long as their command, which lives as long as the program.
std::map<const CLI::Option*, WordsFor>& Offered() {
  static std::map<const CLI::Option*, WordsFor> offered;
  return offered;
}

}  // namespace

void Allow(CLI::Option& option,
           std::vector<std::string> words,
           const std::vector<std::string>& later) {
  option.check([name = option.get_name(), words, later](const std::string& word) {
    CheckChoice(name, word, words, later);
    return std::string();
  });
  Suggest(option, std::move(words));
}

void Suggest(CLI::Option& option, std::vector<std::string> words) {
  SuggestFor(option, [words = std::move(words)](const std::string&) { return words; });
}

void SuggestFor(CLI::Option& option, WordsFor words) { Offered()[&option] = std::move(words); }

const WordsFor* OfferedWords(const CLI::Option& option) {
  const auto found = Offered().find(&option);
  return found == Offered().end() ? nullptr : &found->second;
}

}  // namespace batten::internal
