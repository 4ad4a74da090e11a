// SPDX-License-Identifier: MIT
#include "batten/fitting/uncertainty.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>
#include <random>

#include "batten/fitting/fit_surface.h"
#include "batten/geometry/foot_point.h"
#include "batten/geometry/make_curve.h"
#include "batten/geometry/make_surface.h"
#include "fitting/least_squares/fairness.h"
#include "tolerances.h"

namespace batten {
namespace {

using internal::kHalfDigits;
using internal::kIterated;

PointCloud Hills(int count, double noise, double hole = 0) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> even(0, 1);
  std::normal_distribution<double> normal;
  Eigen::Matrix3Xd points(3, count);
  for (int k = 0; k < count;) {
    const double x = 6 * even(random), y = 5 * even(random);
    if (std::hypot(x - 3, y - 2.5) < hole) continue;
    points.col(k++) << x, y, std::sin(x) * std::cos(y) + noise * normal(random);
  }
  return PointCloud(points);
}

SurfaceFitOptions Plain() {
  SurfaceFitOptions options;
  options.control_points = {8, 7};
  options.trim = Trimming::kNone;
  options.optimize = FreeVariables{};
  options.loss = Loss::kNone;
  options.threads = 1;
  return options;
}

// The functions of a surface without weights at a place, all of them.
Eigen::VectorXd Functions(const NurbsSurface& surface, double u, double v) {
  Eigen::VectorXd values(surface.control_points().cols());
  for (int i = 0; i < surface.size_u(); ++i)
    for (int j = 0; j < surface.size_v(); ++j)
      values[i * surface.size_v() + j] =
          surface.basis_u().Function(i, u) * surface.basis_v().Function(j, v);
  return values;
}

// Dense matrices and their inverse, with fairness by differences of the energy.
struct Dense {
  Eigen::MatrixXd a, inverse;
  double variance;

  Dense(const SurfaceFit& fit, double smoothing) {
    const NurbsSurface& surface = fit.surface;
    const Eigen::Index n = surface.control_points().cols();
    a = Eigen::MatrixXd::Zero(n, n);
    for (Eigen::Index k = 0; k < fit.residuals.size(); ++k) {
      const Eigen::VectorXd b = Functions(surface, fit.parameters(0, k), fit.parameters(1, k));
      a += b * b.transpose();
    }
    const internal::FairnessForm form(surface.basis_u(), &surface.basis_v());
    Eigen::MatrixXd p(n, n);
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index j = 0; j < n; ++j)
        p(i, j) = (form.Energy(Eigen::VectorXd::Unit(n, i) + Eigen::VectorXd::Unit(n, j)) -
                   form.Energy(Eigen::VectorXd::Unit(n, i) - Eigen::VectorXd::Unit(n, j))) /
                  4;
    inverse = (a + smoothing * a.trace() / p.trace() * p).inverse();
    const Eigen::MatrixXd hat = inverse * a;
    const double left =
        static_cast<double>(fit.residuals.size()) - 2 * hat.trace() + (hat * hat).trace();
    variance = fit.residuals.squaredNorm() / left;
  }

  double Covariance(const Eigen::VectorXd& b, const Eigen::VectorXd& c) const {
    return variance * b.dot(inverse * a * inverse * c);
  }
};

TEST(UncertaintyTest, EqualsDenseAlgebra) {
  const PointCloud cloud = Hills(700, 0.02);
  SurfaceFitOptions options = Plain();
  options.smoothing = 1e-2;  // so that bias and spread differ
  const SurfaceFit fit = FitSurface(cloud, options);
  const Uncertainty uncertainty(fit, cloud, 2);
  const Dense dense(fit, 1e-2);
  EXPECT_NEAR(uncertainty.noise(), std::sqrt(dense.variance), kHalfDigits * uncertainty.noise());
  EXPECT_EQ(uncertainty.inflation(), 1);
  const auto& u = fit.surface.basis_u();
  const auto& v = fit.surface.basis_v();
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> in_u(u.lower(), u.upper()), in_v(v.lower(), v.upper());
  for (int k = 0; k < 20; ++k) {
    const double u1 = in_u(random), v1 = in_v(random), u2 = in_u(random), v2 = in_v(random);
    const Eigen::VectorXd b = Functions(fit.surface, u1, v1), c = Functions(fit.surface, u2, v2);
    const double expected = dense.Covariance(b, b);
    const double deviation = uncertainty.At(u1, v1).deviation;
    EXPECT_NEAR(deviation * deviation, expected, 1e-5 * expected);  // squares of the step, 1e-6
    const Eigen::MatrixXd both = uncertainty.Covariance({{{u1, v1, 1}}, {{u2, v2, 2}}});
    EXPECT_NEAR(both(0, 0), expected, kHalfDigits * expected);
    EXPECT_NEAR(both(0, 1), 2 * dense.Covariance(b, c), kHalfDigits * expected);
  }
}

