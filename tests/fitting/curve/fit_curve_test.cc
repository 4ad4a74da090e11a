// SPDX-License-Identifier: MIT
// Curves from ordered points: recovered where they are splines, honest where they are not.
#include "batten/fitting/fit_curve.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "batten/fitting/ordered_points.h"
#include "dense_samples.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::fit_curve_test {

using ::testing::HasSubstr;

constexpr double kSigma = 0.01;

// At given parameters, without fairness: the plain least-squares problem.
CurveFitOptions Plain(int degree, int control_points) {
  CurveFitOptions options;
  options.degree = degree;
  options.control_points = control_points;
  options.parameterization = CurveParameterization::kGiven;
  options.smoothing = 0;
  options.threads = 2;
  return options;
}

template <int Dim>
PointCloud CloudOf(const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points,
                   const Eigen::VectorXd& u = {}) {
  Eigen::Matrix3Xd space = Eigen::Matrix3Xd::Zero(3, points.cols());
  space.template topRows<Dim>() = points;
  PointCloud cloud(std::move(space), Eigen::Vector3d::Zero(), Dim);
  if (u.size() > 0) {
    Eigen::Matrix2Xd parameters = Eigen::Matrix2Xd::Zero(2, u.size());
    parameters.row(0) = u;
    cloud.set_parameters(std::move(parameters));
  }
  return cloud;
}

// Increasing parameters with both ends.
Eigen::VectorXd Parameters(RandomSplines& random, int count, double low, double high) {
  Eigen::VectorXd u(count);
  for (double& value : u) value = random.Real(low, high);
  std::sort(u.begin(), u.end());
  u[0] = low;
  u[count - 1] = high;
  return u;
}

template <int Dim>
NurbsCurve<Dim> RandomUniformCurve(
    RandomSplines& random, int degree, int size, double low, double high) {
  typename NurbsCurve<Dim>::Points points(Dim, size);
  for (double& value : points.reshaped()) value = random.Real(-1, 1);
  return NurbsCurve<Dim>(SplineBasis::Uniform(degree, size, low, high), points);
}

template <int Dim>
PointCloud Sample(const NurbsCurve<Dim>& curve, const Eigen::VectorXd& u) {
  typename NurbsCurve<Dim>::Points points(Dim, u.size());
  for (Eigen::Index k = 0; k < u.size(); ++k) points.col(k) = curve.At(u[k]);
  return CloudOf<Dim>(points, u);
}

// A noisy arc of radius 1 over `angle` radians.
PointCloud NoisyArc(int count, double angle, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> noise(0, kSigma);
  Eigen::Matrix2Xd points(2, count);
  for (int k = 0; k < count; ++k) {
    const double a = angle * k / (count - 1);
    points.col(k) << std::cos(a) + noise(engine), std::sin(a) + noise(engine);
  }
  return CloudOf<2>(points);
}

// How far the curve is from the unit circle, rms over dense samples.
double OffTheCircle(const NurbsCurve<2>& curve) {
  double squares = 0;
  const std::vector<double> at = DenseParameters(curve.basis(), 400);
  for (const double u : at) squares += std::pow(curve.At(u).norm() - 1, 2);
  return std::sqrt(squares / static_cast<double>(at.size()));
}

template <int Dim>
void ExpectRecovered(RandomSplines& random) {
  const int degree = random.Integer(1, 6), size = degree + random.Integer(1, 9);
  const double low = random.Real(-100, 100), high = low + random.Logarithmic(1e-3, 1e3);
  const NurbsCurve<Dim> truth = RandomUniformCurve<Dim>(random, degree, size, low, high);
  const PointCloud cloud = Sample(truth, Parameters(random, 12 * size, low, high));
  const CurveFit<Dim> fit = FitCurve<Dim>(cloud, Plain(degree, size));
  EXPECT_EQ(fit.curve.basis().knots(), truth.basis().knots());
  // Normal equations square the condition, which random parameters make large.
  const double difference = (fit.curve.control_points() - truth.control_points()).norm();
  EXPECT_LT(difference, kHalfDigits);
  EXPECT_LT(fit.report.parameter_error->max, kIterated);
  EXPECT_LE(fit.report.error.max, fit.report.parameter_error->max + kIterated);
}

