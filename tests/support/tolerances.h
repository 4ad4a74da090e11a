// SPDX-License-Identifier: MIT
// The three tolerances of the tests, each relative to the size of what is compared.
#pragma once

namespace batten::internal {

// A closed formula: some thousand roundings of 2^-53 ≈ 1.1e-16, and a factor for the cancellation
// in high derivatives.
inline constexpr double kRounding = 1e-12;

// The end of an iteration that stops when the value no longer falls: distances are then exact to
// rounding times the condition of the problem, for which three digits are granted.
inline constexpr double kIterated = 1e-9;

// What only half of the digits of a double carry: differences in place of derivatives, and the
// place of a minimum, whose value is flat to second order: sqrt(2^-52) ≈ 1.5e-8, and a factor for
// the constants of both.
inline constexpr double kHalfDigits = 1e-6;

}  // namespace batten::internal
