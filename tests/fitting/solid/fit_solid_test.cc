// SPDX-License-Identifier: MIT
#include "batten/fitting/fit_solid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <random>
#include <vector>

#include "batten/fitting/closed_surface.h"
#include "batten/fitting/refused_data.h"
#include "batten/fitting/solid_layout.h"
#include "body_clouds.h"
#include "refusal.h"
#include "tolerances.h"

namespace batten::internal::fit_solid_test {

using ::testing::HasSubstr;

constexpr double kVolume = 4 * std::numbers::pi / 3, kArea = 4 * std::numbers::pi;

double RmsFromSphere(const SolidModel& solid) {
  double sum = 0;
  int count = 0;
  for (const SolidFace& face : solid.faces) {
    const SplineBasis &u = face.surface.basis_u(), &v = face.surface.basis_v();
    for (int i = 0; i < 10; ++i) {
      for (int j = 0; j < 10; ++j, ++count) {
        const double radius = face.surface
                                  .At(u.lower() + (u.upper() - u.lower()) * (i + 0.5) / 10,
                                      v.lower() + (v.upper() - v.lower()) * (j + 0.5) / 10)
                                  .norm();
        sum += (radius - 1) * (radius - 1);
      }
    }
  }
  return std::sqrt(sum / count);
}

TEST(FitSolidTest, MakesASmoothBallOfNoisyPoints) {
  constexpr double kNoise = 0.01;
  constexpr int kPoints = 4000;
  const QuadMesh layout = CubeSphere(2);
  const SolidFit fit = FitSolid(PointCloud(SpherePoints(kPoints, kNoise)), layout, {.threads = 1});
  EXPECT_EQ(fit.solid.faces.size(), 6u);
  EXPECT_EQ(fit.audit.open_edges, 0);
  EXPECT_LE(fit.audit.gap, kRounding);
  EXPECT_LE(fit.audit.edge_angle, kIterated);
  // The mean radius is known to noise / sqrt(points), the volume to three times that: 5 of these.
  EXPECT_NEAR(fit.audit.volume, kVolume, 5 * 3 * kVolume * kNoise / std::sqrt(kPoints));
  EXPECT_NEAR(fit.audit.area, kArea, 0.01 * kArea);
  // At most as much as a free normal of every control point takes in, half as much again.
  const double limit = kNoise * std::sqrt(double(layout.vertices.cols()) / kPoints);
  EXPECT_LE(RmsFromSphere(fit.solid), 1.5 * limit);
  EXPECT_NEAR(fit.report.error.rms, kNoise, 0.1 * kNoise);
  EXPECT_EQ(fit.layout.genus, 0);
  EXPECT_EQ(fit.residuals.size(), kPoints);
}

TEST(FitSolidTest, ReportsTheDistancesFromItsFaces) {
  const Eigen::Matrix3Xd points = SpherePoints(2000, 0.01);
  const SolidFit fit = FitSolid(PointCloud(points), CubeSphere(2), {.threads = 1});
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    const NurbsSurface& face = fit.solid.faces[std::size_t(fit.faces[std::size_t(k)])].surface;
    const Eigen::Vector3d foot = face.At(fit.parameters(0, k), fit.parameters(1, k));
    EXPECT_NEAR((points.col(k) - foot).norm(), std::abs(fit.residuals[k]), kRounding);
    // Positive outside.
    EXPECT_EQ(fit.residuals[k] > 0, points.col(k).norm() > foot.norm());
  }
}

TEST(FitSolidTest, MovesAndGrowsWithItsData) {
  const Eigen::Matrix3Xd points = SpherePoints(1500, 0.01);
  const SolidFit fit =
      FitSolid(PointCloud(points), CubeSphere(1), {.smoothing = 1e-3, .threads = 1});
  QuadMesh layout = CubeSphere(1);
  const Eigen::Vector3d away(1000, -2000, 3000);
  layout.vertices = (64 * layout.vertices).colwise() + away;
  const SolidFit large = FitSolid(PointCloud::FromWorld((64 * points).colwise() + away),
                                  layout,
                                  {.smoothing = 1e-3, .shift = away, .threads = 1});
  EXPECT_NEAR(
      large.audit.volume, 64.0 * 64 * 64 * fit.audit.volume, kHalfDigits * large.audit.volume);
  const Eigen::Matrix3Xd moved = 64 * fit.control_mesh.vertices;
  EXPECT_LE((large.control_mesh.vertices - moved).cwiseAbs().maxCoeff(), 64 * kHalfDigits);
}

