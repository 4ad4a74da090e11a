// SPDX-License-Identifier: MIT
// Meshes of surfaces: closed where the surface is, without cracks, within the chord tolerance.
#include "batten/geometry/tessellate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "batten/geometry/bounding_box.h"
#include "batten/geometry/foot_point.h"
#include "batten/geometry/make_surface.h"
#include "batten/geometry/surface_area.h"
#include "batten/geometry/transform.h"
#include "batten/geometry/trim_region.h"
#include "random_splines.h"
#include "refusal.h"
#include "tolerances.h"
#include "trim_cases.h"

namespace batten::internal::tessellate_test {

using ::testing::HasSubstr;

constexpr unsigned kSeed = 31;

struct Edges {
  int border = 0;  // in one triangle
  int inner = 0;   // in two, run through in both directions
  int others = 0;  // anything else
};

Edges EdgesOf(const TriangleMesh& mesh) {
  std::map<std::pair<int, int>, std::pair<int, int>> uses;  // forwards, backwards
  for (const auto triangle : mesh.triangles.colwise()) {
    for (int k = 0; k < 3; ++k) {
      const int a = triangle[k], b = triangle[(k + 1) % 3];
      auto& use = uses[std::minmax(a, b)];
      ++(a < b ? use.first : use.second);
    }
  }
  Edges edges;
  for (const auto& [edge, use] : uses) {
    const bool once = use.first + use.second == 1, twice = use.first == 1 && use.second == 1;
    ++(once ? edges.border : twice ? edges.inner : edges.others);
  }
  return edges;
}

int EulerCharacteristic(const TriangleMesh& mesh) {
  const Edges edges = EdgesOf(mesh);
  return static_cast<int>(mesh.vertices.cols() + mesh.triangles.cols()) - edges.border -
         edges.inner - edges.others;
}

Eigen::Vector3d Cross(const TriangleMesh& mesh, Eigen::Index triangle) {
  const Eigen::Vector3i t = mesh.triangles.col(triangle);
  const Eigen::Vector3d a = mesh.vertices.col(t[0]);
  const Eigen::Vector3d ab = mesh.vertices.col(t[1]) - a, ac = mesh.vertices.col(t[2]) - a;
  return ab.cross(ac);
}

double MeshArea(const TriangleMesh& mesh) {
  double area = 0;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) area += Cross(mesh, t).norm() / 2;
  return area;
}

// The greatest distance of places of the mesh, at random in random triangles, from the surface
// without its trims.
double MeasuredDistance(const TriangleMesh& mesh,
                        const NurbsSurface& surface,
                        unsigned seed,
                        int count = 600) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> share;
  std::uniform_int_distribution<Eigen::Index> pick(0, mesh.triangles.cols() - 1);
  Eigen::Matrix3Xd points(3, count);
  for (auto point : points.colwise()) {
    const Eigen::Vector3i t = mesh.triangles.col(pick(random));
    double a = share(random), b = share(random);
    if (a + b > 1) a = 1 - a, b = 1 - b;
    const Eigen::Vector3d first = mesh.vertices.col(t[0]);
    point = first + a * (mesh.vertices.col(t[1]) - first) + b * (mesh.vertices.col(t[2]) - first);
  }
  const SurfaceFootPoints feet(surface.WithTrims({}));
  double greatest = 0;
  for (const auto point : points.colwise())
    greatest = std::max(greatest, feet.Nearest(point).distance);
  return greatest;
}

void ExpectSound(const TriangleMesh& mesh, const NurbsSurface& surface) {
  ASSERT_GT(mesh.triangles.cols(), 0);
  EXPECT_GE(mesh.triangles.minCoeff(), 0);
  EXPECT_EQ(mesh.triangles.maxCoeff(), mesh.vertices.cols() - 1);
  EXPECT_EQ(EdgesOf(mesh).others, 0);
  const double size = BoundingBox(surface).diagonal().norm();
  const double far = surface.control_points().cwiseAbs().maxCoeff();
  for (Eigen::Index k = 0; k < mesh.vertices.cols(); ++k) {
    const Eigen::Vector3d point = surface.At(mesh.parameters(0, k), mesh.parameters(1, k));
    ASSERT_LE((mesh.vertices.col(k) - point).norm(), kRounding * (size + far));
    ASSERT_NEAR(mesh.normals.col(k).norm(), 1, kRounding);
  }
  for (const auto triangle : mesh.triangles.colwise()) {
    ASSERT_NE(triangle[0], triangle[1]);
    ASSERT_NE(triangle[1], triangle[2]);
    ASSERT_NE(triangle[2], triangle[0]);
  }
}