TEST(FitCurveTest, RecoversASplineFromItsPointsAtTheirParameters) {
  RandomSplines random(1);
  for (int trial = 0; trial < 60; ++trial) {
    SCOPED_TRACE("seed 1, trial " + std::to_string(trial));
    ExpectRecovered<2>(random);
    ExpectRecovered<3>(random);
  }
}

TEST(FitCurveTest, LeavesResidualsOrthogonalToEveryBasisFunction) {
  RandomSplines random(2);
  for (int trial = 0; trial < 20; ++trial) {
    SCOPED_TRACE("seed 2, trial " + std::to_string(trial));
    const Eigen::VectorXd u = Parameters(random, 80, -3, 5);
    Eigen::Matrix3Xd points(3, u.size());
    for (double& value : points.reshaped()) value = random.Real(-1, 1);
    const CurveFit<3> fit = FitCurve<3>(CloudOf<3>(points, u), Plain(3, 9));
    const SplineBasis& basis = fit.curve.basis();
    Eigen::Matrix3Xd sums = Eigen::Matrix3Xd::Zero(3, basis.size());
    double squares = 0;
    for (Eigen::Index k = 0; k < u.size(); ++k) {
      const Eigen::Vector3d residual = fit.curve.At(u[k]) - points.col(k);
      squares += residual.squaredNorm();
      for (int i = 0; i < basis.size(); ++i) sums.col(i) += basis.Function(i, u[k]) * residual;
    }
    EXPECT_LT(sums.norm(), kIterated * std::sqrt(squares * 80));
    const ErrorSummary& error = *fit.report.parameter_error;
    EXPECT_NEAR(error.rms * error.rms * 80, squares, kRounding * squares);
  }
}

TEST(FitCurveTest, KeepsTheRangeOfGivenParametersExactly) {
  const Eigen::VectorXd u = Eigen::VectorXd::LinSpaced(40, 0.1, 1.0 / 3);
  Eigen::Matrix2Xd points(2, 40);
  points << u.transpose(), u.transpose().array().sin().matrix();
  CurveFitOptions options = Plain(3, 7);
  EXPECT_EQ(FitCurve<2>(CloudOf<2>(points, u), options).curve.basis().lower(), 0.1);
  EXPECT_EQ(FitCurve<2>(CloudOf<2>(points, u), options).curve.basis().upper(), 1.0 / 3);
  options.parameterization = CurveParameterization::kChord;
  EXPECT_EQ(FitCurve<2>(CloudOf<2>(points), options).curve.basis().lower(), 0);
  EXPECT_EQ(FitCurve<2>(CloudOf<2>(points), options).curve.basis().upper(), 1);
}

TEST(FitCurveTest, TakesGivenParametersInAnyOrder) {
  RandomSplines random(3);
  const Eigen::VectorXd u = Parameters(random, 60, 0, 1);
  const PointCloud cloud = Sample(RandomUniformCurve<2>(random, 3, 12, 0, 1), u);
  std::vector<Eigen::Index> order(60);
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::shuffle(order.begin(), order.end(), std::mt19937(3));
  CurveFitOptions options = Plain(3, 8);
  const CurveFit<2> fit = FitCurve<2>(cloud, options);
  const CurveFit<2> shuffled = FitCurve<2>(cloud.Picked(order), options);
  EXPECT_EQ(fit.curve, shuffled.curve);
  EXPECT_EQ(fit.residuals(order), shuffled.residuals);
  options.order = PointOrder::kGiven;
  EXPECT_NO_THROW(FitCurve<2>(cloud, options));
  EXPECT_THROW(FitCurve<2>(cloud.Picked(order), options), std::invalid_argument);
}

TEST(FitCurveTest, MovesAndScalesWithThePoints) {
  const PointCloud cloud = NoisyArc(300, 2, 4);
  const CurveFit<2> fit = FitCurve<2>(cloud);
  const Eigen::Vector3d far(0x1p19, 0x1p22, 0);
  PointCloud moved(cloud.points(), far, 2);
  EXPECT_TRUE(FitCurve<2>(moved).curve.control_points().isApprox(
      fit.curve.control_points().colwise() + far.head<2>(), kRounding));
  const CurveFit<2> scaled = FitCurve<2>(PointCloud(1024 * cloud.points(), {0, 0, 0}, 2));
  EXPECT_EQ(scaled.curve.control_points(), 1024 * fit.curve.control_points());
  EXPECT_EQ(scaled.report.input.noise, 1024 * fit.report.input.noise);
  CurveFitOptions shifted;
  shifted.shift = far;
  EXPECT_TRUE(FitCurve<2>(moved, shifted)
                  .curve.control_points()
                  .isApprox(fit.curve.control_points(), kIterated));
}

