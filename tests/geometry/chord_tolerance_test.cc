// SPDX-License-Identifier: MIT
// The chord tolerance holds both ways, measured at random places of the mesh and of the surface.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "batten/geometry/bounding_box.h"
#include "batten/geometry/flatness_bound.h"
#include "batten/geometry/foot_point.h"
#include "batten/geometry/make_surface.h"
#include "batten/geometry/surface_evaluator.h"
#include "batten/geometry/tessellate.h"
#include "batten/geometry/trim_region.h"
#include "nasty_surfaces.h"
#include "random_splines.h"
#include "tolerances.h"
#include "trim_cases.h"

namespace batten {
namespace {

// The distance of a point from a triangle. [Ericson 2005, §5.1.5]
double Distance(const Eigen::Vector3d& point,
                const Eigen::Vector3d& a,
                const Eigen::Vector3d& b,
                const Eigen::Vector3d& c) {
  const auto to_segment = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    const Eigen::Vector3d along = to - from;
    const double square = along.squaredNorm();
    const double share =
        square > 0 ? std::clamp((point - from).dot(along) / square, 0.0, 1.0) : 0.0;
    return (point - from - share * along).norm();
  };
  const double edges = std::min({to_segment(a, b), to_segment(b, c), to_segment(c, a)});
  const Eigen::Vector3d normal = (b - a).cross(c - a);
  const double square = normal.squaredNorm();
  if (!(square > 0)) return edges;
  const bool over = normal.dot((b - a).cross(point - a)) >= 0 &&
                    normal.dot((c - b).cross(point - b)) >= 0 &&
                    normal.dot((a - c).cross(point - c)) >= 0;
  return over ? std::abs(normal.dot(point - a)) / std::sqrt(square) : edges;
}

double DistanceFromMesh(const Eigen::Vector3d& point, const TriangleMesh& mesh) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto t : mesh.triangles.colwise()) {
    const Eigen::Vector3d a = mesh.vertices.col(t[0]), b = mesh.vertices.col(t[1]),
                          c = mesh.vertices.col(t[2]);
    const Eigen::Array3d beyond =
        (a.cwiseMin(b).cwiseMin(c) - point).cwiseMax(point - a.cwiseMax(b).cwiseMax(c)).array();
    if (beyond.maxCoeff() < least) least = std::min(least, Distance(point, a, b, c));
  }
  return least;
}

struct Worst {
  double of_mesh = 0, of_surface = 0;
};

// The greatest distances of random places of the mesh from the surface, inside its trims, and of
// random places of the surface from the mesh.
Worst Measured(const NurbsSurface& surface,
               const TriangleMesh& mesh,
               RandomSplines& random,
               int count) {
  Worst worst;
  const Eigen::Vector3d middle = BoundingBox(surface).center();
  const NurbsSurface near = surface.Translated(-middle);
  const SurfaceFootPoints feet(near);
  TriangleMesh local = mesh;
  local.vertices.colwise() -= middle;
  for (int k = 0; k < count; ++k) {
    const auto t =
        mesh.triangles.col(random.Integer(0, static_cast<int>(mesh.triangles.cols()) - 1));
    double a = random.Real(0, 1), b = random.Real(0, 1);
    if (a + b > 1) a = 1 - a, b = 1 - b;
    const Eigen::Vector3d place = (1 - a - b) * local.vertices.col(t[0]) +
                                  a * local.vertices.col(t[1]) + b * local.vertices.col(t[2]);
    worst.of_mesh = std::max(worst.of_mesh, feet.Nearest(place).distance);
  }
  const TrimRegion region(surface);
  for (int k = 0; k < count;) {
    const double u = random.Parameter(surface.basis_u()), v = random.Parameter(surface.basis_v());
    ++k;
    if (!region.Contains(u, v)) continue;
    worst.of_surface = std::max(worst.of_surface, DistanceFromMesh(near.At(u, v), local));
  }
  return worst;
}

void ExpectWithin(const NurbsSurface& surface,
                  double tolerance,
                  RandomSplines& random,
                  int count = 100) {
  const TriangleMesh mesh =
      Tessellate(surface, {.chord_tolerance = tolerance, .max_triangles = 200000});
  ASSERT_GT(mesh.triangles.cols(), 0);
  const Worst worst = Measured(surface, mesh, random, count);
  EXPECT_LE(worst.of_mesh, tolerance);
  EXPECT_LE(worst.of_surface, tolerance);
}

