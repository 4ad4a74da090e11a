// SPDX-License-Identifier: MIT
#include "batten/geometry/intersect_surfaces.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "batten/geometry/foot_point.h"
#include "batten/geometry/intersect_curves.h"
#include "batten/geometry/iso_curve.h"
#include "batten/geometry/project_curve.h"
#include "batten/geometry/split.h"
#include "batten/geometry/trim_region.h"
#include "geometry/intersection/branch_chains.h"
#include "geometry/intersection/branch_trims.h"
#include "geometry/intersection/contact_clusters.h"
#include "geometry/intersection/pair_search.h"
#include "geometry/numeric/construction_checks.h"

namespace batten {
using namespace internal;
namespace {

double SizeOfNet(const NurbsSurface& surface) {
  const auto& points = surface.control_points();
  return (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
}

NurbsSurface WithoutTrims(const NurbsSurface& surface) { return surface.WithTrims({}); }

double WorkingTolerance(const NurbsSurface& first,
                        const NurbsSurface& second,
                        const IntersectOptions& options) {
  if (options.tolerance) RequirePositive("IntersectSurfaces", "tolerance", *options.tolerance);
  constexpr double kOfTheSize = 1e-6, kLeastOfTheSize = 1e-12, kUnits = 64, kUnit = 0x1p-52;
  const double a = SizeOfNet(first), b = SizeOfNet(second);
  const double largest = std::max(first.control_points().cwiseAbs().maxCoeff(),
                                  second.control_points().cwiseAbs().maxCoeff());
  return std::max({options.tolerance.value_or(kOfTheSize * std::min(a, b)),
                   kLeastOfTheSize * std::max(a, b),
                   kUnits * kUnit * largest,
                   1e-300});
}

Eigen::Vector4d WidthsOf(const NurbsSurface& a, const NurbsSurface& b) {
  const auto width = [](const SplineBasis& basis) { return basis.upper() - basis.lower(); };
  return {width(a.basis_u()), width(a.basis_v()), width(b.basis_u()), width(b.basis_v())};
}

// The edges of a surface with their places in its domain, as straight lines over the same
// parameter.
struct DomainEdge {
  NurbsCurve<3> curve;
  Eigen::Vector2d from, to;
};

std::vector<DomainEdge> EdgesOf(const NurbsSurface& surface) {
  const auto edges = BoundaryCurves(surface);
  const SplineBasis &u = surface.basis_u(), &v = surface.basis_v();
  return {{edges[0], {u.lower(), v.lower()}, {u.lower(), v.upper()}},
          {edges[1], {u.upper(), v.lower()}, {u.upper(), v.upper()}},
          {edges[2], {u.lower(), v.lower()}, {u.upper(), v.lower()}},
          {edges[3], {u.lower(), v.upper()}, {u.upper(), v.upper()}}};
}

bool Holds(const ParameterBox& box, const Eigen::Vector2d& at) {
  const double u = 1e-6 * (box.u1 - box.u0), v = 1e-6 * (box.v1 - box.v0);
  return at[0] >= box.u0 - u && at[0] <= box.u1 + u && at[1] >= box.v0 - v && at[1] <= box.v1 + v;
}

// None where the curve runs along a seam or over a pole: there its places jump.
std::vector<NurbsCurve<2>> PlacesOn(const NurbsSurface& surface,
                                    const NurbsCurve<3>& curve,
                                    double tolerance) {
  try {
    return ProjectedCurve(surface, curve, tolerance);
  } catch (const std::invalid_argument&) {
    return {};
  }
}

// The edges of one surface that lie on the other, where the two coincide beside them.
void AddOverlapEdges(const NurbsSurface& surface,
                     const NurbsSurface& other,
                     bool first,
                     const std::vector<SurfaceOverlap>& overlaps,
                     double tolerance,
                     std::vector<SurfaceBranch>& branches) {
  for (const DomainEdge& edge : EdgesOf(surface)) {
    if (edge.curve.control_points().rowwise().maxCoeff().isApprox(
            edge.curve.control_points().rowwise().minCoeff(), 1e-12)) {
      continue;
    }
    const double lower = edge.curve.basis().lower(), upper = edge.curve.basis().upper();
    for (const CurveSurfaceOverlap& one :
         IntersectCurveSurface(edge.curve, other, tolerance).overlaps) {
      const double from = one.on_curve.lower, to = one.on_curve.upper;
      const auto place = [&](double t) -> Eigen::Vector2d {
        return edge.from + (t - lower) / (upper - lower) * (edge.to - edge.from);
      };
      const bool here = std::any_of(overlaps.begin(), overlaps.end(), [&](const SurfaceOverlap& o) {
        return Holds(first ? o.first : o.second, place(from / 2 + to / 2));
      });
      if (!here) continue;
      const NurbsCurve<3> curve = Segment(edge.curve, from, to);
      const Eigen::Vector3d middle = curve.At(from / 2 + to / 2);
      const bool known = std::any_of(branches.begin(), branches.end(), [&](const SurfaceBranch& b) {
        return b.kind == BranchKind::kOverlap &&
               CurveFootPoints<3>(b.curve).Nearest(middle).distance <= 4 * tolerance;
      });
      if (known) continue;
      Eigen::Matrix2d ends;
      ends << place(from), place(to);
      std::vector<NurbsCurve<2>> own{NurbsCurve<2>(SplineBasis(1, {from, from, to, to}), ends)};
      std::vector<NurbsCurve<2>> foreign = PlacesOn(other, curve, tolerance);
      const bool closed = (curve.At(from) - curve.At(to)).norm() <= tolerance;
      branches.push_back({BranchKind::kOverlap,
                          closed,
                          curve,
                          first ? own : foreign,
                          first ? foreign : std::move(own)});
    }
  }
}

// At nine places between any two knots.
double DeviationOf(const NurbsSurface& first, const NurbsSurface& second, const SurfaceBranch& b) {
  double most = 0;
  const auto measure = [&](const NurbsSurface& surface, const std::vector<NurbsCurve<2>>& places) {
    for (const NurbsCurve<2>& part : places) {
      for (const int span : part.basis().Spans()) {
        const double from = part.basis().knots()[span], to = part.basis().knots()[span + 1];
        constexpr int kPlaces = 9;
        for (int k = 0; k < kPlaces; ++k) {
          const double t = from + (k + 0.5) / kPlaces * (to - from);
          const Eigen::Vector2d at = part.At(t);
          most = std::max(most, (surface.At(at[0], at[1]) - b.curve.At(t)).norm());
        }
      }
    }
  };
  measure(first, b.on_first);
  measure(second, b.on_second);
  return most;
}

}  // namespace

SurfaceIntersection IntersectSurfaces(const NurbsSurface& first,
                                      const NurbsSurface& second,
                                      const IntersectOptions& options) {
  SurfaceIntersection result;
  const double tolerance = result.tolerance = WorkingTolerance(first, second, options);
  const auto& points = first.control_points();
  const Eigen::Vector3d origin = (points.rowwise().maxCoeff() + points.rowwise().minCoeff()) / 2;
  PatchTree tree_first(first, origin), tree_second(second, origin);
  PairSearch search(tree_first, tree_second, WithoutTrims(second).Translated(-origin), tolerance);
  FoundMeets found = search.Run();
  const SurfaceFootPoints* feet = search.feet();
  if (feet && !found.contacts.empty()) {
    ContactResult contacts = ExplainContacts(tree_first, tree_second, *feet, found, tolerance);
    found.branches.insert(found.branches.end(), contacts.branches.begin(), contacts.branches.end());
    result.touches = std::move(contacts.touches);
    result.overlaps = std::move(contacts.overlaps);
  }
  for (MeetPoint& corner : found.corners) {
    corner.regular = false;  // it may be seen from another side of a seam
    const auto near = [&](const auto& other) { return other.Passes(corner, 8 * tolerance); };
    const auto same = [&](const SurfaceTouch& t) {
      return (t.point - corner.point).norm() <= 8 * tolerance;
    };
    if (std::any_of(found.branches.begin(), found.branches.end(), near) ||
        std::any_of(result.touches.begin(), result.touches.end(), same)) {
      continue;
    }
    result.touches.push_back({corner.point, corner.at.head<2>(), corner.at.tail<2>(), false});
  }
  for (SurfaceTouch& touch : result.touches) touch.point += origin;
  for (SurfaceOverlap& overlap : result.overlaps) overlap.point += origin;
  const Eigen::Vector4d widths = WidthsOf(first, second);
  for (const MeetChain& chain : ChainsOf(std::move(found.branches), 4 * tolerance)) {
    result.branches.push_back(CurvesOf(chain, widths, origin));
  }
  if (!result.overlaps.empty()) {
    const NurbsSurface a = WithoutTrims(first), b = WithoutTrims(second);
    AddOverlapEdges(a, b, true, result.overlaps, tolerance, result.branches);
    AddOverlapEdges(b, a, false, result.overlaps, tolerance, result.branches);
  }
  result.branches = BranchesInside(first, second, std::move(result.branches), tolerance);
  for (SurfaceBranch& branch : result.branches)
    branch.deviation = DeviationOf(first, second, branch);
  if (first.trimmed() || second.trimmed()) {
    const TrimRegion in_first(first), in_second(second);
    std::erase_if(result.touches, [&](const SurfaceTouch& touch) {
      return !in_first.Contains(touch.on_first[0], touch.on_first[1]) ||
             !in_second.Contains(touch.on_second[0], touch.on_second[1]);
    });
  }
  return result;
}

}  // namespace batten
