// SPDX-License-Identifier: MIT
// The knot span layout of a curve fit: breaks, corners, open or closed.
#pragma once

#include <vector>

#include "batten/geometry/spline_basis.h"

namespace batten::internal {

// Samples of a span that show where a curve goes between its data.
inline constexpr int kSamplesOfSpan = 16;

// A knot vector with simple knots at the increasing breaks and knots of multiplicity p at corners,
// where the curve is only continuous. Open: clamped, n = p + the inner knots. Closed: periodic over
// [front, back]; the seam is a break like any other, and may be a corner.
class SpanLayout {
 public:
  // `corners` are some of the breaks; of an open curve inner ones. Throws std::invalid_argument
  // unless there are two breaks, increasing, and corners are among them.
  SpanLayout(int degree, std::vector<double> breaks, std::vector<double> corners, bool closed);

  // A layout of `spans` spans, as equal as the corners between allow; each side of a corner gets
  // one at least.
  static SpanLayout Equal(int degree,
                          int spans,
                          double lower,
                          double upper,
                          const std::vector<double>& corners,
                          bool closed);

  int degree() const { return degree_; }
  bool closed() const { return closed_; }
  int spans() const { return static_cast<int>(breaks_.size()) - 1; }
  const std::vector<double>& breaks() const { return breaks_; }
  const std::vector<double>& corners() const { return corners_; }
  bool IsCorner(int break_index) const;  // the seam's two indices are one

  int control_points() const;  // that differ
  SplineBasis Basis() const;

  // The span that holds a parameter.
  int SpanOf(double parameter) const;

  // Halves every span where `where` is set.
  SpanLayout Halved(const std::vector<bool>& where) const;

  // Removes a break, which is neither an end nor a corner.
  SpanLayout Without(int break_index) const;

  // A layout of `spans` spans with the present density: breaks at equal steps of the present ones'
  // count, corner to corner.
  SpanLayout Resampled(int spans) const;

  // This layout with other breaks between the same ends and corners.
  SpanLayout WithBreaks(std::vector<double> breaks) const;

 private:
  std::vector<int> Pieces() const;  // break indices of ends and inner corners

  int degree_;
  std::vector<double> breaks_, corners_;
  bool closed_;
};

}  // namespace batten::internal