TEST(UncertaintyTest, BiasIsWhatFairnessMovesExactPointsBy) {
  const PointCloud cloud = Hills(900, 0);
  SurfaceFitOptions fair = Plain(), plain = Plain();
  fair.smoothing = 3e-3;
  plain.smoothing = 1e-9;
  const SurfaceFit moved = FitSurface(cloud, fair), exact = FitSurface(cloud, plain);
  const Uncertainty uncertainty(moved, cloud, 1);
  for (const auto& [x, y] : {std::pair{1.5, 1.0}, {3.0, 2.0}, {4.5, 3.5}, {2.0, 4.0}}) {
    const auto height = [x = x, y = y](const SurfaceFit& fit) {
      const Eigen::Vector3d far(x, y, 0);
      return SurfaceFootPoints(fit.surface).Nearest(far);
    };
    const SurfaceFoot at = height(moved);
    const Eigen::Vector3d normal = moved.surface.NormalAt(at.u, at.v).value();
    const SurfaceFoot on = SurfaceFootPoints(exact.surface).Nearest(at.point);
    const double bias = normal.dot(at.point - on.point);
    // To first order, and but for slopes: a tenth of the largest.
    EXPECT_NEAR(uncertainty.At(at.u, at.v).bias, bias, 0.004) << x << ", " << y;
    EXPECT_LT(std::abs(bias), 0.1);
  }
}

TEST(UncertaintyTest, ScalesWithTheDataAndIsTheSameFarAway) {
  const PointCloud cloud = Hills(500, 0.02);
  const SurfaceFit fit = FitSurface(cloud, Plain());
  const double one = Uncertainty(fit, cloud).At(2, 2).deviation;
  for (const double scale : {1e-6, 1e3}) {
    const PointCloud scaled = PointCloud::FromWorld((scale * cloud.points()).colwise() +
                                                    scale * Eigen::Vector3d(5e5, 5e6, 100));
    const SurfaceFit other = FitSurface(scaled, Plain());
    const double u = other.surface.basis_u().lower() + (2 - fit.surface.basis_u().lower()) * scale;
    const double v = other.surface.basis_v().lower() + (2 - fit.surface.basis_v().lower()) * scale;
    EXPECT_NEAR(Uncertainty(other, scaled).At(u, v).deviation, scale * one, 1e-3 * scale * one);
  }
}

TEST(UncertaintyTest, MarksRegionsWithoutPointsWithTheirArea) {
  const PointCloud cloud = Hills(3000, 0.01, 1.3);
  SurfaceFitOptions options = Plain();
  options.control_points = {20, 18};
  const SurfaceFit fit = FitSurface(cloud, options);
  const Uncertainty uncertainty(fit, cloud);
  const UncertaintyMap map = MapUncertainty(uncertainty, fit.surface);
  const UncertaintySummary summary = map.Summary(uncertainty);
  // Splines carry what is known some way over the hole's rim, by a knot span or two at most.
  const double hole = std::numbers::pi * 1.3 * 1.3, inner = std::numbers::pi * 0.6 * 0.6;
  EXPECT_GT(summary.unsupported_area, inner);
  EXPECT_LT(summary.unsupported_area, 1.6 * hole);
  EXPECT_LT(summary.sigma_median, uncertainty.noise());
}

TEST(UncertaintyTest, NoiseThatNeighboursShareRaisesVariances) {
  std::mt19937_64 random(8);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> even(0, 1);
  Eigen::Matrix3Xd points(3, 6400);
  std::vector<double> shared(1600);
  for (double& value : shared) value = normal(random);
  for (int k = 0; k < 6400; ++k) {
    const double x = even(random), y = even(random);
    const int cell = static_cast<int>(40 * x) * 40 + static_cast<int>(40 * y);
    points.col(k) << 6 * x, 5 * y,
        x * y + 0.01 * (normal(random) + shared[static_cast<size_t>(cell)]);
  }
  const PointCloud cloud(points);
  SurfaceFitOptions options = Plain();
  options.control_points = {7, 7};  // cells ten patches wide
  const SurfaceFit fit = FitSurface(cloud, options);
  // Four points share half of their variance: sums have (1 + (4 + 1 − 1)/2) as much, 4 + 1 the mean
  // of squares of Poisson numbers of mean 4 over 4.
  EXPECT_NEAR(Uncertainty(fit, cloud).inflation(), 3, 0.5);
}

TEST(UncertaintyTest, HeldEdgesAndPointsHaveNoVariance) {
  const PointCloud cloud = Hills(900, 0.02);
  SurfaceFitOptions options = Plain();
  options.meet = PointCloud(Eigen::Matrix3Xd(Eigen::Vector3d(3, 2, std::sin(3.) * std::cos(2.))));
  const SurfaceFit fit = FitSurface(cloud, options);
  const Uncertainty uncertainty(fit, cloud);
  ASSERT_EQ(fit.estimator.held_points.cols(), 1);
  const Eigen::Vector2d held = fit.estimator.held_points.col(0);
  EXPECT_LT(uncertainty.At(held[0], held[1]).deviation, 1e-3 * uncertainty.noise());
  EXPECT_GT(uncertainty.At(held[0] + 1, held[1]).deviation, 0.05 * uncertainty.noise());
}

