// SPDX-License-Identifier: MIT
#include "cli/terminal/nearest_name.h"

#include <algorithm>

namespace batten::internal {
namespace {

size_t EditDistance(const std::string& a, const std::string& b) {
  std::vector<std::vector<size_t>> d(a.size() + 1, std::vector<size_t>(b.size() + 1));
  for (size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
  for (size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
  for (size_t i = 1; i <= a.size(); ++i) {
    for (size_t j = 1; j <= b.size(); ++j) {
      const size_t change = a[i - 1] == b[j - 1] ? 0 : 1;
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + change});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
      }
    }
  }
  return d[a.size()][b.size()];
}

// The candidate fewest edits away, if that is fewer than `limit`.
std::string NearestBelow(size_t limit,
                         const std::string& word,
                         const std::vector<std::string>& candidates) {
  std::string nearest;
  for (const std::string& candidate : candidates) {
    const size_t distance = EditDistance(word, candidate);
    if (distance < limit) {
      limit = distance;
      nearest = candidate;
    }
  }
  return nearest;
}

constexpr size_t kLongestWord = 64;

}  // namespace

std::string NearestName(const std::string& word, const std::vector<std::string>& candidates) {
  if (word.size() > kLongestWord) return "";
  return NearestBelow(std::max<size_t>(2, word.size() / 3) + 1, word, candidates);
}

std::string NearestNameOfAll(const std::string& word, const std::vector<std::string>& candidates) {
  return NearestBelow(2 * kLongestWord + 1, word.substr(0, kLongestWord), candidates);
}

}  // namespace batten::internal
