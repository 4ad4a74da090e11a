// SPDX-License-Identifier: MIT
#include "batten/geometry/intersect_surfaces.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "batten/geometry/trim_region.h"
#include "geometry/intersection/branch_chains.h"
#include "geometry/intersection/branch_trims.h"
#include "geometry/intersection/contact_clusters.h"
#include "geometry/intersection/pair_search.h"
#include "geometry/intersection/shared_edges.h"
#include "geometry/numeric/box_diagonal.h"
#include "geometry/numeric/construction_checks.h"
#include "geometry/numeric/number_text.h"
#include "geometry/numeric/reject.h"

namespace batten {
using namespace internal;
namespace {

// Touches reach 8 √(tolerance · size): a surface that is no larger has nothing else.
constexpr double kTolerancesInSize = 64;

NurbsSurface WithoutTrims(const NurbsSurface& surface) { return surface.WithTrims({}); }

double WorkingTolerance(const NurbsSurface& first,
                        const NurbsSurface& second,
                        const IntersectOptions& options) {
  if (options.tolerance) RequirePositive("IntersectSurfaces", "tolerance", *options.tolerance);
  constexpr double kOfTheSize = 1e-6, kLeastOfTheSize = 1e-12, kUnits = 64, kUnit = 0x1p-52;
  const double a = BoxDiagonal(first.control_points()), b = BoxDiagonal(second.control_points());
  if (options.tolerance && *options.tolerance * kTolerancesInSize >= std::min(a, b) &&
      std::min(a, b) > 0) {
    Reject("IntersectSurfaces",
           "tolerance = " + NumberText(*options.tolerance) +
               " is not below a sixty-fourth of the smaller surface's size, " +
               RoundedText(std::min(a, b)) + ": everything would be one touch; ask for less");
  }
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

// The edges of a domain that the boxes in it reach.
EdgeChoice EdgesBeside(const NurbsSurface& surface, const std::vector<ParameterBox>& boxes) {
  const SplineBasis &u = surface.basis_u(), &v = surface.basis_v();
  EdgeChoice beside{};
  for (const ParameterBox& box : boxes) {
    beside[0] |= box.u0 <= u.lower();
    beside[1] |= box.u1 >= u.upper();
    beside[2] |= box.v0 <= v.lower();
    beside[3] |= box.v1 >= v.upper();
  }
  return beside;
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
  // Surfaces that end in each other's plane are near one another in contacts only.
  if (!found.contacts.empty()) {
    std::vector<ParameterBox> in_first, in_second;
    for (const ContactPatch& contact : found.contacts) {
      in_first.push_back(contact.box);
      in_second.push_back(tree_second[contact.patch_b].box);
    }
    AddSharedEdges(
        first, EdgesBeside(first, in_first), second, EdgesBeside(second, in_second), result);
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
