// SPDX-License-Identifier: MIT
#include "batten/fitting/approximate_grid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "fitting/grid/net_distance.h"
#include "geometry/editing/deviation_bound.h"
#include "batten/geometry/surface_evaluator.h"
#include "known_grids.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::approximate_grid_test {

std::vector<double> Places(const SplineBasis& basis, int count) {
  std::vector<double> places;
  for (int k = 0; k <= count; ++k) {
    places.push_back(basis.lower() + (basis.upper() - basis.lower()) * k / count);
  }
  return places;
}

// The largest distance of two surfaces at a fine grid of equal parameters.
double Apart(const NurbsSurface& a, const NurbsSurface& b, int count) {
  const std::vector<double> u = Places(a.basis_u(), count), v = Places(a.basis_v(), count);
  SurfaceGrid of_a, of_b;
  SurfaceEvaluator(a).Grid(u, v, of_a);
  SurfaceEvaluator(b).Grid(u, v, of_b);
  return (of_a.points - of_b.points).colwise().norm().maxCoeff();
}

double MissOf(const NurbsSurface& surface, const GridParameters& t, const PointNet& net) {
  double most = 0;
  for (int i = 0; i < net.rows; ++i) {
    for (int j = 0; j < net.columns; ++j) {
      most = std::max(most, (surface.At(t.u[i], t.v[j]) - net.At(i, j)).norm());
    }
  }
  return most;
}

// What has to hold of every answer, by means that the search does not use.
void ExpectKept(const PointNet& net,
                double tolerance,
                const ToleratedGrid& kept,
                const GridInterpolationOptions& options,
                ThreadPool& pool) {
  constexpr int kFine = 419;  // shares no places with the search
  const NurbsSurface through = InterpolateGrid(net, options, pool).surface;
  EXPECT_LE(MissOf(kept.surface, kept.parameters, net), tolerance);
  const double apart = Apart(kept.surface, through, kFine);
  EXPECT_LE(apart, tolerance);
  EXPECT_LE(apart, kept.error + kRounding * net.points.cwiseAbs().maxCoeff());
  EXPECT_LE(kept.surface.control_points().cols(), through.control_points().cols());
}

TEST(LeastSquaresGridTest, ResidualsAreOrthogonalToTheBasis) {
  ThreadPool pool;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    GridLeastSquaresOptions options{random.Integer(1, 5), random.Integer(1, 5)};
    options.control_u = random.Integer(options.degree_u + 1, 12);
    options.control_v = random.Integer(options.degree_v + 1, 12);
    options.meet_corners = false;
    const PointNet net =
        Shaken(BentGrid(random.Integer(12, 30), random.Integer(12, 30)), 0.1, seed);
    const InterpolatedGrid fit = LeastSquaresGrid(net, options, pool);
    ASSERT_EQ(fit.surface.size_u(), options.control_u);
    ASSERT_EQ(fit.surface.size_v(), options.control_v);
    Eigen::Matrix3Xd gradient = Eigen::Matrix3Xd::Zero(3, fit.surface.control_points().cols());
    for (int i = 0; i < net.rows; ++i) {
      for (int j = 0; j < net.columns; ++j) {
        const double u = fit.parameters.u[i], v = fit.parameters.v[j];
        const Eigen::Vector3d miss = fit.surface.At(u, v) - net.At(i, j);
        for (int a = 0; a < options.control_u; ++a) {
          const double N = fit.surface.basis_u().Function(a, u);
          if (N == 0) continue;
          for (int b = 0; b < options.control_v; ++b) {
            gradient.col(a * options.control_v + b) +=
                N * fit.surface.basis_v().Function(b, v) * miss;
          }
        }
      }
    }
    EXPECT_LE(gradient.cwiseAbs().maxCoeff(), kRounding * net.points.cols());
  }
}

TEST(LeastSquaresGridTest, CornersAreMetAndATransposedGridGivesTheTransposedSurface) {
  ThreadPool pool;
  const PointNet net = Shaken(BentGrid(25, 18), 0.02, 1);
  GridLeastSquaresOptions options{3, 2, 9, 7};
  const NurbsSurface surface = LeastSquaresGrid(net, options, pool).surface;
  EXPECT_LE((surface.control_point(0, 0) - net.At(0, 0)).norm(), kRounding);
  EXPECT_LE((surface.control_point(8, 6) - net.At(24, 17)).norm(), kRounding);
  const NurbsSurface turned = LeastSquaresGrid(Transposed(net), {2, 3, 7, 9}, pool).surface;
  for (int i = 0; i < 9; ++i) {
    for (int j = 0; j < 7; ++j) {
      EXPECT_LE((surface.control_point(i, j) - turned.control_point(j, i)).norm(), kRounding);
    }
  }
}

TEST(LeastSquaresGridTest, AsManyControlPointsAsLinesInterpolate) {
  ThreadPool pool;
  const PointNet net = Shaken(BentGrid(14, 11), 0.02, 2);
  const InterpolatedGrid fit = LeastSquaresGrid(net, {3, 3, 14, 11}, pool);
  EXPECT_LE(MissOf(fit.surface, fit.parameters, net), kIterated);
}

