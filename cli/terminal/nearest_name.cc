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

// Letters after a flag's dashes.
size_t Letters(const std::string& word) {
  const size_t first = word.find_first_not_of('-');
  return first == std::string::npos ? 0 : word.size() - first;
}

constexpr size_t kLongestWord = 64;

}  // namespace

std::vector<std::string> NamesMeant(const std::string& word,
                                    const std::vector<std::string>& candidates) {
  if (Letters(word) == 0 || word.size() > kLongestWord) return {};
  std::vector<std::string> meant;
  for (const std::string& candidate : candidates) {
    if (candidate.rfind(word, 0) == 0) meant.push_back(candidate);
  }
  if (!meant.empty()) return meant;
  size_t limit = std::min<size_t>(3, Letters(word));
  for (const std::string& candidate : candidates) {
    const size_t distance = EditDistance(word, candidate);
    if (distance >= limit) continue;
    limit = distance;
    meant = {candidate};
  }
  return meant;
}

std::string DidYouMean(const std::string& word,
                       const std::vector<std::string>& candidates,
                       const std::string& otherwise) {
  const std::vector<std::string> meant = NamesMeant(word, candidates);
  if (meant.empty()) return otherwise;
  std::string text = "did you mean ";
  for (size_t k = 0; k < meant.size(); ++k) {
    text += k == 0 ? "'" : k + 1 < meant.size() ? "', '" : "' or '";
    text += meant[k];
  }
  return text + "'?";
}

}  // namespace batten::internal