TEST(FitCurveTest, GivesTheSameControlPointsForEveryUnitOfTheParameters) {
  const Eigen::VectorXd u = Eigen::VectorXd::LinSpaced(80, 0, 1);
  Eigen::Matrix2Xd points(2, 80);
  points << u.transpose(), (7 * u.transpose()).array().sin().matrix();
  CurveFitOptions options = Plain(3, 12);
  options.smoothing = 1e-3;
  const CurveFit<2> fit = FitCurve<2>(CloudOf<2>(points, u), options);
  for (const double unit : {0x1p-60, 0x1p-7, 0x1p30}) {
    const CurveFit<2> other = FitCurve<2>(CloudOf<2>(points, unit * u), options);
    EXPECT_TRUE(other.curve.control_points().isApprox(fit.curve.control_points(), kIterated))
        << unit;
  }
}

TEST(FitCurveTest, CountsRepeatedPointsAsWeight) {
  const PointCloud cloud = NoisyArc(60, 2, 5);
  std::vector<Eigen::Index> twice;
  for (Eigen::Index k = 0; k < 60; ++k) twice.insert(twice.end(), k % 3 == 0 ? 2 : 1, k);
  PointCloud weighted = cloud;
  weighted.set_weights(Eigen::VectorXd::NullaryExpr(60, [](auto k) { return k % 3 == 0 ? 2 : 1; }));
  CurveFitOptions options;
  options.control_points = 7;
  const CurveFit<2> repeated = FitCurve<2>(cloud.Picked(twice), options);
  EXPECT_EQ(repeated.curve, FitCurve<2>(weighted, options).curve);
  EXPECT_EQ(repeated.report.input.duplicates, 20);
  EXPECT_EQ(repeated.residuals.size(), 80);
  EXPECT_NE(repeated.curve, FitCurve<2>(cloud, options).curve);
}

TEST(FitCurveTest, DoesNotMergePointsWhoseParametersDiffer) {
  Eigen::Matrix2Xd points(2, 5);
  points << 0, 1, 1, 1, 2, 0, 1, 1, 1, 0;
  const Eigen::VectorXd u = Eigen::VectorXd::LinSpaced(5, 0, 4);
  const CurveFit<2> fit = FitCurve<2>(CloudOf<2>(points, u), Plain(1, 5));
  EXPECT_EQ(fit.report.input.duplicates, 0);
  EXPECT_TRUE(fit.curve.control_points().isApprox(points, kIterated));
}

TEST(FitCurveTest, ReportsDistancesThatADenseMeasurementFinds) {
  const PointCloud cloud = NoisyArc(150, 5, 6);
  CurveFitOptions options;
  options.control_points = 6;
  const CurveFit<2> fit = FitCurve<2>(cloud, options);
  double squares = 0, most = 0;
  for (Eigen::Index k = 0; k < cloud.size(); ++k) {
    const double d = DenseDistance<2>(fit.curve, cloud.points().col(k).head<2>(), 2000);
    EXPECT_NEAR(fit.residuals[k], d, kIterated);
    EXPECT_NEAR((fit.curve.At(fit.parameters[k]) - cloud.points().col(k).head<2>()).norm(),
                fit.residuals[k],
                kIterated);
    squares += d * d;
    most = std::max(most, d);
  }
  EXPECT_NEAR(fit.report.error.rms, std::sqrt(squares / 150), kIterated);
  EXPECT_NEAR(fit.report.error.max, most, kIterated);
  EXPECT_FALSE(fit.report.parameter_error.has_value());
}

