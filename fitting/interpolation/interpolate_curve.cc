// SPDX-License-Identifier: MIT
#include "batten/fitting/interpolate_curve.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "batten/geometry/knot_vectors.h"
#include "fitting/knots/data_knots.h"
#include "fitting/linear/coefficient_order.h"
#include "fitting/linear/collocation.h"

namespace batten {
using namespace internal;
namespace {

[[noreturn]] void Refuse(const std::string& reason) { throw std::invalid_argument(reason); }

// The curve's conditions in increasing order of the parameters.
struct Conditions {
  std::vector<SplineCondition> at;
  std::vector<Eigen::Index> source;  // < m: that point; else m + the index of the derivative
};

void CheckCounts(Eigen::Index points,
                 size_t derivatives,
                 const CurveInterpolationOptions& options) {
  const int p = options.degree;
  if (p < 1 || p > kMaxDegree) {
    Refuse("the degree " + std::to_string(p) + " is not between 1 and " +
           std::to_string(kMaxDegree));
  }
  const std::string there_are = "; there are " + std::to_string(points);
  if (options.closed && points < 3) {
    Refuse("a closed curve needs at least 3 different points" + there_are);
  }
  if (points < 2) Refuse("interpolation needs at least 2 different points" + there_are);
  const auto conditions = points + static_cast<Eigen::Index>(derivatives);
  if (!options.closed && conditions <= p) {
    Refuse("interpolation with degree " + std::to_string(p) + " needs at least " +
           std::to_string(p + 1) + " points and derivatives; there are " +
           std::to_string(conditions) + ": lower the degree to " + std::to_string(conditions - 1) +
           " or add points");
  }
}

template <int Dim>
void CheckDerivatives(std::span<const PointDerivative<Dim>> derivatives,
                      Eigen::Index points,
                      int degree) {
  std::vector<std::pair<Eigen::Index, int>> seen;
  for (const PointDerivative<Dim>& d : derivatives) {
    const std::string name = "the derivative at point " + std::to_string(d.point + 1);
    if (d.point < 0 || d.point >= points) Refuse(name + ": there is no such point");
    if (d.order < 1 || d.order > degree) {
      Refuse(name + " is of order " + std::to_string(d.order) + ", not between 1 and the degree " +
             std::to_string(degree));
    }
    if (!d.value.allFinite()) Refuse(name + " is not finite");
    seen.emplace_back(d.point, d.order);
  }
  std::sort(seen.begin(), seen.end());
  const auto twice = std::adjacent_find(seen.begin(), seen.end());
  if (twice != seen.end()) {
    Refuse("the derivative of order " + std::to_string(twice->second) + " at point " +
           std::to_string(twice->first + 1) + " is given twice");
  }
}

// m parameters, closed m + 1.
Eigen::VectorXd Parameters(const Eigen::MatrixXd& points,
                           const CurveInterpolationOptions& options) {
  const Eigen::Index count = points.cols(), values = count + (options.closed ? 1 : 0);
  const bool given = options.parameterization == CurveParameterization::kGiven;
  const Eigen::VectorXd t =
      given ? options.parameters
            : CurveParameters(points, options.parameterization, options.degree, options.closed);
  if (t.size() != values) {
    Refuse("interpolation of " + std::to_string(count) + " points needs " + std::to_string(values) +
           " parameters; there are " + std::to_string(t.size()));
  }
  if (!t.allFinite()) Refuse("a given parameter is not finite");
  for (Eigen::Index k = 1; k < values; ++k) {
    if (t[k] > t[k - 1]) continue;
    const std::string pair = std::to_string(k) + " and " + std::to_string(k == count ? 1 : k + 1);
    if (given) Refuse("the parameters of points " + pair + " do not increase");
    Refuse("points " + pair +
           (k == count || points.col(k) == points.col(k - 1)
                ? " lie in one place: leave one of them out"
                : " are too close together to be told apart"));
  }
  return t;
}

template <int Dim>
Conditions ConditionsOf(const Eigen::VectorXd& parameters,
                        std::span<const PointDerivative<Dim>> derivatives) {
  const Eigen::Index m = parameters.size();
  std::vector<std::tuple<Eigen::Index, int, Eigen::Index>> order;
  for (Eigen::Index k = 0; k < m; ++k) order.emplace_back(k, 0, k);
  for (size_t i = 0; i < derivatives.size(); ++i) {
    order.emplace_back(
        derivatives[i].point, derivatives[i].order, m + static_cast<Eigen::Index>(i));
  }
  std::sort(order.begin(), order.end());
  Conditions result;
  for (const auto& [point, derivative, source] : order) {
    result.at.push_back({parameters[point], derivative});
    result.source.push_back(source);
  }
  return result;
}

// Whether no derivative is given without those of lower orders, so that the Schoenberg–Whitney
// condition, which open bases keep, is enough.
bool Consecutive(const std::vector<SplineCondition>& conditions) {
  for (size_t k = 0; k < conditions.size(); ++k) {
    if (conditions[k].order > 0 && conditions[k].order != conditions[k - 1].order + 1) return false;
  }
  return true;
}

// A basis with a function for every condition, and the points' parameters over it.
struct Base {
  SplineBasis basis;
  Eigen::VectorXd parameters;
};

// Every parameter as often as there are conditions at its point.
template <int Dim>
std::vector<double> Sites(const Eigen::VectorXd& parameters,
                          std::span<const PointDerivative<Dim>> derivatives) {
  std::vector<double> sites(parameters.begin(), parameters.end());
  for (const PointDerivative<Dim>& d : derivatives) sites.push_back(parameters[d.point]);
  std::sort(sites.begin(), sites.end());
  return sites;
}

template <int Dim>
Base ChosenBase(const Eigen::VectorXd& parameters,
                std::span<const PointDerivative<Dim>> derivatives,
                const CurveInterpolationOptions& options) {
  const int p = options.degree;
  const std::vector<double> sites = Sites<Dim>(parameters, derivatives);
  if (!options.closed) {
    const bool uniform = options.parameterization == CurveParameterization::kUniversal;
    return {uniform && derivatives.empty()
                ? QuasiUniformKnots(p, static_cast<int>(sites.size()), sites.front(), sites.back())
                : AveragedKnots(p, sites),
            parameters};
  }
  const ClosedKnots knots = KnotsAround(p, sites);
  // The first condition at a point stands for the point.
  Eigen::VectorXd at(parameters.size() - 1);
  Eigen::Index k = 0;
  for (size_t i = 0; i + 1 < sites.size(); ++i) {
    if (i == 0 || sites[i] > sites[i - 1]) at[k++] = knots.parameters[static_cast<Eigen::Index>(i)];
  }
  return {knots.basis, at};
}

template <int Dim>
Base GivenBase(const Eigen::VectorXd& parameters,
               std::span<const PointDerivative<Dim>> derivatives,
               const CurveInterpolationOptions& options) {
  const SplineBasis& basis = *options.basis;
  const int functions = DistinctCount(basis);
  const Eigen::Index points = parameters.size() - (options.closed ? 1 : 0);
  const Eigen::VectorXd at = parameters.head(points);
  const auto conditions = points + static_cast<Eigen::Index>(derivatives.size());
  if (basis.degree() != options.degree) Refuse("the given basis is not of the degree asked for");
  if (basis.periodic() != options.closed) {
    Refuse(options.closed ? "a closed curve needs a periodic basis"
                          : "the given basis is periodic, the curve is not closed");
  }
  if (functions != conditions) {
    Refuse("the given basis has " + std::to_string(functions) + " different functions for " +
           std::to_string(conditions) + " points and derivatives");
  }
  if (at[0] < basis.lower() || at[points - 1] > basis.upper()) {
    Refuse("the parameters leave the domain of the given basis");
  }
  if (options.closed) return {basis, at};
  if (const auto i = FirstUnsupported(basis, Sites<Dim>(at, derivatives))) {
    Refuse("the given knots do not suit the parameters: function " + std::to_string(*i + 1) +
           " has no point of its own (Schoenberg-Whitney condition)");
  }
  return {basis, at};
}

}  // namespace

template <int Dim>
InterpolatedCurve<Dim> InterpolateCurve(const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points,
                                        const CurveInterpolationOptions& options,
                                        std::span<const PointDerivative<Dim>> derivatives) {
  const Eigen::Index m = points.cols();
  CheckCounts(m, derivatives.size(), options);
  if (!points.allFinite()) Refuse("a point is not finite");
  CheckDerivatives<Dim>(derivatives, m, options.degree);
  const Eigen::VectorXd parameters = Parameters(points, options);
  Base base = options.basis ? GivenBase<Dim>(parameters, derivatives, options)
                            : ChosenBase<Dim>(parameters, derivatives, options);
  const Conditions conditions = ConditionsOf<Dim>(base.parameters, derivatives);
  // Points are relative to their middle, so that large coordinates cost no digits.
  const Eigen::Matrix<double, Dim, 1> middle =
      points.rowwise().minCoeff() + (points.rowwise().maxCoeff() - points.rowwise().minCoeff()) / 2;
  Eigen::MatrixXd values(Dim, conditions.at.size());
  for (Eigen::Index k = 0; k < values.cols(); ++k) {
    const Eigen::Index source = conditions.source[static_cast<size_t>(k)];
    if (source < m) {
      values.col(k) = points.col(source) - middle;
    } else {
      values.col(k) = derivatives[static_cast<size_t>(source - m)].value;
    }
  }
  const bool regular = options.closed
                           ? !options.basis && derivatives.empty() && options.degree % 2 == 1
                           : Consecutive(conditions.at);
  const auto solution = SolveConditions(base.basis, conditions.at, values, regular);
  if (!solution) {
    Refuse(
        "the points and derivatives do not determine the curve: parameters are too uneven for "
        "degree " +
        std::to_string(options.degree) + ", " +
        (options.closed ? "or it is even: choose an odd one"
                        : "or derivatives of lower orders are missing"));
  }
  Eigen::Matrix<double, Dim, Eigen::Dynamic> control = solution->colwise() + middle;
  if (!options.closed && base.basis.clamped()) {
    if (base.parameters[0] == base.basis.lower()) control.col(0) = points.col(0);
    if (base.parameters[m - 1] == base.basis.upper()) {
      control.col(control.cols() - 1) = points.col(m - 1);
    }
  }
  return {NurbsCurve<Dim>(std::move(base.basis), std::move(control)), std::move(base.parameters)};
}

template <int Dim>
PointDerivative<Dim> EndTangent(const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points,
                                const Eigen::VectorXd& parameters,
                                InterpolationEnd end,
                                const Eigen::Matrix<double, Dim, 1>& tangent) {
  const std::string name = end == InterpolationEnd::kStart ? "start tangent" : "end tangent";
  const double length = tangent.stableNorm();
  if (!(length > 0) || !std::isfinite(length)) Refuse("the " + name + " has no direction");
  if (points.cols() < 2 || parameters.size() < points.cols()) {
    Refuse("the " + name + " needs at least 2 points with parameters");
  }
  const Eigen::Index last = points.cols() - 1, k = end == InterpolationEnd::kStart ? 0 : last - 1;
  const double step = parameters[k + 1] - parameters[k];
  if (!(step > 0)) Refuse("the parameters at the " + name + " do not increase");
  const double speed = (points.col(k + 1) - points.col(k)).stableNorm() / step;
  return {end == InterpolationEnd::kStart ? 0 : last, 1, speed * (tangent / length)};
}

template InterpolatedCurve<2> InterpolateCurve<2>(const Eigen::Matrix2Xd&,
                                                  const CurveInterpolationOptions&,
                                                  std::span<const PointDerivative<2>>);
template InterpolatedCurve<3> InterpolateCurve<3>(const Eigen::Matrix3Xd&,
                                                  const CurveInterpolationOptions&,
                                                  std::span<const PointDerivative<3>>);
template PointDerivative<2> EndTangent<2>(const Eigen::Matrix2Xd&,
                                          const Eigen::VectorXd&,
                                          InterpolationEnd,
                                          const Eigen::Vector2d&);
template PointDerivative<3> EndTangent<3>(const Eigen::Matrix3Xd&,
                                          const Eigen::VectorXd&,
                                          InterpolationEnd,
                                          const Eigen::Vector3d&);

}  // namespace batten