// In part of what the foot search and rounding leave, against the size.
double SizeOfBox(const NurbsSurface& surface) { return BoundingBox(surface).diagonal().norm(); }

TEST(ChordToleranceTest, HoldsForRandomSurfacesOfEveryDegree) {
  RandomSplines random(91);
  for (int round = 0; round < 200; ++round) {
    const int p = random.Integer(1, 9), q = random.Integer(1, 9);
    SCOPED_TRACE(std::to_string(round) + ": degrees " + std::to_string(p) + ", " +
                 std::to_string(q));
    const BasisKind kind{.most_spans = 3, .highest_multiplicity = 3};
    const NurbsSurface surface =
        round % 2 == 0 ? random.Sheet(p, q, 1, kind) : random.Surface(p, q, round % 4 == 1, kind);
    ExpectWithin(surface, SizeOfBox(surface) * random.Logarithmic(0.005, 0.05), random);
  }
}

TEST(ChordToleranceTest, HoldsForNastySurfaces) {
  RandomSplines random(92);
  constexpr int kWithoutArea = 16;
  for (int kind = 0; kind < kNastyKinds; ++kind) {
    if (kind == kWithoutArea) continue;
    for (int round = 0; round < 6; ++round) {
      SCOPED_TRACE(std::to_string(kind) + " " + std::to_string(round));
      const NurbsSurface surface = NastySurface(kind, random);
      ExpectWithin(surface, SizeOfBox(surface) * random.Logarithmic(0.005, 0.03), random);
    }
  }
}

// Flat but for a spike, as narrow in the parameters as weights of 10^±3 make it.
NurbsSurface Spike(RandomSplines& random, int degree, double ratio) {
  const SplineBasis basis = SplineBasis::Uniform(degree, degree + 1, 0, 1);
  const int n = basis.size();
  Eigen::Matrix3Xd points(3, n * n);
  Eigen::VectorXd weights(n * n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      points.col(i * n + j) << i, j, i == n - 2 && j == n - 2 ? random.Real(1, 3) : 0;
      weights[i * n + j] = std::pow(ratio, -(i + j));
    }
  }
  return NurbsSurface(basis, basis, points, weights);
}

TEST(ChordToleranceTest, SpikesNarrowInASpanAreSeen) {
  RandomSplines random(93);
  for (int round = 0; round < 60; ++round) {
    const int degree = random.Integer(2, 5);
    const double ratio = random.Logarithmic(3, 1000);
    SCOPED_TRACE("degree " + std::to_string(degree) + ", weights fall by " + std::to_string(ratio));
    const NurbsSurface surface = Spike(random, degree, ratio);
    const double tolerance = SizeOfBox(surface) * random.Logarithmic(0.002, 0.02);
    const TriangleMesh mesh = Tessellate(surface, {.chord_tolerance = tolerance});
    // Its top, found by looking closely where it is.
    Eigen::Vector3d top = Eigen::Vector3d::Zero();
    for (int i = 0; i <= 400; ++i) {
      for (int j = 0; j <= 400; ++j) {
        const auto at = [&](int k) {
          return 1 / (1 + std::pow(ratio, -1) * std::exp((k - 200) * 0.06));
        };
        const Eigen::Vector3d point = surface.At(at(i), at(j));
        if (point[2] > top[2]) top = point;
      }
    }
    ASSERT_GT(top[2], 2 * tolerance);
    EXPECT_LE(DistanceFromMesh(top, mesh), tolerance);
    ExpectWithin(surface, tolerance, random, 50);
  }
}

TEST(ChordToleranceTest, HoldsInsideTrims) {
  RandomSplines random(94);
  for (int round = 0; round < 4; ++round) {
    const std::vector<LoopCase> cases = LoopCases(94 + round);
    for (const LoopCase& loops : cases) {
      SCOPED_TRACE(loops.name + " " + std::to_string(round));
      const NurbsSurface whole = round == 0
                                     ? MakeTorus(Frame(), 3, 1)
                                     : random.Sheet(random.Integer(1, 5), random.Integer(1, 5), 1);
      const NurbsSurface surface = Trimmed(whole, loops.loops);
      ExpectWithin(surface, SizeOfBox(surface) * random.Logarithmic(0.002, 0.02), random, 60);
    }
  }
}

