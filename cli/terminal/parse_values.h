// SPDX-License-Identifier: MIT
// Values of flags from their text. Each throws UsageError naming the flag, the text and the rule.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace batten::internal {

// Finite numbers separated by commas or semicolons.
std::vector<double> ParseNumbers(const std::string& flag, const std::string& text);

enum class Sign { kAny, kNotNegative, kPositive };

// One finite number.
double ParseNumber(const std::string& flag, const std::string& text, Sign sign = Sign::kAny);

// A whole number in [low, high]; 2e4 is one too.
std::uint64_t ParseWhole(const std::string& flag,
                         const std::string& text,
                         std::uint64_t low,
                         std::uint64_t high);

// Bytes: a number with B, kB, MB, GB, TB (powers of 1000) or KiB, MiB, GiB, TiB (of 1024); without
// a unit bytes. At least `least`.
std::int64_t ParseBytes(const std::string& flag, const std::string& text, std::int64_t least);

// A whole number in [low, high], or a pair of them: "24" is 24,24.
std::pair<int, int> ParsePair(const std::string& flag, const std::string& text, int low, int high);

// Refuses a word that is not among those `now` understood: as of a later version when it is among
// `later`, else naming the nearest and all known ones.
void CheckChoice(const std::string& flag,
                 const std::string& word,
                 const std::vector<std::string>& now,
                 const std::vector<std::string>& later = {});

}  // namespace batten::internal
