// SPDX-License-Identifier: MIT
#include "batten/fitting/interpolate_grid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <string>
#include <vector>

#include "batten/fitting/approximate_grid.h"
#include "batten/geometry/surface_evaluator.h"
#include "known_grids.h"
#include "random_splines.h"
#include "tolerances.h"
#include "refusal.h"

namespace batten::internal::interpolate_grid_test {

double SizeOf(const PointNet& net) {
  return (net.points.rowwise().maxCoeff() - net.points.rowwise().minCoeff()).maxCoeff();
}

// The largest distance of the surface at the lines' parameters from the points.
double MissOf(const InterpolatedGrid& grid, const PointNet& net) {
  double most = 0;
  for (int i = 0; i < net.rows; ++i) {
    for (int j = 0; j < net.columns; ++j) {
      const Eigen::Vector3d at = grid.surface.At(grid.parameters.u[i], grid.parameters.v[j]);
      most = std::max(most, (at - net.At(i, j)).norm());
    }
  }
  return most;
}

// A net of values of a random surface at random increasing parameters.
struct RandomCase {
  NurbsSurface surface;
  PointNet net;
  GridParameters parameters;
};

Eigen::VectorXd RandomParameters(RandomSplines& random, int count) {
  Eigen::VectorXd t(count);
  t[0] = random.Real(-3, 3);
  for (int k = 1; k < count; ++k) t[k] = t[k - 1] + random.Real(0.3, 1);
  return t;
}

PointNet Values(const NurbsSurface& surface, const GridParameters& t) {
  PointNet net{static_cast<int>(t.u.size()), static_cast<int>(t.v.size()), {}, {}};
  net.points.resize(3, Eigen::Index{net.rows} * net.columns);
  for (int i = 0; i < net.rows; ++i) {
    for (int j = 0; j < net.columns; ++j) {
      net.points.col(Eigen::Index{i} * net.columns + j) = surface.At(t.u[i], t.v[j]);
    }
  }
  return net;
}

TEST(InterpolateGridTest, GoesThroughItsPointsInEveryDegreeAndParameterization) {
  ThreadPool pool;
  for (unsigned seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    GridInterpolationOptions options{random.Integer(1, 7), random.Integer(1, 7)};
    const PointNet net = Shaken(BentGrid(random.Integer(options.degree_u + 1, 30),
                                         random.Integer(options.degree_v + 1, 30)),
                                0.01,
                                seed);
    for (const auto parameterization : {GridParameterization::kAuto,
                                        GridParameterization::kUniform,
                                        GridParameterization::kChord,
                                        GridParameterization::kCentripetal}) {
      SCOPED_TRACE(Name(parameterization));
      options.parameterization = parameterization;
      const InterpolatedGrid grid = InterpolateGrid(net, options, pool);
      EXPECT_LE(MissOf(grid, net), kRounding * SizeOf(net));
      const int n = grid.surface.size_u(), m = grid.surface.size_v();
      EXPECT_LE((grid.surface.control_point(0, 0) - net.At(0, 0)).norm(), 1e-15 * SizeOf(net));
      EXPECT_LE((grid.surface.control_point(n - 1, m - 1) - net.At(n - 1, m - 1)).norm(),
                1e-15 * SizeOf(net));
    }
  }
}

TEST(InterpolateGridTest, FindsASurfaceOfItsOwnSpaceAgain) {
  ThreadPool pool;
  for (unsigned seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    GridInterpolationOptions options{random.Integer(1, 5), random.Integer(1, 5)};
    options.parameterization = GridParameterization::kGiven;
    options.parameters = {RandomParameters(random, random.Integer(6, 20)),
                          RandomParameters(random, random.Integer(6, 20))};
    // Whatever goes in first only lends its bases.
    PointNet any{static_cast<int>(options.parameters.u.size()),
                 static_cast<int>(options.parameters.v.size()),
                 {},
                 {}};
    any.points = Eigen::Matrix3Xd::Random(3, Eigen::Index{any.rows} * any.columns);
    const NurbsSurface like = InterpolateGrid(any, options, pool).surface;
    Eigen::Matrix3Xd control(3, any.points.cols());
    for (auto&& point : control.colwise()) point = random.Vector(1);
    const NurbsSurface surface(like.basis_u(), like.basis_v(), control);
    const NurbsSurface found =
        InterpolateGrid(Values(surface, options.parameters), options, pool).surface;
    // The condition of these matrices is below 1e3 each way.
    EXPECT_LE((found.control_points() - control).cwiseAbs().maxCoeff(), kIterated);
  }
}

TEST(InterpolateGridTest, AffineMapsOfThePointsMapTheSurface) {
  ThreadPool pool;
  RandomSplines random(5);
  for (const auto& [scale, far] :
       {std::pair{1.0, 0.0}, {1e-6, 0.0}, {1e6, 0.0}, {1.0, 5e6}, {1e3, 5e6}}) {
    SCOPED_TRACE("scale " + std::to_string(scale) + ", origin at " + std::to_string(far));
    const PointNet net = BentGrid(23, 17);
    PointNet moved = net;
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    const Eigen::Vector3d shift(far, -far, far / 10);
    moved.points = (scale * turn * net.points).colwise() + shift;
    for (const bool local : {false, true}) {
      const auto fit = [&](const PointNet& points) {
        return local ? InterpolateGridLocally(points, {}, pool) : InterpolateGrid(points, {}, pool);
      };
      const Eigen::Matrix3Xd expected =
          (scale * turn * fit(net).surface.control_points()).colwise() + shift;
      const Eigen::Matrix3Xd got = fit(moved).surface.control_points();
      // Coordinates carry 2^-53 of the distance from the origin; parameters pass it on.
      EXPECT_LE((got - expected).cwiseAbs().maxCoeff(), kRounding * scale + 1e-14 * far);
    }
  }
}

TEST(InterpolateGridTest, ATransposedGridGivesTheTransposedSurface) {
  ThreadPool pool;
  const PointNet net = BentGrid(19, 12);
  const NurbsSurface surface = InterpolateGrid(net, {3, 4}, pool).surface;
  const NurbsSurface turned = InterpolateGrid(Transposed(net), {4, 3}, pool).surface;
  for (int i = 0; i < surface.size_u(); ++i) {
    for (int j = 0; j < surface.size_v(); ++j) {
      EXPECT_LE((surface.control_point(i, j) - turned.control_point(j, i)).norm(), kRounding);
    }
  }
}

TEST(InterpolateGridTest, ThreadsChangeNothing) {
  ThreadPool one(1), four(4);
  const PointNet net = BentGrid(70, 90);
  EXPECT_EQ(InterpolateGrid(net, {}, one).surface, InterpolateGrid(net, {}, four).surface);
  EXPECT_EQ(InterpolateGridLocally(net, {}, one).surface,
            InterpolateGridLocally(net, {}, four).surface);
}

// Errors against Franke's function on a grid four times as fine; what a classic not-a-knot
// interpolant leaves is 7.0e-8 and 3.8e-9.
TEST(InterpolateGridTest, FrankesFunctionIsMetToTheFigures) {
  ThreadPool pool;
  for (const auto& [lines, most] : {std::pair{100, 6e-8}, {200, 4e-9}}) {
    const InterpolatedGrid grid = InterpolateGrid(FrankeGrid(lines, lines), {}, pool);
    std::vector<double> places;
    for (int k = 0; k <= 4 * (lines - 1); ++k) places.push_back(k / (4.0 * (lines - 1)));
    SurfaceGrid fine;
    SurfaceEvaluator(grid.surface).Grid(places, places, fine);
    double squares = 0;
    for (const auto& p : fine.points.colwise()) squares += std::pow(p[2] - Franke(p[0], p[1]), 2);
    EXPECT_LE(std::sqrt(squares / static_cast<double>(fine.points.cols())), most);
  }
}

TEST(InterpolateGridTest, AClosedGridIsSmoothAcrossItsSeam) {
  ThreadPool pool;
  for (int degree = 1; degree <= 5; ++degree) {
    SCOPED_TRACE("degree " + std::to_string(degree));
    PointNet net = SphereGrid(9, 25);
    // Without the repeated column, and without poles.
    PointNet ring{7, 24, Eigen::Matrix3Xd(3, 7 * 24), {}};
    for (int i = 0; i < 7; ++i) {
      for (int j = 0; j < 24; ++j) ring.points.col(i * 24 + j) = net.At(i + 1, j);
    }
    GridInterpolationOptions options{3, degree};
    options.closed.v = true;
    const InterpolatedGrid grid = InterpolateGrid(ring, options, pool);
    EXPECT_TRUE(grid.surface.basis_v().periodic());
    EXPECT_LE(MissOf(grid, ring), kRounding);
    // On the sphere between the points as well: the step is 0.26, its fourth power 5e-3.
    if (degree >= 3) {
      for (const double v : {0.01, 0.33, 0.99}) {
        EXPECT_NEAR(grid.surface.At(grid.parameters.u[3], v).norm(), 1, 1e-4);
      }
    }
  }
}

TEST(InterpolateGridTest, PolesStayPoles) {
  ThreadPool pool;
  const PointNet net = SphereGrid(12, 17);
  GridInterpolationOptions options;
  for (const bool local : {false, true}) {
    const NurbsSurface surface = local ? InterpolateGridLocally(net, options, pool).surface
                                       : InterpolateGrid(net, options, pool).surface;
    for (int j = 1; j < surface.size_v(); ++j) {
      EXPECT_EQ(surface.control_point(0, j), surface.control_point(0, 0));
      EXPECT_EQ(surface.control_point(surface.size_u() - 1, j),
                surface.control_point(surface.size_u() - 1, 0));
    }
  }
}

TEST(InterpolateGridLocallyTest, GoesThroughItsPointsAndIsOnceDifferentiable) {
  ThreadPool pool;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const PointNet net = Shaken(BentGrid(random.Integer(2, 20), random.Integer(2, 20)), 0.01, seed);
    const InterpolatedGrid grid = InterpolateGridLocally(net, {}, pool);
    EXPECT_LE(MissOf(grid, net), kRounding);
    for (Eigen::Index i = 1; i + 1 < grid.parameters.u.size(); ++i) {
      const double u = grid.parameters.u[i], step = 1e-9, v = random.Real(0, 1);
      const Eigen::Vector3d before = grid.surface.JetAt(u - step, v).du,
                            after = grid.surface.JetAt(u, v).du;
      // Second derivatives are below 1e3 here.
      EXPECT_LE((before - after).norm(), 1e-5);
    }
  }
}

