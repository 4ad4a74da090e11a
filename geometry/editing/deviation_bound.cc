// SPDX-License-Identifier: MIT
#include "geometry/editing/deviation_bound.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "geometry/bezier/bernstein.h"
#include "geometry/bezier/bezier_span.h"
#include "geometry/numeric/number_text.h"
#include "geometry/bezier/rational_patch.h"
#include "geometry/numeric/constants.h"

namespace batten::internal {
namespace {

// One direction of a shape between two neighbouring breaks: Bézier points are the control points
// first, first + 1, … times the matrix.
struct Stretch {
  int first;
  Eigen::MatrixXd matrix;
};

// A shape as the bound needs it; a curve is a net of one column.
struct Shape {
  Eigen::Index dimension, size_v;
  const double* points;  // dimension × n, v fastest
  const Eigen::VectorXd* weights;
  bool rational;

  double Weight(Eigen::Index k) const { return rational ? (*weights)[k] : 1; }
  auto Point(Eigen::Index k) const {
    return Eigen::Map<const Eigen::VectorXd>(points + k * dimension, dimension);
  }
};

template <int Dim>
Shape ShapeOf(const NurbsCurve<Dim>& curve) {
  return {Dim, 1, curve.control_points().data(), &curve.weights(), curve.rational()};
}

Shape ShapeOf(const NurbsSurface& s) {
  return {3, s.size_v(), s.control_points().data(), &s.weights(), s.rational()};
}

std::vector<double> UnitedBreaks(const SplineBasis& a, const SplineBasis& b) {
  if (a.lower() != b.lower() || a.upper() != b.upper()) {
    throw std::invalid_argument("DeviationBound: the domains " +
                                IntervalText(a.lower(), a.upper()) + " and " +
                                IntervalText(b.lower(), b.upper()) + " differ");
  }
  std::vector<double> breaks;
  for (const SplineBasis* basis : {&a, &b}) {
    for (int i = basis->degree(); i <= basis->size(); ++i) breaks.push_back(basis->knots()[i]);
  }
  std::sort(breaks.begin(), breaks.end());
  breaks.erase(std::unique(breaks.begin(), breaks.end()), breaks.end());
  return breaks;
}

std::vector<Stretch> StretchesOf(const SplineBasis& basis, const std::vector<double>& breaks) {
  std::vector<Stretch> stretches;
  int last = -1;
  Eigen::MatrixXd whole;
  for (size_t k = 0; k + 1 < breaks.size(); ++k) {
    const int span = basis.Span(breaks[k]);
    if (span != last) whole = BezierSpanMatrix(basis, span).transpose();
    last = span;
    const double a = basis.knots()[span], length = basis.knots()[span + 1] - a;
    const double s = (breaks[k] - a) / length, t = (breaks[k + 1] - a) / length;
    stretches.push_back({span - basis.degree(), RestrictedBernstein(whole, s, t)});
  }
  return stretches;
}

// One direction of a curve seen as a surface.
const std::vector<Stretch>& NoDirection() {
  static const std::vector<Stretch> one(1, Stretch{0, Eigen::MatrixXd::Ones(1, 1)});
  return one;
}

RationalPatch PatchOf(const Shape& shape,
                      const Stretch& u,
                      const Stretch& v,
                      const Eigen::VectorXd& origin) {
  const Eigen::Index d = shape.dimension, n = u.matrix.rows(), m = v.matrix.rows();
  RationalPatch patch{static_cast<int>(n) - 1, static_cast<int>(m) - 1, {}};
  patch.columns = Eigen::MatrixXd::Zero(d + 1, n * m);
  for (Eigen::Index i = 0; i < n; ++i) {
    Eigen::MatrixXd row(d + 1, m);
    for (Eigen::Index j = 0; j < m; ++j) {
      const Eigen::Index k = (u.first + i) * shape.size_v + v.first + j;
      row.col(j) << shape.Weight(k) * (shape.Point(k) - origin), shape.Weight(k);
    }
    row *= v.matrix;
    for (Eigen::Index k = 0; k < n; ++k) {
      patch.columns.middleCols(k * m, m) += u.matrix(i, k) * row;
    }
  }
  if (!shape.rational) patch.columns.row(d).setOnes();
  return patch;
}

double SizeOf(const RationalPatch& patch) {
  const Eigen::Index d = patch.columns.rows() - 1;
  return (patch.columns.topRows(d).array().rowwise() / patch.columns.row(d).array())
      .abs()
      .maxCoeff();
}

// Pieces of two shapes over the same stretches, and how large they are.
class Pieces {
 public:
  void Add(const RationalPatch& a, const RationalPatch& b) {
    differences_.push_back(Difference(a, b));
    const double degrees = a.p + a.q + b.p + b.q;
    negligible_ = std::max(negligible_, 8 * degrees * kEpsilon * std::max(SizeOf(a), SizeOf(b)));
  }
  double Bound(double enough) && {
    return FarthestBound(std::move(differences_), negligible_, enough);
  }

