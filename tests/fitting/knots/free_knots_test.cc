// SPDX-License-Identifier: MIT
#include "batten/fitting/free_knots.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "batten/geometry/knot_vectors.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::free_knots_test {

using testing::HasSubstr;

using Data = std::shared_ptr<const FittingData>;

Data Sampled(const std::function<double(double)>& f, double lower, double upper, int count) {
  auto data = std::make_shared<FittingData>();
  data->parameters = Eigen::Matrix2Xd::Zero(2, count);
  data->values.resize(1, count);
  for (int k = 0; k < count; ++k) {
    const double x = lower + (upper - lower) * k / (count - 1);
    data->parameters(0, k) = x;
    data->values(0, k) = f(x);
  }
  return data;
}

FittingProblem UniformCurve(Data data, int interior, int degree = 3, double smoothing = 0) {
  const double lower = data->parameters.row(0).minCoeff(),
               upper = data->parameters.row(0).maxCoeff();
  return FittingProblem(SplineBasis::Uniform(degree, degree + 1 + interior, lower, upper),
                        std::move(data),
                        smoothing);
}

double Step(double x) { return 90 / (1 + std::exp(-100 * (x - 0.4))); }
double Cusp(double x) {
  return 100 * std::exp(-std::abs(10 * x - 5)) + std::pow(10 * x - 5, 5) / 500;
}
double Peak(double x) { return 0.01 / (0.01 + (x - 0.3) * (x - 0.3)); }
double Wave(double x) { return std::sin(2 * x) + 2 * std::exp(-16 * x * x) + 2; }

// What every result must keep.
void ExpectSound(const FittingProblem& problem, const FreeKnotResult& result) {
  ThreadPool pool(1);
  EXPECT_TRUE(std::isfinite(result.squares_after));
  EXPECT_TRUE(result.solution.coefficients.allFinite());
  EXPECT_LE(result.squares_after, result.squares_before);
  EXPECT_EQ(result.squares_before, SolveLinear(problem, pool).residual_squares);
  EXPECT_EQ(result.squares_after, result.solution.residual_squares);
  EXPECT_EQ(result.solution.coefficients.cols(), problem.unknowns());
  EXPECT_EQ(result.problem.basis_u().size(), problem.basis_u().size());
  EXPECT_EQ(result.problem.basis_u().lower(), problem.basis_u().lower());
  EXPECT_EQ(result.problem.basis_u().upper(), problem.basis_u().upper());
  EXPECT_EQ(&result.problem.data(), &problem.data());
}

// Best of many starts of other programs: cubics with k free interior knots, 201 equal samples.
struct TableEntry {
  const char* name;
  double (*f)(double);
  double lower, upper;
  int knots;
  double squares;
};
constexpr TableEntry kTable[] = {
    {"step", Step, 0, 1, 4, 3.38553},
    {"step", Step, 0, 1, 5, 1.54032},
    {"step", Step, 0, 1, 6, 0.0602135},
    {"step", Step, 0, 1, 8, 0.0113010},
    {"cusp", Cusp, 0, 1, 4, 206.83},
    {"cusp", Cusp, 0, 1, 5, 53.202},
    {"cusp", Cusp, 0, 1, 6, 3.75483},
    {"cusp", Cusp, 0, 1, 8, 0.382092},
    {"peak", Peak, 0, 1, 4, 3.60005e-4},
    {"peak", Peak, 0, 1, 5, 9.94115e-5},
    {"peak", Peak, 0, 1, 6, 5.08625e-5},
    {"peak", Peak, 0, 1, 8, 1.48498e-5},
    {"wave", Wave, -2, 2, 4, 0.780214},
    {"wave", Wave, -2, 2, 5, 9.52628e-3},
    {"wave", Wave, -2, 2, 6, 4.45022e-3},
    {"wave", Wave, -2, 2, 8, 2.71909e-4},
};

