// SPDX-License-Identifier: MIT
// Arcs of conics as quadratic rational Bézier curves whose control points may lie at infinity.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "batten/geometry/conic.h"
#include "batten/geometry/nurbs_curve.h"

namespace batten {

// C(t) = Σ B_i(t) w_i P_i / Σ B_i(t) w_i, i = 0 … 2, in homogeneous form. Column i is (w_i P_i,
// w_i); with a last number of zero it is a control point at infinity in the direction of the
// others: of half an ellipse, whose end tangents are parallel. [Piegl & Tiller 1997, §7.3]
template <int Dim>
struct ConicArc {
  using Point = Eigen::Matrix<double, Dim, 1>;
  Eigen::Matrix<double, Dim + 1, 3> columns;

  // With end weights of one: the same curve by a linear rational reparameterization. Throws
  // std::invalid_argument unless both end weights are positive or both negative, and all is finite.
  ConicArc Standard() const;

  // k = w0·w2 / w1² of the standard form: > 1 on an ellipse, 1 on a parabola, < 1 on a hyperbola;
  // infinite where the middle control point is.
  double ShapeFactor() const;

  Point At(double t) const;  // t in [0, 1]
};

// The curve with positive weights: one piece where the weight of the middle control point in
// standard form is at least 1/2 (a turn of up to 120° on a circle), else halved at its shoulder
// once or twice, so two or four equal pieces on [0, 1]. So a control point at infinity, which no
// file can carry, and a negative weight, the complementary arc of an ellipse, are converted
// exactly. Throws std::invalid_argument as Standard() does, and where the arc runs through infinity
// (a standard weight of −1 or less).
template <int Dim>
NurbsCurve<Dim> ToNurbs(const ConicArc<Dim>& arc);

// The arc from `start` to `end` with these tangents there (of either sense) that passes through
// `point`. Tangents that are parallel to 1e-12 give half an ellipse. Throws std::invalid_argument
// where start and end coincide, a tangent runs along the chord, the tangents miss each other or the
// point misses their plane by more than 1e-6 of the chord (the message says by how much), and where
// no arc without a point at infinity passes there. [Piegl & Tiller 1997, §7.5, A7.2]
template <int Dim>
ConicArc<Dim> ConicArcThrough(const Eigen::Matrix<double, Dim, 1>& start,
                              const Eigen::Matrix<double, Dim, 1>& start_tangent,
                              const Eigen::Matrix<double, Dim, 1>& end,
                              const Eigen::Matrix<double, Dim, 1>& end_tangent,
                              const Eigen::Matrix<double, Dim, 1>& point);

// With these tangents and Liming's rho in (0, 1): the share of the way from the middle of the chord
// to the crossing of the tangents at which the shoulder lies. Below 1/2 an ellipse, at 1/2 a
// parabola, above a hyperbola. Refuses parallel tangents. [Farin 2002, §12.7]
template <int Dim>
ConicArc<Dim> ConicArcOfRho(const Eigen::Matrix<double, Dim, 1>& start,
                            const Eigen::Matrix<double, Dim, 1>& start_tangent,
                            const Eigen::Matrix<double, Dim, 1>& end,
                            const Eigen::Matrix<double, Dim, 1>& end_tangent,
                            double rho);

// With this shoulder, the point whose tangent is parallel to the chord, and rho in [0, 1); 0 is
// half an ellipse.
template <int Dim>
ConicArc<Dim> ConicArcOfShoulder(const Eigen::Matrix<double, Dim, 1>& start,
                                 const Eigen::Matrix<double, Dim, 1>& shoulder,
                                 const Eigen::Matrix<double, Dim, 1>& end,
                                 double rho);

// The arc through five points (columns), from the first to the last through the others. Throws
// std::invalid_argument where two coincide or three lie on a line (to 1e-9 of their extent: the
// conic is then lines), where in space they are off their plane by more than 1e-6 of it, and where
// no arc from the first to the last holds the others: points of both branches of a hyperbola.
template <int Dim>
ConicArc<Dim> ConicArcThroughFive(const Eigen::Matrix<double, Dim, 5>& points);

// The arc of a conic between two of its points: through `via` where it is given, else the one of
// less turn, and of two halves of an ellipse the counter-clockwise one. The points are first moved
// onto the conic. Throws std::invalid_argument where the conic is degenerate (the message says what
// it is), a point is farther from it than `tolerance` (> 0, the data's units; unset 1e-6 of the
// chord), start and end coincide or lie on different branches, and where the arc through `via` runs
// through infinity.
ConicArc<2> ArcOf(const ImplicitConic& conic,
                  const Eigen::Vector2d& start,
                  const Eigen::Vector2d& end,
                  const std::optional<Eigen::Vector2d>& via = {},
                  std::optional<double> tolerance = {});

// The equation of the whole conic, scaled so that its largest coefficient is ±1. Throws
// std::invalid_argument where the control points are on one line. [Sederberg, Anderson & Goldman
// 1984]
ImplicitConic ImplicitOf(const ConicArc<2>& arc);

extern template struct ConicArc<2>;
extern template struct ConicArc<3>;

}  // namespace batten
