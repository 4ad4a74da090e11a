// SPDX-License-Identifier: MIT
// Bézier curves in the plane or in space, polynomial or rational.
#pragma once

#include <Eigen/Core>
#include <span>
#include <utility>

#include "batten/geometry/nurbs_curve.h"

namespace batten {

// The highest degree of a Bézier curve or surface: hodographs of rational ones have twice the
// degree.
inline constexpr int kMaxBezierDegree = 2 * kMaxDegree;

// C(t) = Σ B_{i,n}(t) w_i P_i / Σ B_{i,n}(t) w_i on [0, 1], B_{i,n} the Bernstein polynomials. A
// value: editing returns a new one. Parameters outside [0, 1] are taken at its nearest end.
// [Piegl & Tiller 1997, §1.3, §1.4]
template <int Dim>
class BezierCurve {
 public:
  using Point = Eigen::Matrix<double, Dim, 1>;
  using Points = Eigen::Matrix<double, Dim, Eigen::Dynamic>;

  // Control points are Euclidean (Dim × (n+1)); no weights means all ones. Throws
  // std::invalid_argument unless 0 ≤ n ≤ kMaxBezierDegree, sizes agree, everything is finite and
  // weights are positive.
  explicit BezierCurve(Points control_points, Eigen::VectorXd weights = {});

  int degree() const { return static_cast<int>(control_points_.cols()) - 1; }
  const Points& control_points() const { return control_points_; }
  const Eigen::VectorXd& weights() const { return weights_; }
  bool rational() const { return rational_; }  // weights differ

  // De Casteljau's corner cutting; for a rational curve Farin's form of it, in which every
  // intermediate point is a mean of two others with positive weights, so that the point lies in the
  // hull of the control points whatever the weights are. O(n²). [A1.5; Farin 2002, §13.2]
  Point At(double t) const;

  // Column k is the k-th derivative, k = 0 … order.
  Points Derivatives(double t, int order) const;

  bool operator==(const BezierCurve&) const = default;

 private:
  Points control_points_;
  Eigen::VectorXd weights_;
  bool rational_;
};

extern template class BezierCurve<2>;
extern template class BezierCurve<3>;

enum class CurveEnd { kStart, kEnd };

// Point, first and second derivative at an end, in three columns, from the nearest three control
// points and weights alone. [Piegl & Tiller 1997, eqs. 1.10, 1.11, 4.9, 4.10; Farin 2002, §13.5]
template <int Dim>
Eigen::Matrix<double, Dim, 3> EndDerivatives(const BezierCurve<Dim>& curve, CurveEnd end);

// The curve of first derivatives: of degree n − 1 for a polynomial curve (0 for a point), of degree
// 2n for a rational one: with C = A/w, C' = (A'w − Aw')/w², a rational curve with weights of w².
// Throws std::invalid_argument when that degree is above kMaxBezierDegree.
template <int Dim>
BezierCurve<Dim> Hodograph(const BezierCurve<Dim>& curve);

// The parts on [0, t] and [t, 1], each on [0, 1] again. Throws std::invalid_argument unless
// 0 < t < 1. [Piegl & Tiller 1997, eq. 1.13]
template <int Dim>
std::pair<BezierCurve<Dim>, BezierCurve<Dim>> Subdivided(const BezierCurve<Dim>& curve, double t);

// The same curve with degree n + by. Control points are means of given ones; rounding moves no
// point by more than 8(n+by+1)·ε times the largest coordinate. Throws std::invalid_argument when by
// is negative or the degree is above kMaxBezierDegree.
template <int Dim>
BezierCurve<Dim> Elevated(const BezierCurve<Dim>& curve, int by = 1);

// The polynomial curve of degree n through n+1 points (columns) at n+1 increasing parameters in
// [0, 1]. It goes through the points to 1e-12 of the largest control point. Throws
// std::invalid_argument unless sizes agree and the parameters increase. O(n³).
template <int Dim>
BezierCurve<Dim> InterpolatingBezierCurve(const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points,
                                          std::span<const double> parameters);

// At the parameters k/n.
template <int Dim>
BezierCurve<Dim> InterpolatingBezierCurve(const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points);

// The same curve over [lower, upper] as a NURBS curve of one span. Throws std::invalid_argument
// unless lower < upper and the degree is in [1, kMaxDegree].
template <int Dim>
NurbsCurve<Dim> ToNurbs(const BezierCurve<Dim>& curve, double lower = 0, double upper = 1);

// The Bézier form of a NURBS curve of one non-empty span (clamped or not), its domain brought to
// [0, 1]. Throws std::invalid_argument when it has more spans.
template <int Dim>
BezierCurve<Dim> ToBezier(const NurbsCurve<Dim>& curve);

// (Dim + 1) × (n + 1): column i is (w_i·P_i, w_i), with w_i = 1 where the curve is not rational.
template <int Dim>
Eigen::MatrixXd Homogeneous(const BezierCurve<Dim>& curve);

// The curve with these homogeneous control points; `rational` false sets all weights to one.
template <int Dim>
BezierCurve<Dim> BezierFromHomogeneous(const Eigen::MatrixXd& columns, bool rational);

}  // namespace batten
