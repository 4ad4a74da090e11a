// SPDX-License-Identifier: MIT
#include "batten/fitting/solid_layout.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "batten/fitting/closed_surface.h"
#include "batten/fitting/fit_solid.h"
#include "batten/fitting/refused_data.h"
#include "body_clouds.h"
#include "fitting/core/stopwatch.h"
#include "fitting/solid/surface_projector.h"
#include "geometry/mesh/triangle_measure.h"
#include "refusal.h"
#include "tolerances.h"

namespace batten::internal::solid_layout_test {

using ::testing::HasSubstr;

ClosedSurface Closed(const QuadMesh& mesh) { return CloseSurface(mesh.vertices, FacesOf(mesh)); }

TEST(CloseSurfaceTest, TurnsFacesOutwardsAndKeepsTheGenus) {
  QuadMesh mesh = Refined(Torus(12, 8));
  for (Eigen::Index f = 0; f < mesh.faces.cols(); f += 3) mesh.faces.col(f).reverseInPlace();
  const ClosedSurface closed = Closed(mesh);
  EXPECT_EQ(closed.genus, 1);
  EXPECT_EQ(closed.components, 1);
  EXPECT_EQ(closed.filled, 0);
  EXPECT_GT(closed.turned, 0);
  double volume = 0;
  for (const auto t : closed.surface.triangles.colwise()) {
    const Eigen::Matrix3Xd& p = closed.surface.vertices;
    volume += p.col(t[0]).cross(p.col(t[1])).dot(p.col(t[2])) / 6;
  }
  EXPECT_GT(volume, 0);
}

TEST(CloseSurfaceTest, JoinsCornersAndClosesHoles) {
  const QuadMesh mesh = CubeSphere(3);
  // Every face with corners of its own, one left out.
  Eigen::Matrix3Xd corners(3, 4 * mesh.faces.cols());
  std::vector<std::vector<int>> faces;
  for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f) {
    for (int k = 0; k < 4; ++k) corners.col(4 * f + k) = mesh.vertices.col(mesh.faces(k, f));
    const int at = static_cast<int>(4 * f);
    if (f > 0) faces.push_back({at, at + 1, at + 2, at + 3});
  }
  const ClosedSurface closed = CloseSurface(corners, faces);
  EXPECT_EQ(closed.filled, 1);
  EXPECT_EQ(closed.genus, 0);
  EXPECT_NEAR(
      closed.filled_share, 1.0 / double(mesh.faces.cols()), 0.5 / double(mesh.faces.cols()));
}

TEST(CloseSurfaceTest, PartsASurfaceThatTouchesItselfAtAVertex) {
  QuadMesh mesh = CubeSphere(3);
  Eigen::Index top, bottom;
  mesh.vertices.row(2).maxCoeff(&top);
  mesh.vertices.row(2).minCoeff(&bottom);
  mesh.vertices.col(top).setZero();
  mesh.vertices.col(bottom).setZero();
  std::vector<std::vector<int>> faces = FacesOf(mesh);
  faces.push_back(faces[5]);
  const ClosedSurface closed = CloseSurface(mesh.vertices, faces);
  EXPECT_EQ(closed.joined, 1);
  EXPECT_EQ(closed.dropped, 2);  // the triangles of the face that is there twice
  EXPECT_EQ(closed.components, 1);
  EXPECT_EQ(closed.genus, 0);
  EXPECT_EQ(closed.surface.vertices.cols(), mesh.vertices.cols());
}

TEST(CloseSurfaceTest, SaysWhyItCantBeClosed) {
  const QuadMesh sphere = CubeSphere(2);
  std::vector<std::vector<int>> half = FacesOf(sphere);
  half.resize(half.size() / 2);
  EXPECT_THAT(RefusalOf([&] { CloseSurface(sphere.vertices, half); }),
              HasSubstr("the surface is open: its hole would be "));
  std::vector<std::vector<int>> fin = FacesOf(sphere);
  fin.push_back({fin[0][0], fin[0][1], fin.back()[2]});
  EXPECT_THAT(RefusalOf([&] { CloseSurface(sphere.vertices, fin); }), HasSubstr("not manifold"));
  EXPECT_THAT(RefusalOf([&] { CloseSurface(sphere.vertices, {}); }), HasSubstr("no faces"));
  // A strip with a half turn.
  Eigen::Matrix3Xd band(3, 12);
  std::vector<std::vector<int>> moebius;
  for (int k = 0; k < 6; ++k) {
    const double a = std::numbers::pi * k / 3;
    const Eigen::Vector3d out(std::cos(a), std::sin(a), 0), up(0, 0, 1);
    const Eigen::Vector3d across = std::cos(a / 2) * up + std::sin(a / 2) * out;
    band.col(2 * k) = 3 * out + across;
    band.col(2 * k + 1) = 3 * out - across;
    const int next = k < 5 ? 2 * k + 2 : 1, other = k < 5 ? 2 * k + 3 : 0;
    moebius.push_back({2 * k, 2 * k + 1, other, next});
  }
  EXPECT_THAT(RefusalOf([&] { CloseSurface(band, moebius); }), HasSubstr("one side only"));
}