TEST(FitSolidTest, OtherThreadsGiveTheSameSolid) {
  const PointCloud cloud(SpherePoints(1500, 0.01));
  const SolidFit one = FitSolid(cloud, CubeSphere(1), {.threads = 1});
  const SolidFit three = FitSolid(cloud, CubeSphere(1), {.threads = 3});
  EXPECT_LE((one.control_mesh.vertices - three.control_mesh.vertices).cwiseAbs().maxCoeff(),
            kIterated);
}

// Noise wider than the points are apart is no fault of the layout.
TEST(FitSolidTest, SaysThatASolidIsNotThatOfThePointsButNotOfNoise) {
  Eigen::Matrix3Xd torus(3, 2000);
  for (int k = 0; k < 2000; ++k) {
    const double a = 0.7 * k, b = 2.399963 * k, out = 3 + std::cos(b);
    torus.col(k) << out * std::cos(a), out * std::sin(a), std::sin(b);
  }
  QuadMesh box = Cube();
  box.vertices = box.vertices.cwiseSign();
  box.vertices.topRows(2) *= 4;
  const SolidFit other = FitSolid(PointCloud(torus), box, {.smoothing = 1e-3, .threads = 1});
  EXPECT_EQ(other.report.end.code, EndCode::kStructuredResiduals);
  EXPECT_EQ(other.report.termination, Termination::kStalled);
  ASSERT_EQ(other.report.warnings.size(), 1u);
  Eigen::Index farthest;
  other.residuals.cwiseAbs().maxCoeff(&farthest);
  EXPECT_EQ(other.report.end.where.value(), torus.col(farthest));

  const SolidFit noisy =
      FitSolid(PointCloud(SpherePoints(15000, 0.03)), CubeSphere(1), {.threads = 1});
  EXPECT_GT(noisy.report.error.p95, noisy.report.input.spacing);
  EXPECT_EQ(noisy.report.end.code, EndCode::kNoiseReached);
  EXPECT_TRUE(noisy.report.warnings.empty());
}

TEST(FitSolidTest, PointsGivenThriceCountAsOneOfThreefoldWeight) {
  const Eigen::Matrix3Xd points = SpherePoints(1500, 0.01);
  const SolidFit once = FitSolid(PointCloud(points), CubeSphere(1), {.threads = 1});
  const SolidFit thrice =
      FitSolid(PointCloud(points.replicate(1, 3)), CubeSphere(1), {.threads = 1});
  EXPECT_LE((thrice.control_mesh.vertices - once.control_mesh.vertices).cwiseAbs().maxCoeff(),
            kIterated);
  EXPECT_EQ(thrice.report.input.points, 4500);
  EXPECT_EQ(thrice.report.input.duplicates, 3000);
  ASSERT_EQ(thrice.residuals.size(), 4500);
  EXPECT_LE((thrice.residuals - once.residuals.replicate(3, 1)).cwiseAbs().maxCoeff(), kIterated);
}

TEST(FitSolidTest, GivenNormalsMayAllPointInwards) {
  PointCloud cloud(SpherePoints(1500, 0.01));
  cloud.set_normals(cloud.points());
  const SolidFit outwards = FitSolid(cloud, CubeSphere(1), {.threads = 1});
  cloud.set_normals(-cloud.points());
  const SolidFit inwards = FitSolid(cloud, CubeSphere(1), {.threads = 1});
  EXPECT_EQ(outwards.control_mesh.vertices, inwards.control_mesh.vertices);
}

TEST(FitSolidTest, OutliersDoNotCount) {
  Eigen::Matrix3Xd points = SpherePoints(4000, 0.005);
  for (Eigen::Index k = 0; k < points.cols(); k += 20) points.col(k) *= 1.3 + 0.01 * double(k % 7);
  const SolidFit fit = FitSolid(PointCloud(points), CubeSphere(2), {.threads = 1});
  EXPECT_GE(fit.outliers.count(), 180);
  EXPECT_LE(RmsFromSphere(fit.solid), 0.005);
}

// A ball with a bump of a third of a face, dense in points.
double BumpRadius(const Eigen::Vector3d& direction) {
  const Eigen::Vector3d middle = Eigen::Vector3d(2, 1, 3).normalized();
  const double angle = std::atan2(direction.cross(middle).norm(), direction.dot(middle));
  return 1 + 0.1 * std::exp(-angle * angle / (2 * 0.08 * 0.08));
}