// Triangles are turned as the normals at their corners; those that are mere rounding aside.
void ExpectTurnedAsNormals(const TriangleMesh& mesh) {
  const double mean = MeshArea(mesh) / static_cast<double>(mesh.triangles.cols());
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Eigen::Vector3d cross = Cross(mesh, t);
    if (cross.norm() < kHalfDigits * mean) continue;
    for (const int vertex : mesh.triangles.col(t)) {
      ASSERT_GT(cross.dot(mesh.normals.col(vertex)), 0) << t;
    }
  }
}

Frame Tilted() {
  return Frame(
      {1, 2, 3}, Eigen::Vector3d(1, 2, 2).normalized(), Eigen::Vector3d(2, 1, -2).normalized());
}

struct RoundCase {
  std::string name;
  NurbsSurface surface;
  int characteristic;
  bool closed;
};
std::vector<RoundCase> RoundCases() {
  const Frame frame = Tilted();
  return {{"plane", MakePlane(frame, {-1, 2}, {0, 1}), 1, false},
          {"cylinder", MakeCylinder(frame, 2, {-1, 5}), 0, false},
          {"part of a cylinder", MakeCylinder(frame, 2, {-1, 5}, {0.3, 2}), 1, false},
          {"cone with its tip", MakeCone(frame, 2, 0, {0, 3}), 1, false},
          {"blunt cone", MakeCone(frame, 2, 1, {0, 3}), 0, false},
          {"sphere", MakeSphere(frame, 3), 2, true},
          {"dome", MakeSphere(frame, 3, {}, {0.2, std::numbers::pi / 2}), 1, false},
          {"lune", MakeSphere(frame, 3, {0, 1}), 1, false},
          {"torus", MakeTorus(frame, 3, 1), 0, true}};
}

TEST(TessellateTest, RoundShapesAreClosedWithTheirEulerCharacteristic) {
  for (const RoundCase& shape : RoundCases()) {
    for (const double tolerance : {1.0, 0.1, 0.01, 0.002}) {
      SCOPED_TRACE(shape.name + " " + std::to_string(tolerance));
      const TriangleMesh mesh = Tessellate(shape.surface, {.chord_tolerance = tolerance});
      ExpectSound(mesh, shape.surface);
      EXPECT_EQ(EulerCharacteristic(mesh), shape.characteristic);
      EXPECT_EQ(EdgesOf(mesh).border == 0, shape.closed);
      if (tolerance < 0.5) ExpectTurnedAsNormals(mesh);
      EXPECT_LE(MeasuredDistance(mesh, shape.surface, kSeed), tolerance);
    }
  }
}

TEST(TessellateTest, TheAreaTendsToTheSurfaces) {
  // A triangle of sagitta s in curvature κ loses some 4 κ s of its area.
  for (const RoundCase& shape : RoundCases()) {
    SCOPED_TRACE(shape.name);
    for (const double tolerance : {0.01, 0.001}) {
      const double area = MeshArea(Tessellate(shape.surface, {.chord_tolerance = tolerance}));
      const double expected = Area(shape.surface);
      EXPECT_LE(area, expected * (1 + kIterated));
      EXPECT_GE(area, expected * (1 - 4 * tolerance));
    }
  }
}

TEST(TessellateTest, FlatShapesTakeFewTrianglesAndCylindersStrips) {
  EXPECT_EQ(Tessellate(MakePlane(Tilted(), {0, 3}, {0, 1})).triangles.cols(), 2);
  const TriangleMesh mesh =
      Tessellate(MakeCylinder(Tilted(), 1, {0, 5}), {.chord_tolerance = 1e-3});
  EXPECT_LE(mesh.triangles.cols(), 256);
}

TEST(TessellateTest, RandomSurfacesStayWithinTheTolerance) {
  RandomSplines random(kSeed);
  SCOPED_TRACE(kSeed);
  for (int round = 0; round < 30; ++round) {
    SCOPED_TRACE(round);
    const int p = random.Integer(1, 5), q = random.Integer(1, 4);
    const bool rational = round % 2 == 1;
    const BasisKind kind{.periodic = round % 5 == 4};
    const NurbsSurface surface =
        round % 3 == 0 ? random.Surface(p, q, rational, kind, {}) : random.Sheet(p, q, 1);
    const double size = BoundingBox(surface).diagonal().norm();
    const double tolerance = size * (round % 3 == 0 ? 0.03 : 0.003);
    const TriangleMesh mesh = Tessellate(surface, {.chord_tolerance = tolerance});
    ExpectSound(mesh, surface);
    EXPECT_LE(MeasuredDistance(mesh, surface, kSeed + round, 200), tolerance);
  }
}