// With n control points the noise leaves σ·√(n/N) of error; over the seeds half as much again is
// granted for the noise that chord lengths carry into the parameters, and to one of them, whose
// dozen degrees of freedom scatter, twice as much again.
TEST(FitCurveTest, FollowsTheShapeAndNotTheNoise) {
  constexpr unsigned kSeeds = 12;
  double squares = 0;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const CurveFit<2> fit = FitCurve<2>(NoisyArc(1000, 5, seed));
    const double n = fit.curve.basis().size();
    EXPECT_LE(n, 16);
    const double against_limit = OffTheCircle(fit.curve) / (kSigma * std::sqrt(n / 1000));
    squares += against_limit * against_limit;
    EXPECT_LT(against_limit, 3);
    EXPECT_NEAR(fit.report.input.noise, kSigma, 0.25 * kSigma);
    EXPECT_EQ(fit.report.termination, Termination::kNoiseReached);
    EXPECT_FALSE(fit.report.optimize.ran);
  }
  EXPECT_LT(std::sqrt(squares / kSeeds), 1.5);
}

// Of many points means are fitted first; what is left of the noise must be no more than of few, and
// outliers must be told as well, far ones and those of a few noises that only a loss finds.
TEST(FitCurveTest, FollowsManyPointsAsCloselyAsTheirNumberAllows) {
  constexpr Eigen::Index kMany = 40000, kEvery = 20;
  for (const double off : {0.0, 8 * kSigma, 0.5}) {
    SCOPED_TRACE(off);
    const PointCloud clean = NoisyArc(kMany, 5, 21);
    Eigen::Matrix3Xd points = clean.points();
    for (Eigen::Index k = 7; k < kMany; k += kEvery)
      points.col(k) += off * clean.points().col(k).normalized();
    CurveFitOptions options;
    if (off > 0) options.loss = Loss::kTukey;
    const CurveFit<2> fit = FitCurve<2>(PointCloud(points, {0, 0, 0}, 2), options);
    const double n = fit.curve.basis().size();
    EXPECT_LE(n, 24);
    EXPECT_LT(OffTheCircle(fit.curve), 3 * kSigma * std::sqrt(n / static_cast<double>(kMany)));
    EXPECT_NEAR(fit.report.input.noise, kSigma, 0.25 * kSigma);
    EXPECT_EQ(fit.report.termination, Termination::kNoiseReached);
    if (off == 0) continue;
    Eigen::Index told = 0;
    for (Eigen::Index k = 7; k < kMany; k += kEvery) told += fit.outliers[k];
    EXPECT_GE(told, 0.99 * kMany / kEvery);
    // Beyond three deviations is one point of 370.
    EXPECT_LE(fit.report.input.outliers, told + kMany / 200);
  }
}

TEST(FitCurveTest, HalvesSpansUntilTheToleranceIsKept) {
  const int count = 400;
  Eigen::Matrix2Xd points(2, count);
  for (int k = 0; k < count; ++k) {
    const double x = k / (count - 1.0);
    points.col(k) << x, 1 / (1 + std::exp(-100 * (x - 0.4)));
  }
  CurveFitOptions options;
  for (const double tolerance : {1e-1, 1e-3, 1e-5}) {
    SCOPED_TRACE(tolerance);
    options.tolerance = tolerance;
    const CurveFit<2> fit = FitCurve<2>(CloudOf<2>(points), options);
    EXPECT_TRUE(fit.report.tolerance_reached().value());
    EXPECT_EQ(fit.report.termination, Termination::kToleranceReached);
    for (int k = 0; k < count; k += 7) {
      EXPECT_LE(DenseDistance<2>(fit.curve, points.col(k), 4000), tolerance);
    }
  }
}

TEST(FitCurveTest, SaysWhenATolerancecanNotBeKept) {
  CurveFitOptions options;
  options.tolerance = kSigma / 4;
  const CurveFit<2> fit = FitCurve<2>(NoisyArc(300, 2, 8), options);
  EXPECT_FALSE(fit.report.tolerance_reached().value());
  EXPECT_EQ(fit.report.termination, Termination::kNoiseReached);
  EXPECT_LE(fit.curve.basis().size(), 300 / 10);
  options.control_points = 4;
  EXPECT_EQ(FitCurve<2>(NoisyArc(300, 2, 8), options).curve.basis().size(), 4);
  options.control_points.reset();
  options.max_control_points = 10;
  EXPECT_LE(FitCurve<2>(NoisyArc(300, 2, 8), options).curve.basis().size(), 10);
}

