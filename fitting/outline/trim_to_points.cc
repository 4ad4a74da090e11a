// SPDX-License-Identifier: MIT
#include "batten/fitting/trim_to_points.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>

#include "batten/geometry/trim_loops.h"
#include "fitting/core/rounding.h"
#include "fitting/outline/holes_in_space.h"
#include "fitting/outline/outline_in_box.h"
#include "fitting/parameterization/parameterization.h"
#include "geometry/editing/trim_faults.h"

namespace batten {
using namespace internal;
namespace {

constexpr double kLeastHole = 2;    // spacings from the points, in space, of a place amid a hole
constexpr double kFlattest = 1e-3;  // ratio of mean lengths beyond which they are not followed

// Means of |S_u| and |S_v| over some of the feet.
Eigen::Vector2d MeanStretch(const NurbsSurface& surface, const Eigen::Matrix2Xd& feet) {
  const std::vector<SurfaceJet> jets = SomeJets(surface, feet);
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const SurfaceJet& jet : jets) sum += Eigen::Vector2d(jet.du.norm(), jet.dv.norm());
  return sum.cwiseMax(kFlattest * sum.maxCoeff()) / static_cast<double>(jets.size());
}

// |S_u| at heights v of the domain over its mean, linear between rows: the length of a unit of u
// near a pole.
class RowStretch {
 public:
  RowStretch(const NurbsSurface& surface, double mean, double length_v)
      : values_(kRows + 1), length_(length_v) {
    const SplineBasis &u = surface.basis_u(), &v = surface.basis_v();
    for (int row = 0; row <= kRows; ++row) {
      const double at_v = v.lower() + (v.upper() - v.lower()) * row / kRows;
      double sum = 0;
      for (int k = 0; k < kPlaces; ++k) {
        const double at_u = u.lower() + (u.upper() - u.lower()) * (k + 0.5) / kPlaces;
        sum += surface.JetAt(at_u, at_v).du.norm();
      }
      values_[row] = sum / (kPlaces * mean);
    }
  }

  double operator()(double v) const {
    const double at = std::clamp(v / length_, 0.0, 1.0) * kRows;
    const int row = std::min(kRows - 1, static_cast<int>(at));
    return values_[row] + (at - row) * (values_[row + 1] - values_[row]);
  }

 private:
  static constexpr int kRows = 64, kPlaces = 8;
  Eigen::VectorXd values_;
  double length_;
};

bool HasValidTrims(const NurbsSurface& surface) { return TrimFaults(surface).empty(); }

std::ptrdiff_t OuterLoops(const std::vector<NurbsCurve<2>>& loops) {
  return std::count_if(
      loops.begin(), loops.end(), [](const auto& loop) { return SignedArea(loop) > 0; });
}

// The bounding box of a loop's control points, which contains the loop.
Eigen::AlignedBox2d BoxOf(const NurbsCurve<2>& loop) {
  return {loop.control_points().rowwise().minCoeff(), loop.control_points().rowwise().maxCoeff()};
}

}  // namespace

CompatibleLoops LoopsThatGoTogether(const NurbsSurface& trimmed) {
  std::vector<NurbsCurve<2>> all = trimmed.trims();
  if (all.empty() || HasValidTrims(trimmed)) return {std::move(all), 0};
  std::vector<std::pair<double, size_t>>
      order;  // by falling area: what is within a loop follows it
  for (size_t k = 0; k < all.size(); ++k) order.emplace_back(std::abs(SignedArea(all[k])), k);
  std::ranges::stable_sort(order, std::greater<>(), &std::pair<double, size_t>::first);
  std::vector<size_t> taken;
  for (const auto& [area, k] : order) {
    const Eigen::AlignedBox2d box = BoxOf(all[k]);
    std::vector<NurbsCurve<2>> near;
    for (const size_t other : taken)
      if (BoxOf(all[other]).intersects(box)) near.push_back(all[other]);
    near.push_back(all[k]);
    if (HasValidTrims(trimmed.WithTrims(std::move(near)))) taken.push_back(k);
  }
  std::ranges::sort(taken);
  CompatibleLoops result{{}, static_cast<int>(all.size() - taken.size())};
  for (const size_t k : taken) result.loops.push_back(std::move(all[k]));
  return result;
}

