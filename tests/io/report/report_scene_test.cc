// SPDX-License-Identifier: MIT
// Laws of what a report shows: everything drawn lies where geometry and points are.
#include "batten/io/report_scene.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <vector>

#include "batten/fitting/distances.h"
#include "batten/geometry/curvature.h"
#include "batten/geometry/foot_point.h"
#include "batten/geometry/make_curve.h"
#include "batten/geometry/make_surface.h"
#include "io/report/report_points.h"
#include "exact_shapes.h"
#include "tolerances.h"
#include "angles.h"

namespace batten::internal::report_scene_test {

NurbsSurface Waves(const Eigen::Vector3d& origin = Eigen::Vector3d::Zero()) {
  const SplineBasis basis = SplineBasis::Uniform(3, 9, 0, 1);
  Eigen::Matrix3Xd points(3, 81);
  for (int i = 0; i < 9; ++i) {
    for (int j = 0; j < 9; ++j) {
      points.col(i * 9 + j) = origin + Eigen::Vector3d(10 * basis.Greville(i),
                                                       6 * basis.Greville(j),
                                                       std::sin(1.3 * i) * std::cos(0.9 * j));
    }
  }
  return {basis, basis, points};
}

// Points beside a surface by what `off` says of their parameters.
template <class Off>
Eigen::Matrix3Xd Beside(const NurbsSurface& surface, int count, const Off& off) {
  std::mt19937_64 engine(7);
  std::uniform_real_distribution<double> unit(0, 1);
  Eigen::Matrix3Xd points(3, count);
  const SplineBasis &u = surface.basis_u(), &v = surface.basis_v();
  for (int k = 0; k < count; ++k) {
    const double a = u.lower() + unit(engine) * (u.upper() - u.lower());
    const double b = v.lower() + unit(engine) * (v.upper() - v.lower());
    points.col(k) = surface.At(a, b) + off(a, b) * surface.NormalAt(a, b).value();
  }
  return points;
}

// A cloud measured against geometry, as compare does it.
struct Measured {
  PointCloud cloud;
  PointDistances found;
  PointMask outliers;

