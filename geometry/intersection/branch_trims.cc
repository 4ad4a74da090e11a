// SPDX-License-Identifier: MIT
#include "geometry/intersection/branch_trims.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "batten/geometry/foot_point.h"
#include "batten/geometry/intersect_curves.h"
#include "batten/geometry/join.h"
#include "batten/geometry/reparameterize.h"
#include "batten/geometry/split.h"
#include "batten/geometry/trim_region.h"
#include "geometry/editing/monotone_arcs.h"

namespace batten::internal {
namespace {

NurbsCurve<2> InUnits(const NurbsCurve<2>& curve, const UnitDomain& domain) {
  NurbsCurve<2>::Points points = curve.control_points();
  for (Eigen::Index k = 0; k < points.cols(); ++k) points.col(k) = domain(points.col(k).eval());
  return NurbsCurve<2>(curve.basis(), std::move(points), curve.weights());
}

// The trims of one surface, asked about the branch's curves in its domain.
class LoopsOfSurface {
 public:
  LoopsOfSurface(const NurbsSurface& surface, double tolerance)
      : surface_(surface), domain_(surface), region_(surface), tolerance_(tolerance) {
    for (const NurbsCurve<2>& loop : surface.trims()) {
      loops_.push_back(InUnits(loop, domain_));
      feet_.emplace_back(loops_.back());
    }
  }

  void AddCuts(const std::vector<NurbsCurve<2>>& curves, std::vector<double>& cuts) const {
    for (const NurbsCurve<2>& curve : curves) {
      const NurbsCurve<2> unit = InUnits(curve, domain_);
      const double near = ToleranceAlong(curve);
      for (const NurbsCurve<2>& loop : loops_) {
        const CurveIntersection<2> met = IntersectCurves(unit, loop, near);
        for (const CurveMeeting<2>& one : met.points) cuts.push_back(one.first);
        for (const CurveOverlap& one : met.overlaps) {
          cuts.push_back(one.first.lower);
          cuts.push_back(one.first.upper);
        }
      }
    }
  }

  // Whether the branch is inside all over a stretch that no loop crosses, or along a loop, where
  // the tolerance would decide.
  bool Holds(const std::vector<NurbsCurve<2>>& curves, double from, double to) const {
    if (loops_.empty()) return true;
    constexpr int kPlaces = 5;
    for (int k = 0; k < kPlaces; ++k) {
      if (!HoldsAt(curves, from + (k + 0.5) / kPlaces * (to - from))) return false;
    }
    return true;
  }

 private:
  bool HoldsAt(const std::vector<NurbsCurve<2>>& curves, double t) const {
    for (const NurbsCurve<2>& curve : curves) {
      if (t < curve.basis().lower() || t > curve.basis().upper()) continue;
      const Eigen::Vector2d at = curve.At(t);
      if (region_.Contains(at[0], at[1]) || BesideLoop(at)) return true;
    }
    return false;
  }

  // Within twice the tolerance in space: the branch's and the loop's own.
  bool BesideLoop(const Eigen::Vector2d& at) const {
    const Eigen::Vector3d here = surface_.At(at[0], at[1]);
    Eigen::Vector3d flat = Eigen::Vector3d::Zero();
    flat.head<2>() = domain_(at);
    return std::any_of(feet_.begin(), feet_.end(), [&](const CurveFootPoints<2>& feet) {
      const Eigen::Vector2d foot = domain_.Back(feet.curve().At(feet.Nearest(flat).u));
      return (surface_.At(foot[0], foot[1]) - here).norm() <= 2 * tolerance_;
    });
  }

  // Of the unit domain, so that no two places so near are farther apart in space, along the curve,
  // than the tolerance.
  double ToleranceAlong(const NurbsCurve<2>& curve) const {
    constexpr int kPlaces = 9;
    constexpr double kLeast = 1e-9, kMost = 1e-4;
    double fastest = 0;
    for (int k = 0; k <= kPlaces; ++k) {
      const double t = static_cast<double>(k) / kPlaces;
      const Eigen::Vector2d at =
          curve.At(curve.basis().lower() * (1 - t) + curve.basis().upper() * t);
      const SurfaceDerivatives jet = surface_.Derivatives(at[0], at[1], 1);
      fastest = std::max(
          {fastest, jet(1, 0).norm() * domain_.length[0], jet(0, 1).norm() * domain_.length[1]});
    }
    return std::clamp(tolerance_ / std::max(fastest, 1e-300), kLeast, kMost);
  }

