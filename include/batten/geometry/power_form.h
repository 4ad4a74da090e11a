// SPDX-License-Identifier: MIT
// Curves and surfaces as piecewise polynomials, or their quotients, in powers of the parameter.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

// On the piece [u_k, u_{k+1}], with t = (u − u_k) / (u_{k+1} − u_k) in [0, 1]:
// (w·C, w) = Σ_i a_{k,i} t^i, i = 0 … p. [Piegl & Tiller 1997, §1.2]
template <int Dim>
struct PowerCurve {
  int degree = 0;
  std::vector<double> breaks;    // u_0 < u_1 < …, one more than there are pieces
  bool rational = false;         // else w = 1, and the last row is (1, 0, …, 0)
  Eigen::MatrixXd coefficients;  // (Dim + 1) × pieces·(p + 1); a_{k,i} is column k·(p + 1) + i

  // By Horner's rule; parameters outside are taken at the nearest end. O(p). [A1.1]
  Eigen::Matrix<double, Dim, 1> At(double u) const;
};

// The same with the powers t^i s^j on the cells [u_k, u_{k+1}] × [v_l, v_{l+1}]: a_{k,l,i,j} is
// column ((k·cells_v + l)·(p + 1) + i)·(q + 1) + j.
struct PowerSurface {
  int degree_u = 0, degree_v = 0;
  std::vector<double> breaks_u, breaks_v;
  bool rational = false;
  Eigen::Matrix4Xd coefficients;

  Eigen::Vector3d At(double u, double v) const;
};

// How far the power form may be from the shape, relative to the diagonal of the box of its control
// points, before it is refused.
inline constexpr double kPowerTolerance = 1e-9;

// The power form of every piece. Powers are ill-conditioned: at degree p rounding grows by about
// 3^p, so that 1e-9 is kept up to degree 14 or so. The loss is measured, at 2p + 3 places of every
// piece; throws std::invalid_argument, with what was measured, where it is more than `tolerance` of
// the size and more than 64 units in the last place of the largest coordinate; and where a surface
// is trimmed. O(pieces·p²). [Piegl & Tiller 1997, §6.6]
template <int Dim>
PowerCurve<Dim> ToPower(const NurbsCurve<Dim>& curve, double tolerance = kPowerTolerance);
PowerSurface ToPower(const NurbsSurface& surface, double tolerance = kPowerTolerance);

// The B-spline in Bézier form: every inner break a knot of multiplicity p. Neighbours that meet to
// 1e-9 of the size, rational ones after scaling, get one control point, the middle. Throws
// std::invalid_argument unless 1 ≤ p ≤ kMaxDegree, sizes agree, breaks increase and all is finite;
// where neighbours do not meet (with the gap); and where a control point's weight is not positive.
template <int Dim>
NurbsCurve<Dim> FromPower(const PowerCurve<Dim>& power);
NurbsSurface FromPower(const PowerSurface& power);

extern template struct PowerCurve<2>;
extern template struct PowerCurve<3>;

}  // namespace batten