TEST(TessellateTest, TrimmedSurfacesFollowTheirLoops) {
  const std::vector<NurbsSurface> surfaces{MakePlane(Tilted(), {0, 2}, {0, 1}),
                                           MakeTorus(Tilted(), 3, 1),
                                           MakeSphere(Tilted(), 2, {0, 2}, {-1, 1})};
  for (const NurbsSurface& whole : surfaces) {
    for (const LoopCase& loops : LoopCases(kSeed)) {
      const NurbsSurface surface = Trimmed(whole, loops);
      const double tolerance = 2e-3;
      SCOPED_TRACE(loops.name);
      const TriangleMesh mesh = Tessellate(surface, {.chord_tolerance = tolerance});
      ExpectSound(mesh, surface);
      ExpectTurnedAsNormals(mesh);
      EXPECT_LE(MeasuredDistance(mesh, surface, kSeed), tolerance);
      const double area = Area(surface);
      // Along the loops a strip of at most the tolerance may be missing or too much; curvature 1.
      EXPECT_NEAR(MeshArea(mesh), area, 4 * tolerance * area + 20 * tolerance);
    }
  }
}

TEST(TessellateTest, BordersAreTheLoopsAndTheirCornersStay) {
  const std::vector<Eigen::Vector2d> corners{{0.1, 0.1}, {0.9, 0.2}, {0.7, 0.65}, {0.3, 0.8}};
  const NurbsSurface plane = MakePlane(Frame(), {0, 1}, {0, 1});
  const NurbsSurface surface =
      plane.WithTrims(TurnedLoops({PolygonLoop(corners), Circle({0.5, 0.4}, 0.1, false)}));
  const double tolerance = 1e-3;
  const TriangleMesh mesh = Tessellate(surface, {.chord_tolerance = tolerance});
  EXPECT_EQ(EulerCharacteristic(mesh), 0);
  for (const Eigen::Vector2d& corner : corners) {
    EXPECT_EQ((mesh.parameters.colwise() - corner).colwise().norm().minCoeff(), 0);
  }
  // Every vertex is on a corner, a side or the circle: the plane needs no others.
  for (const auto p : mesh.parameters.colwise()) {
    double nearest = std::abs((p - Eigen::Vector2d(0.5, 0.4)).norm() - 0.1);
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const Eigen::Vector2d a = corners[k], b = corners[(k + 1) % corners.size()];
      const Eigen::Vector2d normal(a[1] - b[1], b[0] - a[0]);
      nearest = std::min(nearest, std::abs(normal.dot(p - a)) / normal.norm());
    }
    EXPECT_LE(nearest, 1e-8);  // a step of the lattice is 2e-9
  }
}

TEST(TessellateTest, ABandRoundACylinderIsClosedAtTheSeam) {
  const NurbsSurface whole = MakeCylinder(Tilted(), 1, {0, 2});
  // Up one side of the seam and down the other, with ends in different places.
  const NurbsSurface surface = whole.WithTrims({PolygonLoop(
      {{0, 0.2}, {0.5, 0.1}, {1, 0.2}, {1, 0.5}, {1, 0.9}, {0.4, 0.8}, {0, 0.9}, {0, 0.6}})});
  for (const double tolerance : {0.1, 0.01, 0.001}) {
    const TriangleMesh mesh = Tessellate(surface, {.chord_tolerance = tolerance});
    ExpectSound(mesh, surface);
    EXPECT_EQ(EulerCharacteristic(mesh), 0);
    EXPECT_LE(MeasuredDistance(mesh, surface, kSeed), tolerance);
  }
}

