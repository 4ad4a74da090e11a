// SPDX-License-Identifier: MIT
// Splines evaluated by another method and in long double: control points are differenced first,
// then cornered off by de Boor's algorithm. Beside each value stands its size: the same sum with
// the absolute value of every term, to which rounding is relative.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"
#include "geometry/nurbs/rational_derivatives.h"
#include "geometry/numeric/constants.h"

namespace batten::internal {


using LongMatrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

struct Sized {
  LongMatrix value, size;
};

// Column k: the k-th derivative at u of the spline on `span` with the p+1 coefficients in the
// columns of `active`; one row a coordinate. [Piegl & Tiller 1997, eq. 3.8; de Boor 1972]
inline Sized ExtendedSpline(
    const SplineBasis& basis, int span, double u, int order, const Sized& active) {
  const int p = basis.degree();
  const Eigen::Index rows = active.value.rows();
  const std::vector<long double> U(basis.knots().begin(), basis.knots().end());
  Sized result{LongMatrix::Zero(rows, order + 1), LongMatrix::Zero(rows, order + 1)};
  Sized Q = active;
  for (int k = 0; k <= std::min(order, p); ++k) {
    for (int j = 0; k > 0 && j <= p - k; ++j) {
      const int i = span - p + j;
      const long double factor = (p - k + 1) / (U[i + p + 1] - U[i + k]);
      Q.value.col(j) = (factor * (Q.value.col(j + 1) - Q.value.col(j))).eval();
      Q.size.col(j) = (factor * (Q.size.col(j + 1) + Q.size.col(j))).eval();
    }
    Sized d = Q;
    for (int degree = p - k, r = 1; r <= degree; ++r) {
      for (int j = degree; j >= r; --j) {
        const int i = span - degree + j;
        const long double a = (u - U[i]) / (U[i + degree - r + 1] - U[i]);
        const long double b = (U[i + degree - r + 1] - u) / (U[i + degree - r + 1] - U[i]);
        d.value.col(j) = (b * d.value.col(j - 1) + a * d.value.col(j)).eval();
        d.size.col(j) = (b * d.size.col(j - 1) + a * d.size.col(j)).eval();
      }
    }
    result.value.col(k) = d.value.col(p - k);
    result.size.col(k) = d.size.col(p - k);
  }
  return result;
}

// Columns k = 0 … order: the functions' derivatives on a span, one row a function.
inline Sized ExtendedBasis(const SplineBasis& basis, int span, double u, int order) {
  const LongMatrix unit = LongMatrix::Identity(basis.degree() + 1, basis.degree() + 1);
  return ExtendedSpline(basis, span, u, order, {unit, unit});
}

// Rows of w·(P − origin) and w for control points `first` … `first + count − 1`.
template <typename Points>
Sized ExtendedHomogeneous(const Points& points,
                          const Eigen::VectorXd& weights,
                          const Eigen::VectorXd& origin,
                          Eigen::Index first,
                          Eigen::Index count) {
  const Eigen::Index dim = points.rows();
  Sized active{LongMatrix(dim + 1, count), LongMatrix(dim + 1, count)};
  for (Eigen::Index r = 0; r < count; ++r) {
    const long double w = weights[first + r];
    for (Eigen::Index x = 0; x < dim; ++x) {
      active.value(x, r) = w * (static_cast<long double>(points(x, first + r)) - origin[x]);
    }
    active.value(dim, r) = w;
  }
  active.size = active.value.cwiseAbs();
  return active;
}

// Derivatives of a curve less its origin, a control point of the span: columns k = 0 … order. The
// sizes are those of Leibniz' rule.
template <int Dim>
Sized ExtendedCurve(const NurbsCurve<Dim>& curve,
                    double u,
                    int order,
                    const Eigen::VectorXd& origin) {
  const SplineBasis& basis = curve.basis();
  const int p = basis.degree(), span = basis.Span(u);
  const Eigen::VectorXd weights =
      curve.rational() ? curve.weights() : Eigen::VectorXd::Ones(basis.size());
  const Sized a =
      ExtendedSpline(basis,
                     span,
                     u,
                     order,
                     ExtendedHomogeneous(curve.control_points(), weights, origin, span - p, p + 1));
  Sized c{a.value.topRows(Dim), a.size.topRows(Dim)};
  if (!curve.rational()) return c;
  for (int k = 0; k <= order; ++k) {
    for (int i = 1; i <= k; ++i) {
      const long double binomial = Binomial(k, i);
      c.value.col(k) -= binomial * a.value(Dim, i) * c.value.col(k - i);
      c.size.col(k) += binomial * a.size(Dim, i) * c.size.col(k - i);
    }
    c.value.col(k) /= a.value(Dim, 0);
    c.size.col(k) /= a.value(Dim, 0);
  }
  return c;
}

// Partial derivatives of a surface less its origin: column k·(order+1)+l, for k + l ≤ order.
inline Sized ExtendedSurface(
    const NurbsSurface& surface, double u, double v, int order, const Eigen::VectorXd& origin) {
  const SplineBasis &bu = surface.basis_u(), &bv = surface.basis_v();
  const int p = bu.degree(), q = bv.degree(), su = bu.Span(u), sv = bv.Span(v);
  const Eigen::VectorXd weights =
      surface.rational() ? surface.weights() : Eigen::VectorXd::Ones(surface.weights().size());
  const Eigen::Index stride = order + 1;
  Sized rows{LongMatrix(4 * stride, p + 1), LongMatrix(4 * stride, p + 1)};
  for (int r = 0; r <= p; ++r) {
    const Eigen::Index first = Eigen::Index{su - p + r} * surface.size_v() + sv - q;
    const Sized row = ExtendedSpline(
        bv,
        sv,
        v,
        order,
        ExtendedHomogeneous(surface.control_points(), weights, origin, first, q + 1));
    rows.value.col(r) = row.value.reshaped();
    rows.size.col(r) = row.size.reshaped();
  }
  const Sized all = ExtendedSpline(bu, su, u, order, rows);
  Sized s{LongMatrix::Zero(3, stride * stride), LongMatrix::Zero(3, stride * stride)};
  const auto weight = [&](const LongMatrix& matrix, int k, int l) { return matrix(4 * l + 3, k); };
  for (int k = 0; k <= order; ++k) {
    for (int l = 0; k + l <= order; ++l) {
      auto value = s.value.col(k * stride + l), size = s.size.col(k * stride + l);
      value = all.value.col(k).segment<3>(4 * l);
      size = all.size.col(k).segment<3>(4 * l);
      if (!surface.rational()) continue;
      for (int i = 0; i <= k; ++i) {
        for (int j = i == 0 ? 1 : 0; j <= l; ++j) {
          const long double binomial = Binomial(k, i) * Binomial(l, j);
          const Eigen::Index column = (k - i) * stride + l - j;
          value -= binomial * weight(all.value, i, j) * s.value.col(column);
          size += binomial * weight(all.size, i, j) * s.size.col(column);
        }
      }
      value /= weight(all.value, 0, 0);
      size /= weight(all.value, 0, 0);
    }
  }
  return s;
}

}  // namespace batten::internal
