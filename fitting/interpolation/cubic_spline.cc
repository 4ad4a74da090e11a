// SPDX-License-Identifier: MIT
#include "fitting/interpolation/cubic_spline.h"

#include <string>
#include <utility>
#include <vector>

#include "batten/fitting/interpolate_curve.h"
#include "fitting/interpolation/collocation.h"
#include "geometry/numeric/reject.h"

namespace batten::internal {
namespace {

template <int Dim>
void CheckData(const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points, const Eigen::VectorXd& t) {
  if (points.cols() < 2) {
    Reject("CubicSplineCurve",
           "a spline needs at least 2 points; there are " + std::to_string(points.cols()));
  }
  if (t.size() != points.cols()) {
    Reject("CubicSplineCurve",
           std::to_string(points.cols()) + " points and " + std::to_string(t.size()) +
               " parameters do not agree");
  }
  if (!points.allFinite() || !t.allFinite())
    Reject("CubicSplineCurve", "a point or parameter is not finite");
  for (Eigen::Index k = 1; k < t.size(); ++k) {
    if (!(t[k] > t[k - 1])) {
      Reject("CubicSplineCurve",
             "parameter " + std::to_string(k) + " is not above the one before it");
    }
  }
}

// The parameters that are knots.
std::vector<double> Breaks(const Eigen::VectorXd& t, bool drop_second, bool drop_last_but_one) {
  std::vector<double> breaks(t.begin(), t.end());
  if (drop_last_but_one && breaks.size() > 2) breaks.erase(breaks.end() - 2);
  if (drop_second && breaks.size() > 2) breaks.erase(breaks.begin() + 1);
  return breaks;
}

template <int Dim>
using Point = Eigen::Matrix<double, Dim, 1>;

// The spline's conditions in increasing order of the parameters.
template <int Dim>
struct SplineConditions {
  explicit SplineConditions(int size) : values(Dim, size) {}

  void Require(double u, int order, const Point<Dim>& value) {
    values.col(static_cast<Eigen::Index>(at.size())) = value;
    at.push_back({u, order});
  }
  void Require(double u, const CubicEndCondition<Dim>& end) {
    const bool natural = end.kind == CubicEnd::kNatural;
    Require(u,
            end.kind == CubicEnd::kFirstDerivative ? 1 : 2,
            natural ? Point<Dim>(Point<Dim>::Zero()) : end.value);
  }

  std::vector<SplineCondition> at;
  Eigen::MatrixXd values;
};

}  // namespace

template <int Dim>
NurbsCurve<Dim> CubicSplineCurve(const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points,
                                 const Eigen::VectorXd& t,
                                 const CubicEndCondition<Dim>& start,
                                 const CubicEndCondition<Dim>& end) {
  CheckData<Dim>(points, t);
  if (!start.value.allFinite() || !end.value.allFinite())
    Reject("CubicSplineCurve", "an end's value is not finite");
  const Eigen::Index m = points.cols();
  const bool free_start = start.kind == CubicEnd::kNotAKnot,
             free_end = end.kind == CubicEnd::kNotAKnot;
  SplineBasis basis = SplineBasis::Clamped(3, Breaks(t, free_start, free_end));
  const Point<Dim> middle =
      points.rowwise().minCoeff() + (points.rowwise().maxCoeff() - points.rowwise().minCoeff()) / 2;
  SplineConditions<Dim> conditions(basis.size());
  conditions.Require(t[0], 0, points.col(0) - middle);
  if (!free_start) conditions.Require(t[0], start);
  // Where no knot is left to remove, the degree is lowered instead.
  const Eigen::Index missing = basis.size() - m - (free_start ? 0 : 1) - (free_end ? 0 : 1);
  for (Eigen::Index k = 0; k < missing; ++k) {
    conditions.Require(t[0], static_cast<int>(3 - k), Point<Dim>::Zero());
  }
  for (Eigen::Index k = 1; k + 1 < m; ++k) conditions.Require(t[k], 0, points.col(k) - middle);
  if (!free_end) conditions.Require(t[m - 1], end);
  conditions.Require(t[m - 1], 0, points.col(m - 1) - middle);
  const auto solution = SolveConditions(basis, conditions.at, conditions.values);
  if (!solution) Reject("CubicSplineCurve", "parameters are too close together");
  Eigen::Matrix<double, Dim, Eigen::Dynamic> control = solution->colwise() + middle;
  control.col(0) = points.col(0);
  control.col(control.cols() - 1) = points.col(m - 1);
  return NurbsCurve<Dim>(std::move(basis), std::move(control));
}

template <int Dim>
NurbsCurve<Dim> ClosedCubicSplineCurve(const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points,
                                       const Eigen::VectorXd& parameters) {
  CurveInterpolationOptions options;
  options.parameterization = CurveParameterization::kGiven;
  options.parameters = parameters;
  options.closed = true;
  return InterpolateCurve<Dim>(points, options).curve;
}

template NurbsCurve<2> CubicSplineCurve<2>(const Eigen::Matrix2Xd&,
                                           const Eigen::VectorXd&,
                                           const CubicEndCondition<2>&,
                                           const CubicEndCondition<2>&);
template NurbsCurve<3> CubicSplineCurve<3>(const Eigen::Matrix3Xd&,
                                           const Eigen::VectorXd&,
                                           const CubicEndCondition<3>&,
                                           const CubicEndCondition<3>&);
template NurbsCurve<2> ClosedCubicSplineCurve<2>(const Eigen::Matrix2Xd&, const Eigen::VectorXd&);
template NurbsCurve<3> ClosedCubicSplineCurve<3>(const Eigen::Matrix3Xd&, const Eigen::VectorXd&);

}  // namespace batten::internal