TEST(UncertaintyTest, RefusesWhatHasNone) {
  const PointCloud cloud = Hills(60, 0.02);
  SurfaceFit fit = FitSurface(cloud, Plain());
  fit.estimator.refused = "for a reason";
  EXPECT_THROW(Uncertainty(fit, cloud), std::invalid_argument);
  fit.estimator.refused.clear();
  EXPECT_THROW(Uncertainty(fit, Hills(61, 0.02)), std::invalid_argument);
}

double SumOf(const ShapeFunctional& terms, const std::function<double(double, double)>& nu) {
  double sum = 0;
  for (const DisplacementTerm& term : terms) sum += term.factor * nu(term.u, term.v);
  return sum;
}

// Of a surface moved by ν along its normal, by differences of an exactly moved one.
TEST(ShapeFunctionalTest, AreDerivativesByDisplacement) {
  // z = x²/8 + xy/20 over degree 2: moved along the normal in closed form by sampling.
  const auto shape = [](double u, double v) {
    return Eigen::Vector3d(u, v, u * u / 8 + u * v / 20);
  };
  Eigen::Matrix3Xd net(3, 9);
  const auto polar = [](double a, double b, double c, double d) {  // of u², and of uv
    return std::pair{a * b, (a + b) / 2 * (c + d) / 2};
  };
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const double a = i > 1 ? 2 : 0, b = i > 0 ? 2 : 0, c = j > 1 ? 2 : 0, d = j > 0 ? 2 : 0;
      const auto [uu, uv] = polar(a, b, c, d);
      net.col(3 * i + j) << (a + b) / 2, (c + d) / 2, uu / 8 + uv / 20;
    }
  const SplineBasis basis(2, {0, 0, 0, 2, 2, 2});
  const NurbsSurface surface(basis, basis, net);
  ASSERT_LT((surface.At(0.7, 1.1) - shape(0.7, 1.1)).norm(), 1e-12);
  const auto nu = [](double u, double v) { return 0.3 + std::sin(u) * v + 0.2 * v * v; };
  const double eps = 1e-5;
  const auto moved = [&](double u, double v, double by) -> Eigen::Vector3d {
    return shape(u, v) + by * nu(u, v) * surface.NormalAt(u, v).value();
  };
  const double u = 0.8, v = 1.2;
  const auto curvature = [&](double by) {
    const double h = 1e-3;
    const Eigen::Vector3d mid = moved(u, v, by);
    const Eigen::Vector3d tu = (moved(u + h, v, by) - moved(u - h, v, by)) / (2 * h);
    const Eigen::Vector3d tv = (moved(u, v + h, by) - moved(u, v - h, by)) / (2 * h);
    const Eigen::Vector3d n = tu.cross(tv).normalized();
    // Along (1, 2): second difference on that line of parameters.
    const Eigen::Vector3d t = tu + 2 * tv;
    const Eigen::Vector3d second =
        (moved(u + h, v + 2 * h, by) - 2 * mid + moved(u - h, v - 2 * h, by)) / (h * h);
    return n.dot(second) / t.squaredNorm();
  };
  const double by_curvature = (curvature(eps) - curvature(-eps)) / (2 * eps);
  EXPECT_NEAR(SumOf(NormalCurvature(surface, u, v, {1, 2}), nu),
              by_curvature,
              1e-4 * std::abs(by_curvature));
  const auto radius = (1 / curvature(eps) - 1 / curvature(-eps)) / (2 * eps);
  EXPECT_NEAR(SumOf(CurvatureRadius(surface, u, v, {1, 2}), nu), radius, 1e-4 * std::abs(radius));
  const auto normal = [&](double by) {
    const double h = 1e-4;
    return (moved(u + h, v, by) - moved(u - h, v, by))
        .cross(moved(u, v + h, by) - moved(u, v - h, by))
        .normalized()
        .eval();
  };
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
  const double tilt = (normal(eps) - normal(-eps)).dot(x) / (2 * eps);
  EXPECT_NEAR(SumOf(NormalAlong(surface, u, v, x), nu), tilt, 1e-4 * std::abs(tilt));
  const auto apart = [&](double by) { return (moved(u, v, by) - moved(0.2, 0.3, by)).norm(); };
  EXPECT_NEAR(SumOf(DistanceBetween(surface, {0.2, 0.3}, {u, v}), nu),
              (apart(eps) - apart(-eps)) / (2 * eps),
              kHalfDigits);
}

TEST(ShapeFunctionalTest, RefuseWhatIsNotThere) {
  const SplineBasis line(1, {0, 0, 1, 1});
  Eigen::Matrix3Xd net(3, 4);
  net << 0, 0, 1, 1, 0, 1, 0, 1, 0, 0, 0, 0;
  const NurbsSurface flat(line, line, net);
  EXPECT_THROW(CurvatureRadius(flat, 0.5, 0.5, {1, 0}), std::invalid_argument);
  EXPECT_THROW(NormalCurvature(flat, 0.5, 0.5, {0, 0}), std::invalid_argument);
  EXPECT_THROW(DistanceBetween(flat, {0.5, 0.5}, {0.5, 0.5}), std::invalid_argument);
}

}  // namespace
}  // namespace batten
