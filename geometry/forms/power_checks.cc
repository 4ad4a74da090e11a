// SPDX-License-Identifier: MIT
#include "geometry/forms/power_checks.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/numeric/construction_checks.h"
#include "geometry/nurbs/homogeneous.h"

namespace batten::internal {

PlaceInPiece PlaceIn(const std::vector<double>& breaks, double u) {
  RequireThat(!std::isnan(u), "At", "u is not a number");
  const auto above = std::upper_bound(breaks.begin() + 1, breaks.end() - 1, u);
  const auto piece = static_cast<int>(above - breaks.begin()) - 1;
  const double t = (u - breaks[piece]) / (breaks[piece + 1] - breaks[piece]);
  return {piece, std::clamp(t, 0.0, 1.0)};
}

std::vector<double> PlacesIn(int degree) {
  const int count = 2 * degree + 3;
  std::vector<double> places;
  for (int k = 0; k < count; ++k) places.push_back(static_cast<double>(k) / (count - 1));
  return places;
}

void RefusePowerLoss(const Eigen::Ref<const Eigen::MatrixXd>& control_points,
                     double error,
                     double tolerance,
                     int degree) {
  RequireThat(tolerance > 0, "ToPower", "tolerance is not positive");
  constexpr double kUnits = 64 * std::numeric_limits<double>::epsilon();
  const double size =
      (control_points.rowwise().maxCoeff() - control_points.rowwise().minCoeff()).norm();
  const double allowed = std::max(tolerance * size, kUnits * control_points.cwiseAbs().maxCoeff());
  RequireThat(error <= allowed,
              "ToPower",
              "powers of degree " + std::to_string(degree) + " lose the shape by " +
                  RoundedText(error) + ", more than " + RoundedText(allowed) +
                  "; keep the Bezier form, or split or reduce first");
}

void CheckPowers(int degree, const std::vector<double>& breaks, const std::string& name) {
  RequireThat(
      degree >= 1 && degree <= kMaxDegree,
      "FromPower",
      "degree = " + std::to_string(degree) + " is not in [1, " + std::to_string(kMaxDegree) + "]");
  RequireThat(breaks.size() >= 2, "FromPower", name + " must be two at least");
  for (size_t k = 0; k + 1 < breaks.size(); ++k) {
    RequireThat(breaks[k] < breaks[k + 1] && std::isfinite(breaks[k + 1] - breaks[k]),
                "FromPower",
                name + "[" + std::to_string(k + 1) + "] = " + NumberText(breaks[k + 1]) +
                    " does not increase");
  }
}

void CloseGap(const Eigen::VectorXd& end,
              Eigen::Ref<Eigen::VectorXd> start,
              const Eigen::Ref<const Eigen::MatrixXd>& so_far,
              double at) {
  constexpr double kMeets = 1e-9;
  const Eigen::Index dim = end.size() - 1;
  const Eigen::MatrixXd places = so_far.topRows(dim).array().rowwise() / so_far.row(dim).array();
  const double size = (places.rowwise().maxCoeff() - places.rowwise().minCoeff()).norm();
  const double gap = (end.head(dim) / end[dim] - start.head(dim) / start[dim]).norm();
  const double allowed = std::max(
      kMeets * size, 64 * std::numeric_limits<double>::epsilon() * places.cwiseAbs().maxCoeff());
  RequireThat(gap <= allowed,
              "FromPower",
              "the pieces at " + NumberText(at) + " are " + RoundedText(gap) +
                  " apart; they must meet to 1e-9 of the size, " + RoundedText(allowed));
  start = (start + end) / 2;
}

SplineBasis BezierFormBasis(int degree, const std::vector<double>& breaks) {
  std::vector<double> knots(degree + 1, breaks.front());
  for (size_t k = 1; k + 1 < breaks.size(); ++k) knots.insert(knots.end(), degree, breaks[k]);
  knots.insert(knots.end(), degree + 1, breaks.back());
  return SplineBasis(degree, std::move(knots));
}

template <int Dim>
NurbsCurve<Dim> BezierFormCurve(int degree,
                                const std::vector<double>& breaks,
                                const Eigen::MatrixXd& columns,
                                bool rational) {
  return CurveFromHomogeneous<Dim>(BezierFormBasis(degree, breaks), columns, rational);
}

template NurbsCurve<2> BezierFormCurve<2>(int,
                                          const std::vector<double>&,
                                          const Eigen::MatrixXd&,
                                          bool);
template NurbsCurve<3> BezierFormCurve<3>(int,
                                          const std::vector<double>&,
                                          const Eigen::MatrixXd&,
                                          bool);

}  // namespace batten::internal