TEST(ChordToleranceTest, HoldsFarFromTheOriginAndForRoundShapes) {
  RandomSplines random(95);
  const std::vector<NurbsSurface> shapes{MakeSphere(Frame(), 2),
                                         MakeTorus(Frame(), 3, 1),
                                         MakeCone(Frame(), 2, 0, {0, 3}),
                                         MakeCylinder(Frame(), 1, {0, 4}),
                                         random.Sheet(3, 3, 1)};
  for (const NurbsSurface& shape : shapes) {
    for (const double share : {0.03, 0.003, 0.0003}) {
      const NurbsSurface far = shape.Translated({5e5, -4e6, 1e3});
      ExpectWithin(far, share * SizeOfBox(far), random, 60);
    }
  }
}

// The bound itself, against places close together.
TEST(FlatnessBoundTest, IsNotBelowWhatTheSurfaceIsOffThePlane) {
  RandomSplines random(96);
  for (int round = 0; round < 200; ++round) {
    SCOPED_TRACE(round);
    const int p = random.Integer(1, 6), q = random.Integer(1, 6);
    const NurbsSurface surface =
        random.Surface(p,
                       q,
                       random.Coin(),
                       {.most_spans = 3, .highest_multiplicity = std::max(1, std::min(p, q) - 1)});
    const SplineBasis &u = surface.basis_u(), &v = surface.basis_v();
    // Of degree one, or with knots of full multiplicity, only inside one span.
    const bool smooth = p > 1 && q > 1;
    std::array<Eigen::Vector2d, 3> corners;
    const double reach = random.Logarithmic(1e-3, 1);
    const Eigen::Vector2d centre(random.Real(u.lower(), u.upper()),
                                 random.Real(v.lower(), v.upper()));
    for (Eigen::Vector2d& corner : corners) {
      corner[0] = std::clamp(centre[0] + random.Real(-reach, reach), u.lower(), u.upper());
      corner[1] = std::clamp(centre[1] + random.Real(-reach, reach), v.lower(), v.upper());
    }
    if (!smooth) continue;
    std::array<Eigen::Vector3d, 3> at;
    for (int e = 0; e < 3; ++e) at[e] = surface.At(corners[e][0], corners[e][1]);
    const Eigen::Vector3d cross = (at[1] - at[0]).cross(at[2] - at[0]);
    if (cross.norm() < kHalfDigits * (at[1] - at[0]).norm() * (at[2] - at[0]).norm()) continue;
    const Eigen::Vector3d normal = cross.normalized();
    FlatnessBound bound(surface);
    const double most = bound.Over(corners, normal, normal.dot(at[0]), 0).distance;
    double measured = 0;
    for (int k = 0; k < 500; ++k) {
      double a = random.Real(0, 1), b = random.Real(0, 1);
      if (a + b > 1) a = 1 - a, b = 1 - b;
      const Eigen::Vector2d place = (1 - a - b) * corners[0] + a * corners[1] + b * corners[2];
      measured = std::max(measured, std::abs(normal.dot(surface.At(place[0], place[1]) - at[0])));
    }
    EXPECT_LE(measured, most + kRounding * SizeOf(surface));
    // A looser bound at the first boxes is as true.
    EXPECT_GE(bound.Over(corners, normal, normal.dot(at[0]), HUGE_VAL).distance,
              measured - kRounding * SizeOf(surface));
  }
}

TEST(FlatnessBoundTest, TendsToTheBendOfSmallTriangles) {
  // A paraboloid z = (a x² + b y²) / 2, whose second derivatives are a and b everywhere.
  const SplineBasis basis = SplineBasis::Uniform(2, 3, 0, 1);
  Eigen::Matrix3Xd points(3, 9);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      points.col(3 * i + j) << i / 2.0, j / 2.0, (i == 2 ? 0.5 * 3 : 0) + (j == 2 ? 0.5 * -2 : 0);
    }
  }
  FlatnessBound bound(NurbsSurface(basis, basis, points));
  // Seen along z an edge along u of length h bends by 3 h² / 8, one along v by 2 h² / 8.
  const auto over = bound.Over(
      {Eigen::Vector2d(0.2, 0.3), {0.4, 0.3}, {0.2, 0.5}}, Eigen::Vector3d::UnitZ(), 0, 0);
  EXPECT_NEAR(over.bends[2], 3 * 0.04 / 8, kRounding);
  EXPECT_NEAR(over.bends[1], 2 * 0.04 / 8, kRounding);
}

}  // namespace
}  // namespace batten