TEST(LayoutOfTest, IsAllQuadrilateralsOfTheSurfacesGenus) {
  for (const QuadMesh& mesh :
       {CubeSphere(4), Refined(Refined(Torus(12, 8))), Refined(Refined(Refined(Cube())))}) {
    const ClosedSurface closed = Closed(mesh);
    for (const int faces : {60, 250, 900}) {
      const QuadMesh layout = LayoutOf(closed.surface, faces);
      const QuadMeshSummary summary = CheckQuadMesh(layout);
      EXPECT_EQ(summary.genus, closed.genus);
      EXPECT_GE(summary.least_valence, 3);
      EXPECT_LE(summary.greatest_valence, 7);
      EXPECT_GE(layout.faces.cols(), faces / 2);
      EXPECT_LE(layout.faces.cols(), 2 * faces);
    }
  }
}

// A ball with two thin ears.
TriangleSurface BallWithEars() {
  QuadMesh mesh = CubeSphere(5);
  for (auto vertex : mesh.vertices.colwise()) {
    const Eigen::Vector3d direction = vertex;
    for (const double side : {-1.0, 1.0}) {
      const Eigen::Vector3d tip = Eigen::Vector3d(0.6 * side, 0.3, 0.74).normalized();
      const Eigen::Vector3d thin = Eigen::Vector3d(0, 1, -0.4).normalized();
      const double a = (direction - tip).dot(thin) / 0.1;
      const double b = direction.dot(tip.cross(thin).normalized()) / 0.2;
      if (direction.dot(tip) > 0) vertex += 1.2 * std::exp(-(a * a + b * b) / 2) * direction;
    }
  }
  return Closed(mesh).surface;
}

// How far middles of faces and of their edges are from the surface at most, in edges.
double Farthest(const QuadMesh& layout, const SurfaceProjector& projector, double area) {
  double farthest = 0;
  for (const auto face : layout.faces.colwise()) {
    const Eigen::Matrix<double, 3, 4> corners = layout.vertices(Eigen::all, face);
    Eigen::Matrix<double, 3, 5> places;
    places << corners.rowwise().mean(), (corners + corners(Eigen::all, {1, 2, 3, 0})) / 2;
    for (const auto place : places.colwise()) {
      farthest = std::max(farthest, (projector.Nearest(place) - place).norm());
    }
  }
  return farthest / std::sqrt(area / double(layout.faces.cols()));
}

// No face spans more than half a circle, as from the tip of an ear to the head. Of faces of one
// size some are 0.64, 0.69 and 0.6 edges away.
TEST(LayoutOfTest, SpansNoEars) {
  const TriangleSurface surface = BallWithEars();
  const SurfaceProjector projector(surface);
  const double area = AreaOf(surface);
  for (const int faces : {280, 320, 360}) {
    EXPECT_LE(Farthest(LayoutOf(surface, faces), projector, area), 0.5) << faces;
  }
}

// A ball of which the points are below a height: what is above only closes it, and the border is
// drawn there, or a tenth too low.
TEST(FitSolidTest, AnOpenShellEndsAtTheBorderOfThePoints) {
  constexpr double kHeight = 0.5;
  const double radius = std::sqrt(1 - kHeight * kHeight), tau = 2 * std::numbers::pi;
  TriangleSurface ball = Closed(CubeSphere(4)).surface;
  for (auto p : ball.vertices.colwise()) p.normalize();
  std::vector<Eigen::Vector3d> below;
  for (const auto p : ball.vertices.colwise()) {
    if (p.z() < kHeight) below.emplace_back(p);
  }
  Eigen::Matrix3Xd points(3, std::ssize(below));
  for (std::size_t k = 0; k < below.size(); ++k) points.col(Eigen::Index(k)) = below[k];
  for (const double drawn : {kHeight, kHeight - 0.1}) {
    ball.caps.clear();
    for (const auto t : ball.triangles.colwise())
      ball.caps.push_back(ball.vertices(2, t).mean() > drawn);
    const SolidFit fit = FitSolid(PointCloud::FromWorld(points), ball, 150);
    EXPECT_EQ(fit.report.geometry.kind, "shell");
    EXPECT_NEAR(fit.audit.open_length, tau * radius, 0.05 * tau * radius);
    EXPECT_NEAR(fit.audit.area, tau * (1 + kHeight), 0.05 * tau);
    EXPECT_LT(fit.audit.edge_angle, 1e-6);
    EXPECT_LT(fit.report.error.rms, 0.002);
    EXPECT_LT(fit.report.error.max, 0.02);  // a fifth of how far points are apart
    for (const int face : fit.faces) EXPECT_LT(face, std::ssize(fit.solid.faces));
  }
}