TEST(FreeKnotsTest, MeetsOrBeatsTheBestKnownSumsOfFourFunctions) {
  ThreadPool pool(2);
  for (const TableEntry& entry : kTable) {
    SCOPED_TRACE(std::string(entry.name) + ", knots " + std::to_string(entry.knots));
    const FittingProblem problem =
        UniformCurve(Sampled(entry.f, entry.lower, entry.upper, 201), entry.knots);
    const FreeKnotResult result = OptimizeKnots(problem, {}, pool);
    ExpectSound(problem, result);
    EXPECT_LE(result.squares_after, 1.001 * entry.squares);
  }
}

// Values of (x, y) instead of y: x itself is a spline over any knots, so nothing changes.
TEST(FreeKnotsTest, ACurveInThePlaneHasTheSumOfItsHeights) {
  ThreadPool pool(2);
  auto data = std::make_shared<FittingData>(*Sampled(Wave, -2, 2, 201));
  data->values.conservativeResize(2, 201);
  data->values.row(1) = data->values.row(0).eval();
  data->values.row(0) = data->parameters.row(0);
  const FreeKnotResult result = OptimizeKnots(UniformCurve(data, 5), {}, pool);
  EXPECT_LE(result.squares_after, 1.001 * 9.52628e-3);
}

// [de Boor & Rice 1968; knots found again by Jupp 1978 and others]
TEST(FreeKnotsTest, FindsTheKnownKnotsOfTheTitaniumData) {
  constexpr double kProperty[] = {
      0.644, 0.622, 0.638, 0.649, 0.652, 0.639, 0.646, 0.657, 0.652, 0.655, 0.644, 0.663, 0.663,
      0.668, 0.676, 0.676, 0.686, 0.679, 0.678, 0.683, 0.694, 0.699, 0.710, 0.730, 0.763, 0.812,
      0.907, 1.044, 1.336, 1.881, 2.169, 2.075, 1.598, 1.211, 0.916, 0.746, 0.672, 0.627, 0.615,
      0.607, 0.606, 0.609, 0.603, 0.601, 0.603, 0.601, 0.611, 0.601, 0.608};
  ThreadPool pool(2);
  const Data data =
      Sampled([&](double x) { return kProperty[std::lround((x - 595) / 10)]; }, 595, 1075, 49);
  const FreeKnotResult result = OptimizeKnots(UniformCurve(data, 5), {}, pool);
  EXPECT_LE(result.squares_after, 1.001 * 0.00765276);
  constexpr double kKnots[] = {835.457, 876.506, 898.167, 916.280, 974.017};
  // The sum is flat there: a thousandth of it is some hundredths of a degree.
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(result.problem.basis_u().knots()[4 + i], kKnots[i], 0.05);
}

TEST(FreeKnotsTest, KnotsThatComeTogetherAreExactlyEqual) {
  ThreadPool pool(2);
  // The cusp at 0.5 asks a cubic for a triple knot.
  const FreeKnotResult result = OptimizeKnots(UniformCurve(Sampled(Cusp, 0, 1, 201), 5), {}, pool);
  const std::vector<KnotMultiplicity> knots = DomainKnots(result.problem.basis_u());
  ASSERT_EQ(knots.size(), 5u);
  EXPECT_EQ(knots[2].multiplicity, 3);
  EXPECT_NEAR(knots[2].knot, 0.5, 1.0 / 200);  // between two samples the sum hardly changes
}

TEST(FreeKnotsTest, FindsTheKnotsOfASpline) {
  ThreadPool pool(2);
  for (unsigned seed = 0; seed < 6; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int degree = random.Integer(2, 5);
    std::vector<double> breaks(1, 0.0);
    for (int i = 0; i < 5; ++i) breaks.push_back(breaks.back() + random.Real(0.5, 1.5));
    const SplineBasis basis = SplineBasis::Clamped(degree, breaks);
    auto data = std::make_shared<FittingData>(
        *Sampled([](double) { return 0.0; }, breaks.front(), breaks.back(), 300));
    Eigen::MatrixXd coefficients(1, basis.size());
    for (int i = 0; i < basis.size(); ++i)
      coefficients(0, i) = (i % 2 ? 1 : -1) * random.Real(0.5, 1);
    data->values = EvaluateAt(FittingProblem(basis, data, 0), coefficients, pool);
    const FittingProblem problem = UniformCurve(data, 4, degree);
    const FreeKnotResult result = OptimizeKnots(problem, {}, pool);
    ExpectSound(problem, result);
    EXPECT_LE(result.squares_after, kHalfDigits * kHalfDigits * 300);
  }
}