// y(x) at given x: the tolerance is held against what is fitted, not against the nearest point.
TEST(FitCurveTest, HoldsTheToleranceAgainstTheDistanceAskedFor) {
  const Eigen::VectorXd u = Eigen::VectorXd::LinSpaced(200, 0, 1);
  Eigen::Matrix2Xd points(2, 200);
  points << u.transpose(), 50 * (9 * u.transpose()).array().sin().matrix();
  CurveFitOptions options;
  options.parameterization = CurveParameterization::kGiven;
  options.tolerance = 0.5;
  const CurveFit<2> at_parameter = FitCurve<2>(CloudOf<2>(points, u), options);
  EXPECT_LE(at_parameter.report.parameter_error->max, 0.5);
  options.distance = CurveDistance::kPoint;
  options.corners = false;  // hairpins between two points
  const CurveFit<2> nearest = FitCurve<2>(CloudOf<2>(points, u), options);
  EXPECT_LE(nearest.report.error.max, 0.5);
  EXPECT_LT(nearest.curve.basis().size(), at_parameter.curve.basis().size());
}

TEST(FitCurveTest, GivesTheSameBitsForEveryNumberOfThreads) {
  const PointCloud cloud = NoisyArc(5000, 5, 9);
  CurveFitOptions options;
  options.loss = Loss::kTukey;
  options.threads = 1;
  const CurveFit<2> one = FitCurve<2>(cloud, options);
  options.threads = 3;
  const CurveFit<2> three = FitCurve<2>(cloud, options);
  EXPECT_EQ(one.curve, three.curve);
  EXPECT_EQ(one.residuals, three.residuals);
}

TEST(FitCurveTest, ForgetsFarPointsWhenALossIsAskedFor) {
  PointCloud clean = NoisyArc(500, 2, 10);
  Eigen::Matrix3Xd points = clean.points();
  for (Eigen::Index k = 5; k < 500; k += 20) points(1, k) += 0.5;
  CurveFitOptions options;
  options.parameterization = CurveParameterization::kUniform;
  options.control_points = 8;
  options.loss = Loss::kNone;
  const double plain = OffTheCircle(FitCurve<2>(PointCloud(points, {0, 0, 0}, 2), options).curve);
  options.loss = Loss::kTukey;
  const CurveFit<2> fit = FitCurve<2>(PointCloud(points, {0, 0, 0}, 2), options);
  const double robust = OffTheCircle(fit.curve);
  const double without = OffTheCircle(FitCurve<2>(clean, options).curve);
  EXPECT_GT(plain, 10 * without);
  EXPECT_LT(robust, 2 * without);
  for (Eigen::Index k = 5; k < 500; k += 20) EXPECT_TRUE(fit.outliers[k]);
  EXPECT_LE(fit.report.input.outliers, 30);
  EXPECT_EQ(fit.report.input.used + fit.report.input.outliers, 500);
  EXPECT_LT(fit.report.error.max, 0.1);
  EXPECT_GT(fit.report.error_all.max, 0.4);
  options.control_points.reset();
  options.tolerance = 0.06;
  EXPECT_TRUE(
      FitCurve<2>(PointCloud(points, {0, 0, 0}, 2), options).report.tolerance_reached().value());
}

TEST(FitCurveTest, DrawsALineThroughTwoPointsAndLowersNoDegreeUnasked) {
  Eigen::Matrix3Xd points(3, 2);
  points << 1, 4, 2, 6, 3, 3;
  CurveFitOptions options;
  options.degree = 1;
  const CurveFit<3> fit = FitCurve<3>(CloudOf<3>(points), options);
  EXPECT_LT(fit.report.error.max, kIterated);
  EXPECT_TRUE(fit.curve.At(0.5).isApprox(Eigen::Vector3d(2.5, 4, 3), kIterated));
  EXPECT_THAT(fit.report.warnings, ::testing::IsEmpty());
  for (const int degree : {2, 3, 7}) {
    options.degree = degree;
    try {
      FitCurve<3>(CloudOf<3>(points), options);
      ADD_FAILURE() << "degree " << degree;
    } catch (const std::invalid_argument& error) {
      EXPECT_THAT(error.what(), HasSubstr("lower the degree to 1"));
    }
  }
}

