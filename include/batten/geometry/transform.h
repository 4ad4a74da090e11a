// SPDX-License-Identifier: MIT
// Affine and perspective maps of curves and surfaces.
#pragma once

#include <Eigen/Core>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

// The image under (x, y, z, 1) ↦ matrix · (x, y, z, 1), divided by the last coordinate: the point
// of the image at a parameter is the image of the point at that parameter.
//  (1) Where the last row is 0 0 0 k, k > 0, the map is affine: only control points move, weights
//      and knots stay bit by bit. Projections onto a plane, line or point are affine maps too.
//  (2) Otherwise a control point P keeps its place in the net, moves to its image, and its weight
//  is
//      multiplied by the last coordinate f(P): the image is rational even if the shape was not.
// Rounding: image points and f are right to 4ε·Σ|m_rk·P_k| of their row r, ε = 2^-52.
// Throws std::invalid_argument if the matrix is not finite, or f ≤ 0 to rounding at a control point
// (it lies on or behind the plane that goes to infinity). O(n). [Piegl & Tiller 1997, §6.3]
NurbsSurface Transformed(const NurbsSurface& surface, const Eigen::Matrix4d& matrix);

// The same; a plane curve is taken in the plane z = 0, and the matrix must map that plane onto
// itself, to rounding, or std::invalid_argument is thrown.
template <int Dim>
NurbsCurve<Dim> Transformed(const NurbsCurve<Dim>& curve, const Eigen::Matrix4d& matrix);

// x ↦ x + shift.
Eigen::Matrix4d Translation(const Eigen::Vector3d& shift);

// The turn by `angle` (radians, right-handed) about the axis through the origin, of any length.
// Throws std::invalid_argument if the axis is zero or not finite, or the angle is not.
Eigen::Matrix4d Rotation(const Eigen::Vector3d& axis, double angle);

// x ↦ (a·x, b·y, c·z) with the factors (a, b, c); negative and zero factors are meant.
Eigen::Matrix4d Scaling(const Eigen::Vector3d& factors);
Eigen::Matrix4d Scaling(double factor);

}  // namespace batten
