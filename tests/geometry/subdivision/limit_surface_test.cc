// SPDX-License-Identifier: MIT
#include "geometry/subdivision/limit_surface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "quad_nets.h"
#include "refusal.h"
#include "tolerances.h"

namespace batten::internal::limit_surface_test {

QuadTopology TopologyOf(const QuadMesh& mesh) { return QuadTopology(mesh); }

const std::vector<QuadMesh>& Meshes() {
  static const std::vector<QuadMesh> meshes = {Shaken(Cube(), 0.2, 1),
                                               Shaken(Torus(4, 5), 0.1, 2),
                                               Shaken(Prism(5), 0.1, 3),
                                               Shaken(Prism(8), 0.1, 4),
                                               Refined(Shaken(Prism(3), 0.1, 5))};
  return meshes;
}

// And ones with creases, their ends, corners of 90° and of 270°.
const std::vector<QuadMesh>& AllMeshes() {
  static const std::vector<QuadMesh> meshes = [] {
    std::vector<QuadMesh> all = Meshes();
    all.insert(all.end(),
               {Creased(Shaken(Cube(), 0.1, 1), 1),
                Shaken(Can(), 0.05, 2),
                Shaken(Creased(LBlock(), 1), 0.05, 3),
                Shaken(CreasedTorus(), 0.05, 4)});
    return all;
  }();
  return meshes;
}

template <typename Visit>
void ForPlaces(const QuadMesh& mesh, Visit visit) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int face = 0; face < mesh.faces.cols(); ++face) {
    for (int k = 0; k < 8; ++k) visit(face, unit(random), unit(random));
    visit(face, 1e-4, 2e-4);
    visit(face, 0.5, 0.5);
    visit(face, 0.25, 1.0);
  }
}

// Of the bicubic piece there, by which rounding of derivatives is divided.
double WidthAt(const LimitPlace& place) { return std::max(place.u, place.v) / 2; }

TEST(LimitStencilsTest, SumToOneAndTheirDerivativesToZero) {
  for (const QuadMesh& mesh : AllMeshes()) {
    const LimitStencils stencils(TopologyOf(mesh));
    ForPlaces(mesh, [&](int face, double u, double v) {
      const LimitPlace place = LimitStencils::PlaceOnFace(face, u, v);
      const Eigen::VectorXd sums = stencils.WeightsAt(place, 6).colwise().sum();
      EXPECT_NEAR(sums[0], 1, kRounding);
      const double width = WidthAt(place);
      EXPECT_LE(sums.segment(1, 2).cwiseAbs().maxCoeff(), kRounding / width);
      EXPECT_LE(sums.tail(3).cwiseAbs().maxCoeff(), kRounding / (width * width));
    });
  }
}

TEST(LimitStencilsTest, GiveTheJetsOfTheSurface) {
  for (const QuadMesh& mesh : AllMeshes()) {
    const LimitStencils stencils(TopologyOf(mesh));
    const LimitSurface surface(stencils, mesh.vertices);
    ForPlaces(mesh, [&](int face, double u, double v) {
      const LimitPlace place = LimitStencils::PlaceOnFace(face, u, v);
      const auto support = stencils.Support(place.patch);
      Eigen::Matrix3Xd points(3, Eigen::Index(support.size()));
      for (std::size_t k = 0; k < support.size(); ++k) {
        points.col(Eigen::Index(k)) = mesh.vertices.col(support[k]);
      }
      const Eigen::Matrix3Xd found = points * stencils.WeightsAt(place, 6);
      const SurfaceJet jet = surface.JetAt(place);
      Eigen::Matrix<double, 3, 6> expected;
      expected << jet.point, jet.du, jet.dv, jet.duu, jet.duv, jet.dvv;
      const Eigen::RowVectorXd error = (found - expected).cwiseAbs().colwise().maxCoeff();
      const double width = WidthAt(place);
      EXPECT_LE(error[0], kRounding * 10);
      EXPECT_LE(error.segment(1, 2).maxCoeff(), 10 * kRounding / width);
      EXPECT_LE(error.tail(3).maxCoeff(), 10 * kRounding / (width * width));
    });
  }
}