PointCloud BumpyBall(int each, double noise) {
  Eigen::Matrix3Xd points(3, 2 * each);
  points.leftCols(each) = SpherePoints(each, 0);
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    if (k >= each) {
      points.col(k) = Eigen::Vector3d(2, 1, 3).normalized() +
                      0.15 * Eigen::Vector3d::NullaryExpr([&] { return normal(random); });
    }
    points.col(k).normalize();
    points.col(k) *= BumpRadius(points.col(k)) + (noise > 0 ? noise * normal(random) : 0);
  }
  return PointCloud(points);
}

void IsFinerWhereItsLayoutMissesThePoints(double noise) {
  const QuadMesh layout = CubeSphere(2);
  const PointCloud cloud = BumpyBall(3000, noise);
  const SolidFit fit = FitSolid(cloud, layout, {.threads = 1});
  // As finely everywhere it would be over a thousand.
  if (noise > 0) {
    EXPECT_LE(fit.report.geometry.control_points[0], 400);
  }
  EXPECT_GT(fit.report.geometry.control_points[0], layout.vertices.cols());
  EXPECT_EQ(fit.solid.faces.size(), 6u);
  EXPECT_EQ(fit.audit.open_edges, 0);
  EXPECT_LE(fit.audit.edge_angle, kIterated);
  double most = 0;
  for (Eigen::Index k = 0; k < cloud.size(); ++k) {
    const NurbsSurface& face = fit.solid.faces[std::size_t(fit.faces[std::size_t(k)])].surface;
    const Eigen::Vector3d foot = face.At(fit.parameters(0, k), fit.parameters(1, k));
    most = std::max(most, std::abs(foot.norm() - BumpRadius(foot)));
  }
  EXPECT_LE(most, noise > 0 ? 3 * noise : 1.5e-3);
  // Over the layout alone it is missed by a fifth of its height.
  const SolidFit coarse =
      FitSolid(cloud, layout, {.smoothing = fit.report.iterations.back().score, .threads = 1});
  EXPECT_EQ(coarse.report.geometry.control_points[0], layout.vertices.cols());
  EXPECT_GE(coarse.report.error.max, 5 * most);
}

TEST(FitSolidTest, IsFinerWhereItsLayoutMissesNoisyPoints) {
  IsFinerWhereItsLayoutMissesThePoints(1e-3);
}

TEST(LongFitSolidTest, IsFinerWhereItsLayoutMissesExactPoints) {
  IsFinerWhereItsLayoutMissesThePoints(0);
}

// Faces are refined for what is asked, and for what is more than noise if less is asked.
TEST(FitSolidTest, IsFinerForItsTolerance) {
  constexpr double kNoise = 1e-3;
  const QuadMesh layout = CubeSphere(2);
  const PointCloud cloud = BumpyBall(3000, kNoise);
  const auto fit_within = [&](double tolerance) {
    return FitSolid(cloud, layout, {.tolerance = tolerance, .keep_outliers = true, .threads = 1});
  };
  EXPECT_EQ(fit_within(0.1).report.geometry.control_points[0], layout.vertices.cols());
  for (const double tolerance : {5 * kNoise, kNoise / 4}) {
    const SolidFit fit = fit_within(tolerance);
    EXPECT_GT(fit.report.geometry.control_points[0], layout.vertices.cols());
    EXPECT_LE(fit.report.error.rms, 1.1 * kNoise);
    EXPECT_EQ(fit.report.error.out_of_tolerance == 0, tolerance > kNoise);
  }
}

TEST(FitSolidTest, IsFinerBesideCaps) {
  QuadMesh layout = CubeSphere(2);
  for (int f = 0; f < layout.faces.cols(); ++f) {
    double height = 0;
    for (const int corner : layout.faces.col(f)) height += layout.vertices(2, corner) / 4;
    if (height < -0.5) layout.caps.push_back(f);
  }
  const Eigen::Matrix3Xd all = BumpyBall(3000, 0).points();
  std::vector<Eigen::Index> above;
  for (Eigen::Index k = 0; k < all.cols(); ++k) {
    if (all(2, k) > -0.5) above.push_back(k);
  }
  const SolidFit fit =
      FitSolid(PointCloud(Eigen::Matrix3Xd(all(Eigen::all, above))), layout, {.threads = 1});
  EXPECT_GT(fit.report.geometry.control_points[0], layout.vertices.cols());
  EXPECT_LE(fit.report.error.max, 3e-3);
  EXPECT_EQ(fit.report.geometry.kind, "shell");
  EXPECT_GT(fit.audit.open_edges, 0);
  EXPECT_THAT(fit.control_mesh.caps.size() / layout.caps.size(), testing::AnyOf(4, 16));
  EXPECT_EQ(fit.control_mesh.caps.size() % layout.caps.size(), 0u);
  EXPECT_LE(fit.audit.edge_angle, kIterated);
}

