// SPDX-License-Identifier: MIT
#include "cli/arguments/cleaning.h"

#include <algorithm>
#include <vector>

#include "batten/io/read_error.h"
#include "cli/terminal/parse_values.h"

namespace batten::internal {

Cleaning ToCleaning(const std::string& text) {
  const std::string word = text.substr(0, text.find(':'));
  CheckChoice("--clean", word, {"auto", "none", "statistical"});
  if (word != "statistical" && word != text)
    throw UsageError("--clean: '" + text + "': " + word + " takes no numbers");
  if (word == "none") return {.keep_outliers = true, .statistical = std::nullopt};
  if (word == "auto") return {};
  StatisticalRemoval removal;
  if (word.size() < text.size()) {
    const std::vector<double> numbers =
        ParseNumbers("--clean statistical:K,S", text.substr(word.size() + 1));
    constexpr double kMostNeighbours = 1000;
    if (numbers.size() != 2 || !(numbers[0] >= 1) || numbers[0] > kMostNeighbours ||
        numbers[0] != static_cast<int>(numbers[0]) || !(numbers[1] > 0)) {
      throw UsageError("--clean: '" + text +
                       "' is not statistical:K,S, a whole number of neighbours from 1 to 1000 and "
                       "a positive number of standard deviations");
    }
    removal = {static_cast<int>(numbers[0]), numbers[1]};
  }
  return {.keep_outliers = false, .statistical = removal};
}

}  // namespace batten::internal
