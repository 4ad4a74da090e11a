// SPDX-License-Identifier: MIT
// Surfaces that meet curves, neighbours and points exactly.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "batten/fitting/fit_surface.h"
#include "batten/fitting/interpolate_curve.h"
#include "batten/geometry/iso_curve.h"
#include "batten/geometry/joins.h"
#include "batten/geometry/reverse.h"
#include "jittered_shell.h"

namespace batten::internal::fit_conditions_test {

constexpr double kSigma = 1e-3;

PointCloud ShellCloud(Eigen::Index count, double u0, double u1, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> along(u0, u1), across(0, 1);
  std::normal_distribution<double> normal(0, kSigma);
  Eigen::Matrix3Xd points(3, count);
  for (auto point : points.colwise()) {
    point = Shell(along(engine), across(engine));
    for (double& x : point) x += normal(engine);
  }
  return PointCloud(std::move(points));
}

NurbsCurve<3> Through(const std::function<Eigen::Vector3d(double)>& at) {
  constexpr int kPlaces = 81;
  Eigen::Matrix3Xd points(3, kPlaces);
  for (int k = 0; k < kPlaces; ++k) points.col(k) = at(k / (kPlaces - 1.0));
  return InterpolateCurve<3>(points, {}).curve;
}

// The shell's four edges, in no order and no common sense.
std::vector<BoundaryCondition> ShellEdges() {
  return {{Through([](double t) { return Shell(1 - t, 0); }), "low"},
          {Through([](double t) { return Shell(0, t); }), "left"},
          {Through([](double t) { return Shell(t, 1); }), "high"},
          {Through([](double t) { return Shell(1, 1 - t); }), "right"}};
}

double FarthestFrom(const std::array<NurbsCurve<3>, 4>& edges, const NurbsCurve<3>& curve) {
  double least = 1e300;
  for (const NurbsCurve<3>& edge : edges) {
    double most = 0;
    const bool turned = (edge.At(edge.basis().lower()) - curve.At(curve.basis().lower())).norm() >
                        (edge.At(edge.basis().upper()) - curve.At(curve.basis().lower())).norm();
    const NurbsCurve<3> other = turned ? Reversed(edge) : edge;
    for (int k = 0; k <= 200; ++k) {
      const auto on = [&](const NurbsCurve<3>& c) {
        return c.At(c.basis().lower() + (c.basis().upper() - c.basis().lower()) * k / 200);
      };
      most = std::max(most, (on(other) - on(curve)).norm());
    }
    least = std::min(least, most);
  }
  return least;
}

double TruthRms(const SurfaceFit& fit) {
  Eigen::Matrix3Xd truth(3, 4000);
  std::mt19937_64 engine(99);
  std::uniform_real_distribution<double> uniform(0.02, 0.98);
  for (auto point : truth.colwise()) point = Shell(uniform(engine), uniform(engine));
  ThreadPool pool(2);
  const Eigen::VectorXd distances = DistancesTo(fit.surface, truth, pool).distances;
  return std::sqrt(distances.squaredNorm() / static_cast<double>(truth.cols()));
}

TEST(FitConditionsTest, EdgesAreTheCurvesGivenAndTheInsideIsNoWorse) {
  const PointCloud cloud = ShellCloud(10000, 0, 1, 5);
  SurfaceFitOptions options;
  options.boundary = ShellEdges();
  const SurfaceFit fit = FitSurface(cloud, options);
  EXPECT_FALSE(fit.surface.trimmed());
  const auto edges = BoundaryCurves(fit.surface);
  for (const BoundaryCondition& condition : options.boundary) {
    SCOPED_TRACE(condition.name);
    EXPECT_LT(FarthestFrom(edges, std::get<NurbsCurve<3>>(condition.shape)), 1e-12);
  }
  EXPECT_LT(TruthRms(fit), 1.1 * TruthRms(FitSurface(cloud)));
}

TEST(FitConditionsTest, JoinsANeighbourWithItsTangentPlanes) {
  const SurfaceFit first = FitSurface(ShellCloud(6000, 0, 0.5, 1));
  ASSERT_FALSE(first.surface.trimmed());
  SurfaceFitOptions options;
  options.boundary = {{first.surface, "first"}};
  const SurfaceFit second = FitSurface(ShellCloud(6000, 0.5, 1, 2), options);
  const SurfaceJoin join = TestJoin(first.surface, second.surface);
  EXPECT_EQ(join.shared_edges, 1);
  EXPECT_LT(join.position_gap, 1e-9);
  EXPECT_LT(join.angle_gap, 1.7e-4) << "0.01 degrees";
  EXPECT_LT(second.report.error.rms, 1.1 * kSigma);
}

TEST(FitConditionsTest, MeetsPointsAndTheirTangentPlanes) {
  SurfaceFitOptions options;
  Eigen::Matrix3Xd places(3, 2), normals(3, 2);
  places << Shell(0.3, 0.4), Shell(0.7, 0.6);
  places.col(0) += Eigen::Vector3d(0, 0, 0.004);  // off the shell by four times the noise
  for (int k = 0; k < 2; ++k) {
    const double u = k == 0 ? 0.3 : 0.7, v = k == 0 ? 0.4 : 0.6, step = 1e-5;
    normals.col(k) = (Shell(u + step, v) - Shell(u - step, v))
                         .cross(Shell(u, v + step) - Shell(u, v - step))
                         .normalized();
  }
  options.meet.emplace(places);
  options.meet->set_normals(normals);
  const SurfaceFit fit = FitSurface(ShellCloud(6000, 0, 1, 3), options);
  for (int k = 0; k < 2; ++k) {
    const SurfaceFoot foot = SurfaceFootPoints(fit.surface).Nearest(places.col(k));
    EXPECT_LT(foot.distance, 1e-10);
    const auto normal = fit.surface.NormalAt(foot.u, foot.v);
    ASSERT_TRUE(normal);
    EXPECT_GT(std::abs(normal->dot(normals.col(k))), 1 - 1e-12);
  }
  EXPECT_LT(fit.report.error.rms, 1.2 * kSigma);
}

TEST(FitConditionsTest, RefusesCurvesThatDoNotMeetAndNamesTheGap) {
  SurfaceFitOptions options;
  options.boundary = ShellEdges();
  const auto& low = std::get<NurbsCurve<3>>(options.boundary[0].shape);
  Eigen::Matrix3Xd points = low.control_points();
  points.col(0) += Eigen::Vector3d(0, 0, 0.02);
  options.boundary[0].shape = NurbsCurve<3>(low.basis(), points);
  try {
    FitSurface(ShellCloud(4000, 0, 1, 3), options);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("do not meet at a corner"));
    EXPECT_THAT(error.what(), testing::HasSubstr("0.02"));
  }
}