  MeasuredPoints points() const {
    return {cloud, found.distances, found.parameters, outliers, {}, 0, 0};
  }
};

Measured Measure(const NurbsSurface& surface, const Eigen::Matrix3Xd& world) {
  Measured result{PointCloud::FromWorld(world), {}, PointMask::Constant(world.cols(), false)};
  ThreadPool pool;
  result.found =
      DistancesTo(surface.Translated(-result.cloud.origin()), result.cloud.points(), pool);
  return result;
}

ReportScene SceneOf(const std::vector<Geometry>& geometry,
                    const MeasuredPoints& points,
                    const ReportSceneOptions& options = {}) {
  ThreadPool pool;
  return MakeReportScene(geometry, points, options, pool);
}

void ExpectWhole(const ReportScene& scene) {
  for (const ReportSurface& surface : scene.surfaces) {
    const Eigen::Index count = surface.mesh.vertices.cols();
    EXPECT_GT(count, 0);
    EXPECT_EQ(surface.mesh.normals.cols(), count);
    EXPECT_EQ(surface.mesh.parameters.cols(), count);
    EXPECT_EQ(surface.deviation.size(), count);
    EXPECT_TRUE(surface.gap.size() == count || surface.gap.size() == 0);
    EXPECT_EQ(surface.gaussian.size(), count);
    EXPECT_EQ(surface.mean.size(), count);
    EXPECT_LT(surface.mesh.triangles.maxCoeff(), count);
    EXPECT_GE(surface.mesh.triangles.minCoeff(), 0);
    EXPECT_EQ(surface.net.cols(), surface.net_u * surface.net_v);
    EXPECT_TRUE(surface.mesh.vertices.allFinite());
  }
  for (const ReportCurve& curve : scene.curves) {
    const Eigen::Index count = curve.points.cols();
    EXPECT_GT(count, 1);
    EXPECT_EQ(curve.parameters.size(), count);
    EXPECT_EQ(curve.curvature.size(), count);
    EXPECT_EQ(curve.normals.cols(), count);
    EXPECT_TRUE(curve.points.allFinite());
    EXPECT_TRUE(std::is_sorted(curve.parameters.begin(), curve.parameters.end()));
  }
  const Eigen::Index shown = scene.cloud.points.cols();
  EXPECT_EQ(scene.cloud.deviation.size(), shown);
  EXPECT_EQ(scene.cloud.outlier.size(), shown);
  EXPECT_LE(shown, scene.cloud.total);
  EXPECT_EQ(scene.cloud.feet.cols(), scene.curves.empty() ? 0 : shown);
}

TEST(ReportSceneTest, MeshAndLinesLieOnTheSurfaceFarFromTheOrigin) {
  const NurbsSurface surface = Waves({500000, 5400000, 300});
  const Measured measured =
      Measure(surface, Beside(surface, 2000, [](double, double) { return 0.01; }));
  const ReportScene scene = SceneOf({surface}, measured.points());
  ExpectWhole(scene);
  ASSERT_EQ(scene.surfaces.size(), 1u);
  const ReportSurface& drawn = scene.surfaces[0];
  const NurbsSurface near = surface.Translated(-scene.center);
  double farthest = 0;
  for (Eigen::Index k = 0; k < drawn.mesh.vertices.cols(); ++k) {
    const Eigen::Vector2d uv = drawn.mesh.parameters.col(k);
    farthest = std::max(farthest, (near.At(uv[0], uv[1]) - drawn.mesh.vertices.col(k)).norm());
  }
  EXPECT_LT(farthest, kIterated * scene.size);
  EXPECT_LT(drawn.mesh.vertices.rowwise().mean().norm(), scene.size / 4);  // about the centre
  EXPECT_EQ(drawn.edges.size(), 4u);
  EXPECT_EQ(drawn.knot_lines.size(), 10u);  // five interior knots either way
  EXPECT_TRUE(drawn.trims.empty());
  // As single precision they still are where they are.
  const Eigen::Matrix3Xd rounded = drawn.mesh.vertices.cast<float>().cast<double>();
  EXPECT_LT((rounded - drawn.mesh.vertices).cwiseAbs().maxCoeff(), 1e-7 * scene.size);
}

// Where the surface goes on without points, the distance of its vertices from them tells.
TEST(ReportSceneTest, GapsAreDistancesOfVerticesFromTheNearestPoint) {
  const NurbsSurface surface = Waves({500000, 5400000, 300});
  const Measured measured =
      Measure(surface, Beside(surface, 300, [](double u, double) { return u > 0.5 ? 0.0 : 0.4; }));
  MeasuredPoints points = measured.points();
  PointMask outliers = PointMask::Constant(points.cloud.size(), false);
  outliers.head(100).setConstant(true);
  points.outliers = outliers;
  const ReportScene scene = SceneOf({surface}, points);
  ExpectWhole(scene);
  const ReportSurface& drawn = scene.surfaces[0];
  for (Eigen::Index v = 0; v < drawn.mesh.vertices.cols(); v += 7) {
    const Eigen::Vector3d place = drawn.mesh.vertices.col(v) + scene.center;
    double nearest = HUGE_VAL;
    for (Eigen::Index k = 0; k < points.cloud.size(); ++k)
      if (!outliers[k]) nearest = std::min(nearest, (points.cloud.World(k) - place).norm());
    ASSERT_NEAR(drawn.gap[v], nearest, 1e-6 * scene.size);
  }
}

TEST(ReportSceneTest, ConstantDeviationIsFoundAtEveryVertexWithItsSign) {
  const NurbsSurface surface = Waves();
  for (const double off : {0.02, -0.02}) {
    const Measured measured =
        Measure(surface, Beside(surface, 4000, [&](double, double) { return off; }));
    const ReportScene scene = SceneOf({surface}, measured.points());
    const Eigen::VectorXd& deviation = scene.surfaces[0].deviation;
    EXPECT_TRUE(deviation.allFinite());
    EXPECT_LT((deviation.array() - off).abs().maxCoeff(), kHalfDigits);
    EXPECT_TRUE(scene.signed_values);
  }
}

TEST(ReportSceneTest, DeviationFollowsTheMeanOfTheNeighboursAndIsNoneWhereNoPointIs) {
  const NurbsSurface surface = Waves();
  const auto off = [](double u, double) { return 0.05 * std::sin(2 * kPi * u); };
  Eigen::Matrix3Xd points = Beside(surface, 20000, off);
  // Half of the sheet was not measured.
  std::vector<Eigen::Index> measured_half;
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    if (points(0, k) < 5) measured_half.push_back(k);
  }
  const Measured measured = Measure(surface, points(Eigen::all, measured_half));
  const ReportScene scene = SceneOf({surface}, measured.points());
  const ReportSurface& drawn = scene.surfaces[0];
  constexpr int kNeighbours = 8;
  const double spacing = std::sqrt(30.0 / static_cast<double>(measured_half.size()));
  Eigen::Index none = 0;
  for (Eigen::Index k = 0; k < drawn.deviation.size(); ++k) {
    const Eigen::Vector3d place = drawn.mesh.vertices.col(k) + scene.center;
    if (place.x() > 5.5) {
      EXPECT_TRUE(std::isnan(drawn.deviation[k])) << place.transpose();
      ++none;
      continue;
    }
    if (place.x() > 5 - spacing || place.x() < spacing || k % 50 != 0) continue;
    std::vector<std::pair<double, double>> nearest;  // brute force
    for (Eigen::Index p = 0; p < measured.cloud.size(); ++p) {
      nearest.emplace_back((measured.cloud.World(p) - place).norm(), measured.found.distances[p]);
    }
    std::partial_sort(nearest.begin(), nearest.begin() + kNeighbours, nearest.end());
    double mean = 0;
    for (int n = 0; n < kNeighbours; ++n) mean += nearest[n].second / kNeighbours;
    EXPECT_NEAR(drawn.deviation[k], mean, 0.004) << place.transpose();  // one spacing's change
  }
  EXPECT_GT(none, drawn.deviation.size() / 3);
}