TEST(FitCurveTest, RefusesPointsThatCarryNoCurve) {
  const auto refused = [](const PointCloud& cloud, const CurveFitOptions& options) -> std::string {
    try {
      FitCurve<2>(cloud, options);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "not refused";
  };
  CurveFitOptions given;
  given.parameterization = CurveParameterization::kGiven;
  Eigen::Matrix2Xd points(2, 3);
  points << 0, 1, 2, 0, 1, 4;
  const Eigen::Vector3d one(5, 5, 5), tiny(0, 1e-70, 2e-70), large(1e15, 1e15 + 1, 1e15 + 2);
  EXPECT_THAT(refused(CloudOf<2>(Eigen::Matrix2Xd(2, 0)), {}), HasSubstr("no points"));
  EXPECT_THAT(refused(CloudOf<2>(Eigen::Matrix2Xd::Ones(2, 9)), {}),
              HasSubstr("all 9 are the same"));
  EXPECT_THAT(refused(CloudOf<2>(1e-150 * points), {}), HasSubstr("less than 1e-100"));
  EXPECT_THAT(refused(CloudOf<2>(points), given), HasSubstr("no parameters"));
  EXPECT_THAT(refused(CloudOf<2>(points, one), given), HasSubstr("all equal"));
  EXPECT_THAT(refused(CloudOf<2>(points, tiny), given), HasSubstr("less than 1e-60"));
  EXPECT_THAT(refused(CloudOf<2>(points, large), given), HasSubstr("hardly differ"));
  EXPECT_THAT(refused(CloudOf<3>(Eigen::Matrix3Xd::Identity(3, 3)), {}), HasSubstr("in space"));
}

TEST(FitCurveTest, NamesTheOptionThatBreaksItsRule) {
  const auto refusal = [](auto change) -> std::string {
    CurveFitOptions options;
    change(options);
    try {
      Check(options);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_THAT(refusal([](auto& o) { o.degree = 0; }), HasSubstr("degree is 0"));
  EXPECT_THAT(refusal([](auto& o) { o.degree = 26; }), HasSubstr("degree is 26"));
  EXPECT_THAT(refusal([](auto& o) { o.tolerance = 0; }), HasSubstr("tolerance"));
  EXPECT_THAT(refusal([](auto& o) { o.tolerance = NAN; }), HasSubstr("tolerance"));
  EXPECT_THAT(refusal([](auto& o) { o.control_points = 3; }), HasSubstr("control_points"));
  EXPECT_THAT(refusal([](auto& o) { o.max_control_points = 3; }), HasSubstr("max_control_points"));
  EXPECT_THAT(refusal([](auto& o) { o.smoothing = -1; }), HasSubstr("smoothing"));
  EXPECT_THAT(refusal([](auto& o) { o.loss_scale = 0; }), HasSubstr("loss_scale"));
  EXPECT_THAT(refusal([](auto& o) { o.shift[0] = INFINITY; }), HasSubstr("shift"));
  EXPECT_EQ(refusal([](auto& o) { o.optimize = FreeVariables{}; }), "accepted");
}

TEST(FitCurveTest, StopsWhenProgressSaysSo) {
  CurveFitOptions options;
  options.progress = [](const char*, double) { return false; };
  EXPECT_THROW(FitCurve<2>(NoisyArc(100, 2, 1), options), Cancelled);
}

TEST(OrderPointsTest, StepsByWhatTheNameSays) {
  RandomSplines random(11);
  Eigen::Matrix3Xd points(3, 30);
  double a = 0;
  for (int k = 0; k < 30; ++k, a += random.Real(0.01, 0.2)) {
    points.col(k) << std::cos(a), std::sin(a), 0.3 * a;
  }
  const PointCloud cloud(points);
  const Eigen::VectorXd
      uniform =
          OrderPoints(cloud, {.parameterization = CurveParameterization::kUniform}).parameters,
      chord = OrderPoints(cloud, {.parameterization = CurveParameterization::kChord}).parameters,
      root =
          OrderPoints(cloud, {.parameterization = CurveParameterization::kCentripetal}).parameters;
  const auto step = [](const Eigen::VectorXd& u, int k) { return u[k + 1] - u[k]; };
  for (int k = 0; k < 29; ++k) {
    const double ratio =
        (points.col(k + 1) - points.col(k)).norm() / (points.col(1) - points.col(0)).norm();
    EXPECT_NEAR(step(uniform, k), 1.0 / 29, kRounding);
    EXPECT_NEAR(step(chord, k) / step(chord, 0), ratio, kIterated);
    EXPECT_NEAR(step(root, k) / step(root, 0), std::sqrt(ratio), kIterated);
  }
  EXPECT_EQ(chord[0], 0);
  EXPECT_EQ(chord[29], 1);
}

TEST(OrderPointsTest, FindsNoNoiseInExactPoints) {
  Eigen::Matrix3Xd points(3, 200);
  for (int k = 0; k < 200; ++k) points.col(k) << std::cos(k / 50.0), std::sin(k / 50.0), k / 100.0;
  const OrderedPoints ordered =
      OrderPoints(PointCloud(points), {.parameterization = CurveParameterization::kChord});
  EXPECT_LT(ordered.noise, 1e-7);  // the fourth power of a step of 0.02, over the cubic's constant
  EXPECT_NEAR(ordered.spacing, std::hypot(0.02, 0.01), 1e-5);
}

// Noise is taken to be so large that means are formed, and these are all in one place.
TEST(OrderPointsTest, TakesPointsThatGoToAndFro) {
  for (const int count : {20, 29, 45, 52}) {
    SCOPED_TRACE(count);
    Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, count);
    for (int k = 1; k < count; k += 2) points.col(k) << 1, 2, 3;
    for (const bool closed : {false, true}) {
      const OrderedPoints ordered = OrderPoints(PointCloud(points), {.closed = closed});
      EXPECT_TRUE(ordered.parameters.allFinite());
      EXPECT_TRUE(ordered.lengths.allFinite());
      EXPECT_TRUE(std::isfinite(ordered.noise));
      EXPECT_GT(ordered.length, 0);
    }
  }
}

// Different points at few parameters: the corners that their means make must not coincide.
TEST(FitCurveTest, TakesManyPointsAtFewParameters) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    RandomSplines random(seed);
    const int count = random.Integer(20, 60);
    Eigen::Matrix3Xd points(3, count);
    Eigen::Matrix2Xd parameters = Eigen::Matrix2Xd::Zero(2, count);
    for (int k = 0; k < count; ++k) {
      const double t = k / (count - 1.0);
      points.col(k) << t, std::sin(3 * t), t * t;
      parameters(0, k) = random.Integer(0, 5);
    }
    PointCloud cloud(points);
    cloud.set_parameters(parameters);
    const CurveFit<3> fit = FitCurve<3>(cloud,
                                        {.degree = random.Integer(2, 7),
                                         .parameterization = CurveParameterization::kGiven,
                                         .distance = CurveDistance::kPoint,
                                         .optimize = FreeVariables{}});
    EXPECT_TRUE(fit.curve.control_points().allFinite());
  }
}