// The limit of a mesh is the limit of the mesh refined.
TEST(LimitSurfaceTest, IsThatOfTheRefinedMesh) {
  for (const QuadMesh& mesh : AllMeshes()) {
    const QuadMesh finer = Refined(mesh);
    const LimitStencils stencils(TopologyOf(mesh)), finer_stencils(TopologyOf(finer));
    const LimitSurface surface(stencils, mesh.vertices);
    const LimitSurface finer_surface(finer_stencils, finer.vertices);
    ForPlaces(mesh, [&](int face, double u, double v) {
      const LimitPlace place = LimitStencils::PlaceOnFace(face, u, v);
      // Patches are the faces of the refined mesh.
      const LimitPlace same = LimitStencils::PlaceOnFace(place.patch, place.u, place.v);
      const Eigen::Vector3d expected = finer_surface.At(same);
      EXPECT_LE((surface.At(place) - expected).norm(), kRounding * 10);
    });
  }
}

TEST(LimitSurfaceTest, DerivativesAreDifferences) {
  for (const QuadMesh& mesh : AllMeshes()) {
    const LimitStencils stencils(TopologyOf(mesh));
    const LimitSurface surface(stencils, mesh.vertices);
    constexpr double kStep = 1e-6;
    for (int patch = 0; patch < stencils.patches(); ++patch) {
      const LimitPlace at{patch, 0.31, 0.17};
      const SurfaceJet jet = surface.JetAt(at);
      const SurfaceJet right = surface.JetAt({patch, at.u + kStep, at.v});
      const SurfaceJet up = surface.JetAt({patch, at.u, at.v + kStep});
      EXPECT_LE(((right.point - jet.point) / kStep - jet.du).norm(), 1e2 * kHalfDigits);
      EXPECT_LE(((up.point - jet.point) / kStep - jet.dv).norm(), 1e2 * kHalfDigits);
      EXPECT_LE(((right.du - jet.du) / kStep - jet.duu).norm(), 1e3 * kHalfDigits);
      EXPECT_LE(((up.du - jet.du) / kStep - jet.duv).norm(), 1e3 * kHalfDigits);
      EXPECT_LE(((up.dv - jet.dv) / kStep - jet.dvv).norm(), 1e3 * kHalfDigits);
    }
  }
}

// Both sides of a crease have the same curve, a uniform cubic spline of its own points.
TEST(LimitSurfaceTest, HasTheCurveOfACreaseOnBothSides) {
  const QuadMesh mesh = Shaken(Can(2), 0.05, 5);
  const QuadTopology topology(mesh);
  const LimitStencils stencils(topology);
  const LimitSurface surface(stencils, mesh.vertices);
  int creases = 0;
  for (int h = 0; h < topology.half_edges(); ++h) {
    if (!topology.IsCrease(h)) continue;
    ++creases;
    const LimitPlace one{h, 0.3, 0}, other{QuadTopology::Next(topology.Twin(h)), 0, 0.3};
    EXPECT_LE((surface.At(one) - surface.At(other)).norm(), kRounding * 10);
    int before = h, after = topology.Outgoing(topology.Origin(QuadTopology::Next(h)));
    do {
      before = topology.Turned(before);
    } while (!topology.IsCrease(before));
    while (!topology.IsCrease(after) || after == topology.Twin(h)) after = topology.Turned(after);
    const auto weights = UniformCubic(0.15).value;
    Eigen::Vector3d expected = Eigen::Vector3d::Zero();
    const auto far = [&](int g) {
      return mesh.vertices.col(topology.Origin(QuadTopology::Next(g)));
    };
    expected += weights[0] * far(before) + weights[1] * mesh.vertices.col(topology.Origin(h)) +
                weights[2] * far(h) + weights[3] * far(after);
    EXPECT_LE((surface.At(one) - expected).norm(), kRounding * 10);
    // A step over the crease slides along it.
    const LimitPlace slid = surface.Moved({h, 0.3, 0.1}, 0.2, -0.3);
    EXPECT_EQ(slid.patch, h);
    EXPECT_NEAR(slid.u, 0.5, kRounding);
    EXPECT_EQ(slid.v, 0);
  }
  EXPECT_EQ(creases, 32);
}

// The closed masks of limit positions against deep refinement. [Halstead et al. 1993]
TEST(LimitSurfaceTest, MeetsTheLimitPointOfAVertex) {
  for (const QuadMesh& mesh : Meshes()) {
    const QuadTopology topology = TopologyOf(mesh);
    const LimitStencils stencils(topology);
    const LimitSurface surface(stencils, mesh.vertices);
    for (int face = 0; face < mesh.faces.cols(); ++face) {
      const int n = topology.Valence(mesh.faces(0, face));
      Eigen::Vector3d limit = mesh.vertices.col(mesh.faces(0, face)) * n / (n + 5.0);
      for (int k = 0, h = 4 * face; k < n; ++k, h = topology.Turned(h)) {
        const int next = QuadTopology::Next(h);
        limit += (4 * mesh.vertices.col(topology.Origin(next)) +
                  mesh.vertices.col(topology.Origin(QuadTopology::Next(next)))) /
                 (n * (n + 5.0));
      }
      // Evaluation ends 20 refinements beside the vertex, each of which shrinks its surroundings by
      // the subdominant eigenvalue. [Peters & Reif 2008, eq. 6.2]
      const double c = std::cos(2 * std::numbers::pi / n);
      const double shrinks = (c + 5 + std::sqrt((c + 1) * (c + 9))) / 16;
      EXPECT_LE((surface.At({4 * face, 0, 0}) - limit).norm(), 2 * std::pow(shrinks, 20));
    }
  }
}