TEST(ReportSceneTest, CurvatureOfASphereIsThatOfItsRadiusAlsoAtThePoles) {
  constexpr double kRadius = 4;
  const NurbsSurface sphere = Sphere(kRadius);
  const Measured measured =
      Measure(sphere, Beside(sphere, 500, [](double, double) { return 0.0; }));
  const ReportScene scene = SceneOf({sphere}, measured.points());
  ExpectWhole(scene);
  const ReportSurface& drawn = scene.surfaces[0];
  EXPECT_TRUE(drawn.edges.empty());  // seam and poles are no edges
  EXPECT_LT((drawn.gaussian.array() - 1 / (kRadius * kRadius)).abs().maxCoeff(), kHalfDigits);
  EXPECT_LT((drawn.mean.array().abs() - 1 / kRadius).abs().maxCoeff(), kHalfDigits);
  EXPECT_LT((drawn.mesh.normals.colwise().norm().array() - 1).abs().maxCoeff(), kIterated);
  const Eigen::Matrix3Xd places = drawn.mesh.vertices.colwise() + scene.center;
  EXPECT_LT((places.colwise().norm().array() - kRadius).abs().maxCoeff(), kIterated * kRadius);
}

TEST(ReportSceneTest, TrimLoopsAndLinesStayInsideWhatIsKept) {
  const NurbsSurface sheet = Waves();
  Eigen::Matrix2Xd corners(2, 5);
  corners << 0.1, 0.9, 0.9, 0.1, 0.1, 0.2, 0.2, 0.7, 0.7, 0.2;
  const NurbsCurve<2> outer(SplineBasis::Clamped(1, std::vector<double>{0, 1, 2, 3, 4}), corners);
  const NurbsSurface trimmed = sheet.WithTrims({outer});
  const Measured measured =
      Measure(trimmed, Beside(sheet, 500, [](double, double) { return 0.0; }));
  const ReportScene scene = SceneOf({trimmed}, measured.points());
  ExpectWhole(scene);
  const ReportSurface& drawn = scene.surfaces[0];
  ASSERT_EQ(drawn.trims.size(), 1u);
  EXPECT_TRUE(drawn.edges.empty());
  constexpr double kSlack = 1e-9;
  const SurfaceFootPoints feet(sheet.Translated(-scene.center));
  const auto expect_inside = [&](const Eigen::Matrix3Xd& places) {
    for (const Eigen::Vector3d place : places.colwise()) {
      const auto foot = feet.Nearest(place);
      EXPECT_LT(foot.distance, kIterated * scene.size);
      EXPECT_GT(foot.u, 0.1 - kSlack);
      EXPECT_LT(foot.u, 0.9 + kSlack);
      EXPECT_GT(foot.v, 0.2 - kSlack);
      EXPECT_LT(foot.v, 0.7 + kSlack);
    }
  };
  for (const Eigen::Matrix3Xd& line : drawn.knot_lines) expect_inside(line);
  expect_inside(drawn.trims[0]);
  EXPECT_LT((drawn.trims[0].leftCols<1>() - drawn.trims[0].rightCols<1>()).norm(),
            kIterated * scene.size);
  EXPECT_GT(drawn.knot_lines.size(), 5u);
}

