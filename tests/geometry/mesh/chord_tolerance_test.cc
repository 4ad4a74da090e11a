// SPDX-License-Identifier: MIT
// The chord tolerance holds both ways, measured at random places of the mesh and of the surface.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "batten/geometry/bounding_box.h"
#include "batten/geometry/foot_point.h"
#include "batten/geometry/make_surface.h"
#include "batten/geometry/surface_evaluator.h"
#include "batten/geometry/tessellate.h"
#include "batten/geometry/trim_region.h"
#include "cases.h"
#include "nasty_surfaces.h"
#include "random_splines.h"
#include "tolerances.h"
#include "trim_cases.h"

namespace batten::internal::chord_tolerance_test {

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
    const SurfaceFoot foot = feet.Nearest(place);
    double distance = foot.distance;
    if (foot.lower_bound == 0) {  // not certified: weights that differ by ten orders and more
      for (int i = 0; i <= 20; ++i) {
        for (int j = 0; j <= 20 - i && distance > 0; ++j) {
          const auto& p = local.parameters;
          const Eigen::Vector2d at =
              ((20 - i - j) * p.col(t[0]) + i * p.col(t[1]) + j * p.col(t[2])) / 20;
          distance = std::min(distance, LocalFootPoint(near, place, at[0], at[1]).distance);
        }
      }
    }
    worst.of_mesh = std::max(worst.of_mesh, distance);
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

// Returns false, without a look, where more triangles are needed than this test has time for.
bool ExpectWithin(const NurbsSurface& surface,
                  double tolerance,
                  RandomSplines& random,
                  int count = 40) {
  TriangleMesh mesh;
  try {
    mesh = Tessellate(surface, {.chord_tolerance = tolerance, .max_triangles = 60000});
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("needs more than"), std::string::npos);
    return false;
  }
  EXPECT_GT(mesh.triangles.cols(), 0);
  const Worst worst = Measured(surface, mesh, random, count);
  EXPECT_LE(worst.of_mesh, tolerance);
  EXPECT_LE(worst.of_surface, tolerance);
  return true;
}

// In part of what the foot search and rounding leave, against the size.
double SizeOfBox(const NurbsSurface& surface) { return BoundingBox(surface).diagonal().norm(); }

TEST(ChordToleranceTest, HoldsForRandomSurfacesOfEveryDegree) {
  RandomSplines random(91);
  const int rounds = Cases(80);
  int measured = 0;
  for (int round = 0; round < rounds; ++round) {
    const int p = random.Integer(1, 9), q = random.Integer(1, 9);
    SCOPED_TRACE(std::to_string(round) + ": degrees " + std::to_string(p) + ", " +
                 std::to_string(q));
    const BasisKind kind{.most_spans = 3, .highest_multiplicity = 3};
    const NurbsSurface surface =
        round % 2 == 0 ? random.Sheet(p, q, 1, kind) : random.Surface(p, q, round % 4 == 1, kind);
    measured += ExpectWithin(surface, SizeOfBox(surface) * random.Logarithmic(0.005, 0.05), random);
  }
  EXPECT_GT(measured, rounds * 9 / 10);
}

// Without those that have no area, and those whose random nets close or lie in a plane: these fold
// on themselves inside single spans, which is looked for at seven places of a triangle only.
TEST(ChordToleranceTest, HoldsForNastySurfaces) {
  RandomSplines random(92);
  constexpr int kPeriodic = 11, kInAPlane = 15, kWithoutArea = 16, kClosed = 17;
  const int rounds = Cases(2);
  int measured = 0, all = 0;
  for (int kind = 0; kind < kNastyKinds; ++kind) {
    if (kind == kPeriodic || kind == kInAPlane || kind == kWithoutArea || kind == kClosed) continue;
    for (int round = 0; round < rounds; ++round, ++all) {
      SCOPED_TRACE(std::to_string(kind) + " " + std::to_string(round));
      const NurbsSurface surface = NastySurface(kind, random);
      measured +=
          ExpectWithin(surface, SizeOfBox(surface) * random.Logarithmic(0.005, 0.03), random);
    }
  }
  EXPECT_GT(measured, all * 9 / 10);
}

// Flat but for a spike, as narrow in the parameters as weights of 10^3 to 10^8 make it.
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
    const double ratio = std::pow(random.Logarithmic(1e3, 1e8), 0.5 / degree);
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
    EXPECT_TRUE(ExpectWithin(surface, tolerance, random, 50));
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
      const NurbsSurface surface = Trimmed(whole, loops);
      EXPECT_TRUE(
          ExpectWithin(surface, SizeOfBox(surface) * random.Logarithmic(0.002, 0.02), random, 60));
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
      EXPECT_TRUE(ExpectWithin(far, share * SizeOfBox(far), random, 60));
    }
  }
}

}  // namespace batten::internal::chord_tolerance_test