TEST(FreeKnotsTest, ThreadsDoNotChangeABit) {
  ThreadPool one(1), three(3);
  const FittingProblem problem = UniformCurve(Sampled(Step, 0, 1, 201), 5);
  const FreeKnotResult a = OptimizeKnots(problem, {}, one), b = OptimizeKnots(problem, {}, three);
  EXPECT_EQ(a.problem.basis_u(), b.problem.basis_u());
  EXPECT_EQ(a.solution.coefficients, b.solution.coefficients);
  EXPECT_EQ(a.iterations, b.iterations);
  EXPECT_EQ(a.starts, b.starts);
}

TEST(FreeKnotsTest, UnitsOfValuesAndParametersDoNotMatter) {
  ThreadPool pool(2);
  const FreeKnotResult plain = OptimizeKnots(UniformCurve(Sampled(Peak, 0, 1, 201), 4), {}, pool);
  for (const double scale : {1e-6, 1e6}) {
    SCOPED_TRACE("scale " + std::to_string(scale));
    const Data data =
        Sampled([&](double x) { return scale * (5 + Peak(x / scale)); }, 0, scale, 201);
    const FreeKnotResult scaled = OptimizeKnots(UniformCurve(data, 4), {}, pool);
    // The end of an iteration, squared: half the digits.
    EXPECT_NEAR(
        scaled.squares_after / (scale * scale), plain.squares_after, 1e-6 * plain.squares_after);
  }
}

TEST(FreeKnotsTest, WeightsCountAsRepetition) {
  ThreadPool pool(2);
  const Data once = Sampled(Peak, 0, 1, 101);
  auto weighted = std::make_shared<FittingData>(*once);
  weighted->weights = Eigen::VectorXd::Ones(101);
  weighted->weights.segment(30, 20).setConstant(2);
  auto repeated = std::make_shared<FittingData>(*once);
  repeated->parameters.conservativeResize(2, 121);
  repeated->values.conservativeResize(1, 121);
  repeated->parameters.rightCols(20) = once->parameters.middleCols(30, 20);
  repeated->values.rightCols(20) = once->values.middleCols(30, 20);
  const FreeKnotResult a = OptimizeKnots(UniformCurve(weighted, 4), {}, pool);
  const FreeKnotResult b = OptimizeKnots(UniformCurve(repeated, 4), {}, pool);
  EXPECT_NEAR(a.squares_after, b.squares_after, kHalfDigits * b.squares_after);
  EXPECT_TRUE(SameKnots(a.problem.basis_u(), b.problem.basis_u(), 1e-3));
}

TEST(FreeKnotsTest, NoDegreeIsTooHighOrTooLow) {
  ThreadPool pool(2);
  for (const int degree : {1, 2, 5, 10}) {
    SCOPED_TRACE("degree " + std::to_string(degree));
    for (const double smoothing : {0.0, 1e-3}) {
      const FittingProblem problem = UniformCurve(Sampled(Wave, -2, 2, 101), 4, degree, smoothing);
      const FreeKnotResult result = OptimizeKnots(problem, {.starts = 4}, pool);
      ExpectSound(problem, result);
      EXPECT_LT(result.squares_after, 0.9 * result.squares_before);
      EXPECT_EQ(result.problem.smoothing(), smoothing);
    }
  }
}

TEST(FreeKnotsTest, APolygonHasItsKnotsAtTheCorners) {
  ThreadPool pool(2);
  const auto polygon = [](double x) { return std::abs(x - 0.3) - 2 * std::abs(x - 0.6); };
  const FittingProblem problem = UniformCurve(Sampled(polygon, 0, 1, 101), 2, 1);
  const FreeKnotResult result = OptimizeKnots(problem, {}, pool);
  ExpectSound(problem, result);
  EXPECT_LE(result.squares_after, kHalfDigits);
  EXPECT_NEAR(result.problem.basis_u().knots()[2], 0.3, 1e-3);
  EXPECT_NEAR(result.problem.basis_u().knots()[3], 0.6, 1e-3);
}