TEST(ReportSceneTest, PlaneCurvesHaveSignedCurvatureAndSidesAndNormalsAwayFromTheCentre) {
  constexpr double kRadius = 3, kOff = 0.1;
  const NurbsCurve<2> circle = Circle(kRadius);  // counter-clockwise: left is inside
  Eigen::Matrix3Xd points(3, 400);
  for (int k = 0; k < 400; ++k) {
    const double angle = 2 * kPi * k / 400, radius = kRadius + (k % 2 == 0 ? kOff : -kOff);
    points.col(k) << radius * std::cos(angle), radius * std::sin(angle), 0;
  }
  const PointCloud cloud(points, Eigen::Vector3d::Zero(), 2);
  ThreadPool pool;
  const PointDistances found = DistancesTo<2>(circle, points, pool);
  const ReportScene scene = SceneOf({circle}, {cloud, found.distances, found.parameters});
  ExpectWhole(scene);
  ASSERT_EQ(scene.curves.size(), 1u);
  const ReportCurve& drawn = scene.curves[0];
  EXPECT_TRUE(drawn.closed);
  EXPECT_TRUE(drawn.planar);
  EXPECT_TRUE(scene.signed_values);
  EXPECT_LT((drawn.curvature.array() - 1 / kRadius).abs().maxCoeff(), kHalfDigits);
  for (Eigen::Index k = 0; k < drawn.points.cols(); ++k) {
    const Eigen::Vector3d place = drawn.points.col(k) + scene.center;
    EXPECT_LT((place.normalized() - drawn.normals.col(k)).norm(), kHalfDigits);
  }
  for (Eigen::Index k = 0; k < 400; ++k) {
    EXPECT_NEAR(scene.cloud.deviation[k], k % 2 == 0 ? -kOff : kOff, kIterated);
    EXPECT_NEAR((scene.cloud.points.col(k) - scene.cloud.feet.col(k)).norm(), kOff, kIterated);
  }
  EXPECT_EQ(scene.plan_u, Eigen::Vector3d::UnitX());
  EXPECT_EQ(scene.plan_v, Eigen::Vector3d::UnitY());
}

TEST(ReportSceneTest, CornersAndJumpsOfCurvatureHaveASampleOnEitherSide) {
  Eigen::Matrix3Xd corners(3, 3);
  corners << 0, 1, 1, 0, 0, 2, 0, 0, 0;
  const NurbsCurve<3> bent(SplineBasis::Clamped(1, std::vector<double>{0, 1, 2}), corners);
  const PointCloud cloud(corners);
  const Eigen::VectorXd distances = Eigen::Vector3d::Zero();
  Eigen::MatrixXd parameters(1, 3);
  parameters << 0, 1, 2;
  const ReportScene scene = SceneOf({bent}, {cloud, distances, parameters});
  ExpectWhole(scene);
  const ReportCurve& drawn = scene.curves[0];
  const Eigen::Vector3d corner = Eigen::Vector3d(1, 0, 0) - scene.center;
  int at_corner = 0;
  for (const Eigen::Vector3d place : drawn.points.colwise()) {
    if ((place - corner).norm() < kHalfDigits) ++at_corner;
  }
  EXPECT_EQ(at_corner, 2);
  ASSERT_EQ(drawn.knots.cols(), 1);
  EXPECT_LT((drawn.knots.col(0) - corner).norm(), kRounding);
  EXPECT_FALSE(drawn.closed);
  EXPECT_TRUE(drawn.normals.allFinite());
  EXPECT_LT((drawn.normals.colwise().norm().array() - 1).abs().maxCoeff(), kIterated);
}

