// SPDX-License-Identifier: MIT
#include "geometry/intersection/shared_edges.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "batten/geometry/foot_point.h"
#include "batten/geometry/intersect_curves.h"
#include "batten/geometry/iso_curve.h"
#include "batten/geometry/project_curve.h"
#include "batten/geometry/split.h"
#include "geometry/intersection/net_cone.h"
#include "geometry/numeric/box_diagonal.h"

namespace batten::internal {
namespace {

constexpr double kAlongside = 4;  // tolerances: within this a curve runs along another
constexpr int kPlacesAlong = 9;
constexpr double kSamePlane = 1e-3;  // radians between normals of one plane

// An edge of a surface with its places in the domain, a straight line over the same parameter.
struct DomainEdge {
  NurbsCurve<3> curve;
  Eigen::Vector2d from, to;

  Eigen::Vector2d PlaceAt(double t) const {
    const double lower = curve.basis().lower(), upper = curve.basis().upper();
    return from + (t - lower) / (upper - lower) * (to - from);
  }
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

std::vector<double> PlacesAlong(const NurbsCurve<3>& curve) {
  std::vector<double> places;
  const double lower = curve.basis().lower(), upper = curve.basis().upper();
  for (int k = 0; k < kPlacesAlong; ++k) {
    places.push_back(lower + (k + 0.5) / kPlacesAlong * (upper - lower));
  }
  return places;
}

class EdgeMeets {
 public:
  EdgeMeets(const NurbsSurface& surface,
            const NurbsSurface& other,
            bool first,
            SurfaceIntersection& met)
      : surface_(surface), other_(other), feet_(other), first_(first), met_(met) {}

  void Add(const DomainEdge& edge) {
    if (BoxDiagonal(edge.curve.control_points()) <= met_.tolerance) return;
    for (const CurveSurfaceOverlap& one :
         IntersectCurveSurface(edge.curve, other_, met_.tolerance).overlaps) {
      AddStretch(edge, one.on_curve);
    }
  }

 private:
  void AddStretch(const DomainEdge& edge, const Interval& part) {
    const NurbsCurve<3> curve = Segment(edge.curve, part.lower, part.upper);
    if (Known(curve)) return;
    const BranchKind kind = KindOf(edge, curve);
    GiveWay(curve, kind);
    Eigen::Matrix2d ends;
    ends << edge.PlaceAt(part.lower), edge.PlaceAt(part.upper);
    std::vector<NurbsCurve<2>> own{
        NurbsCurve<2>(SplineBasis(1, {part.lower, part.lower, part.upper, part.upper}), ends)};
    std::vector<NurbsCurve<2>> foreign = PlacesOn(other_, curve, met_.tolerance);
    const bool closed = (curve.At(part.lower) - curve.At(part.upper)).norm() <= met_.tolerance;
    met_.branches.push_back(
        {kind, closed, curve, first_ ? own : foreign, first_ ? foreign : std::move(own)});
  }

  // Whether every place of the curve is beside some branch.
  bool Known(const NurbsCurve<3>& curve) const {
    std::vector<double> places = PlacesAlong(curve);
    for (const SurfaceBranch& branch : met_.branches) {
      const CurveFootPoints<3> feet(branch.curve);
      std::erase_if(places, [&](double t) {
        return feet.Nearest(curve.At(t)).distance <= kAlongside * met_.tolerance;
      });
      if (places.empty()) return true;
    }
    return false;
  }

  BranchKind KindOf(const DomainEdge& edge, const NurbsCurve<3>& curve) const {
    const Eigen::Vector2d middle =
        edge.PlaceAt(curve.basis().lower() / 2 + curve.basis().upper() / 2);
    for (const SurfaceOverlap& overlap : met_.overlaps) {
      if (Holds(first_ ? overlap.first : overlap.second, middle)) return BranchKind::kOverlap;
    }
    for (const double t : PlacesAlong(curve)) {
      const Eigen::Vector2d at = edge.PlaceAt(t);
      const SurfaceFoot foot = feet_.Nearest(curve.At(t));
      const auto own = surface_.NormalAt(at[0], at[1]), across = other_.NormalAt(foot.u, foot.v);
      if (own && across && LineAngle(*own, *across) > kSamePlane) return BranchKind::kTransversal;
    }
    return BranchKind::kTangential;
  }

  void GiveWay(const NurbsCurve<3>& curve, BranchKind kind) {
    const CurveFootPoints<3> feet(curve);
    const double size = BoxDiagonal(curve.control_points()), near = kAlongside * met_.tolerance;
    std::erase_if(met_.branches, [&](const SurfaceBranch& branch) {
      const std::vector<double> places = PlacesAlong(branch.curve);
      return std::all_of(places.begin(), places.end(), [&](double t) {
        return feet.Nearest(branch.curve.At(t)).distance <= near;
      });
    });
    if (kind != BranchKind::kTangential) return;
    const double reach = 8 * std::sqrt(met_.tolerance * size);  // of a touch
    std::erase_if(met_.touches, [&](const SurfaceTouch& touch) {
      return feet.Nearest(touch.point).distance <= reach;
    });
  }

  const NurbsSurface &surface_, &other_;
  SurfaceFootPoints feet_;
  bool first_;
  SurfaceIntersection& met_;
};

}  // namespace

void AddSharedEdges(const NurbsSurface& first,
                    const EdgeChoice& of_first,
                    const NurbsSurface& second,
                    const EdgeChoice& of_second,
                    SurfaceIntersection& met) {
  const NurbsSurface a = first.WithTrims({}), b = second.WithTrims({});
  const auto add = [&](const NurbsSurface& surface,
                       const NurbsSurface& other,
                       bool is_first,
                       const EdgeChoice& choice) {
    if (std::none_of(choice.begin(), choice.end(), [](bool chosen) { return chosen; })) return;
    EdgeMeets meets(surface, other, is_first, met);
    const std::vector<DomainEdge> edges = EdgesOf(surface);
    for (std::size_t k = 0; k < edges.size(); ++k) {
      if (choice[k]) meets.Add(edges[k]);
    }
  };
  add(a, b, true, of_first);
  add(b, a, false, of_second);
}

}  // namespace batten::internal
