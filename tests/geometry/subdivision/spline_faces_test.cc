// SPDX-License-Identifier: MIT
#include "geometry/subdivision/spline_faces.h"

#include <gtest/gtest.h>

#include <numbers>
#include <set>
#include <vector>

#include "geometry/subdivision/limit_surface.h"
#include "geometry/subdivision/smooth_corner.h"
#include "quad_nets.h"
#include "tolerances.h"

namespace batten::internal::spline_faces_test {

QuadTopology TopologyOf(const QuadMesh& mesh) { return QuadTopology(mesh); }

const std::vector<QuadMesh>& Meshes() {
  static const std::vector<QuadMesh> meshes = {Shaken(Cube(), 0.2, 1),
                                               Shaken(Torus(4, 5), 0.1, 2),
                                               Shaken(Prism(5), 0.1, 3),
                                               Shaken(Prism(6), 0.05, 6),
                                               Shaken(Prism(8), 0.02, 4),
                                               Refined(Shaken(Prism(3), 0.1, 5)),
                                               Refined(Refined(Shaken(Cube(), 0.2, 9)))};
  return meshes;
}

// With creases, their ends, corners of 90° and of 270°, and where one ends at the side of another.
const std::vector<QuadMesh>& CreasedMeshes() {
  static const std::vector<QuadMesh> meshes = {Creased(Shaken(Cube(), 0.2, 1), 1),
                                               Shaken(Can(), 0.05, 2),
                                               Shaken(Can(3), 0.03, 3),
                                               Shaken(Refined(Creased(LBlock(), 1)), 0.02, 4),
                                               Shaken(CreasedTorus(), 0.05, 5)};
  return meshes;
}

std::vector<QuadMesh> AllMeshes() {
  std::vector<QuadMesh> all = Meshes();
  all.insert(all.end(), CreasedMeshes().begin(), CreasedMeshes().end());
  return all;
}

// 1e-9 of a radian: rounding of normals where the parameters' directions are 1 : 50.
constexpr double kSmooth = 1e-9;

TEST(SplineSolidTest, IsClosedAndSmoothOverEveryEdge) {
  for (const QuadMesh& mesh : AllMeshes()) {
    const QuadTopology topology = TopologyOf(mesh);
    for (const auto& blocks : {SingleBlocks(topology), MotorcycleBlocks(topology)}) {
      const SolidModel solid = SplineSolid(topology, mesh.vertices, blocks);
      const SolidAudit audit = AuditSolid(solid);
      EXPECT_EQ(audit.open_edges, 0);
      EXPECT_LE(audit.gap, kRounding * 10);
      EXPECT_LE(audit.edge_angle, kSmooth);
      EXPECT_GT(audit.volume, 0);
    }
  }
}

TEST(SplineSolidTest, FewerFacesAreTheSameSolid) {
  for (const QuadMesh& mesh : AllMeshes()) {
    const QuadTopology topology = TopologyOf(mesh);
    const SolidModel many = SplineSolid(topology, mesh.vertices, SingleBlocks(topology));
    const SolidModel few = SplineSolid(topology, mesh.vertices, MotorcycleBlocks(topology));
    EXPECT_LE(few.faces.size(), many.faces.size());
    const SolidAudit a = AuditSolid(many), b = AuditSolid(few);
    EXPECT_NEAR(a.volume, b.volume, kRounding * 10 * a.volume);
    EXPECT_NEAR(a.area, b.area, 1e-5 * a.area);
    // Of closed surfaces: V − E + F is that of the mesh.
    const auto euler = [](const SolidModel& solid) {
      return static_cast<int>(solid.vertices.cols()) - static_cast<int>(solid.edges.size()) +
             static_cast<int>(solid.faces.size());
    };
    EXPECT_EQ(euler(few), topology.vertices() - topology.edges() + topology.faces());
  }
}

TEST(SplineSolidTest, IsTheSameOfASubdividedMesh) {
  for (const QuadMesh& mesh : AllMeshes()) {
    const QuadTopology topology = TopologyOf(mesh);
    const SubdividedMesh finer = Subdivided(topology);
    const std::vector<QuadBlock> blocks = MotorcycleBlocks(topology);
    const SolidModel coarse = SplineSolid(topology, mesh.vertices, blocks);
    const SolidModel fine = SplineSolid(
        finer.topology, Combined(finer.stencils, mesh.vertices), SubdividedBlocks(blocks), 1);
    ASSERT_EQ(fine.faces.size(), coarse.faces.size());
    EXPECT_EQ(fine.edges.size(), coarse.edges.size());
    for (std::size_t f = 0; f < fine.faces.size(); ++f) {
      const NurbsSurface &one = fine.faces[f].surface, &other = coarse.faces[f].surface;
      ASSERT_EQ(one.control_points().cols(), other.control_points().cols());
      EXPECT_LE((one.control_points() - other.control_points()).cwiseAbs().maxCoeff(),
                10 * kRounding);
      EXPECT_EQ(one.basis_u().knots(), other.basis_u().knots());
    }
    EXPECT_THROW(SplineSolid(topology, mesh.vertices, SingleBlocks(topology), 1),
                 std::invalid_argument);
  }
}

// Away from corners of other than four edges faces are the limit surface itself.
TEST(SplineSolidTest, FollowsTheLimitSurface) {
  for (const QuadMesh& mesh : AllMeshes()) {
    const QuadTopology topology = TopologyOf(mesh);
    const LimitStencils stencils(topology);
    const LimitSurface surface(stencils, mesh.vertices);
    const SolidModel solid = SplineSolid(topology, mesh.vertices, SingleBlocks(topology));
    for (int face = 0; face < topology.faces(); ++face) {
      for (const auto& [u, v] : {std::pair{0.5, 0.5}, {0.26, 0.1}, {0.1, 0.3}, {0.6, 0.97}}) {
        const Eigen::Vector3d expected = surface.At(LimitStencils::PlaceOnFace(face, u, v));
        const Eigen::Vector3d found = solid.faces[face].surface.At(4 * u, 4 * v);
        EXPECT_LE((found - expected).norm(), kRounding * 10);
      }
      // Beside the corner at least as a shape, for parameters run differently; but for ends of
      // creases, where the limit surface has no tangent plane.
      if (topology.Creases(mesh.faces(0, face)) == 1) continue;
      const SurfaceJet corner = surface.JetAt(LimitStencils::PlaceOnFace(face, 0.05, 0.05));
      const Eigen::Vector3d off = solid.faces[face].surface.At(0.2, 0.2) - corner.point;
      const Eigen::Vector3d normal = corner.du.cross(corner.dv).normalized();
      EXPECT_LE(mesh.creases.cols() == 0 ? off.norm() : std::abs(off.dot(normal)), 0.05);
    }
  }
}

TEST(SplineSolidTest, IsExactWhereFacesAreFlat) {
  const auto solid_of = [](const QuadMesh& mesh) {
    const QuadTopology topology(mesh);
    return SplineSolid(topology, mesh.vertices, MotorcycleBlocks(topology));
  };
  const SolidModel box = solid_of(Creased(Cube(), 1));
  const SolidAudit of_box = AuditSolid(box);
  EXPECT_EQ(box.faces.size(), 6u);
  EXPECT_EQ(of_box.sharp_edges, 12);
  EXPECT_NEAR(of_box.sharp_length, 24, kRounding * 100);
  EXPECT_NEAR(of_box.volume, 8, kRounding * 100);
  EXPECT_NEAR(of_box.least_sharp, std::numbers::pi / 2, kRounding);
  EXPECT_NEAR(of_box.greatest_sharp, std::numbers::pi / 2, kRounding);
  for (const QuadMesh& mesh : {Creased(LBlock(), 1), Refined(Creased(LBlock(), 1))}) {
    const SolidAudit block = AuditSolid(solid_of(mesh));
    EXPECT_NEAR(block.volume, 3, kIterated);
    EXPECT_NEAR(block.area, 14, kIterated);
    EXPECT_LE(block.turn, kHalfDigits);  // no fold
  }
}

TEST(SmoothCornerTest, KeepsConstants) {
  for (const int valence : {3, 5, 6, 7, 8, 11}) {
    const SmoothCorner corner({{valence, false, false}, 2 * std::numbers::pi});
    const Eigen::VectorXd sums = corner.mask().rowwise().sum();
    EXPECT_LE((sums.array() - 1).abs().maxCoeff(), kIterated) << valence;
  }
  for (const CornerKind& kind : {CornerKind{{3, true, false}, std::numbers::pi},
                                 CornerKind{{3, true, true}, 1.5 * std::numbers::pi},
                                 CornerKind{{4, true, true}, 2 * std::numbers::pi}}) {
    const Eigen::VectorXd sums = SmoothCorner(kind).mask().rowwise().sum();
    EXPECT_LE((sums.array() - 1).abs().maxCoeff(), kIterated) << kind.angle;
  }
}

// Negative weights carry coefficients out of the hull of their net. What the conditions leave free
// must not: least squares alone, without the third derivatives, oscillate to 0.058 and 0.070 of the
// size at valences 8 and 11.
TEST(SmoothCornerTest, StaysInTheHullOfItsNetButForATwentieth) {
  constexpr double kOutside = 0.05;
  for (const int valence : {3, 5, 6, 7, 8, 11}) {
    const SmoothCorner corner({{valence, false, false}, 2 * std::numbers::pi});
    const Eigen::VectorXd outside = (-corner.mask()).cwiseMax(0).rowwise().sum();
    EXPECT_LE(outside.maxCoeff(), kOutside) << valence;
  }
}

TEST(MotorcycleBlocksTest, CoverEveryFaceOnceAndMergeRegularOnes) {
  for (const QuadMesh& mesh : Meshes()) {
    const QuadTopology topology = TopologyOf(mesh);
    int covered = 0;
    for (const QuadBlock& block : MotorcycleBlocks(topology)) covered += block.across * block.along;
    EXPECT_EQ(covered, topology.faces());
  }
  // None closes on itself, as those that go round a torus would.
  for (const QuadMesh& mesh : {Torus(4, 5), Torus(6, 3), Refined(Torus(3, 3))}) {
    const QuadTopology topology = TopologyOf(mesh);
    const std::vector<QuadBlock> blocks = MotorcycleBlocks(topology);
    EXPECT_LT(static_cast<int>(blocks.size()), topology.faces());
    for (const SolidFace& face : SplineSolid(topology, mesh.vertices, blocks).faces) {
      std::set<int> edges;
      for (const SolidCoedge& coedge : face.loop) EXPECT_TRUE(edges.insert(coedge.edge).second);
    }
  }
  const QuadMesh fine = Refined(Refined(Cube()));
  EXPECT_EQ(MotorcycleBlocks(TopologyOf(fine)).size(), 6u);
}

}  // namespace batten::internal::spline_faces_test
