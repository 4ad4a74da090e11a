// SPDX-License-Identifier: MIT
#include "batten/fitting/curve_parameterization.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include "batten/geometry/knot_vectors.h"
#include "geometry/numeric/dense_solvers.h"
#include "geometry/numeric/enum_name.h"
#include "geometry/numeric/polygon.h"
#include "geometry/numeric/reject.h"

namespace batten {
using namespace internal;
namespace {

// The points from the first on, the largest coordinate 1: squares neither vanish nor overflow.
// Closed, the first point follows the last.
Eigen::MatrixXd Scaled(const Eigen::Ref<const Eigen::MatrixXd>& points, bool closed) {
  Eigen::MatrixXd result(points.rows(), points.cols() + (closed ? 1 : 0));
  result.leftCols(points.cols()) = points.colwise() - points.col(0);
  if (closed) result.rightCols(1).setZero();
  const double size = result.cwiseAbs().maxCoeff();
  if (!(size > 0))
    Reject("CurveParameters", "all " + std::to_string(points.cols()) + " points are in one place");
  return result / size;
}

// The points turned and stretched so that they spread equally in every direction they fill.
// Directions in which they differ by rounding only are left out.
Eigen::MatrixXd Whitened(const Eigen::MatrixXd& points, bool closed, double rounding) {
  constexpr double kFlattest = 1e-10;  // of the widest spread
  // A closed curve's first point, which is there twice, counts once.
  const Eigen::MatrixXd once = points.leftCols(points.cols() - (closed ? 1 : 0));
  const Eigen::VectorXd mean = once.rowwise().mean();
  const auto [spread, axes] = SingularValuesOf((once.colwise() - mean).transpose());
  const double least =
      std::max(kFlattest * spread[0], rounding * std::sqrt(static_cast<double>(once.cols())));
  Eigen::Index wide = 1;
  while (wide < spread.size() && spread[wide] > least) ++wide;
  return spread.head(wide).cwiseInverse().asDiagonal() * axes.leftCols(wide).transpose() *
         (points.colwise() - mean);
}

// By how much the polygon turns at b, not more than a right angle; 0 where a side has no length.
double Turn(const Eigen::VectorXd& before, const Eigen::VectorXd& behind) {
  const double a = before.norm(), b = behind.norm();
  if (!(a > 0 && b > 0)) return 0;
  const Eigen::VectorXd u = before / a, v = behind / b;
  return std::min(2 * std::atan2((u - v).norm(), (u + v).norm()), std::numbers::pi / 2);
}

Eigen::VectorXd FoleySteps(const Eigen::MatrixXd& points, bool closed) {
  const Eigen::VectorXd lengths = StepLengths(points);
  const Eigen::Index steps = lengths.size();
  // By how much of itself the turn at point k lengthens the step `of`, one of the two that meet
  // there.
  const auto lengthening = [&](Eigen::Index k, Eigen::Index of) {
    if (!closed && (k == 0 || k == steps)) return 0.0;
    const Eigen::Index before = (k + steps - 1) % steps, behind = k % steps;
    const double sum = lengths[before] + lengths[behind];
    if (!(sum > 0)) return 0.0;
    const double turn = Turn(points.col(before + 1) - points.col(before),
                             points.col(behind + 1) - points.col(behind));
    return 1.5 * turn * lengths[of == before ? behind : before] / sum;
  };
  Eigen::VectorXd result(steps);
  for (Eigen::Index k = 0; k < steps; ++k) {
    result[k] = lengths[k] * (1 + lengthening(k, k) + lengthening(k + 1, k));
  }
  return result;
}

// The place of the only maximum of N_i: where its derivative changes sign.
double Maximum(const SplineBasis& basis, int i) {
  const int p = basis.degree();
  double low = basis.knots()[i], high = basis.knots()[i + p + 1];
  for (;;) {
    const double middle = low + (high - low) / 2;
    if (!(middle > low && middle < high)) return middle;
    (basis.FunctionDerivatives(i, middle, 1)[1] > 0 ? low : high) = middle;
  }
}

Eigen::VectorXd UniversalParameters(int degree, Eigen::Index count) {
  if (count <= degree) {
    Reject("CurveParameters",
           "universal parameters of degree " + std::to_string(degree) + " need more than " +
               std::to_string(degree) + " points; there are " + std::to_string(count));
  }
  const int n = static_cast<int>(count);
  const SplineBasis basis = QuasiUniformKnots(degree, n, 0, 1);
  Eigen::VectorXd result(count);
  for (int i = 0; 2 * i < n; ++i) {
    const bool shifted = i >= degree && i + degree < n;  // like its neighbours: symmetric
    result[i] = i == 0    ? 0
                : shifted ? (basis.knots()[i] + basis.knots()[i + degree + 1]) / 2
                          : Maximum(basis, i);
    result[n - 1 - i] = 1 - result[i];
  }
  if (n % 2 == 1) result[n / 2] = 0.5;
  return result;
}

}  // namespace

const char* Name(CurveParameterization parameterization) {
  static constexpr std::array kNames{
      "given", "uniform", "chord", "centripetal", "foley", "universal"};
  return NameIn<CurveParameterization::kUniversal>(kNames, parameterization);
}

Eigen::VectorXd CurveParameters(const Eigen::Ref<const Eigen::MatrixXd>& points,
                                CurveParameterization parameterization,
                                int degree,
                                bool closed) {
  const Eigen::Index count = points.cols();
  if (count < 2)
    Reject("CurveParameters",
           "a curve needs at least 2 points; there are " + std::to_string(count));
  if (!points.allFinite()) Reject("CurveParameters", "a point is not finite");
  const Eigen::Index values = count + (closed ? 1 : 0);
  switch (parameterization) {
    case CurveParameterization::kGiven:
      Reject("CurveParameters", "kGiven takes the parameters that come with the points");
    case CurveParameterization::kUniform:
      return Eigen::VectorXd::LinSpaced(values, 0, 1);
    case CurveParameterization::kUniversal:
      return closed ? Eigen::VectorXd(Eigen::VectorXd::LinSpaced(values, 0, 1))
                    : UniversalParameters(degree, count);
    case CurveParameterization::kChord:
      return SummedSteps(StepLengths(Scaled(points, closed)));
    case CurveParameterization::kCentripetal:
      return SummedSteps(StepLengths(Scaled(points, closed)).cwiseSqrt());
    case CurveParameterization::kFoley: {
      const Eigen::MatrixXd scaled = Scaled(points, closed);
      const double size = (points.colwise() - points.col(0)).cwiseAbs().maxCoeff();
      const double rounding =
          8 * std::numeric_limits<double>::epsilon() * points.cwiseAbs().maxCoeff() / size;
      return SummedSteps(FoleySteps(Whitened(scaled, closed, rounding), closed));
    }
  }
  Reject("CurveParameters", "unknown parameterization");
}

PointCloud ParameterizedByX(PointCloud cloud) {
  Eigen::Matrix2Xd parameters = Eigen::Matrix2Xd::Zero(2, cloud.size());
  for (Eigen::Index k = 0; k < cloud.size(); ++k) parameters(0, k) = cloud.World(k).x();
  cloud.set_parameters(std::move(parameters));
  return cloud;
}

}  // namespace batten