TEST(LeastSquaresGridTest, ClosedGridsArePeriodic) {
  ThreadPool pool;
  PointNet ring{9, 40, Eigen::Matrix3Xd(3, 9 * 40), {}};
  const PointNet sphere = SphereGrid(11, 41);
  for (int i = 0; i < 9; ++i) {
    for (int j = 0; j < 40; ++j) ring.points.col(i * 40 + j) = sphere.At(i + 1, j);
  }
  GridLeastSquaresOptions options{3, 3, 8, 14};
  options.closed.v = true;
  const InterpolatedGrid fit = LeastSquaresGrid(ring, options, pool);
  EXPECT_TRUE(fit.surface.basis_v().periodic());
  // Spans of 0.45: (0.45)⁴ / 384 and a factor for the rows.
  EXPECT_LE(MissOf(fit.surface, fit.parameters, ring), 1e-3);
}

TEST(NetDistanceTest, IsAnUpperBoundThatCutsTighten) {
  ThreadPool pool;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const PointNet net = Shaken(BentGrid(14, 17), 0.05, seed);
    GridInterpolationOptions uniform;
    uniform.parameterization = GridParameterization::kUniform;
    const NurbsSurface a = InterpolateGrid(net, uniform, pool).surface;
    GridLeastSquaresOptions squares{3, 3, 6, 8};
    squares.parameterization = GridParameterization::kUniform;
    const NurbsSurface b = LeastSquaresGrid(net, squares, pool).surface;
    const double most = DeviationBound(a, b);  // at most 1 % above the maximum
    const double rough = NetDistance(a, b), fine = NetDistance(a, b, 8);
    EXPECT_GE(rough, 0.99 * most);
    EXPECT_GE(fine, 0.99 * most);
    EXPECT_LE(fine, rough);
    // What it is too large by falls with the square: to a 64th, for which a 16th is granted.
    EXPECT_LE(fine - 0.99 * most, 0.01 * most + (rough - 0.99 * most) / 16);
  }
}

// What SISL's s1966 takes on the same grids is 506 and 399 at 1e-3 on 100² and 200², at 1e-4 and on
// the coarser grids more than the interpolant.
TEST(ApproximateGridTest, FrankesFunctionIsKeptWithFewControlPoints) {
  ThreadPool pool(2);
  struct Case {
    int lines;
    double tolerance;
    int most;
    bool truth;  // the grid is fine enough for that
  };
  for (const Case& c : {Case{21, 1e-3, 441, true},
                        {21, 1e-4, 441, false},
                        {51, 1e-3, 250, true},
                        {51, 1e-4, 560, true},
                        {100, 1e-3, 250, true},
                        {100, 1e-4, 520, true},
                        {200, 1e-3, 250, true},
                        {200, 1e-4, 520, true}}) {
    SCOPED_TRACE(std::to_string(c.lines) + " lines, tolerance " + std::to_string(c.tolerance));
    const PointNet net = FrankeGrid(c.lines, c.lines);
    const ToleratedGrid kept = ApproximateGrid(net, c.tolerance, {}, pool);
    ExpectKept(net, c.tolerance, kept, {}, pool);
    EXPECT_LE(kept.surface.control_points().cols(), c.most);
    if (!c.truth) continue;
    double most = 0;
    for (int i = 0; i <= 600; ++i) {
      for (int j = 0; j <= 600; ++j) {
        const Eigen::Vector3d p = kept.surface.At(i / 600.0, j / 600.0);
        most = std::max(most, std::abs(p[2] - Franke(p[0], p[1])));
      }
    }
    EXPECT_LE(most, c.tolerance);
  }
}

TEST(ApproximateGridTest, KeepsTheToleranceWhateverThePointsAre) {
  ThreadPool pool(2);
  const auto ridge = [](double x, double y) -> Eigen::Vector3d {
    return {x, y, std::abs(x - 0.4) + 0.3 * std::abs(y - x)};
  };
  const auto step = [](double x, double y) -> Eigen::Vector3d {
    return {x, y, x + 0.3 * y > 0.6 ? 1.0 : 0.0};
  };
  const auto spike = [](double x, double y) -> Eigen::Vector3d {
    return {x, y, std::exp(-3000 * (std::pow(x - 0.3, 2) + std::pow(y - 0.7, 2)))};
  };
  const auto plane = [](double x, double y) -> Eigen::Vector3d { return {x, 2 * y, 3 * x - y}; };
  const std::vector<std::pair<std::string, PointNet>> nets{
      {"ridge", GridOn(ridge, 40, 33)},
      {"step", GridOn(step, 30, 30)},
      {"spike", GridOn(spike, 45, 45)},
      {"plane", GridOn(plane, 12, 15)},
      {"noise", Shaken(FrankeGrid(30, 30), 0.01, 1)},
      {"sheet", BentGrid(40, 25)},
      {"sphere", SphereGrid(20, 33)},
      {"strip", BentGrid(200, 4)},
      {"4 x 4", BentGrid(4, 4)}};
  for (const auto& [name, net] : nets) {
    for (const double tolerance : {0.3, 1e-2, 1e-3, 1e-5}) {
      SCOPED_TRACE(name + ", tolerance " + std::to_string(tolerance));
      ExpectKept(net, tolerance, ApproximateGrid(net, tolerance, {}, pool), {}, pool);
    }
  }
}