TEST(TessellateTest, CreasesAreEdges) {
  // A roof: a ridge along v in the middle of u.
  Eigen::Matrix3Xd points(3, 6);
  points << 0, 0, 1, 1, 2, 2, 0, 1, 0, 1, 0, 1, 0, 0, 1, 1, 0, 0;
  const NurbsSurface roof(SplineBasis(1, {0, 0, 0.3, 1, 1}), SplineBasis(1, {0, 0, 1, 1}), points);
  const TriangleMesh mesh = Tessellate(roof, {.chord_tolerance = 1e-6});
  EXPECT_EQ(mesh.triangles.cols(), 4);
  EXPECT_NEAR(MeshArea(mesh), 2 * std::sqrt(2.0), kRounding * 10);
}

TEST(TessellateTest, TheUnitAndTheOriginMakeNoDifference) {
  RandomSplines random(kSeed);
  const NurbsSurface surface = Trimmed(MakeTorus(Frame(), 3, 1), LoopCases(kSeed)[2]);
  const TriangleMesh mesh = Tessellate(surface, {.chord_tolerance = 0.01});
  for (const double scale : {1e-6, 1e6}) {
    const Eigen::Matrix3Xd scaled_points = scale * surface.control_points();
    const NurbsSurface scaled =
        NurbsSurface(surface.basis_u(), surface.basis_v(), scaled_points, surface.weights())
            .WithTrims(surface.trims());
    const TriangleMesh other = Tessellate(scaled, {.chord_tolerance = 0.01 * scale});
    EXPECT_NEAR(static_cast<double>(other.triangles.cols()),
                static_cast<double>(mesh.triangles.cols()),
                0.01 * static_cast<double>(mesh.triangles.cols()));
    EXPECT_NEAR(
        MeshArea(other), scale * scale * MeshArea(mesh), 1e-3 * scale * scale * MeshArea(mesh));
  }
  const NurbsSurface far = surface.Translated({5e6, -5e6, 5e6});
  const TriangleMesh other = Tessellate(far, {.chord_tolerance = 0.01});
  ExpectSound(other, far);
  EXPECT_LE(MeasuredDistance(other, far, kSeed), 0.01);
}

TEST(TessellateTest, TheDefaultIsAThousandthOfTheSizeAndTheSameAgain) {
  const NurbsSurface sphere = MakeSphere(Tilted(), 3);
  const TriangleMesh mesh = Tessellate(sphere), again = Tessellate(sphere);
  EXPECT_EQ(mesh.triangles, again.triangles);
  EXPECT_EQ(mesh.vertices, again.vertices);
  const double size = BoundingBox(sphere).diagonal().norm();
  EXPECT_EQ(mesh.triangles, Tessellate(sphere, {.chord_tolerance = 1e-3 * size}).triangles);
}

TEST(TessellateTest, JoinedMeshesKeepAllTriangles) {
  const TriangleMesh a = Tessellate(MakeSphere(Frame(), 1)),
                     b = Tessellate(MakePlane(Frame(), {0, 1}, {0, 1}));
  const TriangleMesh both = JoinedMeshes({a, b});
  EXPECT_EQ(both.vertices.cols(), a.vertices.cols() + b.vertices.cols());
  EXPECT_EQ(both.triangles.cols(), a.triangles.cols() + b.triangles.cols());
  EXPECT_NEAR(MeshArea(both), MeshArea(a) + MeshArea(b), kRounding * 100);
}

std::string Refusal(const NurbsSurface& surface, const TessellateOptions& options) {
  return internal::RefusalOf([&] { Tessellate(surface, options); }, "");
}

TEST(TessellateTest, WhatCannotBeIsRefusedByName) {
  const NurbsSurface sphere = MakeSphere(Frame(), 1);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(Refusal(sphere, {.chord_tolerance = -1}), HasSubstr("chord_tolerance: -1"));
  EXPECT_THAT(Refusal(sphere, {.chord_tolerance = kNan}), HasSubstr("chord_tolerance"));
  EXPECT_THAT(Refusal(sphere, {.max_triangles = 0}), HasSubstr("max_triangles: 0"));
  EXPECT_THAT(Refusal(sphere, {.chord_tolerance = 1e-14}), HasSubstr("1e-14 needs more than"));
  EXPECT_THAT(Refusal(sphere, {.chord_tolerance = 1e-4, .max_triangles = 1000}),
              HasSubstr("more than the 1000 triangles"));
}

TEST(TessellateTest, ProgressCanStopIt) {
  TessellateOptions options{.chord_tolerance = 1e-5};
  options.progress = [](double) { throw std::runtime_error("stop"); };
  EXPECT_THROW(Tessellate(MakeSphere(Frame(), 1), options), std::runtime_error);
}

}  // namespace batten::internal::tessellate_test
