// SPDX-License-Identifier: MIT
// Several points and derivatives that a shape is to have, met at once with the least change.
#pragma once

#include <Eigen/Core>
#include <span>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

// What a curve is to have at a parameter: the point (order 0) or its derivative of an order up to
// 25, in the data's units by the parameter's to the power of the order.
template <int Dim>
struct CurveTarget {
  double u = 0;
  Eigen::Matrix<double, Dim, 1> value;
  int order = 0;
};

// The same for a surface: ∂^(k+l)S/∂u^k∂v^l.
struct SurfaceTarget {
  double u = 0, v = 0;
  Eigen::Vector3d value;
  int order_u = 0, order_v = 0;
};

// A control point (i,j) of a surface.
struct NetPlace {
  int i = 0, j = 0;
};

// The shape that meets every target: of all moves of control points that do it, the one whose
// squared distances sum to least. Weights, knots and trims stay bit by bit, as do the control
// points in `fixed` and those that act at no target. Copies of a control point over a periodic
// basis move together and count once, as do those that coincide because the shape closes over a
// clamped basis or an edge of it is a point: it stays closed. A point of the shape that is to stay
// where it is, is a target of its own. Targets are met to 1e-9 of the greatest change asked for,
// usually to rounding.
//
// Throws std::invalid_argument where a parameter is outside the domain (in a periodic direction it
// is wrapped), an order negative or above 25, a value not finite, a control point not there; where
// there are more than 500 targets; and where targets cannot be met, by so much: they contradict one
// another, all control points that act there are fixed, or the degree has no such derivative.
// O(c²·a), c targets, a control points that act at them. [Piegl & Tiller 1997, §11.5.1]
template <int Dim>
NurbsCurve<Dim> WithTargets(const NurbsCurve<Dim>& curve,
                            std::span<const CurveTarget<Dim>> targets,
                            std::span<const int> fixed = {});
NurbsSurface WithTargets(const NurbsSurface& surface,
                         std::span<const SurfaceTarget> targets,
                         std::span<const NetPlace> fixed = {});

}  // namespace batten