TEST(InterpolateGridLocallyTest, APointActsOnItsNeighbourhoodOnly) {
  ThreadPool pool;
  const PointNet net = BentGrid(15, 15);
  GridInterpolationOptions options;
  options.parameterization = GridParameterization::kUniform;
  PointNet flawed = net;
  flawed.points.col(7 * 15 + 7) += Eigen::Vector3d(0.1, 0.1, 0.1);
  const NurbsSurface a = InterpolateGridLocally(net, options, pool).surface,
                     b = InterpolateGridLocally(flawed, options, pool).surface;
  for (int k = 0; k <= 56; ++k) {
    for (int l = 0; l <= 56; ++l) {
      const double u = k / 56.0, v = l / 56.0;
      const bool near = std::abs(14 * u - 7) < 2 && std::abs(14 * v - 7) < 2;
      const double apart = (a.At(u, v) - b.At(u, v)).norm();
      if (near) continue;
      EXPECT_LE(apart, kRounding) << u << ' ' << v;
    }
  }
}

TEST(InterpolateGridLocallyTest, FollowsBiquadraticSurfacesExactly) {
  ThreadPool pool;
  const PointNet net = GridOn(
      [](double u, double v) -> Eigen::Vector3d {
        return {u, v, 1 + u - 2 * v + u * u - 3 * u * v + v * v + u * u * v * v};
      },
      7,
      9);
  const NurbsSurface surface = InterpolateGridLocally(net, {}, pool).surface;
  for (int k = 0; k <= 50; ++k) {
    const double u = k / 50.0, v = std::fmod(0.37 * k, 1);
    const Eigen::Vector3d p = surface.At(u, v);
    EXPECT_NEAR(p[2],
                1 + p[0] - 2 * p[1] + p[0] * p[0] - 3 * p[0] * p[1] + p[1] * p[1] +
                    p[0] * p[0] * p[1] * p[1],
                kRounding);
  }
}

