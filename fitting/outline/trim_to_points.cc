// SPDX-License-Identifier: MIT
#include "batten/fitting/trim_to_points.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "fitting/outline/outline_in_box.h"
#include "batten/geometry/surface_evaluator.h"
#include "batten/geometry/trim_loops.h"
#include "batten/geometry/trim_region.h"

namespace batten {
using namespace internal;
namespace {

constexpr double kMostOutside = 0.01;  // share of the points outside one outline; above: no trim
constexpr double kFlattest = 1e-3;     // ratio of mean lengths beyond which they are not followed

// Means of |S_u| and |S_v| over some of the feet.
Eigen::Vector2d MeanStretch(const NurbsSurface& surface, const Eigen::Matrix2Xd& feet) {
  constexpr Eigen::Index kPlaces = 4000;  // enough for a mean
  const Eigen::Index step = std::max<Eigen::Index>(1, feet.cols() / kPlaces);
  std::vector<SurfaceJet> jets;
  const Eigen::Matrix2Xd places = feet(Eigen::all, Eigen::seq(0, Eigen::last, step));
  SurfaceEvaluator(surface).Jets(places, jets);
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

double ShareOutside(const NurbsSurface& surface, const Eigen::Matrix2Xd& feet) {
  const TrimRegion region(surface);
  Eigen::Index outside = 0;
  for (const auto& foot : feet.colwise()) outside += region.Contains(foot[0], foot[1]) ? 0 : 1;
  return static_cast<double>(outside) / static_cast<double>(feet.cols());
}

bool HasValidTrims(const NurbsSurface& surface) {
  try {
    CheckTrims(surface);
  } catch (const std::invalid_argument&) {
    return false;
  }
  return true;
}

// The bounding box of a loop's control points, which contains the loop.
Eigen::AlignedBox2d BoxOf(const NurbsCurve<2>& loop) {
  return {loop.control_points().rowwise().minCoeff(), loop.control_points().rowwise().maxCoeff()};
}

}  // namespace

CompatibleLoops LoopsThatGoTogether(const NurbsSurface& trimmed) {
  const std::vector<NurbsCurve<2>>& all = trimmed.trims();
  if (all.empty() || HasValidTrims(trimmed)) return {all, 0};
  const auto count = static_cast<int>(all.size());
  if (!HasValidTrims(trimmed.WithTrims({all.front()}))) return {{}, count};
  std::vector<NurbsCurve<2>> holes(all.begin() + 1, all.end());
  std::stable_sort(holes.begin(), holes.end(), [](const auto& a, const auto& b) {
    return std::abs(SignedArea(a)) > std::abs(SignedArea(b));
  });
  CompatibleLoops result{{all.front()}, 0};
  for (const NurbsCurve<2>& hole : holes) {
    const Eigen::AlignedBox2d box = BoxOf(hole);
    std::vector<NurbsCurve<2>> near = {all.front()};
    for (size_t k = 1; k < result.loops.size(); ++k)
      if (BoxOf(result.loops[k]).intersects(box)) near.push_back(result.loops[k]);
    near.push_back(hole);
    if (HasValidTrims(trimmed.WithTrims(std::move(near)))) {
      result.loops.push_back(hole);
    } else {
      ++result.left_out;
    }
  }
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
  const Eigen::Array2d most(options.length_u, options.length_v);
  Eigen::Matrix2Xd lengths = stretch.asDiagonal() * (feet.colwise() - low);
  lengths = lengths.array().max(0).matrix();
  for (int d = 0; d < 2; ++d) lengths.row(d) = lengths.row(d).cwiseMin(most[d]);
  const Outline outline = FindOutlineInBox(std::move(lengths), options, pool);
  PointTrim result{surface, outline.warnings};
  if (outline.fills) return result;
  std::vector<NurbsCurve<2>> loops;
  for (const OutlineCurve& curve : outline.loops) loops.push_back(curve.loop);
  NurbsSurface trimmed =
      surface.WithTrims(MovedLoops(TurnedLoops(std::move(loops)), stretch.cwiseInverse(), low));
  if (outline.parts > 1 && ShareOutside(trimmed, feet) > kMostOutside) {
    result.warnings = {"the points fall into " + std::to_string(outline.parts) +
                       " parts: a surface has one outline, so it was not cut back to any; fit one "
                       "part at a time (--box, --where)"};
    return result;
  }
  CompatibleLoops together = LoopsThatGoTogether(trimmed);
  if (together.left_out > 0) {
    result.warnings.push_back(
        together.loops.empty()
            ? "the outline of the points crosses itself: the surface was not cut back to it"
            : "holes among the points whose outlines cross themselves or others were left "
              "closed: " +
                  std::to_string(together.left_out));
    trimmed = surface.WithTrims(std::move(together.loops));
  }
  result.surface = std::move(trimmed);
  return result;
}

}  // namespace batten