// From one side of the plane the surface of both, its own mirror image to the last bits.
TEST(FitConditionsTest, MirrorsItselfWhereOneSideWasMeasured) {
  std::mt19937_64 engine(12);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> normal(0, kSigma);
  const auto hull = [](double x, double y) { return 0.3 * x * x - 0.4 * y * y + 0.1 * x; };
  Eigen::Matrix3Xd points(3, 5000);
  for (auto point : points.colwise()) {
    const double x = 2 * uniform(engine), y = uniform(engine);
    point << x, 5 + y, hull(x, y) + normal(engine);
  }
  SurfaceFitOptions options;
  options.symmetric = MirrorPlane{{0, 2, 0}, 10};  // y = 5
  const SurfaceFit fit = FitSurface(PointCloud(points), options);
  EXPECT_EQ(fit.parameters.cols(), 5000);
  EXPECT_EQ(fit.residuals.size(), 5000);
  EXPECT_EQ(fit.report.input.points, 5000);
  EXPECT_LT(fit.report.error.rms, 1.05 * kSigma);
  const SurfaceFootPoints feet(fit.surface);
  for (const double x : {0.1, 0.9, 1.9}) {
    for (const double y : {-0.95, -0.5, 0.0, 0.5, 0.95}) {
      const Eigen::Vector3d truth(x, 5 + y, hull(x, y));
      EXPECT_LT(feet.Nearest(truth).distance, kSigma) << "measured or not";
    }
  }
  const NurbsSurface& s = fit.surface;
  double off[2] = {0, 0};  // from the images of control points across u, across v
  for (int i = 0; i < s.size_u(); ++i) {
    for (int j = 0; j < s.size_v(); ++j) {
      Eigen::Vector3d image = s.control_point(i, j);
      image[1] = 10 - image[1];
      const Eigen::Vector3d across_u = s.control_point(s.size_u() - 1 - i, j),
                            across_v = s.control_point(i, s.size_v() - 1 - j);
      off[0] = std::max(off[0], (across_u - image).norm());
      off[1] = std::max(off[1], (across_v - image).norm());
    }
  }
  EXPECT_LE(std::min(off[0], off[1]), 2e-15) << "two units in the last place of 6";
}

TEST(FitConditionsTest, LeavesOutAndCountsWhatLiesBeyondAGivenEdge) {
  SurfaceFitOptions options;
  options.boundary = {{Through([](double t) { return Shell(0.05, t); }), "inside"}};
  const SurfaceFit fit = FitSurface(ShellCloud(6000, 0, 1, 3), options);
  EXPECT_NEAR(static_cast<double>(fit.report.input.outliers), 0.05 * 6000, 40) << "3 sd of chance";
  EXPECT_LT(fit.report.error.rms, 1.1 * kSigma);
  bool said = false;
  for (const std::string& warning : fit.report.warnings)
    said = said || warning.find("lie beyond the given boundary") != std::string::npos;
  EXPECT_TRUE(said);
}

TEST(FitConditionsTest, TakesADomainInCoordinates) {
  std::mt19937_64 engine(8);
  std::uniform_real_distribution<double> uniform(0, 1);
  Eigen::Matrix3Xd points(3, 3000);
  for (auto point : points.colwise()) {
    const double x = uniform(engine), y = uniform(engine);
    point << 5 + x, 3 + y, 0.1 * x * y;
  }
  SurfaceFitOptions options;
  options.domain = DomainBox{5.2, 2.9, 6.1, 4};
  options.trim = Trimming::kNone;
  const SurfaceFit fit = FitSurface(PointCloud(points), options);
  EXPECT_DOUBLE_EQ(fit.surface.basis_u().lower(), 5.2);
  EXPECT_DOUBLE_EQ(fit.surface.basis_u().upper(), 6.1);
  EXPECT_DOUBLE_EQ(fit.surface.basis_v().lower(), 2.9);
  EXPECT_DOUBLE_EQ(fit.surface.basis_v().upper(), 4);
  for (const double u : {5.3, 5.9}) {
    const Eigen::Vector3d at = fit.surface.At(u, 3.4);
    EXPECT_NEAR(at[0], u, 1e-9);
    EXPECT_NEAR(at[1], 3.4, 1e-9);
    EXPECT_NEAR(at[2], 0.1 * (u - 5) * 0.4, 1e-4) << "fairness bends an exact saddle a little";
  }
  options.domain = DomainBox{15, 2, 16, 3};
  EXPECT_THROW(FitSurface(PointCloud(points), options), std::invalid_argument);
}

}  // namespace batten::internal::fit_conditions_test
