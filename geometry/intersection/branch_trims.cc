// SPDX-License-Identifier: MIT
#include "geometry/intersection/branch_trims.h"

#include <algorithm>
#include <optional>
#include <utility>

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
  explicit LoopsOfSurface(const NurbsSurface& surface) : domain_(surface), region_(surface) {
    for (const NurbsCurve<2>& loop : surface.trims()) loops_.push_back(InUnits(loop, domain_));
  }

  void AddCuts(const std::vector<NurbsCurve<2>>& curves, std::vector<double>& cuts) const {
    constexpr double kOne = 1e-9;  // of the domain
    for (const NurbsCurve<2>& curve : curves) {
      const NurbsCurve<2> unit = InUnits(curve, domain_);
      for (const NurbsCurve<2>& loop : loops_) {
        const CurveIntersection<2> met = IntersectCurves(unit, loop, kOne);
        for (const CurveMeeting<2>& one : met.points) cuts.push_back(one.first);
        for (const CurveOverlap& one : met.overlaps) {
          cuts.push_back(one.first.lower);
          cuts.push_back(one.first.upper);
        }
      }
    }
  }

  // Along a loop itself rounding would decide: a little to either side counts.
  bool Holds(const std::vector<NurbsCurve<2>>& curves, double t) const {
    if (loops_.empty()) return true;
    for (const NurbsCurve<2>& curve : curves) {
      if (t < curve.basis().lower() || t > curve.basis().upper()) continue;
      const Eigen::Vector2d at = curve.At(t);
      constexpr double kAside = 1e-8;
      for (const double du : {0.0, -kAside, kAside}) {
        for (const double dv : {0.0, -kAside, kAside}) {
          if (region_.Contains(at[0] + du * domain_.length[0], at[1] + dv * domain_.length[1])) {
            return true;
          }
        }
      }
    }
    return false;
  }

 private:
  UnitDomain domain_;
  TrimRegion region_;
  std::vector<NurbsCurve<2>> loops_;
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
    const double middle = cuts[k] / 2 + cuts[k + 1] / 2;
    if (!first.Holds(branch.on_first, middle) || !second.Holds(branch.on_second, middle)) continue;
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
  const LoopsOfSurface loops_first(first), loops_second(second);
  std::vector<SurfaceBranch> kept;
  for (const SurfaceBranch& branch : branches) {
    AddParts(loops_first, loops_second, branch, tolerance, kept);
  }
  return kept;
}

}  // namespace batten::internal