// Stopped at any time, it is the solid of before, or there is none yet.
TEST(FitSolidTest, KeepsWhatItHasWhenRefinementIsStopped) {
  const PointCloud cloud = BumpyBall(2000, 0);
  const QuadMesh layout = CubeSphere(2);
  const auto stopped_after = [&](int calls) {
    return FitSolid(cloud, layout, {.threads = 1, .progress = [&](const char*, double) {
                                      return --calls > 0;
                                    }});
  };
  int calls = 0;
  const SolidFit whole = FitSolid(
      cloud, layout, {.threads = 1, .progress = [&](const char*, double) { return ++calls > 0; }});
  int last = 0;
  for (const double share : {0.5, 0.7, 0.9}) {
    try {
      const SolidFit fit = stopped_after(int(share * calls));
      EXPECT_EQ(fit.report.termination, Termination::kCancelled);
      EXPECT_EQ(fit.audit.open_edges, 0);
      EXPECT_GE(fit.report.geometry.control_points[0], last);
      EXPECT_LE(fit.report.geometry.control_points[0], whole.report.geometry.control_points[0]);
      last = fit.report.geometry.control_points[0];
    } catch (const Cancelled&) {
      EXPECT_EQ(last, 0);
    }
  }
  EXPECT_GE(last, layout.vertices.cols());
}

TriangleSurface Ball() {
  const QuadMesh mesh = CubeSphere(5);
  return CloseSurface(mesh.vertices, FacesOf(mesh)).surface;
}

// More freedom than the shape needs takes in noise.
TEST(FitSolidTest, ChoosesACoarseLayoutForANoisyBall) {
  constexpr double kNoise = 0.02;
  constexpr int kPoints = 6000;
  const PointCloud cloud(SpherePoints(kPoints, kNoise));
  const SolidFit chosen = FitSolid(cloud, Ball(), 0, {.threads = 1});
  EXPECT_LE(chosen.control_mesh.faces.cols(), LayoutFaces(kPoints) / 3 * 1.2);
  const double limit = kNoise * std::sqrt(double(chosen.control_mesh.vertices.cols()) / kPoints);
  EXPECT_LE(RmsFromSphere(chosen.solid), 1.5 * limit);
  // Of 600 points, known to 3 %: five of these.
  EXPECT_NEAR(std::sqrt(chosen.held_out.mean()), kNoise, 0.15 * kNoise);
}

TEST(FitSolidTest, KeepsTheCoarserSolidWhenItIsStopped) {
  bool fitted = false;
  const auto progress = [&](const char* stage, double) {
    const std::string name = stage;
    fitted = fitted || name == "fit";
    return !(fitted && name == "layout");
  };
  const PointCloud cloud(SpherePoints(3000, 0));
  const SolidFit fit = FitSolid(cloud, Ball(), 0, {.threads = 1, .progress = progress});
  EXPECT_EQ(fit.report.termination, Termination::kCancelled);
  EXPECT_LE(fit.control_mesh.faces.cols(), LayoutFaces(3000) / 3 * 1.2);
  EXPECT_EQ(fit.audit.open_edges, 0);
  EXPECT_THROW(FitSolid(cloud,
                        Ball(),
                        300,
                        {.threads = 1, .progress = [](const char*, double) { return false; }}),
               Cancelled);
}

TEST(FitSolidTest, RefusesLayoutsByName) {
  const PointCloud cloud(SpherePoints(1500, 0.01));
  const auto refusal = [&](const QuadMesh& layout) {
    return RefusalOf([&] { FitSolid(cloud, layout, {.threads = 1}); });
  };
  QuadMesh open = CubeSphere(1);
  open.faces.conservativeResize(4, open.faces.cols() - 1);
  EXPECT_THAT(refusal(open), HasSubstr("the mesh is open"));
  QuadMesh turned = CubeSphere(1);
  for (Eigen::Index f = 0; f < turned.faces.cols(); ++f) turned.faces.col(f).reverseInPlace();
  EXPECT_THAT(refusal(turned), HasSubstr("clockwise seen from outside"));
  QuadMesh apart = CubeSphere(1);
  apart.vertices.row(0).array() += 3;
  EXPECT_THAT(refusal(apart), HasSubstr("the layout lies apart from the points"));
  EXPECT_THAT(refusal(CubeSphere(4)), HasSubstr("a coarser layout is needed"));
  EXPECT_THROW(FitSolid(cloud, CubeSphere(1), {.tolerance = -1.0}), std::invalid_argument);
}

