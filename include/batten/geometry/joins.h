// SPDX-License-Identifier: MIT
// How smoothly two curves, two surfaces, or the ends of one shape meet, as measured.
#pragma once

#include <array>
#include <optional>

#include "batten/geometry/direction.h"
#include "batten/geometry/join_options.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

// What holds where two shapes meet; all gaps are the largest found along the joint.
//  G0: they meet. G1: the tangent goes on in its direction, over an edge the tangent plane goes on
//  without folding back. G2: so does the curvature, over an edge in every direction.
//  C0: they meet. C1, C2: so do the first, and the second, derivatives by the parameters as they
//  are, one shape run backwards or its directions swapped if need be; over an edge all partial
//  derivatives, those along the edge too.
struct JoinQuality {
  int parametric = -1;      // k of C^k, −1 … 2
  int geometric = -1;       // k of G^k, −1 … 2
  double position_gap = 0;  // the data's units
  // Between the directions across the joint, in [0, π]; none where a shape has no tangent (plane).
  std::optional<double> angle_gap;
  // One over the data's units. Curves: the length of the difference of the curvature vectors.
  // Surfaces: the largest difference of normal curvatures in one direction of the tangent plane.
  // None where a curvature is infinite or unknown.
  std::optional<double> curvature_gap;
};

struct CurveJoin : JoinQuality {
  std::array<double, 2> at;  // the parameter on each curve: an end of its domain
};

// At their nearest ends; among equally near ones the end of the first and the start of the second.
// Where C′ vanishes the tangent is the limit. Throws std::invalid_argument unless all tolerances
// are positive. O(degree²).
template <int Dim>
CurveJoin TestJoin(const NurbsCurve<Dim>& first,
                   const NurbsCurve<Dim>& second,
                   const JoinOptions& options = {});

// From the end of a curve to its own start.
template <int Dim>
CurveJoin TestSeam(const NurbsCurve<Dim>& curve, const JoinOptions& options = {});

// One of the four edges of a surface: where `direction` is at the end of its domain.
struct SurfaceEdge {
  Direction direction = Direction::kU;
  bool upper = false;

  bool operator==(const SurfaceEdge&) const = default;
};

struct SurfaceJoin : JoinQuality {
  std::array<SurfaceEdge, 2> edges;
  bool reversed = false;  // the edges run in opposite senses
  int shared_edges = 0;   // how many pairs of edges coincide; measured is the first
  // (u, v) on each, where the joint is worst: widest where it is open, else most bent where it is
  // not G1, else where the curvature differs most.
  std::array<Eigen::Vector2d, 2> at;
};

// Across the edges that coincide, as curves in space whatever their parameters; if none do, across
// those with the least gap, the largest distance of a point of one edge from the other. Edges are
// compared, and everything is measured, at some dozens of places of each edge, at least three in
// every span where there are fewer than a hundred, with the nearest points of the other; a gap
// between these places goes unseen. Collapsed edges do not count. Throws std::invalid_argument
// where two edges coincide over a stretch but not wholly, and for tolerances as above.
SurfaceJoin TestJoin(const NurbsSurface& first,
                     const NurbsSurface& second,
                     const JoinOptions& options = {});

// From the upper edge of a direction of a surface to its lower one.
SurfaceJoin TestSeam(const NurbsSurface& surface,
                     Direction direction,
                     const JoinOptions& options = {});

extern template CurveJoin TestJoin(const NurbsCurve<2>&, const NurbsCurve<2>&, const JoinOptions&);
extern template CurveJoin TestJoin(const NurbsCurve<3>&, const NurbsCurve<3>&, const JoinOptions&);
extern template CurveJoin TestSeam(const NurbsCurve<2>&, const JoinOptions&);
extern template CurveJoin TestSeam(const NurbsCurve<3>&, const JoinOptions&);

}  // namespace batten
