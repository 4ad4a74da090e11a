// SPDX-License-Identifier: MIT
#include "geometry/mesh/border_shares.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <utility>

#include "geometry/mesh/loop_parameters.h"

namespace batten::internal {
namespace {

// The share between two others at which a coordinate of the curve has the value.
double Crossing(
    const NurbsCurve<2>& curve, int coordinate, double value, double lower, double upper) {
  const bool rising = AtShare(curve, lower)[coordinate] < value;
  constexpr int kHalvings = 52;  // to the last digit
  for (int k = 0; k < kHalvings; ++k) {
    const double middle = (lower + upper) / 2;
    ((AtShare(curve, middle)[coordinate] < value) == rising ? lower : upper) = middle;
  }
  return (lower + upper) / 2;
}

void AddCrossings(const NurbsCurve<2>& curve,
                  int coordinate,
                  double value,
                  std::vector<double>& shares,
                  std::size_t count) {
  for (std::size_t k = 0; k + 1 < count; ++k) {
    const double from = AtShare(curve, shares[k])[coordinate] - value;
    const double to = AtShare(curve, shares[k + 1])[coordinate] - value;
    if ((from < 0 && to > 0) || (from > 0 && to < 0)) {
      shares.push_back(Crossing(curve, coordinate, value, shares[k], shares[k + 1]));
    }
  }
}

// What keeps a loop of bent edges from closing up where the tolerance is wider than it: the middle
// of an edge that is not straight in space, and the quarters of one that closes.
void AddLeast(const NurbsCurve<2>& curve,
              const SurfaceEvaluator& surface,
              std::vector<double>& shares) {
  constexpr double kStraight = 1e-6;  // of its length
  const auto at = [&](double share) {
    const Eigen::Vector2d place = AtShare(curve, share);
    return surface.At(place[0], place[1]);
  };
  const Eigen::Vector3d start = at(0), end = at(1);
  double length = (end - start).norm(), bend = 0;
  for (const double share : {0.25, 0.5, 0.75}) {
    const Eigen::Vector3d way = at(share) - start;
    length = std::max(length, way.norm());
    bend = std::max(bend, way.cross((end - start).stableNormalized()).norm());
  }
  if ((end - start).norm() <= kStraight * length) {
    shares.insert(shares.end(), {0.25, 0.5, 0.75});
  } else if (bend > kStraight * length) {
    shares.push_back(0.5);
  }
}

}  // namespace

std::vector<double> BorderShares(const NurbsCurve<2>& curve,
                                 const DomainMesh& mesh,
                                 double tolerance,
                                 double beside) {
  const double lower = curve.basis().lower(), length = curve.basis().upper() - lower;
  std::vector<double> shares;
  for (const double at : EdgeParameters(curve, mesh.surface(), tolerance, beside)) {
    shares.push_back((at - lower) / length);
  }
  shares.push_back(1);
  const std::size_t count = shares.size();
  const MeshDomain& domain = mesh.domain();
  for (const std::int64_t x : domain.creases_u()) {
    AddCrossings(curve, 0, domain.ParameterOf({x, 0})[0], shares, count);
  }
  for (const std::int64_t y : domain.creases_v()) {
    AddCrossings(curve, 1, domain.ParameterOf({0, y})[1], shares, count);
  }
  AddLeast(curve, mesh.surface(), shares);
  SortShares(shares);
  return shares;
}

void SortShares(std::vector<double>& shares) {
  constexpr double kApart = 1e-9;
  std::sort(shares.begin(), shares.end());
  std::vector<double> kept;
  for (const double share : shares) {
    if (kept.empty() || share - kept.back() > kApart) kept.push_back(share);
  }
  kept.front() = 0;
  kept.back() = 1;
  shares = std::move(kept);
}

Eigen::Vector2d AtShare(const NurbsCurve<2>& curve, double share) {
  const double lower = curve.basis().lower(), upper = curve.basis().upper();
  return curve.At(share >= 1 ? upper : lower + share * (upper - lower));
}

}  // namespace batten::internal