// The surface of a mesh of flat faces, each cut into n × n, a power of two so that faces meet
// exactly, with points at its vertices.
struct Body {
  Body(const QuadMesh& coarse, int n) {
    std::vector<std::vector<int>> faces;
    std::vector<Eigen::Vector3d> points;
    for (const auto face : coarse.faces.colwise()) {
      const int first = int(points.size());
      for (int i = 0; i <= n; ++i) {
        for (int j = 0; j <= n; ++j) {
          const double u = double(i) / n, v = double(j) / n;
          points.push_back((1 - u) * (1 - v) * coarse.vertices.col(face[0]) +
                           u * (1 - v) * coarse.vertices.col(face[1]) +
                           u * v * coarse.vertices.col(face[2]) +
                           (1 - u) * v * coarse.vertices.col(face[3]));
        }
      }
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
          const int at = first + i * (n + 1) + j;
          faces.push_back({at, at + n + 1, at + n + 2, at + 1});
        }
      }
    }
    Eigen::Matrix3Xd all(3, Eigen::Index(points.size()));
    for (std::size_t k = 0; k < points.size(); ++k) all.col(Eigen::Index(k)) = points[k];
    surface = CloseSurface(all, faces).surface;
  }

  // With the points moved by noise in all directions.
  SolidFit Fit(const QuadMesh* layout, int faces, double noise = 0) const {
    TriangleSurface moved = surface;
    std::mt19937_64 random(3);
    std::normal_distribution<double> normal;
    for (double& value : moved.vertices.reshaped()) value += noise * normal(random);
    PointCloud cloud(moved.vertices);
    cloud.set_normals(NormalsNear(moved, moved.vertices));
    const SolidFitOptions options{.keep_outliers = true, .threads = 1};
    return layout ? FitSolid(cloud, WithCreases(*layout, moved), options)
                  : FitSolid(cloud, moved, faces, options);
  }

  TriangleSurface surface;
};

TEST(FitSolidTest, MakesABoxExactlyOverAGivenLayoutAndItsOwn) {
  const Body box(Cube(), 16);
  const QuadMesh layout = Refined(Creased(Cube(), 1));
  const QuadMesh given{layout.vertices, layout.faces};
  for (const SolidFit& fit : {box.Fit(&given, 0), box.Fit(nullptr, 100)}) {
    EXPECT_EQ(fit.solid.faces.size(), 6u);
    EXPECT_EQ(fit.audit.sharp_edges, 12);
    EXPECT_NEAR(fit.audit.sharp_length, 24, kHalfDigits);
    EXPECT_NEAR(fit.audit.volume, 8, kHalfDigits);
    EXPECT_NEAR(fit.audit.least_sharp, std::numbers::pi / 2, kHalfDigits);
    EXPECT_LE(fit.report.error.max, kHalfDigits);
    EXPECT_EQ(fit.control_mesh.corners.size(), 8u);
  }
}

TEST(FitSolidTest, KeepsSharpEdgesThroughNoise) {
  constexpr double kNoise = 2e-3;  // 1e-3 of the size
  const SolidFit box = Body(Cube(), 16).Fit(nullptr, 60, kNoise);
  EXPECT_EQ(box.audit.sharp_edges, 12);
  EXPECT_LE(box.report.error.rms, 1.1 * kNoise);
  // Faces are planes of some hundred points each.
  EXPECT_NEAR(box.audit.volume, 8, 0.1 * kNoise * 24);
  const SolidFit block = Body(LBlock(), 8).Fit(nullptr, 110, kNoise);
  EXPECT_NEAR(block.audit.sharp_length, 22, 30 * kNoise);  // they waver by the noise
  EXPECT_NEAR(block.audit.volume, 3, 0.5 * kNoise * 14);
  EXPECT_LE(block.audit.edge_angle, kHalfDigits);
}

TEST(FitSolidTest, FindsNoSharpEdgesOnNoisySmoothBodies) {
  for (const QuadMesh& mesh : {CubeSphere(4), Torus(48, 24)}) {
    const double noise = 1e-3 * (mesh.vertices.maxCoeff() - mesh.vertices.minCoeff());
    const TriangleSurface body =
        CloseSurface(Shaken(mesh, std::sqrt(3.0) * noise, 5).vertices, FacesOf(mesh)).surface;
    EXPECT_EQ(LayoutOf(body, 150).creases.cols(), 0);
  }
}

}  // namespace batten::internal::fit_solid_test
