// SPDX-License-Identifier: MIT
#include "batten/fitting/rigid_alignment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "batten/fitting/sample_geometry.h"
#include "batten/geometry/make_surface.h"
#include "tolerances.h"

namespace batten {
namespace {

using internal::kHalfDigits;

NurbsSurface Flat(const Eigen::Vector3d& at, const Eigen::Vector3d& u, const Eigen::Vector3d& v) {
  const SplineBasis line(1, {0, 0, 1, 1});
  Eigen::Matrix3Xd net(3, 4);
  net << at, at + v, at + u, at + u + v;
  return NurbsSurface(line, line, net);
}

// Three faces of a box of 6 × 4 × 2 that meet in a corner, and points of each.
struct Corner {
  std::vector<NurbsSurface> faces{Flat({0, 0, 0}, {6, 0, 0}, {0, 4, 0}),
                                  Flat({0, 0, 0}, {0, 0, 2}, {6, 0, 0}),
                                  Flat({0, 0, 0}, {0, 4, 0}, {0, 0, 2})};
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd(3, 900);
  explicit Corner(double noise = 0) {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> even(0.2, 0.8);
    std::normal_distribution<double> normal;
    for (int k = 0; k < 900; ++k) {
      const double a = even(random), b = even(random);
      points.col(k) = faces[static_cast<size_t>(k % 3)].At(a, b);
      for (double& x : points.col(k)) x += noise * normal(random);
    }
  }
};

TEST(RigidAlignmentTest, RecoversAMotionFarFromZero) {
  const Eigen::Vector3d far(5e5, 5e6, 100);
  const Corner corner;
  const Eigen::AngleAxisd turn(0.05, Eigen::Vector3d(1, -2, 1).normalized());
  const Eigen::Matrix3Xd moved = (turn.toRotationMatrix() * corner.points).colwise() +
                                 (Eigen::Vector3d(0.1, -0.05, 0.08) + far);
  std::vector<NurbsSurface> faces;
  for (const NurbsSurface& face : corner.faces) faces.push_back(face.Translated(far));
  ThreadPool pool(2);
  const PointCloud cloud = PointCloud::FromWorld(moved);
  for (const std::vector<int>& datums : {std::vector<int>{}, {0, 1, 2}, {2, 0, 1}}) {
    const RigidAlignment found = AlignRigidly(faces, cloud, datums, pool);
    EXPECT_EQ(found.determined, 6);
    EXPECT_NEAR((found.rotation * turn.toRotationMatrix() - Eigen::Matrix3d::Identity()).norm(),
                0,
                kHalfDigits);
    const PointCloud back = found.Moved(cloud);
    double most = 0;
    for (Eigen::Index k = 0; k < back.size(); ++k)
      most = std::max(most, (back.World(k) - far - corner.points.col(k)).norm());
    EXPECT_LT(most, kHalfDigits);
  }
}

TEST(RigidAlignmentTest, LeavesAloneWhatThePointsDoNotSee) {
  const Corner corner;
  Eigen::Matrix3Xd points(3, 300);
  for (int k = 0; k < 300; ++k) points.col(k) = corner.points.col(3 * k);
  points.row(2).array() += 0.1;
  ThreadPool pool(1);
  const RigidAlignment found = AlignRigidly({corner.faces.front()}, PointCloud(points), {}, pool);
  EXPECT_EQ(found.determined, 3);
  EXPECT_NEAR((found.translation - Eigen::Vector3d(0, 0, -0.1)).norm(), 0, kHalfDigits);
  EXPECT_NEAR((found.rotation - Eigen::Matrix3d::Identity()).norm(), 0, kHalfDigits);
  EXPECT_NEAR(found.CovarianceAt({9, 9, 0})(0, 0), 0, kHalfDigits);
}

// A secondary face that is out of square by an angle does not turn the primary one.
TEST(RigidAlignmentTest, PrimaryDatumComesFirst) {
  Corner corner;
  for (int k = 1; k < 900; k += 3) corner.points(1, k) += 0.02 * corner.points(2, k);
  ThreadPool pool(1);
  const PointCloud cloud(corner.points);
  const RigidAlignment datum = AlignRigidly(corner.faces, cloud, {0, 1, 2}, pool);
  const RigidAlignment best = AlignRigidly(corner.faces, cloud, {}, pool);
  const auto tilt = [](const RigidAlignment& found) {
    return (found.rotation * Eigen::Vector3d::UnitZ()).head<2>().norm();
  };
  EXPECT_LT(tilt(datum), kHalfDigits);
  EXPECT_GT(tilt(best), 1e-3);
}

TEST(RigidAlignmentTest, DeviationIsThatOfManyDraws) {
  const Eigen::Vector3d place(6, 4, 0), up = Eigen::Vector3d::UnitZ();
  ThreadPool pool(1);
  std::mt19937_64 random(9);
  std::normal_distribution<double> normal;
  double squares = 0, said = 0;
  constexpr int kDraws = 200;
  for (int draw = 0; draw < kDraws; ++draw) {
    Corner corner;
    for (double& x : corner.points.reshaped()) x += 0.01 * normal(random);
    const RigidAlignment found = AlignRigidly(corner.faces, PointCloud(corner.points), {}, pool);
    const double error = up.dot(found.rotation * place + found.translation - place);
    squares += error * error;
    said = 0.01 * std::sqrt(up.dot(found.CovarianceAt(place) * up));
  }
  // The deviation of a deviation over n draws is 1/√(2n), 5 %; three of them.
  EXPECT_NEAR(std::sqrt(squares / kDraws) / said, 1, 0.15);
}

TEST(RigidAlignmentTest, RefusesWhatIsNotThere) {
  const Corner corner;
  ThreadPool pool(1);
  const PointCloud cloud(corner.points);
  EXPECT_THROW(AlignRigidly({}, cloud, {}, pool), std::invalid_argument);
  EXPECT_THROW(AlignRigidly(corner.faces, cloud, {3}, pool), std::invalid_argument);
}

}  // namespace
}  // namespace batten
