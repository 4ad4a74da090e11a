// SPDX-License-Identifier: MIT
#include "io/exchange/brep_scanner.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>

#include "batten/io/read_error.h"

namespace batten::internal {
namespace {

constexpr size_t kLongestWord = 100;  // OpenCASCADE reads words into 255 bytes
constexpr double kLargestNumber = 1e150;
constexpr std::string_view kBlanks = " \t\r\n";

// from_chars takes no plus.
std::string_view WithoutPlus(std::string_view word) {
  return word.size() > 1 && word[0] == '+' && word[1] != '-' ? word.substr(1) : word;
}

}  // namespace

void BrepScanner::Fail(const std::string& why) const {
  const auto line =
      std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(word_at_), '\n');
  throw ReadError::AtLine(path_, line + 1, why);
}

std::string_view BrepScanner::Next(const char* what) {
  const size_t begin = text_.find_first_not_of(kBlanks, at_);
  if (begin == text_.npos) {
    word_at_ = text_.size();
    Fail(std::string("the file ends where ") + what + " should stand");
  }
  const size_t end = std::min(text_.find_first_of(kBlanks, begin), text_.size());
  word_at_ = begin;
  at_ = end;
  if (end - begin > kLongestWord) Fail(std::string("a word of more than 100 bytes is no ") + what);
  return text_.substr(begin, end - begin);
}

std::string_view BrepScanner::Word(const char* what) {
  const std::string_view word = Next(what);
  if (copies_) {
    copied_ += word;
    copied_ += ' ';
  }
  return word;
}

std::string_view BrepScanner::Peek() {
  const size_t at = at_, word_at = word_at_;
  const std::string_view word = Next("more");
  at_ = at;
  word_at_ = word_at;
  return word;
}

double BrepScanner::Real(const char* what) {
  const std::string_view word = WithoutPlus(Word(what));
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) {
    Fail("'" + std::string(word) + "' is no number, which " + what + " must be");
  }
  if (std::abs(value) > kLargestNumber) {
    Fail(std::string(what) + " of " + std::string(word) + " is above 1e150 in magnitude");
  }
  return value;
}

std::int64_t BrepScanner::Integer(const char* what, std::int64_t least, std::int64_t most) {
  const std::string_view word = WithoutPlus(Word(what));
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || value < least || value > most) {
    Fail(std::string(what) + " must be a whole number from " + std::to_string(least) + " to " +
         std::to_string(most) + ", not '" + std::string(word) + "'");
  }
  return value;
}

void BrepScanner::Expect(std::string_view word) {
  const std::string_view found = Word(std::string(word).c_str());
  if (found != word) {
    Fail("'" + std::string(word) + "' should stand where '" + std::string(found) + "' does");
  }
}

}  // namespace batten::internal
