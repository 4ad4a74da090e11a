// SPDX-License-Identifier: MIT
#include "batten/fitting/fit_grid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "batten/fitting/distances.h"
#include "fitting/grid/fill_cells.h"
#include "known_grids.h"
#include "tolerances.h"
#include "refusal.h"

namespace batten::internal::fit_grid_test {

using testing::HasSubstr;

GridFitOptions OptionsFor(const PointNet& net) {
  GridFitOptions options;
  options.rows = net.rows;
  options.columns = net.columns;
  options.threads = 1;
  return options;
}

std::string Refusal(const PointCloud& cloud, const GridFitOptions& options) {
  return internal::RefusalOf([&] { FitGrid(cloud, options); }, "not refused");
}

// A disc of cells without points, and the cloud of those that have one.
struct Holed {
  PointMask missing;
  PointCloud cloud;
};

Holed WithHole(const PointNet& net, double radius) {
  Holed holed{PointMask::Constant(net.points.cols(), false), {}};
  std::vector<Eigen::Index> kept;
  for (int i = 0; i < net.rows; ++i) {
    for (int j = 0; j < net.columns; ++j) {
      const Eigen::Index cell = Eigen::Index{i} * net.columns + j;
      holed.missing[cell] = std::hypot(static_cast<double>(i) / (net.rows - 1) - 0.45,
                                       static_cast<double>(j) / (net.columns - 1) - 0.55) < radius;
      if (!holed.missing[cell]) kept.push_back(cell);
    }
  }
  holed.cloud = PointCloud(net.points(Eigen::all, kept));
  return holed;
}

TEST(FitGridTest, InterpolatesAndReportsWhatTheSurfaceIs) {
  const PointNet net = BentGrid(40, 30);
  for (const GridMethod method :
       {GridMethod::kAuto, GridMethod::kInterpolate, GridMethod::kInterpolateLocally}) {
    GridFitOptions options = OptionsFor(net);
    options.method = method;
    const SurfaceFit fit = FitGrid(PointCloud(net.points), options);
    EXPECT_LE(fit.report.error.max, kRounding);
    EXPECT_EQ(fit.report.error.points, 1200);
    EXPECT_EQ(fit.report.geometry.base, "grid");
    EXPECT_THAT(fit.report.geometry.base_why, HasSubstr("40 rows of 30 points"));
    EXPECT_EQ(fit.report.geometry.control_points,
              (std::vector<int>{fit.surface.size_u(), fit.surface.size_v()}));
    EXPECT_TRUE(fit.report.warnings.empty());
    EXPECT_FALSE(fit.outliers.any());
    // Parameters are lengths: the sheet's sides are about 3 and 1.5 long.
    EXPECT_NEAR(fit.surface.basis_u().upper(), 3.2, 0.6);
    EXPECT_LE(fit.report.geometry.distortion, 0.5);
  }
}

TEST(FitGridTest, TheToleranceIsReachedAsAnIndependentMeasureSays) {
  const PointNet net = FrankeGrid(60, 50);
  GridFitOptions options = OptionsFor(net);
  options.tolerance = 1e-3;
  const SurfaceFit fit = FitGrid(PointCloud(net.points), options);
  EXPECT_EQ(fit.report.termination, Termination::kToleranceReached);
  EXPECT_EQ(fit.report.tolerance_reached(), true);
  EXPECT_LT(fit.surface.control_points().cols(), 300);
  ThreadPool pool;
  const PointDistances found = DistancesTo(fit.surface, net.points, pool);
  EXPECT_LE(found.distances.cwiseAbs().maxCoeff(), 1e-3);
  // Local feet are never nearer than the nearest, and hardly ever farther.
  EXPECT_LE(found.distances.cwiseAbs().maxCoeff(), fit.report.error.max * (1 + kHalfDigits));
}

TEST(FitGridTest, TooFewControlPointsMissTheToleranceAndSaySo) {
  const PointNet net = FrankeGrid(40, 40);
  GridFitOptions options = OptionsFor(net);
  options.control_points = {6, 7};
  options.tolerance = 1e-3;
  const SurfaceFit fit = FitGrid(PointCloud(net.points), options);
  EXPECT_EQ(fit.surface.size_u(), 6);
  EXPECT_EQ(fit.surface.size_v(), 7);
  EXPECT_EQ(fit.report.tolerance_reached(), false);
  EXPECT_EQ(fit.report.end.code, EndCode::kMaxControlPoints);
  EXPECT_GT(fit.report.error.max, 1e-3);
}

TEST(FitGridTest, FarOriginsAndShiftsChangeNothing) {
  const PointNet net = BentGrid(25, 20);
  GridFitOptions options = OptionsFor(net);
  options.tolerance = 1e-3;
  const SurfaceFit near = FitGrid(PointCloud(net.points), options);
  // As from a survey, 12.5 m apart from a round origin.
  const Eigen::Vector3d origin(448260, 5411932, 110);
  const SurfaceFit far = FitGrid(PointCloud(net.points, origin), options);
  EXPECT_LE((far.surface.Translated(-origin).control_points() - near.surface.control_points())
                .cwiseAbs()
                .maxCoeff(),
            2e-9);  // two units in the last place of the largest coordinate
  EXPECT_EQ(far.report.tolerance_reached(), true);
  options.shift = origin;
  const SurfaceFit shifted = FitGrid(PointCloud(net.points, origin), options);
  EXPECT_LE(
      (shifted.surface.control_points() - near.surface.control_points()).cwiseAbs().maxCoeff(),
      kRounding);
}

TEST(FitGridTest, MissingCellsAreVoidsOverWhichTheSurfaceIsFair) {
  const PointNet net = FrankeGrid(50, 45);
  const Holed holed = WithHole(net, 0.08);
  for (const bool tolerant : {false, true}) {
    GridFitOptions options = OptionsFor(net);
    options.missing = holed.missing;
    if (tolerant) options.tolerance = 1e-3;
    const SurfaceFit fit = FitGrid(holed.cloud, options);
    EXPECT_LE(fit.report.error.max, tolerant ? 1e-3 : kRounding);
    EXPECT_EQ(fit.report.error.points, holed.cloud.size());
    ASSERT_EQ(fit.report.warnings.size(), 1u);
    EXPECT_THAT(fit.report.warnings[0], HasSubstr("missing"));
    // In the void, 0.16 wide over bumps of width 0.2 and height 1, no farther off than a tenth.
    ThreadPool pool;
    EXPECT_LE(DistancesTo(fit.surface, net.points, pool).distances.cwiseAbs().maxCoeff(), 0.1);
  }
}

TEST(FitGridTest, LinesThatRepeatAreTakenOnceWithAWarning) {
  const PointNet net = BentGrid(20, 15);
  PointNet repeated{21, 15, Eigen::Matrix3Xd(3, 21 * 15), {}};
  repeated.points.leftCols(8 * 15) = net.points.leftCols(8 * 15);
  repeated.points.rightCols(13 * 15) = net.points.rightCols(13 * 15);
  const SurfaceFit fit = FitGrid(PointCloud(repeated.points), OptionsFor(repeated));
  ASSERT_EQ(fit.report.warnings.size(), 1u);
  EXPECT_EQ(fit.report.warnings[0], "row 9 of the grid repeats row 8 and was left out");
  EXPECT_EQ(fit.surface.size_u(), 20);
  EXPECT_EQ(fit.report.error_all.points, 21 * 15);
  EXPECT_LE(fit.report.error_all.max, kRounding);
}

TEST(FitGridTest, ALastLineThatRepeatsTheFirstClosesTheSurface) {
  const PointNet net = SphereGrid(20, 31);
  GridFitOptions options = OptionsFor(net);
  const SurfaceFit closed = FitGrid(PointCloud(net.points), options);
  EXPECT_EQ(closed.report.geometry.closed, (std::vector<bool>{false, true}));
  EXPECT_LE(closed.report.error_all.max, kRounding);
  options.tolerance = 1e-3;
  const SurfaceFit few = FitGrid(PointCloud(net.points), options);
  EXPECT_TRUE(few.surface.basis_v().periodic());
  EXPECT_EQ(few.report.tolerance_reached(), true);
  options.closed = Closing::kNone;
  EXPECT_FALSE(FitGrid(PointCloud(net.points), options).surface.basis_v().periodic());
  options = OptionsFor(net);
  options.method = GridMethod::kInterpolateLocally;
  EXPECT_LE(FitGrid(PointCloud(net.points), options).report.error.max, kRounding);
}

TEST(FitGridTest, GivenParametersKeepTheirRange) {
  const PointNet net = BentGrid(12, 10);
  GridFitOptions options = OptionsFor(net);
  options.parameterization = GridParameterization::kGiven;
  options.parameters = {Eigen::VectorXd::LinSpaced(12, -5, 7),
                        Eigen::VectorXd::LinSpaced(10, 2, 3)};
  const SurfaceFit fit = FitGrid(PointCloud(net.points), options);
  EXPECT_EQ(fit.surface.basis_u().lower(), -5);
  EXPECT_EQ(fit.surface.basis_u().upper(), 7);
  EXPECT_LE(
      (fit.surface.At(options.parameters.u[3], options.parameters.v[4]) - net.At(3, 4)).norm(),
      kRounding);
}

TEST(FitGridTest, CountsThatDoNotFitAreRefusedWithThoseThatWould) {
  const PointNet net = BentGrid(12, 10);
  const PointCloud cloud(net.points);
  GridFitOptions options = OptionsFor(net);
  options.rows = 11;
  EXPECT_THAT(
      Refusal(cloud, options),
      HasSubstr("a grid of 11 x 10 takes 110 points; there are 120; so many points would be "
                "12 x 10"));
  options.rows = 7;
  options.columns = 11;
  EXPECT_THAT(Refusal(cloud, options), HasSubstr("fill neither rows of 11 nor columns of 7"));
  options.rows = 1;
  EXPECT_THAT(Refusal(cloud, options), HasSubstr("must be 2 at least"));
  options = OptionsFor(net);
  options.degree_v = 12;
  EXPECT_THAT(Refusal(cloud, options), HasSubstr("lower the degree to 9"));
  options = OptionsFor(net);
  options.method = GridMethod::kLeastSquares;
  EXPECT_THAT(Refusal(cloud, options), HasSubstr("control_points"));
  EXPECT_THAT(Refusal(PointCloud(Eigen::Matrix3Xd::Ones(3, 120)), OptionsFor(net)),
              HasSubstr("the same"));
  // Points on a line.
  Eigen::Matrix3Xd line(3, 120);
  for (int k = 0; k < 120; ++k) line.col(k) << k, 2 * k, 0;
  EXPECT_THAT(Refusal(PointCloud(line), OptionsFor(net)), HasSubstr("on a line"));
}

TEST(FitGridTest, ProgressCanCancel) {
  const PointNet net = BentGrid(12, 10);
  GridFitOptions options = OptionsFor(net);
  options.progress = [](const char*, double) { return false; };
  EXPECT_THROW(FitGrid(PointCloud(net.points), options), Cancelled);
}

TEST(FillCellsTest, ContinuesWhatIsLinearExactlyAndKeepsEveryPoint) {
  PointNet net = GridOn(
      [](double u, double v) -> Eigen::Vector3d {
        return {u, 2 * v, 1 + 3 * u - v};
      },
      15,
      12);
  const PointNet whole = net;
  net.missing = PointMask::Constant(net.points.cols(), false);
  for (const int cell : {0, 1, 12, 13, 60, 61, 72, 73, 74, 179}) {
    net.missing[cell] = true;
    net.points.col(cell).setConstant(1e9);
  }
  const GridParameters t{Eigen::VectorXd::LinSpaced(15, 0, 1),
                         Eigen::VectorXd::LinSpaced(12, 0, 2)};
  const PointNet filled = WithFilledCells(net, t);
  EXPECT_TRUE(filled.complete());
  EXPECT_LE((filled.points - whole.points).cwiseAbs().maxCoeff(), kRounding);
}

}  // namespace batten::internal::fit_grid_test
