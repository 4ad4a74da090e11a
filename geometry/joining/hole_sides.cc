// SPDX-License-Identifier: MIT
#include "geometry/joining/hole_sides.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/numeric/construction_checks.h"
#include "geometry/numeric/dense_solvers.h"
#include "geometry/nurbs/homogeneous.h"

namespace batten::internal {

constexpr int kFillDegree = 5;

HoleSide::HoleSide(const FillSide& side, bool reversed)
    : side_(side), reversed_(reversed), length_(side.curve) {}

double HoleSide::ParameterAt(double s) const {
  const double share = std::clamp(reversed_ ? 1 - s : s, 0.0, 1.0);
  return length_.ParameterAt(share * length_.length());
}

Eigen::Vector3d HoleSide::At(double s) const { return side_.curve.At(ParameterAt(s)); }

Eigen::Vector3d HoleSide::TangentAt(double s) const {
  const Eigen::Vector3d first = side_.curve.JetAt(ParameterAt(s)).first;
  if (!(first.norm() > 0)) return Eigen::Vector3d::Zero();
  return (reversed_ ? -1 : 1) * first.normalized();
}

std::optional<HoleSide::Plane> HoleSide::PlaneAt(double s) const {
  if (!side_.neighbour) return std::nullopt;
  const double along = ParameterAt(s);
  const bool across_u = side_.edge.direction == Direction::kU;
  const SplineBasis& basis = BasisOf(*side_.neighbour, side_.edge.direction);
  const double end = side_.edge.upper ? basis.upper() : basis.lower();
  const double u = across_u ? end : along, v = across_u ? along : end;
  const auto normal = side_.neighbour->NormalAt(u, v);
  if (!normal) return std::nullopt;
  const SurfaceJet jet = side_.neighbour->JetAt(u, v);
  const Eigen::Vector3d tangent = across_u ? jet.dv : jet.du;
  Eigen::Vector3d outwards = (across_u ? jet.du : jet.dv) * (side_.edge.upper ? 1 : -1);
  const double square = tangent.squaredNorm();
  if (square > 0) outwards -= outwards.dot(tangent) / square * tangent;
  return Plane{*normal, outwards.normalized()};
}

NurbsCurve<3> HoleSide::Spline(int spans,
                               const Eigen::Vector3d& start,
                               const Eigen::Vector3d& end) const {
  const int size = 2 * spans + kFillDegree;
  const SplineBasis basis = SplineBasis::Uniform(kFillDegree, size, 0, 1);
  const int samples = 4 * size;
  Eigen::MatrixXd values = Eigen::MatrixXd::Zero(samples, size);
  Eigen::MatrixXd points(samples, 3);
  Eigen::VectorXd local(kFillDegree + 1);
  for (int k = 0; k < samples; ++k) {
    // Chebyshev's places: none too far from the ends.
    const double s = (1 - std::cos(std::acos(-1.0) * (k + 0.5) / samples)) / 2;
    const int span = basis.Span(s);
    basis.Values(span, s, local.data());
    values.row(k).segment(span - kFillDegree, kFillDegree + 1) = local.transpose();
    points.row(k) = At(s).transpose();
  }
  Eigen::Matrix3Xd control(3, size);
  control.col(0) = start;
  control.col(size - 1) = end;
  const Eigen::MatrixXd rest =
      points - values.col(0) * start.transpose() - values.col(size - 1) * end.transpose();
  control.middleCols(1, size - 2) = LeastSquares(values.middleCols(1, size - 2), rest).transpose();
  return NurbsCurve<3>(basis, std::move(control));
}

std::vector<HoleSide> OrderedSides(const std::vector<FillSide>& sides, double tolerance) {
  const auto end = [&](size_t k, bool upper) {
    const SplineBasis& basis = sides[k].curve.basis();
    return sides[k].curve.At(upper ? basis.upper() : basis.lower());
  };
  std::vector<HoleSide> ordered{HoleSide(sides[0], false)};
  std::vector<size_t> left;
  for (size_t k = 1; k < sides.size(); ++k) left.push_back(k);
  Eigen::Vector3d at = end(0, true);
  while (!left.empty()) {
    size_t best = left.front();
    bool reversed = false;
    double gap = HUGE_VAL;
    for (const size_t k : left) {
      for (const bool upper : {false, true}) {
        const double distance = (end(k, upper) - at).norm();
        if (!(distance < gap)) continue;
        gap = distance;
        best = k;
        reversed = upper;
      }
    }
    RequireThat(gap <= tolerance,
                "Fill",
                "the sides make no loop: the nearest end of another side, side " +
                    std::to_string(best) + ", is " + RoundedText(gap) +
                    " away, more than the tolerance " + RoundedText(tolerance));
    ordered.emplace_back(sides[best], reversed);
    at = end(best, !reversed);
    left.erase(std::find(left.begin(), left.end(), best));
  }
  const double gap = (at - end(0, false)).norm();
  RequireThat(gap <= tolerance,
              "Fill",
              "the loop stays open by " + RoundedText(gap) + ", more than the tolerance " +
                  RoundedText(tolerance));
  return ordered;
}

}  // namespace batten::internal