// Rounding must not put a corner at the seam of a closed curve below its domain.
TEST(FitCurveTest, ClosesPointsOfALattice) {
  for (unsigned seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE(seed);
    RandomSplines random(seed);
    const int count = random.Integer(10, 45);
    Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, count);
    for (int k = 1; k < count; ++k) {
      points.col(k) = points.col(k - 1);
      points(random.Integer(0, 1), k) += random.Coin() ? 1 : -1;
    }
    const CurveFit<2> fit = FitCurve<2>(PointCloud(points, Eigen::Vector3d::Zero(), 2),
                                        {.parameterization = CurveParameterization::kUniform,
                                         .order = PointOrder::kGiven,
                                         .closed = ClosedChoice::kYes,
                                         .optimize = FreeVariables{}});
    EXPECT_TRUE(fit.curve.basis().periodic());
    EXPECT_TRUE(fit.curve.control_points().allFinite());
  }
}

TEST(FitCurveTest, FarMoreControlPointsThanPointsAreRefused) {
  Eigen::Matrix3Xd points(3, 143);
  for (int k = 0; k < 143; ++k) points.col(k) << std::cos(0.03 * k), std::sin(0.05 * k), 0.01 * k;
  CurveFitOptions options;
  options.control_points = 2000;
  EXPECT_THROW(FitCurve<3>(PointCloud::FromWorld(points), options), std::invalid_argument);
  options.control_points = 300;
  EXPECT_EQ(FitCurve<3>(PointCloud::FromWorld(points), options).curve.basis().size(), 300);
}

}  // namespace batten::internal::fit_curve_test