TEST(FreeKnotsTest, UnclampedBasesKeepTheirEndKnots) {
  ThreadPool pool(2);
  const FittingProblem problem(UniformKnots(3, 9, 0, 1), Sampled(Peak, 0, 1, 201), 0);
  const FreeKnotResult result = OptimizeKnots(problem, {.starts = 4}, pool);
  ExpectSound(problem, result);
  EXPECT_LE(result.squares_after, 1.001 * 9.94115e-5);  // the same splines as clamped ones
  const std::vector<double>&before = problem.basis_u().knots(),
        &after = result.problem.basis_u().knots();
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(after[i], before[i]);
    EXPECT_EQ(after[after.size() - 1 - i], before[before.size() - 1 - i]);
  }
}

TEST(FreeKnotsTest, StopsAtTheSquaresAskedFor) {
  ThreadPool pool(2);
  const FittingProblem problem = UniformCurve(Sampled(Peak, 0, 1, 201), 6);
  const FreeKnotResult whole = OptimizeKnots(problem, {}, pool);
  const FreeKnotResult stopped = OptimizeKnots(problem, {.stop_squares = 1e-3}, pool);
  ExpectSound(problem, stopped);
  EXPECT_LE(stopped.squares_after, 1e-3);
  EXPECT_LT(stopped.iterations, whole.iterations / 4);
  const FreeKnotResult nothing = OptimizeKnots(problem, {.stop_squares = 10}, pool);
  EXPECT_EQ(nothing.problem.basis_u(), problem.basis_u());
  EXPECT_THAT(nothing.note, HasSubstr("good enough"));
}

TEST(FreeKnotsTest, CancelledItReturnsTheBestSoFar) {
  ThreadPool pool(2);
  const FittingProblem problem = UniformCurve(Sampled(Step, 0, 1, 201), 8);
  for (const int allowed : {0, 1, 5, 50, 300}) {
    SCOPED_TRACE("calls " + std::to_string(allowed));
    int calls = 0;
    double last = 0;
    const FreeKnotResult result = OptimizeKnots(problem,
                                                {.progress =
                                                     [&](const char* stage, double fraction) {
                                                       EXPECT_STREQ(stage, "knots");
                                                       EXPECT_GE(fraction, last);
                                                       EXPECT_LE(fraction, 1);
                                                       last = fraction;
                                                       return calls++ < allowed;
                                                     }},
                                                pool);
    ExpectSound(problem, result);
    EXPECT_TRUE(result.cancelled);
    EXPECT_EQ(result.note, "cancelled");
    EXPECT_EQ(calls, allowed + 1);
  }
}

TEST(FreeKnotsTest, ATimeLimitHolds) {
  ThreadPool pool(2);
  const FittingProblem problem = UniformCurve(Sampled(Step, 0, 1, 2001), 30);
  const FreeKnotResult result = OptimizeKnots(problem, {.seconds = 0.05}, pool);
  ExpectSound(problem, result);
  EXPECT_FALSE(result.cancelled);
  EXPECT_EQ(result.note, "time limit reached");
}

TEST(FreeKnotsTest, NothingThatMayMoveIsSaid) {
  ThreadPool pool(1);
  const FittingProblem problem = UniformCurve(Sampled(Peak, 0, 1, 51), 0);
  EXPECT_THAT(OptimizeKnots(problem, {}, pool).note, HasSubstr("no interior knot"));
  const FittingProblem held = UniformCurve(Sampled(Peak, 0, 1, 51), 3);
  const FreeKnotResult result = OptimizeKnots(held, {.u = false}, pool);
  EXPECT_THAT(result.note, HasSubstr("no interior knot"));
  EXPECT_EQ(result.problem.basis_u(), held.basis_u());
  EXPECT_EQ(result.squares_after, result.squares_before);
}