  const NurbsSurface& surface_;
  UnitDomain domain_;
  TrimRegion region_;
  double tolerance_;
  std::vector<NurbsCurve<2>> loops_;
  std::vector<CurveFootPoints<2>> feet_;
};

std::vector<NurbsCurve<2>> PartsOf(const std::vector<NurbsCurve<2>>& curves,
                                   double from,
                                   double to) {
  std::vector<NurbsCurve<2>> parts;
  for (const NurbsCurve<2>& curve : curves) {
    const double a = std::max(from, curve.basis().lower());
    const double b = std::min(to, curve.basis().upper());
    constexpr double kShort = 1e-9;
    if (b - a > kShort * (to - from)) parts.push_back(Segment(curve, a, b));
  }
  return parts;
}

template <int Dim>
NurbsCurve<Dim> Shifted(const NurbsCurve<Dim>& curve, double by) {
  return Reparameterized(curve, curve.basis().lower() + by, curve.basis().upper() + by);
}

// A part that ends where the next begins, over the start of a closed branch.
SurfaceBranch Joined(const SurfaceBranch& last, const SurfaceBranch& first, double tolerance) {
  const double by = last.curve.basis().upper() - first.curve.basis().lower();
  SurfaceBranch joined = last;
  joined.curve = Join(last.curve, first.curve, 4 * tolerance);
  for (const NurbsCurve<2>& part : first.on_first) joined.on_first.push_back(Shifted(part, by));
  for (const NurbsCurve<2>& part : first.on_second) joined.on_second.push_back(Shifted(part, by));
  return joined;
}

void AddParts(const LoopsOfSurface& first,
              const LoopsOfSurface& second,
              const SurfaceBranch& branch,
              double tolerance,
              std::vector<SurfaceBranch>& kept) {
  const double lower = branch.curve.basis().lower(), upper = branch.curve.basis().upper();
  std::vector<double> cuts{lower, upper};
  first.AddCuts(branch.on_first, cuts);
  second.AddCuts(branch.on_second, cuts);
  std::sort(cuts.begin(), cuts.end());
  const auto near = [&](double x, double y) { return y - x <= tolerance; };
  cuts.erase(std::unique(cuts.begin(), cuts.end(), near), cuts.end());
  cuts.back() = upper;
  std::vector<std::pair<double, double>> stretches;
  for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
    if (!first.Holds(branch.on_first, cuts[k], cuts[k + 1]) ||
        !second.Holds(branch.on_second, cuts[k], cuts[k + 1])) {
      continue;
    }
    if (!stretches.empty() && stretches.back().second == cuts[k]) {
      stretches.back().second = cuts[k + 1];
    } else {
      stretches.emplace_back(cuts[k], cuts[k + 1]);
    }
  }
  if (stretches.size() == 1 && stretches[0] == std::pair(lower, upper)) {
    kept.push_back(branch);
    return;
  }
  std::vector<SurfaceBranch> parts;
  for (const auto& [from, to] : stretches) {
    parts.push_back({branch.kind,
                     false,
                     Segment(branch.curve, from, to),
                     PartsOf(branch.on_first, from, to),
                     PartsOf(branch.on_second, from, to)});
  }
  if (branch.closed && parts.size() > 1 && stretches.front().first == lower &&
      stretches.back().second == upper) {
    parts.front() = Joined(parts.back(), parts.front(), tolerance);
    parts.pop_back();
  }
  kept.insert(kept.end(), parts.begin(), parts.end());
}

}  // namespace

std::vector<SurfaceBranch> BranchesInside(const NurbsSurface& first,
                                          const NurbsSurface& second,
                                          std::vector<SurfaceBranch> branches,
                                          double tolerance) {
  if (!first.trimmed() && !second.trimmed()) return branches;
  const LoopsOfSurface loops_first(first, tolerance), loops_second(second, tolerance);
  std::vector<SurfaceBranch> kept;
  for (const SurfaceBranch& branch : branches) {
    AddParts(loops_first, loops_second, branch, tolerance, kept);
  }
  return kept;
}

}  // namespace batten::internal
