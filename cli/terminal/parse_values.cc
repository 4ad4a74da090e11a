// SPDX-License-Identifier: MIT
#include "cli/terminal/parse_values.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <map>

#include "batten/io/read_error.h"
#include "cli/terminal/nearest_name.h"

namespace batten::internal {
namespace {

[[noreturn]] void Refuse(const std::string& flag,
                         const std::string& text,
                         const std::string& rule) {
  throw UsageError(flag + ": '" + text + "' is not " + rule);
}

// Numbers as far as the text is a list of them; empty where it is none.
std::vector<double> Numbers(const std::string& text) {
  std::vector<double> numbers;
  const char* at = text.data();
  const char* const end = at + text.size();
  const auto skip_blanks = [&] {
    while (at != end && (*at == ' ' || *at == '\t')) ++at;
  };
  for (;;) {
    skip_blanks();
    if (at != end && *at == '+') ++at;
    double value = 0;
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc() || !std::isfinite(value)) return {};
    numbers.push_back(value);
    at = next;
    skip_blanks();
    if (at == end) return numbers;
    if (*at != ',' && *at != ';') return {};
    ++at;
  }
}

bool Whole(double number, double low, double high) {
  return number >= low && number <= high && number == std::floor(number);
}

}  // namespace

std::vector<double> ParseNumbers(const std::string& flag, const std::string& text) {
  std::vector<double> numbers = Numbers(text);
  if (numbers.empty()) Refuse(flag, text, "a list of finite numbers");
  return numbers;
}

double ParseNumber(const std::string& flag, const std::string& text, Sign sign) {
  const std::vector<double> numbers = Numbers(text);
  const bool one = numbers.size() == 1;
  if (sign == Sign::kPositive && !(one && numbers[0] > 0))
    Refuse(flag, text, "a positive finite number");
  if (sign == Sign::kNotNegative && !(one && numbers[0] >= 0))
    Refuse(flag, text, "a finite number of 0 or more");
  if (!one) Refuse(flag, text, "a finite number");
  return numbers[0];
}

std::uint64_t ParseWhole(const std::string& flag,
                         const std::string& text,
                         std::uint64_t low,
                         std::uint64_t high) {
  std::uint64_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [next, error] = std::from_chars(text.data(), end, value);
  if (error == std::errc() && next == end && value >= low && value <= high) return value;
  const std::vector<double> numbers = Numbers(text);
  constexpr double kExact = 0x1p53;
  if (numbers.size() == 1 &&
      Whole(numbers[0], static_cast<double>(low), std::min(kExact, static_cast<double>(high)))) {
    return static_cast<std::uint64_t>(numbers[0]);
  }
  Refuse(flag, text, "a whole number from " + std::to_string(low) + " to " + std::to_string(high));
}

std::int64_t ParseBytes(const std::string& flag, const std::string& text, std::int64_t least) {
  static const std::map<std::string, double> kUnits = {{"", 1},
                                                       {"b", 1},
                                                       {"kb", 1e3},
                                                       {"mb", 1e6},
                                                       {"gb", 1e9},
                                                       {"tb", 1e12},
                                                       {"kib", 0x1p10},
                                                       {"mib", 0x1p20},
                                                       {"gib", 0x1p30},
                                                       {"tib", 0x1p40}};
  constexpr double kMost = 0x1p60;
  double number = 0;
  const char* const end = text.data() + text.size();
  const auto [next, error] = std::from_chars(text.data(), end, number);
  std::string unit(next, end);
  for (char& c : unit) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const auto found = kUnits.find(unit.substr(std::min(unit.find_first_not_of(' '), unit.size())));
  const double bytes = found == kUnits.end() ? 0 : number * found->second;
  if (error != std::errc() || !(bytes > 0) || bytes > kMost)
    Refuse(flag, text, "a size such as 500MB, 2GB or 1GiB");
  if (bytes < static_cast<double>(least))
    Refuse(flag, text, "enough: at least " + std::to_string(least >> 20) + "MiB");
  return static_cast<std::int64_t>(bytes);
}

std::pair<int, int> ParsePair(const std::string& flag, const std::string& text, int low, int high) {
  const std::vector<double> numbers = Numbers(text);
  bool good = numbers.size() == 1 || numbers.size() == 2;
  for (const double number : numbers) good = good && Whole(number, low, high);
  if (!good) {
    Refuse(flag,
           text,
           "one or two whole numbers from " + std::to_string(low) + " to " + std::to_string(high));
  }
  return {static_cast<int>(numbers.front()), static_cast<int>(numbers.back())};
}

void CheckChoice(const std::string& flag,
                 const std::string& word,
                 const std::vector<std::string>& now,
                 const std::vector<std::string>& later) {
  if (std::find(now.begin(), now.end(), word) != now.end()) return;
  if (std::find(later.begin(), later.end(), word) != later.end()) {
    throw UsageError(flag + " " + word + " is not in this version");
  }
  std::string known;
  for (const std::string& choice : now) known += " " + choice;
  const std::string meant = DidYouMean(word, now, "");
  throw UsageError(flag + ": '" + word + "' is not one of" + known +
                   (meant.empty() ? "" : "; " + meant));
}

}  // namespace batten::internal
