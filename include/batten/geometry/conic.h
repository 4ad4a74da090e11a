// SPDX-License-Identifier: MIT
// Conics of the plane as equations: what they are, degenerate ones too.
#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <string>
#include <variant>

#include "batten/geometry/classify_shape.h"

namespace batten {

// a x² + b x y + c y² + d x + e y + f = 0.
struct ImplicitConic {
  double a = 0, b = 0, c = 0, d = 0, e = 0, f = 0;

  double At(const Eigen::Vector2d& p) const;
  Eigen::Vector2d GradientAt(const Eigen::Vector2d& p) const;
  Eigen::Matrix3d Matrix() const;  // Q with (x, y, 1) Q (x, y, 1)' the left side

  // The same curve seen from `origin`: F'(p) = F(origin + p).
  ImplicitConic From(const Eigen::Vector2d& origin) const;
};

// Degenerate conics; directions have length one.
struct CrossingLines {
  Eigen::Vector2d point;
  std::array<Eigen::Vector2d, 2> directions;
};
struct ParallelLines {
  std::array<Eigen::Vector2d, 2> points;  // one on each, nearest to one another
  Eigen::Vector2d direction;
};
struct DoubleLine {
  Eigen::Vector2d point, direction;
};
struct SinglePoint {
  Eigen::Vector2d point;
};
struct EmptyConic {};
struct WholePlane {};  // all coefficients vanish

// All in the plane z = 0. A LineShape is the conic without a quadratic part.
using ConicLocus = std::variant<CircleShape,
                                EllipseShape,
                                ParabolaShape,
                                HyperbolaShape,
                                CrossingLines,
                                ParallelLines,
                                DoubleLine,
                                LineShape,
                                SinglePoint,
                                EmptyConic,
                                WholePlane>;

// Some tens of roundings: what coefficients multiplied out of exact ones are off by.
inline constexpr double kConicTolerance = 64 * std::numeric_limits<double>::epsilon();

// Where the equation holds. Lengths are measured in the unit in which no term exceeds the quadratic
// part; there, an eigenvalue of the quadratic part, a constant at the centre or a discriminant of
// at most `tolerance` counts as zero, and makes an ellipse a circle. A conic far from the origin
// against its size has lost its digits in f: give it From() a point near it. Throws
// std::invalid_argument unless the coefficients are finite and tolerance ≥ 0. O(1).
// [Piegl & Tiller 1997, §7.2]
ConicLocus ClassifyConic(const ImplicitConic& conic, double tolerance = kConicTolerance);

// "circle", "ellipse", "parabola", "hyperbola", "two crossing lines", "two parallel lines", "a
// double line", "line", "a point", "empty", "the whole plane".
std::string NameOf(const ConicLocus& locus);

}  // namespace batten