TEST(ReportSceneTest, SpaceCurvesAreDrawnAlongTheirPrincipalAxes) {
  const SplineBasis basis = SplineBasis::Uniform(3, 12, 0, 1);
  Eigen::Matrix3Xd points(3, 12);
  for (int k = 0; k < 12; ++k) points.col(k) << 0.3 * std::sin(k), k, std::cos(k);
  const NurbsCurve<3> helix(basis, points);
  const PointCloud cloud(Eigen::Matrix3Xd(helix.At(0.5)));
  const Eigen::VectorXd distances = Eigen::VectorXd::Zero(1);
  const ReportScene scene =
      SceneOf({helix}, {cloud, distances, Eigen::MatrixXd::Constant(1, 1, 0.5)});
  EXPECT_FALSE(scene.signed_values);
  EXPECT_FALSE(scene.curves[0].planar);
  EXPECT_GT(scene.plan_u.y(), 0.98);
  EXPECT_NEAR(scene.plan_u.dot(scene.plan_v), 0, kRounding);
  for (Eigen::Index k = 0; k < scene.curves[0].points.cols(); ++k) {
    const double u = scene.curves[0].parameters[k];
    EXPECT_NEAR(scene.curves[0].curvature[k], CurvatureAt(helix, u)->curvature, kHalfDigits);
    const CurveJet<3> jet = helix.JetAt(u);
    EXPECT_NEAR(scene.curves[0].normals.col(k).dot(jet.first), 0, kHalfDigits * jet.first.norm());
    EXPECT_LT(scene.curves[0].normals.col(k).dot(jet.second), 0);
  }
}

TEST(ReportSceneTest, EveryPointCountsInTheHistogramAndThinningKeepsOutliersAndTheWorst) {
  constexpr int kPoints = 40000, kShown = 5000, kOutliers = 300;
  const NurbsSurface surface = Waves();
  std::mt19937_64 engine(3);
  std::normal_distribution<double> noise(0, 0.01);
  Measured measured =
      Measure(surface, Beside(surface, kPoints, [&](double, double) { return noise(engine); }));
  for (int k = 0; k < kOutliers; ++k) measured.outliers[k * 100] = true;
  ReportSceneOptions options;
  options.max_points = kShown;
  const ReportScene scene = SceneOf({surface}, measured.points(), options);
  ExpectWhole(scene);
  EXPECT_EQ(scene.cloud.total, kPoints);
  EXPECT_EQ(scene.cloud.points.cols(), kShown);
  EXPECT_EQ(scene.cloud.outlier.count(), kOutliers);
  double worst = 0;
  for (int k = 0; k < kPoints; ++k) {
    if (!measured.outliers[k]) worst = std::max(worst, std::abs(measured.found.distances[k]));
  }
  double shown = 0;
  for (int k = 0; k < kShown; ++k) {
    if (!scene.cloud.outlier[k]) shown = std::max(shown, std::abs(scene.cloud.deviation[k]));
  }
  EXPECT_EQ(shown, worst);
  const ReportHistogram& histogram = scene.histogram;
  EXPECT_EQ(std::accumulate(histogram.counts.begin(), histogram.counts.end(), Eigen::Index{0}) +
                histogram.below + histogram.above,
            kPoints - kOutliers);
  EXPECT_LT(histogram.below + histogram.above, kPoints / 100);
  EXPECT_LT(histogram.low, -0.02);
  EXPECT_GT(histogram.high, 0.02);
  EXPECT_LT(histogram.high, 0.06);
}

