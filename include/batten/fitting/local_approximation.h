// SPDX-License-Identifier: MIT
// Local curve approximation within a tolerance, piece by piece.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "batten/geometry/nurbs_curve.h"

namespace batten {

enum class ApproximationPieces {
  kConics,  // rational quadratics: exact for conics; in space one piece needs points in a plane
  kCubics,
};

struct LocalApproximationOptions {
  ApproximationPieces pieces = ApproximationPieces::kCubics;
  bool closed = false;  // the first point follows the last
  // Turning angle of the polygon (radians, in ]0, π[) above which points are corners, if they turn
  // much more than their neighbours do, over legs of five tolerances at least . No corners are
  // sought when absent.
  std::optional<double> corner_angle = 0.5;
  std::vector<Eigen::Index> corners = {};  // further points that are corners
};

template <int Dim>
struct LocalApproximation {
  NurbsCurve<Dim> curve;
  Eigen::VectorXd parameters;  // of each point, where the curve is within the tolerance of it
  double largest_distance = 0;
  std::vector<Eigen::Index> corners;  // found and given, increasing
  Eigen::Index pieces = 0;
};

// Approximates the points greedily: from the first point on, the longest run of points that one
// piece fits within the tolerance (> 0, data's units), and so on; pieces meet at points of the
// data, in one direction except at corners. Where no piece fits even two steps, the piece between
// two neighbours goes exactly through both. The curve is C¹ as InterpolateLocally's is; domain [0,
// 1]; closed: periodic. Meant for points whose noise is below the tolerance: directions are taken
// from as many neighbours as agree on one. O(m log m) tests of a point against a piece for each
// piece's length. Throws std::invalid_argument if the tolerance is not positive or the angle not in
// ]0, π[, there are fewer than two points (closed: three), one is not finite, neighbours lie in one
// place, or a corner is no point. [Piegl & Tiller 1997, §9.5]
template <int Dim>
LocalApproximation<Dim> ApproximateLocally(const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points,
                                           double tolerance,
                                           const LocalApproximationOptions& options = {});

extern template LocalApproximation<2> ApproximateLocally<2>(const Eigen::Matrix2Xd&,
                                                            double,
                                                            const LocalApproximationOptions&);
extern template LocalApproximation<3> ApproximateLocally<3>(const Eigen::Matrix3Xd&,
                                                            double,
                                                            const LocalApproximationOptions&);

}  // namespace batten