// Layouts, the fits that were refused or not as good, and the one that was: all is in a stage.
TEST(FitSolidTest, SecondsTellOfLayoutsAndOtherFits) {
  TriangleSurface ball = Closed(CubeSphere(4)).surface;
  for (auto p : ball.vertices.colwise()) p.normalize();
  const PointCloud cloud = PointCloud::FromWorld(ball.vertices);
  for (const int faces : {0, 150}) {
    Stopwatch watch;
    const StageSeconds of = FitSolid(cloud, ball, faces).report.seconds;
    const double wall = watch.Lap();
    EXPECT_NEAR(of.total, wall, 0.05 * wall);
    const double sum = of.read + of.prepare + of.parameterize + of.solve + of.project + of.refine +
                       of.optimize + of.trim + of.write;
    EXPECT_NEAR(sum, of.total, kRounding * wall);
    EXPECT_GT(of.parameterize, 0.2 * wall);  // layouts
    EXPECT_LT(of.refine, faces > 0 ? 0.01 * wall : wall);
  }
}

// Caps of few faces have corners, which stay: no other layout needs to be tried.
void FollowsTheBordersOfCapsAbove(const std::vector<double>& heights) {
  TriangleSurface ball = Closed(CubeSphere(5)).surface;
  for (auto p : ball.vertices.colwise()) p.normalize();
  const Eigen::Vector3d up = Eigen::Vector3d(1, 2, 3).normalized();
  for (const double height : heights) {
    ball.caps.clear();
    for (const auto t : ball.triangles.colwise())
      ball.caps.push_back(up.dot(ball.vertices(Eigen::all, t).rowwise().mean()) > height);
    for (const int faces : {100, 200, 400}) {
      const QuadMesh layout = LayoutOf(ball, faces);
      double area = 0;
      for (const int f : layout.caps) {
        const auto c = layout.faces.col(f);
        const Eigen::Vector3d one = layout.vertices.col(c[2]) - layout.vertices.col(c[0]);
        const Eigen::Vector3d two = layout.vertices.col(c[3]) - layout.vertices.col(c[1]);
        area += one.cross(two).norm() / 2;
      }
      const double whole = 2 * std::numbers::pi * (1 - height);
      EXPECT_NEAR(area, whole, 0.25 * whole) << height << ' ' << faces;
      EXPECT_LE(layout.faces.cols(), 1.15 * faces) << height << ' ' << faces;
    }
  }
}

TEST(LayoutOfTest, FollowsTheBordersOfASmallCap) { FollowsTheBordersOfCapsAbove({0.87}); }

TEST(LongLayoutOfTest, FollowsTheBordersOfSmallCaps) { FollowsTheBordersOfCapsAbove({0.8, 0.93}); }

TEST(LayoutFacesTest, GrowWithThePointsWithinBounds) {
  EXPECT_EQ(LayoutFaces(0), LayoutFaces(100));
  EXPECT_EQ(LayoutFaces(100000), LayoutFaces(Eigen::Index(1) << 40));
  EXPECT_EQ(2 * LayoutFaces(3000), LayoutFaces(6000));
}

TEST(LayoutOfTest, LiesOnTheSurface) {
  const QuadMesh layout = LayoutOf(Closed(CubeSphere(5)).surface, 300);
  // Chords of the sphere's own triangles.
  EXPECT_LE((layout.vertices.colwise().norm().array() - 1).abs().maxCoeff(), 2e-3);
}

TEST(LayoutOfTest, IsTheSameEveryTime) {
  const ClosedSurface closed = Closed(CubeSphere(4));
  const QuadMesh one = LayoutOf(closed.surface, 200), two = LayoutOf(closed.surface, 200);
  EXPECT_EQ(one.faces, two.faces);
  EXPECT_EQ(one.vertices, two.vertices);
}

}  // namespace batten::internal::solid_layout_test