TEST(ReportSceneTest, AFewFarPointsDoNotPressTheHistogramTogether) {
  std::mt19937_64 engine(5);
  std::normal_distribution<double> noise(0, 0.01);
  Eigen::VectorXd deviations(10000);
  for (double& deviation : deviations) deviation = noise(engine);
  deviations.head(100).setLinSpaced(-40, 40);
  const ReportHistogram histogram = HistogramOf(deviations, {}, {}, true);
  EXPECT_GT(histogram.low, -0.08);
  EXPECT_LT(histogram.high, 0.08);
  EXPECT_NEAR(static_cast<double>(histogram.below + histogram.above), 100, 2);
  EXPECT_EQ(std::accumulate(histogram.counts.begin(), histogram.counts.end(), Eigen::Index{0}) +
                histogram.below + histogram.above,
            10000);
  // The figures are those of all points, not of the bins.
  EXPECT_NEAR(histogram.mean, deviations.mean(), kHalfDigits);
  EXPECT_NEAR(histogram.deviation,
              std::sqrt((deviations.array() - deviations.mean()).square().mean()),
              kHalfDigits);
  // Distances without a sign begin at zero; equal ones have a bin of their own.
  EXPECT_EQ(HistogramOf(deviations.cwiseAbs(), {}, {}, false).low, 0);
  const ReportHistogram same = HistogramOf(Eigen::VectorXd::Constant(7, 0.25), {}, {}, true);
  EXPECT_LT(same.low, same.high);
  EXPECT_EQ(same.below + same.above, 0);
}

TEST(ReportSceneTest, ThePointsShownAreEvenlySpreadAndTheSameEveryTime) {
  constexpr Eigen::Index kTotal = 1000003, kCount = 150000;
  const std::vector<Eigen::Index> spread = EvenlySpread(kTotal, kCount);
  ASSERT_EQ(std::ssize(spread), kCount);
  EXPECT_EQ(spread, EvenlySpread(kTotal, kCount));
  for (Eigen::Index k = 0; k < kCount; ++k) {
    ASSERT_GE(spread[k], k * kTotal / kCount);
    ASSERT_LT(spread[k], (k + 1) * kTotal / kCount);
  }
  // In step with no period of the cloud's order: every residue class of rows is met alike.
  std::vector<int> met(7);
  for (const Eigen::Index k : spread) ++met[k % 7];
  for (const int count : met) EXPECT_NEAR(count, kCount / 7.0, 0.03 * kCount / 7.0);
}

TEST(ReportSceneTest, PointsOfSeveralGeometriesColourTheirOwn) {
  const NurbsSurface low = Waves(), high = Waves({0, 0, 8});
  Eigen::Matrix3Xd points(3, 4000);
  points << Beside(low, 2000, [](double, double) { return 0.03; }),
      Beside(high, 2000, [](double, double) { return -0.01; });
  const PointCloud cloud(points);
  ThreadPool pool;
  PointDistances found = DistancesTo(low, points, pool);
  const PointDistances other = DistancesTo(high, points, pool);
  std::vector<int> owners(4000, 0);
  for (int k = 0; k < 4000; ++k) {
    if (std::abs(other.distances[k]) >= std::abs(found.distances[k])) continue;
    found.distances[k] = other.distances[k];
    found.parameters.col(k) = other.parameters.col(k);
    owners[k] = 1;
  }
  const ReportScene scene =
      SceneOf({low, high}, {cloud, found.distances, found.parameters, {}, owners});
  ExpectWhole(scene);
  ASSERT_EQ(scene.surfaces.size(), 2u);
  EXPECT_NEAR(scene.surfaces[0].deviation.mean(), 0.03, kHalfDigits);
  EXPECT_NEAR(scene.surfaces[1].deviation.mean(), -0.01, kHalfDigits);
  EXPECT_NE(scene.surfaces[0].name, scene.surfaces[1].name);
}

TEST(ReportSceneTest, AShiftOfTheGeometryLeavesThePictureWhereThePointsAre) {
  const Eigen::Vector3d origin(500000, 5400000, 300);
  const NurbsSurface far = Waves(origin);
  const Measured measured = Measure(far, Beside(far, 500, [](double, double) { return 0.02; }));
  const ReportScene kept = SceneOf({far}, measured.points());
  ReportSceneOptions options;
  options.shift = origin;
  const ReportScene shifted = SceneOf({far.Translated(-origin)}, measured.points(), options);
  EXPECT_LT((kept.center - shifted.center).norm(), kIterated * kept.size);
  ASSERT_EQ(kept.surfaces[0].mesh.vertices.cols(), shifted.surfaces[0].mesh.vertices.cols());
  EXPECT_LT(
      (kept.surfaces[0].mesh.vertices - shifted.surfaces[0].mesh.vertices).cwiseAbs().maxCoeff(),
      kIterated * kept.size);
}

