// SPDX-License-Identifier: MIT
// Plain decimal numbers, read fast and exactly. Not installed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace batten::internal {

// The decimal number at `at`, correctly rounded, where one operation on exact doubles gives it: up
// to 2^53 without its point, times or by a power of ten up to 10^22. [Clinger, How to read floating
// point numbers accurately, 1990] Returns the end of the number; null where it is none or needs
// std::from_chars, which takes three times as long.
inline const char* ParsePlainDecimal(const char* at, const char* end, double& value) {
  constexpr std::array kPowers{1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                               1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                               1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
  constexpr int kLargestPower = static_cast<int>(kPowers.size()) - 1;
  constexpr int kMostDigits = 19;  // fit in 64 bits
  constexpr std::uint64_t kLargestExact = std::uint64_t{1} << 53;

  const bool negative = at < end && *at == '-';
  if (negative) ++at;
  std::uint64_t digits = 0;
  const auto take_digits = [&] {
    const char* const first = at;
    for (; at < end; ++at) {
      const unsigned digit = static_cast<unsigned char>(*at) - unsigned{'0'};
      if (digit > 9) break;
      digits = 10 * digits + digit;
    }
    return static_cast<int>(at - first);
  };
  int count = take_digits(), power = 0;
  if (at < end && *at == '.') {
    ++at;
    power = take_digits();
    count += power;
    power = -power;
  }
  if (count == 0 || count > kMostDigits || digits > kLargestExact) return nullptr;
  if (at < end && (*at == 'e' || *at == 'E')) {
    ++at;
    const bool down = at < end && *at == '-';
    if (at < end && (*at == '-' || *at == '+')) ++at;
    int exponent = 0, length = 0;
    for (; at < end && *at >= '0' && *at <= '9' && length < 4; ++at, ++length) {
      exponent = 10 * exponent + (*at - '0');
    }
    if (length == 0 || length > 3) return nullptr;
    power += down ? -exponent : exponent;
  }
  if (power < -kLargestPower || power > kLargestPower) return nullptr;
  const auto exact = static_cast<double>(digits);
  const double size = power < 0 ? exact / kPowers[static_cast<std::size_t>(-power)]
                                : exact * kPowers[static_cast<std::size_t>(power)];
  value = negative ? -size : size;
  return at;
}

}  // namespace batten::internal
