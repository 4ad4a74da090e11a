// SPDX-License-Identifier: MIT
#include "io/base/plain_decimal.h"

#include <gtest/gtest.h>

#include <bit>
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <random>
#include <string>

namespace batten::internal::plain_decimal_test {

constexpr unsigned kSeed = 3;
constexpr int kRounds = 3'000'000;

// The library's number, bit by bit, and the same end; or no answer.
void ExpectAgreement(const std::string& text, std::int64_t& answers) {
  const char* const end = text.data() + text.size();
  double plain = 0, exact = 0;
  const char* const after = ParsePlainDecimal(text.data(), end, plain);
  if (after == nullptr) return;
  ++answers;
  const auto [expected_end, error] = std::from_chars(text.data(), end, exact);
  ASSERT_EQ(error, std::errc()) << text;
  ASSERT_EQ(after, expected_end) << text;
  ASSERT_EQ(std::bit_cast<std::uint64_t>(plain), std::bit_cast<std::uint64_t>(exact)) << text;
}

TEST(PlainDecimalTest, AgreesWithTheLibraryBitByBitOnRandomSpellings) {
  std::mt19937_64 random(kSeed);
  std::int64_t answers = 0;
  std::string text;
  for (int round = 0; round < kRounds; ++round) {
    text.clear();
    if (random() % 2) text += '-';
    const auto digits = [&](std::uint64_t most) {
      for (auto left = random() % (most + 1); left > 0; --left) {
        text += static_cast<char>('0' + random() % 10);
      }
    };
    digits(random() % 3 == 0 ? 20 : 7);
    if (random() % 4) text += '.';
    digits(random() % 3 == 0 ? 20 : 9);
    if (random() % 3 == 0) {
      text += random() % 2 ? 'e' : 'E';
      if (random() % 2) text += random() % 3 ? '-' : '+';
      digits(random() % 10 == 0 ? 5 : 2);
    }
    if (random() % 2) text += " 7";
    ExpectAgreement(text, answers);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(answers, kRounds / 3);
}

// What scanners write needs no second reading.
TEST(PlainDecimalTest, ReadsUsualCoordinatesAlone) {
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> coordinate(-6e6, 6e6);
  char text[64];
  for (const char* form : {"%.3f", "%.6f", "%.9g", "%.12e", "%.0f"}) {
    std::int64_t answers = 0;
    for (int round = 0; round < 100'000; ++round) {
      std::snprintf(text, sizeof text, form, coordinate(random));
      ExpectAgreement(text, answers);
      if (HasFatalFailure()) return;
    }
    EXPECT_EQ(answers, 100'000) << form;
  }
}

TEST(PlainDecimalTest, LeavesTheRestToTheLibrary) {
  double value = 0;
  for (const std::string text : {"",
                                 "-",
                                 ".",
                                 "-.",
                                 "nan",
                                 "inf",
                                 "+1",
                                 "e5",
                                 "1e",
                                 "1e+",
                                 "1e1000",
                                 "1e23",
                                 "9007199254740993",
                                 "12345678901234567890"}) {
    EXPECT_EQ(ParsePlainDecimal(text.data(), text.data() + text.size(), value), nullptr) << text;
  }
}

}  // namespace batten::internal::plain_decimal_test