TEST(ReportSceneTest, LimitIsTheToleranceOrWhatThePointsKeepAndNeverZero) {
  const PointMask none;
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(10);
  EXPECT_EQ(DeviationLimit(zero, none, 0.037, 1, 1), 0.037);
  EXPECT_NEAR(DeviationLimit(zero, none, {}, 0, 5), 5e-9, 1e-20);
  EXPECT_EQ(DeviationLimit(zero, none, {}, 0, 0), 1);
  EXPECT_NEAR(DeviationLimit(zero, none, {}, 0.01, 1), 1e-9, 1e-20);  // all is far below the noise
  Eigen::VectorXd spread = Eigen::VectorXd::LinSpaced(1001, -1, 1);
  EXPECT_EQ(DeviationLimit(spread, none, {}, 0, 1), 1);
  EXPECT_EQ(DeviationLimit(spread, none, {}, 0.5, 1), 1.5);
  EXPECT_EQ(DeviationLimit(spread, none, {}, 100, 1), 3);
  PointMask outer = spread.array().abs() > 0.14;
  EXPECT_EQ(DeviationLimit(spread, outer, {}, 0, 1), 0.15);
}

TEST(ReportSceneTest, MoreCellsThanTrianglesAreStillDrawnWithinTheLimit) {
  const SplineBasis basis = SplineBasis::Uniform(2, 120, 0, 1);
  Eigen::Matrix3Xd points(3, 14400);
  for (int i = 0; i < 120; ++i) {
    for (int j = 0; j < 120; ++j) {
      points.col(i * 120 + j) << basis.Greville(i), basis.Greville(j), 0.01 * std::sin(i * j);
    }
  }
  const NurbsSurface rough(basis, basis, points);
  const Measured measured = Measure(rough, rough.control_points().leftCols(50));
  ReportSceneOptions options;
  options.max_triangles = 2000;
  const ReportScene scene = SceneOf({rough}, measured.points(), options);
  ExpectWhole(scene);
  EXPECT_LE(scene.surfaces[0].mesh.triangles.cols(), 2000);
}

// A tongue of the domain that the trims cut off must not decide how fine the rest is drawn.
TEST(ReportSceneTest, WildPartsOutsideTheTrimsCostNothing) {
  const NurbsSurface sheet = Waves();
  Eigen::Matrix3Xd control = sheet.control_points();
  control.col(80) *= 300;
  control.col(0).z() = -4000;
  const NurbsSurface wild(sheet.basis_u(), sheet.basis_v(), control);
  Eigen::Matrix2Xd corners(2, 5);
  corners << 0.4, 0.6, 0.6, 0.4, 0.4, 0.4, 0.4, 0.6, 0.6, 0.4;
  const NurbsCurve<2> outer(SplineBasis::Clamped(1, std::vector<double>{0, 1, 2, 3, 4}), corners);
  const NurbsSurface trimmed = wild.WithTrims({outer});
  Eigen::Matrix3Xd points(3, 1);
  points.col(0) = wild.At(0.5, 0.5);
  const Measured measured = Measure(trimmed, points);
  const ReportScene scene = SceneOf({trimmed}, measured.points());
  ExpectWhole(scene);
  EXPECT_LT(scene.size, 10);
  EXPECT_GT(scene.surfaces[0].mesh.triangles.cols(), 5000);
  EXPECT_LT(scene.surfaces[0].mesh.triangles.cols(), 150000);
}

TEST(ReportSceneTest, RefusesWhatDoesNotBelongTogether) {
  const NurbsSurface surface = Waves();
  Measured measured = Measure(surface, Beside(surface, 20, [](double, double) { return 0.0; }));
  EXPECT_THROW(SceneOf({}, measured.points()), std::invalid_argument);
  MeasuredPoints points = measured.points();
  points.owners.assign(20, 1);
  EXPECT_THROW(SceneOf({surface}, points), std::invalid_argument);
  measured.found.distances.conservativeResize(19);
  EXPECT_THROW(SceneOf({surface}, measured.points()), std::invalid_argument);
}

}  // namespace batten::internal::report_scene_test
