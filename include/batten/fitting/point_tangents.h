// SPDX-License-Identifier: MIT
// Tangents of a curve at its points, estimated from their neighbours.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace batten {

enum class TangentRule {
  // The tangent of the circle through the point and its two neighbours, which is also the direction
  // of their parabola over chord lengths. Circles come out exactly. [Bessel; Ackland 1915]
  kBessel,
  // A mean of the steps before and after, in which the step beside the straighter pair counts more:
  // straight stretches stay straight and corners between them show. [Akima 1970]
  kAkima,
};

struct TangentOptions {
  TangentRule rule = TangentRule::kAkima;
  bool closed = false;  // the first point follows the last
  // Points between two straight stretches, of three points each at least, are corners; otherwise
  // they get the mean direction.
  bool find_corners = true;
  std::vector<Eigen::Index> corners = {};  // further points that are corners
};

// Unit tangents (Dim × m) before and after each point. They differ at corners only; at the ends of
// an open curve they agree.
template <int Dim>
struct PointTangents {
  Eigen::Matrix<double, Dim, Eigen::Dynamic> arriving, leaving;
  std::vector<Eigen::Index> corners;  // found and given, increasing, without the ends
};

// Tangents at all points. Beside corners and at ends only points on the same side count. Where the
// curve turns back on itself the point is a corner. O(m). Throws std::invalid_argument if there are
// fewer than two points (closed: three), one is not finite, neighbours lie in one place, or a
// corner is no point. [Piegl & Tiller 1997, §9.3.1, eqs. 9.28–9.33]
template <int Dim>
PointTangents<Dim> TangentsAt(const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points,
                              const TangentOptions& options = {});

extern template PointTangents<2> TangentsAt<2>(const Eigen::Matrix2Xd&, const TangentOptions&);
extern template PointTangents<3> TangentsAt<3>(const Eigen::Matrix3Xd&, const TangentOptions&);

}  // namespace batten