// Places on a plane of a grid that is regular over it, however it is turned.
TEST(GridParametersTest, ARegularGridOverAPlaneKeepsItsPlaces) {
  PointNet net = GridOn(
      [](double u, double v) -> Eigen::Vector3d {
        return {3 * u * u + u, 2 * v, Franke(u, v)};
      },
      20,
      14);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(3, -1, 2).normalized()).toRotationMatrix();
  net.points = turn * net.points;
  const GridParameters t = ParametersOf(net, GridParameterization::kAuto);
  for (int i = 0; i < 20; ++i) {
    const double u = i / 19.0;
    EXPECT_NEAR(t.u[i], (3 * u * u + u) / 4, kRounding);
  }
  for (int j = 0; j < 14; ++j) EXPECT_NEAR(t.v[j], j / 13.0, kRounding);
}

TEST(InterpolateGridTest, RefusesWhatCarriesNoSurface) {
  using testing::HasSubstr;
  ThreadPool pool;
  const auto refusal = [&](const PointNet& net, const GridInterpolationOptions& options = {}) {
    return RefusalOf([&] { InterpolateGrid(net, options, pool); });
  };
  EXPECT_THAT(refusal(BentGrid(3, 20)), HasSubstr("lower the degree to 2"));
  EXPECT_THAT(refusal({1, 5, Eigen::Matrix3Xd::Random(3, 5), {}}), HasSubstr("1 x 5"));
  EXPECT_THAT(refusal({4, 5, Eigen::Matrix3Xd::Random(3, 19), {}}),
              HasSubstr("takes 20 points; there are 19"));
  PointNet repeated = BentGrid(8, 8);
  repeated.points.middleCols(3 * 8, 8) = repeated.points.middleCols(2 * 8, 8);
  EXPECT_THAT(refusal(repeated), HasSubstr("rows 3 and 4"));
  EXPECT_THAT(refusal(Transposed(repeated)), HasSubstr("columns 3 and 4"));
  PointNet one_place{5, 5, Eigen::Matrix3Xd::Ones(3, 25), {}};
  EXPECT_THAT(refusal(one_place), HasSubstr("in one place"));
  PointNet holed = BentGrid(8, 8);
  holed.missing = PointMask::Constant(64, false);
  holed.missing[5] = true;
  EXPECT_THAT(refusal(holed), HasSubstr("missing"));
  PointNet bad = BentGrid(8, 8);
  bad.points(1, 9) = std::nan("");
  EXPECT_THAT(refusal(bad), HasSubstr("row 2, column 2"));
  GridInterpolationOptions given;
  given.parameterization = GridParameterization::kGiven;
  given.parameters = {Eigen::VectorXd::LinSpaced(8, 0, 1), Eigen::VectorXd::LinSpaced(7, 0, 1)};
  EXPECT_THAT(refusal(BentGrid(8, 8), given), HasSubstr("columns needs 8 parameters"));
}

}  // namespace batten::internal::interpolate_grid_test
