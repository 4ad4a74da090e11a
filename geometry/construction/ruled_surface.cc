// SPDX-License-Identifier: MIT
#include "batten/geometry/ruled_surface.h"

#include <algorithm>
#include <tuple>
#include <utility>
#include <vector>

#include "batten/geometry/arc_length.h"
#include "batten/geometry/compatible_curves.h"
#include "geometry/construction/cubic_approximation.h"
#include "geometry/construction/curve_closure.h"
#include "geometry/construction/curves_together.h"
#include "geometry/construction/one_sided_curve.h"
#include "geometry/numeric/constants.h"
#include "geometry/numeric/construction_checks.h"

namespace batten {
using namespace internal;
namespace {

// The two curves, over one basis, as the edges v = 0 and v = 1.
NurbsSurface Between(const NurbsCurve<3>& first, const NurbsCurve<3>& second) {
  const Eigen::Index size = first.control_points().cols();
  Eigen::Matrix3Xd points(3, 2 * size);
  Eigen::VectorXd weights(2 * size);
  for (Eigen::Index i = 0; i < size; ++i) {
    points.col(2 * i) = first.control_points().col(i);
    points.col(2 * i + 1) = second.control_points().col(i);
    weights[2 * i] = first.weights()[i];
    weights[2 * i + 1] = second.weights()[i];
  }
  return NurbsSurface(
      first.basis(), SplineBasis(1, {0, 0, 1, 1}), std::move(points), std::move(weights));
}

double Largest(const NurbsCurve<3>& curve) { return curve.control_points().cwiseAbs().maxCoeff(); }

// The second curve at the pace of the first: it has run the same share of its length.
struct Paced {
  const ArcLengthMap first, second;
  const OneSidedCurve first_pieces, second_pieces;

  ValueAndSlope At(double u, Side side) const {
    const double share = std::clamp(first.LengthAt(u) / first.length(), 0.0, 1.0);
    const double at = second.ParameterAt(share * second.length());
    const CurveJet<3> jet = second_pieces.JetAt(at, side);
    const double pace = first_pieces.JetAt(u, side).first.norm() / first.length();
    return {jet.point, jet.first.normalized() * (pace * second.length())};
  }
};

// Places where either curve is less than smooth, by the parameter of the first.
std::vector<FunctionBreak> BreaksOfBoth(const NurbsCurve<3>& first,
                                        const NurbsCurve<3>& second,
                                        const Paced& paced) {
  std::vector<FunctionBreak> breaks = BreaksOf(first);
  const std::vector<FunctionBreak> others = BreaksOf(second);
  for (std::size_t k = 1; k + 1 < others.size(); ++k) {
    const double share = paced.second.LengthAt(others[k].at) / paced.second.length();
    breaks.push_back({paced.first.ParameterAt(share * paced.first.length()), others[k].continuity});
  }
  return MergedBreaks(std::move(breaks));
}

std::pair<NurbsCurve<3>, double> RetracedByLength(const NurbsCurve<3>& first,
                                                  const NurbsCurve<3>& second,
                                                  double tolerance) {
  const Paced paced{
      ArcLengthMap(first), ArcLengthMap(second), OneSidedCurve(first), OneSidedCurve(second)};
  RequireThat(paced.first.length() > 0 && paced.second.length() > 0,
              "Ruled",
              "by length: a curve is a point and has no length");
  CubicApproximation cubic =
      ApproximateByCubic([&](double u, Side side) { return paced.At(u, side); },
                         BreaksOfBoth(first, second, paced),
                         [](const Eigen::VectorXd& difference) { return difference.norm(); },
                         tolerance,
                         "Ruled");
  return {NurbsCurve<3>(std::move(cubic.basis), cubic.coefficients), cubic.error};
}

}  // namespace

NurbsSurface Extrude(const NurbsCurve<3>& profile, const Eigen::Vector3d& by) {
  RequireThat(by.allFinite(), "Extrude", "by is not finite");
  RequireThat(by.norm() > 4 * kEpsilon * Largest(profile),
              "Extrude",
              "by has the length " + RoundedText(by.norm()) +
                  ", too little to be told from nothing at the curve's coordinates");
  RequireThat(
      !LieAlong(profile.control_points(), by),
      "Extrude",
      "the curve lies on a line in the direction it is moved in, or is a point: the surface "
      "would have no area; move it across itself");
  Eigen::Matrix3Xd moved = profile.control_points().colwise() + by;
  return Between(profile, NurbsCurve<3>(profile.basis(), std::move(moved), profile.weights()));
}

RuledSurface Ruled(const NurbsCurve<3>& first,
                   const NurbsCurve<3>& second,
                   const RuledOptions& options) {
  RequireSameClosedness({first, second}, "Ruled", "curve");
  std::vector<NurbsCurve<3>> curves = {first, second};
  double error = 0;
  if (options.by == RuledBy::kLength) {
    RequirePositive("Ruled", "tolerance", options.tolerance);
    std::tie(curves[1], error) = RetracedByLength(first, second, options.tolerance);
  }
  curves = Compatible(std::move(curves));
  const double apart =
      (curves[0].control_points() - curves[1].control_points()).colwise().norm().maxCoeff();
  RequireThat(
      apart > 4 * kEpsilon * std::max(Largest(first), Largest(second)),
      "Ruled",
      "the two curves are one: their control points are at most " + RoundedText(apart) + " apart");
  RuledSurface ruled{Between(curves[0], curves[1]), error};
  RequireArea(ruled.surface, "Ruled");
  return ruled;
}

}  // namespace batten
