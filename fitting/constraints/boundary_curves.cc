// SPDX-License-Identifier: MIT
#include "fitting/constraints/boundary_curves.h"

#include <algorithm>
#include <limits>
#include <utility>
#include <variant>

#include "batten/fitting/refused_data.h"
#include "batten/geometry/arc_length.h"
#include "batten/geometry/clamp.h"
#include "batten/geometry/iso_curve.h"
#include "batten/geometry/remove_knots.h"
#include "batten/geometry/reverse.h"
#include "fitting/constraints/polynomial_curve.h"
#include "geometry/numeric/box_diagonal.h"
#include "geometry/numeric/number_text.h"
#include "geometry/nurbs/placed_curve.h"

namespace batten::internal {
namespace {

constexpr int kFewestSamples = 16, kMostSamples = 2000;
constexpr double kOfSpacing = 0.5;      // between samples
constexpr double kFarFromPoints = 0.5;  // of the cloud's size: a curve of another place
constexpr double kAlong = 5;            // spacings: a neighbour's edge beside the points
constexpr double kFollows = 1e-10;      // of the size: what a cubic in place of a conic is off by

// The mean distance of a curve's places from their nearest points.
double DistanceFrom(const NurbsCurve<3>& curve,
                    const Eigen::Matrix3Xd& points,
                    const NeighbourIndex& index) {
  constexpr int kPlaces = 33;
  Eigen::Matrix3Xd places(3, kPlaces);
  const double a = curve.basis().lower(), b = curve.basis().upper();
  for (int k = 0; k < kPlaces; ++k) places.col(k) = curve.At(a + (b - a) * k / (kPlaces - 1));
  const std::vector<int> nearest = index.Nearest(places, 1);
  return (places - points(Eigen::all, nearest)).colwise().norm().mean();
}

void RequireOpen(const NurbsCurve<3>& curve, const std::string& name, double size) {
  const double a = curve.basis().lower(), b = curve.basis().upper();
  const double gap = (curve.At(b) - curve.At(a)).norm();
  if (ArcLength(curve) <= kFollows * size)
    throw RefusedData("boundary " + name + ": the curve has no length");
  if (gap <= kFollows * size) {
    throw RefusedData("boundary " + name +
                      ": the curve is closed; an edge of a surface runs from corner to "
                      "corner: give its parts one by one");
  }
}

// That edge of the neighbour which runs along the points.
BoundaryEdge EdgeAlong(const NurbsSurface& neighbour,
                       const std::string& name,
                       const Eigen::Matrix3Xd& points,
                       const NeighbourIndex& index,
                       double spacing) {
  std::optional<BoundaryEdge> best;
  double least = std::numeric_limits<double>::infinity();
  for (const Direction direction : {Direction::kU, Direction::kV}) {
    const SplineBasis& basis =
        direction == Direction::kU ? neighbour.basis_u() : neighbour.basis_v();
    if (basis.periodic()) continue;
    for (const bool upper : {false, true}) {
      NurbsCurve<3> edge = IsoCurve(neighbour, direction, upper ? basis.upper() : basis.lower());
      if (!(ArcLength(edge) > 0)) continue;
      const double distance = DistanceFrom(edge, points, index);
      if (distance >= least) continue;
      least = distance;
      best = BoundaryEdge{std::move(edge), NeighbourEdge{neighbour, direction, upper}, name};
    }
  }
  if (best && least <= std::max(kAlong * spacing, kFollows * BoxDiagonal(points))) return *best;
  throw RefusedData("boundary " + name + ": no edge of this surface runs along the points" +
                    (best ? ": the nearest is " + RoundedText(least) + " away, " +
                                RoundedText(kAlong) + " spacings are allowed"
                          : "") +
                    "; give the curve itself where the surface is to end elsewhere");
}

}  // namespace

std::vector<BoundaryEdge> BoundaryEdges(const SurfaceFitOptions& options,
                                        const Eigen::Vector3d& origin,
                                        const Eigen::Matrix3Xd& points,
                                        const NeighbourIndex& index,
                                        double spacing) {
  std::vector<BoundaryEdge> sides;
  const double size = BoxDiagonal(points);
  for (const BoundaryCondition& condition : options.boundary) {
    const auto* curve = std::get_if<NurbsCurve<3>>(&condition.shape);
    BoundaryEdge side =
        curve != nullptr ? BoundaryEdge{Translated(*curve, -origin), std::nullopt, condition.name}
                         : EdgeAlong(std::get<NurbsSurface>(condition.shape).Translated(-origin),
                                     condition.name,
                                     points,
                                     index,
                                     spacing);
    side.curve = Clamped(side.curve);
    RequireOpen(side.curve, side.name, size);
    const double distance = DistanceFrom(side.curve, points, index);
    if (distance > kFarFromPoints * size) {
      throw RefusedData("boundary " + side.name + ": the curve runs " + RoundedText(distance) +
                        " from the points on average, which are " + RoundedText(size) +
                        " across: is it in their coordinates?");
    }
    if (side.curve.rational()) {
      side.curve =
          PolynomialCurve(side.curve, std::max(options.boundary_tolerance / 2, kFollows * size));
    }
    if (options.boundary_tolerance > 0)
      side.curve = RemoveKnots(side.curve, options.boundary_tolerance / 2).shape;
    sides.push_back(std::move(side));
  }
  return sides;
}

SideSamples SampleSide(const BoundaryEdge& side, double spacing) {
  const double a = side.curve.basis().lower(), b = side.curve.basis().upper();
  const double wanted = ArcLength(side.curve) / (kOfSpacing * spacing);
  const int count = static_cast<int>(std::clamp<double>(wanted, kFewestSamples, kMostSamples)) + 1;
  SideSamples samples{Eigen::VectorXd::LinSpaced(count, a, b), Eigen::Matrix3Xd(3, count)};
  for (int k = 0; k < count; ++k) samples.points.col(k) = side.curve.At(samples.parameters[k]);
  return samples;
}

BoundaryEdge Turned(const BoundaryEdge& side) {
  BoundaryEdge turned = side;
  turned.curve = Reversed(side.curve);
  turned.reversed = !side.reversed;
  return turned;
}

}  // namespace batten::internal