std::vector<NurbsCurve<2>> MovedLoops(const std::vector<NurbsCurve<2>>& loops,
                                      const Eigen::Vector2d& scale,
                                      const Eigen::Vector2d& shift) {
  std::vector<NurbsCurve<2>> moved;
  for (const NurbsCurve<2>& loop : loops) {
    Eigen::Matrix2Xd points = (scale.asDiagonal() * loop.control_points()).colwise() + shift;
    moved.emplace_back(loop.basis(), std::move(points), loop.weights());
  }
  return moved;
}

PointTrim TrimToPoints(const NurbsSurface& surface,
                       const Eigen::Matrix2Xd& feet,
                       const Poles& poles,
                       double spacing,
                       double noise,
                       ThreadPool& pool) {
  const Eigen::Vector2d low(surface.basis_u().lower(), surface.basis_v().lower());
  const Eigen::Vector2d sides(surface.basis_u().upper() - low[0],
                              surface.basis_v().upper() - low[1]);
  const Eigen::Vector2d stretch = MeanStretch(surface, feet);
  OutlineOptions options;
  options.spacing = spacing;
  options.noise = noise;
  options.length_u = stretch[0] * sides[0];
  options.length_v = stretch[1] * sides[1];
  options.periodic_u = surface.basis_u().periodic();
  options.periodic_v = surface.basis_v().periodic();
  options.pole_start = poles.start != PoleKind::kNone;
  options.pole_end = poles.end != PoleKind::kNone;
  if (poles.any()) options.stretch_u = RowStretch(surface, stretch[0], options.length_v);
  options.place = [&](const Eigen::Vector2d& lengths) {
    const Eigen::Vector2d at = low + lengths.cwiseQuotient(stretch);
    return surface.At(std::min(at[0], surface.basis_u().upper()),
                      std::min(at[1], surface.basis_v().upper()));
  };
  const Eigen::Array2d most(options.length_u, options.length_v);
  Eigen::Matrix2Xd lengths = stretch.asDiagonal() * (feet.colwise() - low);
  lengths = lengths.array().max(0).matrix();
  for (int d = 0; d < 2; ++d) lengths.row(d) = lengths.row(d).cwiseMin(most[d]);
  const Outline outline = FindOutlineInBox(std::move(lengths), options, pool);
  PointTrim result{surface, outline.warnings, outline.parts, outline.outside};
  if (outline.fills) return result;
  std::vector<NurbsCurve<2>> loops;
  for (const OutlineCurve& curve : outline.loops) loops.push_back(curve.loop);
  loops = HolesInSpace(
      surface, MovedLoops(loops, stretch.cwiseInverse(), low), feet, kLeastHole * spacing);
  const double whole = (1 - kRelativelyEqual) * sides.prod();
  if (loops.size() == 1 && SignedArea(loops.front()) > whole) return result;
  NurbsSurface trimmed = surface.WithTrims(std::move(loops));
  CompatibleLoops together = LoopsThatGoTogether(trimmed);
  if (OuterLoops(together.loops) < OuterLoops(trimmed.trims())) {  // would hide a part's points
    result.warnings = {"outlines of the points cross: the surface is not trimmed"};
    result.outside.clear();
    return result;
  }
  if (together.left_out > 0) {
    result.warnings.push_back("outlines of holes that cross themselves or others were left out: " +
                              std::to_string(together.left_out));
    trimmed = surface.WithTrims(std::move(together.loops));
  }
  result.surface = std::move(trimmed);
  return result;
}

}  // namespace batten
