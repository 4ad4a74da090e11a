// SPDX-License-Identifier: MIT
// The known name a mistyped one was probably meant to be.
#pragma once

#include <string>
#include <vector>

namespace batten::internal {

// The candidate with the fewest insertions, deletions, replacements and swaps of neighbours away;
// empty when none is within a third of the word's length (at least two). [Damerau 1964, restricted]
std::string NearestName(const std::string& word, const std::vector<std::string>& candidates);

// The same however far away it is; empty only without candidates.
std::string NearestNameOfAll(const std::string& word, const std::vector<std::string>& candidates);

}  // namespace batten::internal