TEST(LimitSurfaceTest, StepsAcrossBordersGoOnStraight) {
  for (const QuadMesh& mesh : Meshes()) {
    const LimitStencils stencils(TopologyOf(mesh));
    const LimitSurface surface(stencils, mesh.vertices);
    for (int patch = 0; patch < stencils.patches(); ++patch) {
      for (const auto& [du, dv] : {std::pair{0.1, 0.0}, {-0.1, 0.01}, {0.02, 0.1}, {0.01, -0.1}}) {
        const LimitPlace from{patch,
                              du > 0.05    ? 0.999
                              : du < -0.05 ? 0.001
                                           : 0.4,
                              dv > 0.05    ? 0.999
                              : dv < -0.05 ? 0.001
                                           : 0.4};
        const LimitPlace there = surface.Moved(from, 0.02 * du, 0.02 * dv);
        EXPECT_NE(there.patch, patch);
        const SurfaceJet jet = surface.JetAt(from);
        const Eigen::Vector3d foreseen = jet.point + 0.02 * du * jet.du + 0.02 * dv * jet.dv;
        EXPECT_LE((surface.At(there) - foreseen).norm(), 1e-4);
      }
    }
  }
}

TEST(QuadTopologyTest, RefinementKeepsTheEulerNumber) {
  for (const QuadMesh& mesh : Meshes()) {
    const QuadMeshSummary coarse = CheckQuadMesh(mesh), fine = CheckQuadMesh(Refined(mesh));
    EXPECT_EQ(coarse.genus, fine.genus);
    EXPECT_EQ(coarse.components, fine.components);
    EXPECT_EQ(coarse.extraordinary, fine.extraordinary);
  }
  EXPECT_EQ(CheckQuadMesh(Cube()).genus, 0);
  EXPECT_EQ(CheckQuadMesh(Torus(4, 5)).genus, 1);
  EXPECT_NEAR(CheckQuadMesh(Cube()).volume, 8, kRounding);
}

std::string RefusalOfMesh(const QuadMesh& mesh) {
  return RefusalOf([&] { CheckQuadMesh(mesh); });
}

TEST(QuadTopologyTest, NamesWhatIsWrong) {
  using testing::HasSubstr;
  QuadMesh open = Cube();
  open.faces.conservativeResize(4, 5);
  EXPECT_THAT(RefusalOfMesh(open), HasSubstr("the mesh is open: the edge from vertex"));
  QuadMesh turned = Cube();
  turned.faces.col(2).reverseInPlace();
  EXPECT_THAT(RefusalOfMesh(turned), HasSubstr("turned differently"));
  QuadMesh inside_out = Cube();
  for (int f = 0; f < 6; ++f) inside_out.faces.col(f).reverseInPlace();
  EXPECT_THAT(RefusalOfMesh(inside_out), HasSubstr("clockwise seen from outside"));
  QuadMesh pinched;
  pinched.vertices.resize(3, 15);
  pinched.vertices << Cube().vertices,
      (Cube().vertices.colwise() + Eigen::Vector3d(2, 2, 2)).rightCols(7);
  pinched.faces.resize(4, 12);
  // The second cube's first vertex is the last of the first one.
  const Eigen::Matrix4Xi second = Cube().faces.unaryExpr([](int v) { return v == 0 ? 7 : v + 7; });
  pinched.faces << Cube().faces, second;
  EXPECT_THAT(RefusalOfMesh(pinched), HasSubstr("at vertex 8 several sheets touch"));
  QuadMesh twice = Cube();
  twice.faces(1, 0) = twice.faces(0, 0);
  EXPECT_THAT(RefusalOfMesh(twice), HasSubstr("face 1 has vertex 1 twice"));
  QuadMesh missing = Cube();
  missing.faces(1, 3) = 8;
  EXPECT_THAT(RefusalOfMesh(missing), HasSubstr("face 4 names a vertex that is not there"));
}

}  // namespace batten::internal::limit_surface_test
