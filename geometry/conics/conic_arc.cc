// SPDX-License-Identifier: MIT
#include "batten/geometry/conic_arc.h"

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "geometry/numeric/construction_checks.h"

namespace batten {
using namespace internal;
namespace {

constexpr double kWidest = 0.5;  // the middle weight of 120° of a circle, the widest single piece

// The halves of a standard arc at its shoulder share the point (P0 + 2 P1 + P2) / 4, of weight
// (1 + w1) / 2; both halves have the same middle weight in standard form.
template <int Dim>
using Columns = Eigen::Matrix<double, Dim + 1, 3>;

template <int Dim>
std::vector<Columns<Dim>> Halved(const std::vector<Columns<Dim>>& pieces) {
  std::vector<Columns<Dim>> halves;
  for (const Columns<Dim>& piece : pieces) {
    const double w = (1 + piece(Dim, 1)) / 2;
    const auto first = ((piece.col(0) + piece.col(1)) / 2).eval();
    const auto last = ((piece.col(1) + piece.col(2)) / 2).eval();
    const auto shoulder = ((first + last) / (2 * w)).eval();
    Columns<Dim> lower, upper;
    lower << piece.col(0), first / std::sqrt(w), shoulder;
    upper << shoulder, last / std::sqrt(w), piece.col(2);
    halves.insert(halves.end(), {lower, upper});
  }
  return halves;
}

}  // namespace

template <int Dim>
ConicArc<Dim> ConicArc<Dim>::Standard() const {
  RequireThat(columns.allFinite(), "ConicArc", "a control point is not finite");
  const double w0 = columns(Dim, 0), w2 = columns(Dim, 2);
  RequireThat(w0 * w2 > 0,
              "ConicArc",
              "the end weights " + NumberText(w0) + " and " + NumberText(w2) +
                  " must have one sign: an end at infinity is no end of a curve");
  ConicArc result = *this;
  result.columns.col(0) /= w0;
  result.columns.col(2) /= w2;
  result.columns.col(1) /= std::copysign(std::sqrt(w0) * std::sqrt(w2), 1.0) * (w0 < 0 ? -1 : 1);
  return result;
}

template <int Dim>
double ConicArc<Dim>::ShapeFactor() const {
  const double w1 = Standard().columns(Dim, 1);
  return 1 / (w1 * w1);
}

template <int Dim>
typename ConicArc<Dim>::Point ConicArc<Dim>::At(double t) const {
  const double s = 1 - t;
  const Eigen::Matrix<double, Dim + 1, 1> sum =
      s * s * columns.col(0) + 2 * s * t * columns.col(1) + t * t * columns.col(2);
  return sum.template head<Dim>() / sum[Dim];
}

template <int Dim>
NurbsCurve<Dim> ToNurbs(const ConicArc<Dim>& arc) {
  std::vector<Columns<Dim>> pieces{arc.Standard().columns};
  const double w1 = pieces[0](Dim, 1);
  RequireThat(w1 > -1,
              "ToNurbs",
              "the arc runs through infinity: its middle weight " + NumberText(w1) +
                  " in standard form is not above -1");
  while (pieces[0](Dim, 1) < kWidest) pieces = Halved<Dim>(pieces);
  const auto count = static_cast<int>(pieces.size());
  typename NurbsCurve<Dim>::Points points(Dim, 2 * count + 1);
  Eigen::VectorXd weights(2 * count + 1);
  std::vector<double> knots(3, 0.0);
  for (int k = 0; k < count; ++k) {
    for (int i = 0; i < 3; ++i) {
      weights[2 * k + i] = pieces[k](Dim, i);
      points.col(2 * k + i) = pieces[k].col(i).template head<Dim>() / pieces[k](Dim, i);
    }
    if (k > 0) knots.insert(knots.end(), 2, static_cast<double>(k) / count);
  }
  knots.insert(knots.end(), 3, 1.0);
  return NurbsCurve<Dim>(SplineBasis(2, std::move(knots)), std::move(points), std::move(weights));
}

ImplicitConic ImplicitOf(const ConicArc<2>& arc) {
  const Eigen::Vector2d origin = arc.columns.col(0).head<2>() / arc.columns(2, 0);
  Eigen::Matrix3d H = arc.Standard().columns;
  for (int i = 0; i < 3; ++i) H.col(i).head<2>() -= H(2, i) * origin;
  // With (x, y, 1) = Σ b_i column_i the curve is b1² = 4 b0 b2.
  const Eigen::Vector3d b0 = H.col(1).cross(H.col(2)), b1 = H.col(2).cross(H.col(0)),
                        b2 = H.col(0).cross(H.col(1));
  constexpr double kFlat = 1e-13;
  RequireThat(
      std::abs(H.col(0).dot(b0)) > kFlat * H.col(0).norm() * H.col(1).norm() * H.col(2).norm(),
      "ImplicitOf",
      "the control points lie on one line");
  const Eigen::Matrix3d Q = b1 * b1.transpose() - 2 * (b0 * b2.transpose() + b2 * b0.transpose());
  const ImplicitConic local{Q(0, 0), 2 * Q(0, 1), Q(1, 1), 2 * Q(0, 2), 2 * Q(1, 2), Q(2, 2)};
  const ImplicitConic world = local.From(-origin);
  const double largest = std::max({std::abs(world.a),
                                   std::abs(world.b),
                                   std::abs(world.c),
                                   std::abs(world.d),
                                   std::abs(world.e),
                                   std::abs(world.f)});
  return {world.a / largest,
          world.b / largest,
          world.c / largest,
          world.d / largest,
          world.e / largest,
          world.f / largest};
}

template struct ConicArc<2>;
template struct ConicArc<3>;
template NurbsCurve<2> ToNurbs(const ConicArc<2>&);
template NurbsCurve<3> ToNurbs(const ConicArc<3>&);

}  // namespace batten
