// SPDX-License-Identifier: MIT
// The known names a mistyped one was probably meant to be.
#pragma once

#include <string>
#include <vector>

namespace batten::internal {

// The candidates that begin with the word. Where none does, the one with the fewest insertions,
// deletions, replacements and swaps of neighbours away, at most two and fewer than the word has
// letters; empty where none is so near. [Damerau 1964, restricted]
std::vector<std::string> NamesMeant(const std::string& word,
                                    const std::vector<std::string>& candidates);

// "did you mean 'a', 'b' or 'c'?" of these; `otherwise` where there are none.
std::string DidYouMean(const std::string& word,
                       const std::vector<std::string>& candidates,
                       const std::string& otherwise);

}  // namespace batten::internal