// Lines that are rough along v only keep all their control points in that direction alone.
TEST(ApproximateGridTest, ADirectionThatCannotBeThinnedLeavesTheOther) {
  ThreadPool pool;
  PointNet net = FrankeGrid(40, 30);
  const PointNet rough = Shaken(FrankeGrid(2, 30), 0.01, 3);
  for (int i = 0; i < 40; ++i) {
    for (int j = 0; j < 30; ++j) net.points(2, i * 30 + j) += rough.At(0, j)[2];
  }
  const ToleratedGrid kept = ApproximateGrid(net, 1e-3, {}, pool);
  ExpectKept(net, 1e-3, kept, {}, pool);
  EXPECT_LT(kept.surface.size_u(), 30);
}

TEST(ApproximateGridTest, APlaneTakesOneCell) {
  ThreadPool pool;
  const PointNet net = GridOn(
      [](double x, double y) -> Eigen::Vector3d {
        return {x, 2 * y, 3 * x - y};
      },
      30,
      25);
  const ToleratedGrid kept = ApproximateGrid(net, 1e-6, {}, pool);
  EXPECT_EQ(kept.surface.control_points().cols(), 16);
}

TEST(ApproximateGridTest, ScaledMovedAndTurnedPointsGiveTheSameKnots) {
  ThreadPool pool(2);
  const PointNet net = BentGrid(50, 40);
  const NurbsSurface expected = ApproximateGrid(net, 1e-4, {}, pool).surface;
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.9, Eigen::Vector3d(2, 1, -1).normalized()).toRotationMatrix();
  for (const auto& [scale, far] : {std::pair{1e-6, 0.0}, {1e6, 0.0}, {1.0, 5e6}, {30.0, 5e5}}) {
    SCOPED_TRACE("scale " + std::to_string(scale) + ", origin at " + std::to_string(far));
    PointNet moved = net;
    moved.points = (scale * turn * net.points).colwise() + Eigen::Vector3d(far, far, 0);
    const ToleratedGrid kept = ApproximateGrid(moved, 1e-4 * scale, {}, pool);
    ASSERT_EQ(kept.surface.size_u(), expected.size_u());
    ASSERT_EQ(kept.surface.size_v(), expected.size_v());
    ExpectKept(moved, 1e-4 * scale, kept, {}, pool);
  }
}

TEST(ApproximateGridTest, ThreadsChangeNothing) {
  ThreadPool one(1), three(3);
  const PointNet net = FrankeGrid(60, 45);
  EXPECT_EQ(ApproximateGrid(net, 1e-3, {}, one).surface,
            ApproximateGrid(net, 1e-3, {}, three).surface);
}

TEST(ApproximateGridTest, ClosedGridsStayClosedAndPolesStayPoles) {
  ThreadPool pool(2);
  PointNet sphere = SphereGrid(31, 41);
  PointNet open{31, 40, Eigen::Matrix3Xd(3, 31 * 40), {}};
  for (int i = 0; i < 31; ++i) {
    for (int j = 0; j < 40; ++j) open.points.col(i * 40 + j) = sphere.At(i, j);
  }
  for (int degree = 2; degree <= 5; ++degree) {
    SCOPED_TRACE("degree " + std::to_string(degree));
    GridInterpolationOptions options{3, degree};
    options.closed.v = true;
    const ToleratedGrid kept = ApproximateGrid(open, 1e-3, options, pool);
    ExpectKept(open, 1e-3, kept, options, pool);
    EXPECT_TRUE(kept.surface.basis_v().periodic());
    EXPECT_LT(kept.surface.size_v(), 20);
    for (int j = 1; j < kept.surface.size_v(); ++j) {
      EXPECT_EQ(kept.surface.control_point(0, j), kept.surface.control_point(0, 0));
    }
  }
}

TEST(ApproximateGridTest, RefusesAToleranceThatIsNone) {
  ThreadPool pool;
  EXPECT_THROW(ApproximateGrid(BentGrid(8, 8), 0, {}, pool), std::invalid_argument);
  EXPECT_THROW(ApproximateGrid(BentGrid(8, 8), -1, {}, pool), std::invalid_argument);
  EXPECT_THROW(LeastSquaresGrid(BentGrid(8, 8), {3, 3, 9, 8}, pool), std::invalid_argument);
  EXPECT_THROW(LeastSquaresGrid(BentGrid(8, 8), {3, 3, 3, 8}, pool), std::invalid_argument);
}

}  // namespace batten::internal::approximate_grid_test
