// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <limits>

#include "batten/geometry/power_form.h"
#include "geometry/bezier/spline_pieces.h"
#include "geometry/forms/power_basis.h"
#include "geometry/forms/power_checks.h"
#include "geometry/numeric/construction_checks.h"

namespace batten {
using namespace internal;

template <int Dim>
Eigen::Matrix<double, Dim, 1> PowerCurve<Dim>::At(double u) const {
  const auto [piece, t] = PlaceIn(breaks, u);
  const Eigen::Index first = Eigen::Index{piece} * (degree + 1);
  Eigen::VectorXd sum = coefficients.col(first + degree);
  for (int i = degree - 1; i >= 0; --i) sum = sum * t + coefficients.col(first + i);
  return sum.template head<Dim>() / sum[Dim];
}

template <int Dim>
PowerCurve<Dim> ToPower(const NurbsCurve<Dim>& curve, double tolerance) {
  const std::vector<CurvePiece> pieces = PiecesOf(curve);
  PowerCurve<Dim> power;
  power.degree = curve.basis().degree();
  power.rational = curve.rational();
  const int count = power.degree + 1;
  const Eigen::MatrixXd powers = PowersOfBernstein(power.degree);
  power.coefficients.resize(Dim + 1, std::ssize(pieces) * count);
  power.breaks.push_back(pieces.front().u0);
  for (Eigen::Index k = 0; k < std::ssize(pieces); ++k) {
    const CurvePiece& piece = pieces[k];
    power.breaks.push_back(piece.u1);
    auto block = power.coefficients.middleCols(k * count, count);
    block.topRows(Dim) = piece.points.topRows(Dim) * powers;
    block.row(Dim) = piece.points.row(3) * powers;
    if (!power.rational) block.row(Dim) = Eigen::RowVectorXd::Unit(count, 0);
    block.topRows(Dim) += piece.origin.head<Dim>() * block.row(Dim);
  }
  double error = 0;
  for (const CurvePiece& piece : pieces) {
    for (const double t : PlacesIn(power.degree)) {
      const double u = piece.u0 + t * (piece.u1 - piece.u0);
      error = std::max(error, (power.At(u) - curve.At(u)).norm());
    }
  }
  RefusePowerLoss(curve.control_points(), error, tolerance, power.degree);
  return power;
}

template <int Dim>
NurbsCurve<Dim> FromPower(const PowerCurve<Dim>& power) {
  const int p = power.degree;
  CheckPowers(p, power.breaks, "breaks");
  const Eigen::Index pieces = std::ssize(power.breaks) - 1;
  RequireThat(power.coefficients.rows() == Dim + 1 && power.coefficients.cols() == pieces * (p + 1),
              "FromPower",
              std::to_string(power.coefficients.cols()) + " coefficients, but " +
                  std::to_string(pieces) + " pieces of degree " + std::to_string(p) + " have " +
                  std::to_string(pieces * (p + 1)));
  RequireThat(power.coefficients.allFinite(), "FromPower", "a coefficient is not finite");
  const Eigen::MatrixXd bernstein = BernsteinOfPowers(p);
  Eigen::MatrixXd columns(Dim + 1, pieces * p + 1);
  for (Eigen::Index k = 0; k < pieces; ++k) {
    Eigen::MatrixXd piece = power.coefficients.middleCols(k * (p + 1), p + 1) * bernstein;
    if (k > 0) {
      const double scale = columns(Dim, k * p) / piece(Dim, 0);
      RequireThat(scale > 0, "FromPower", "a weight is not positive");
      piece *= scale;
      CloseGap(columns.col(k * p), piece.col(0), columns.leftCols(k * p + 1), power.breaks[k]);
    }
    columns.middleCols(k * p, p + 1) = piece;
  }
  return BezierFormCurve<Dim>(p, power.breaks, columns, power.rational);
}

template struct PowerCurve<2>;
template struct PowerCurve<3>;
template PowerCurve<2> ToPower(const NurbsCurve<2>&, double);
template PowerCurve<3> ToPower(const NurbsCurve<3>&, double);
template NurbsCurve<2> FromPower(const PowerCurve<2>&);
template NurbsCurve<3> FromPower(const PowerCurve<3>&);

}  // namespace batten