TEST(FreeKnotsTest, TooFewDataComeBackAsTheyWere) {
  ThreadPool pool(2);
  const FittingProblem problem = UniformCurve(Sampled(Peak, 0, 1, 9), 12);
  const FreeKnotResult result = OptimizeKnots(problem, {}, pool);
  ExpectSound(problem, result);
  EXPECT_EQ(result.problem.basis_u(), problem.basis_u());
  EXPECT_THAT(result.note, HasSubstr("do not determine"));
  // Fairness determines what the data do not.
  const FittingProblem fair = UniformCurve(Sampled(Peak, 0, 1, 9), 12, 3, 1e-9);
  ExpectSound(fair, OptimizeKnots(fair, {}, pool));
}

TEST(FreeKnotsTest, AllDataInOneSpanAreFoundByTheKnots) {
  ThreadPool pool(2);
  auto data = std::make_shared<FittingData>(*Sampled([](double x) { return Peak(x); }, 0, 1, 201));
  data->parameters *= 0.1;  // of a domain ten times as long
  const FittingProblem problem(SplineBasis::Uniform(3, 8, 0, 1), data, 0);
  const FreeKnotResult result = OptimizeKnots(problem, {}, pool);
  ExpectSound(problem, result);
}

TEST(FreeKnotsTest, EmptySpansAndGapsInTheDataAreNoTrouble) {
  ThreadPool pool(2);
  for (unsigned seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    auto data = std::make_shared<FittingData>();
    const int m = random.Integer(12, 60);
    data->parameters = Eigen::Matrix2Xd::Zero(2, m);
    data->values.resize(2, m);
    // Clusters of equal parameters with different values, and nothing in between.
    std::vector<double> places;
    for (int i = random.Integer(3, 12); i > 0; --i) places.push_back(random.Real(0, 1));
    for (int k = 0; k < m; ++k) {
      const bool loose = random.Integer(0, 3) == 0;
      data->parameters(0, k) = loose
                                   ? random.Real(0, 1)
                                   : places[random.Integer(0, static_cast<int>(places.size()) - 1)];
      for (int d = 0; d < 2; ++d) data->values(d, k) = random.Real(-1, 1);
    }
    const double smoothing = random.Coin() ? 0 : random.Logarithmic(1e-10, 1e-3);
    const int degree = random.Integer(1, 5);
    const FittingProblem problem(
        SplineBasis::Uniform(degree, degree + 1 + random.Integer(1, 8), 0, 1), data, smoothing);
    ExpectSound(problem, OptimizeKnots(problem, {.starts = 4}, pool));
  }
}

TEST(FreeKnotsTest, KnotsThatStartTogetherMayStayOrPart) {
  ThreadPool pool(2);
  const Data data = Sampled(Peak, 0, 1, 201);
  for (const std::vector<double>& interior :
       {std::vector<double>{0.5, 0.5, 0.5, 0.5 + 1e-9},
        std::vector<double>{0.1, 0.1, 0.9, 0.9},
        std::vector<double>{1e-12, 2e-12, 3e-12, 4e-12},
        std::vector<double>{0.3, 0.3 + 1e-15, 0.3 + 2e-15, 0.9}}) {
    std::vector<double> knots = {0, 0, 0, 0};
    knots.insert(knots.end(), interior.begin(), interior.end());
    knots.insert(knots.end(), {1, 1, 1, 1});
    const FittingProblem problem(SplineBasis(3, knots), data, 0);
    const FreeKnotResult result = OptimizeKnots(problem, {}, pool);
    ExpectSound(problem, result);
    EXPECT_LE(result.squares_after, 1.001 * 3.60005e-4);
  }
}

TEST(FreeKnotsTest, ExactAndConstantDataEndAtOnce) {
  ThreadPool pool(2);
  const FittingProblem constant = UniformCurve(Sampled([](double) { return 3.0; }, 0, 1, 50), 4);
  ExpectSound(constant, OptimizeKnots(constant, {}, pool));
  const FittingProblem cubic =
      UniformCurve(Sampled([](double x) { return x * x * x - x; }, 0, 1, 50), 4);
  ExpectSound(cubic, OptimizeKnots(cubic, {}, pool));
}

