// SPDX-License-Identifier: MIT
// What curves and surfaces in powers share: places, preconditions, pieces that meet.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "batten/geometry/nurbs_curve.h"

namespace batten::internal {

struct PlaceInPiece {
  int piece;
  double t;  // in [0, 1]
};
PlaceInPiece PlaceIn(const std::vector<double>& breaks, double u);

// 2p + 3 places of a piece, its ends among them.
std::vector<double> PlacesIn(int degree);

// Throws std::invalid_argument where `error` is above what ToPower allows.
void RefusePowerLoss(const Eigen::Ref<const Eigen::MatrixXd>& control_points,
                     double error,
                     double tolerance,
                     int degree);

// Throws unless the degree is in [1, kMaxDegree] and the breaks, two at least, increase.
void CheckPowers(int degree, const std::vector<double>& breaks, const std::string& name);

// Moves `start` to the middle of both homogeneous points of equal weight; throws where they are
// apart by more than 1e-9 of the extent of `so_far`.
void CloseGap(const Eigen::VectorXd& end,
              Eigen::Ref<Eigen::VectorXd> start,
              const Eigen::Ref<const Eigen::MatrixXd>& so_far,
              double at);

// The knots of pieces in Bézier form.
SplineBasis BezierFormBasis(int degree, const std::vector<double>& breaks);

// The curve of homogeneous Bézier points, the shared ones once.
template <int Dim>
NurbsCurve<Dim> BezierFormCurve(int degree,
                                const std::vector<double>& breaks,
                                const Eigen::MatrixXd& columns,
                                bool rational);

}  // namespace batten::internal