 private:
  std::vector<RationalPatch> differences_;
  double negligible_ = 0;
};

Pieces PiecesOf(const Shape& a,
                const Shape& b,
                const std::vector<Stretch>& a_u,
                const std::vector<Stretch>& b_u,
                const std::vector<Stretch>& a_v,
                const std::vector<Stretch>& b_v) {
  Pieces pieces;
  for (size_t i = 0; i < a_u.size(); ++i) {
    for (size_t j = 0; j < a_v.size(); ++j) {
      const Eigen::VectorXd origin = a.Point(a_u[i].first * a.size_v + a_v[j].first);
      pieces.Add(PatchOf(a, a_u[i], a_v[j], origin), PatchOf(b, b_u[i], b_v[j], origin));
    }
  }
  return pieces;
}

// Bézier shapes are their own only piece.
double BezierBound(RationalPatch a, RationalPatch b, const Eigen::VectorXd& origin) {
  const Eigen::Index d = origin.size();
  for (RationalPatch* patch : {&a, &b}) {
    patch->columns.topRows(d) -= origin * patch->columns.row(d);
  }
  Pieces pieces;
  pieces.Add(a, b);
  return std::move(pieces).Bound(std::numeric_limits<double>::infinity());
}

}  // namespace

template <int Dim>
double DeviationBound(const NurbsCurve<Dim>& a, const NurbsCurve<Dim>& b, double enough) {
  const std::vector<double> breaks = UnitedBreaks(a.basis(), b.basis());
  return PiecesOf(ShapeOf(a),
                  ShapeOf(b),
                  StretchesOf(a.basis(), breaks),
                  StretchesOf(b.basis(), breaks),
                  NoDirection(),
                  NoDirection())
      .Bound(enough);
}

double DeviationBound(const NurbsSurface& a, const NurbsSurface& b, double enough) {
  const std::vector<double> u = UnitedBreaks(a.basis_u(), b.basis_u());
  const std::vector<double> v = UnitedBreaks(a.basis_v(), b.basis_v());
  return PiecesOf(ShapeOf(a),
                  ShapeOf(b),
                  StretchesOf(a.basis_u(), u),
                  StretchesOf(b.basis_u(), u),
                  StretchesOf(a.basis_v(), v),
                  StretchesOf(b.basis_v(), v))
      .Bound(enough);
}

template <int Dim>
double DeviationBound(const BezierCurve<Dim>& a, const BezierCurve<Dim>& b) {
  return BezierBound(
      {a.degree(), 0, Homogeneous(a)}, {b.degree(), 0, Homogeneous(b)}, a.control_points().col(0));
}

double DeviationBound(const BezierSurface& a, const BezierSurface& b) {
  return BezierBound({a.degree_u(), a.degree_v(), Homogeneous(a)},
                     {b.degree_u(), b.degree_v(), Homogeneous(b)},
                     a.control_point(0, 0));
}

template double DeviationBound(const NurbsCurve<2>&, const NurbsCurve<2>&, double);
template double DeviationBound(const NurbsCurve<3>&, const NurbsCurve<3>&, double);
template double DeviationBound(const BezierCurve<2>&, const BezierCurve<2>&);
template double DeviationBound(const BezierCurve<3>&, const BezierCurve<3>&);

}  // namespace batten::internal