TEST(FreeKnotsTest, RefusesWhatItCannotDo) {
  ThreadPool pool(1);
  const Data data = Sampled(Peak, 0, 1, 51);
  const FittingProblem problem = UniformCurve(data, 3);
  const auto refused = [&](const FittingProblem& asked, const FreeKnotOptions& options) {
    try {
      OptimizeKnots(asked, options, pool);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_THAT(refused(FittingProblem(PeriodicUniformKnots(3, 8, 0, 1), data, 0), {}),
              HasSubstr("periodic"));
  EXPECT_THAT(refused(problem, {.max_iterations = -1}), HasSubstr("max_iterations"));
  EXPECT_THAT(refused(problem, {.starts = -1}), HasSubstr("starts"));
  EXPECT_THAT(refused(problem, {.coalesce = 0.5}), HasSubstr("coalesce"));
  EXPECT_THAT(refused(problem, {.stop_squares = std::numeric_limits<double>::quiet_NaN()}),
              HasSubstr("stop_squares"));
  EXPECT_THAT(refused(problem, {.seconds = -1}), HasSubstr("seconds"));
}

// A profile across u = 0.37, with a little waviness along v.
FittingProblem Ridge(
    double (*profile)(double), int knots_u, int knots_v, int count, int dimension) {
  RandomSplines random(5);
  auto data = std::make_shared<FittingData>();
  data->parameters.resize(2, count);
  data->values.resize(dimension, count);
  for (int k = 0; k < count; ++k) {
    const double u = random.Real(0, 1), v = random.Real(0, 1);
    data->parameters.col(k) << u, v;
    const double height = profile((u - 0.37) / 0.01) + 0.1 * std::sin(3 * v);
    if (dimension == 3) data->values.col(k).head(2) << u, v;
    data->values(dimension - 1, k) = height;
  }
  return FittingProblem(SplineBasis::Uniform(3, 4 + knots_u, 0, 1),
                        SplineBasis::Uniform(3, 4 + knots_v, 0, 1),
                        data,
                        0);
}

double Gauss(double s) { return std::exp(-s * s); }
double Lorentz(double s) { return 1 / (1 + s * s); }
double Tanh(double s) { return std::tanh(s); }

double Rms(const FreeKnotResult& result) {
  return std::sqrt(result.squares_after / static_cast<double>(result.problem.size()));
}

double NearestKnot(const SplineBasis& basis, double place) {
  double least = std::numeric_limits<double>::infinity();
  for (const double t : basis.knots()) least = std::min(least, std::abs(t - place));
  return least;
}

TEST(FreeKnotsTest, ANarrowRidgeNeedsSixKnots) {
  ThreadPool pool(2);
  const FittingProblem problem = Ridge(Gauss, 6, 2, 20000, 1);
  const FreeKnotResult result = OptimizeKnots(problem, {.v = false}, pool);
  ExpectSound(problem, result);
  EXPECT_LE(Rms(result), 1e-3);
  EXPECT_LE(NearestKnot(result.problem.basis_u(), 0.37), 1e-3);
  EXPECT_EQ(result.problem.basis_v(), problem.basis_v());
  // Uniform knots need more than 80.
  EXPECT_GT(SolveLinear(Ridge(Gauss, 80, 2, 20000, 1), pool).residual_squares, 1e-6 * 20000);
}

TEST(FreeKnotsTest, SurfacesAreTheSameOnAnyNumberOfThreadsAndInEitherDirection) {
  ThreadPool one(1), three(3);
  const FittingProblem problem = Ridge(Gauss, 2, 1, 1000, 3);
  const FreeKnotResult a = OptimizeKnots(problem, {}, one), b = OptimizeKnots(problem, {}, three);
  ExpectSound(problem, a);
  EXPECT_EQ(a.problem.basis_u(), b.problem.basis_u());
  EXPECT_EQ(a.problem.basis_v(), b.problem.basis_v());
  EXPECT_EQ(a.squares_after, b.squares_after);

  auto turned = std::make_shared<FittingData>(problem.data());
  turned->parameters.row(0).swap(turned->parameters.row(1));
  const FittingProblem turned_problem(problem.basis_v(), problem.basis_u(), turned, 0);
  const FreeKnotResult straight = OptimizeKnots(problem, {.v = false}, three);
  const FreeKnotResult across = OptimizeKnots(turned_problem, {.u = false}, three);
  EXPECT_EQ(across.problem.basis_u(), turned_problem.basis_u());
  // The data are thinned in another order, and many descents end in slightly different places.
  EXPECT_NEAR(Rms(straight), Rms(across), 0.2 * Rms(straight));
}

TEST(LongFreeKnotsTest, RidgesAndStepsOfManyKinds) {
  ThreadPool pool(2);
  struct Kind {
    const char* name;
    double (*profile)(double);
    bool ridge;
  };
  for (const Kind& kind :
       {Kind{"Gauss", Gauss, true}, {"Lorentz", Lorentz, true}, {"tanh", Tanh, false}}) {
    for (const int dimension : {1, 3}) {
      SCOPED_TRACE(std::string(kind.name) + ", dimension " + std::to_string(dimension));
      const FittingProblem problem = Ridge(kind.profile, 8, 2, 20000, dimension);
      const FreeKnotResult result = OptimizeKnots(problem, {.v = false}, pool);
      ExpectSound(problem, result);
      EXPECT_LE(Rms(result), 1e-3);
      // A step has knots on both of its sides instead.
      if (kind.ridge) {
        EXPECT_LE(NearestKnot(result.problem.basis_u(), 0.37), 1e-3);
      }
    }
  }
}

// Sought on part of the data, ended on all of them.
TEST(LongFreeKnotsTest, ManyDataAndManyKnots) {
  ThreadPool pool(2);
  RandomSplines random(3);
  auto data = std::make_shared<FittingData>();
  const int m = 100000;
  data->parameters = Eigen::Matrix2Xd::Zero(2, m);
  data->values.resize(2, m);
  for (int k = 0; k < m; ++k) {
    const double x = random.Real(0, 1);
    data->parameters(0, k) = x;
    data->values.col(k) << std::sin(40 * x * x) + random.Real(-1e-4, 1e-4),
        std::abs(x - 0.3) + random.Real(-1e-4, 1e-4);
  }
  const FittingProblem problem = UniformCurve(data, 50);
  const FreeKnotResult result = OptimizeKnots(problem, {}, pool);
  ExpectSound(problem, result);
  const double noise = std::sqrt(2.0 / 3) * 1e-4;  // of both coordinates
  EXPECT_GT(result.squares_before, 100 * noise * noise * m);
  EXPECT_LT(result.squares_after, 10 * noise * noise * m);
}

TEST(LongFreeKnotsTest, TheTableHoldsForAnySeed) {
  ThreadPool pool(2);
  for (std::uint64_t seed = 2; seed < 8; ++seed) {
    for (const TableEntry& entry : kTable) {
      SCOPED_TRACE(std::string(entry.name) + ", knots " + std::to_string(entry.knots) + ", seed " +
                   std::to_string(seed));
      const FittingProblem problem =
          UniformCurve(Sampled(entry.f, entry.lower, entry.upper, 201), entry.knots);
      EXPECT_LE(OptimizeKnots(problem, {.seed = seed}, pool).squares_after, 1.001 * entry.squares);
    }
  }
}

// The search does not grow without bound with the knots: a spiral of 300 places and 90 knots took
// 9000 descents' iterations, most of them to close gaps.
TEST(FreeKnotsTest, ManyKnotsOnFewDataEndSoon) {
  RandomSplines random(4);
  auto data = std::make_shared<FittingData>();
  constexpr int kPlaces = 300, kKnots = 90, kMostIterations = 4000;
  data->parameters = Eigen::Matrix2Xd::Zero(2, kPlaces);
  data->values.resize(2, kPlaces);
  for (int k = 0; k < kPlaces; ++k) {
    const double t = static_cast<double>(k) / (kPlaces - 1);
    data->parameters(0, k) = t;
    data->values.col(k) << t * std::cos(30 * t) + random.Real(-3e-4, 3e-4),
        t * std::sin(30 * t) + random.Real(-3e-4, 3e-4);
  }
  ThreadPool pool(2);
  const FittingProblem problem = UniformCurve(data, kKnots);
  const FreeKnotResult result = OptimizeKnots(problem, {}, pool);
  ExpectSound(problem, result);
  EXPECT_LE(result.iterations, kMostIterations);
}

}  // namespace batten::internal::free_knots_test
