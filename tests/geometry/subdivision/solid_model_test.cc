// SPDX-License-Identifier: MIT
// Laws of the audit of solids: what is wrong by a known amount is found to be wrong by it.
#include "batten/geometry/solid_model.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "geometry/subdivision/spline_faces.h"
#include "quad_nets.h"
#include "tolerances.h"

namespace batten::internal::solid_model_test {

SolidModel Rounded(const QuadMesh& mesh) {
  const QuadTopology topology(mesh.faces, static_cast<int>(mesh.vertices.cols()));
  return SplineSolid(topology, mesh.vertices, MotorcycleBlocks(topology));
}

NurbsSurface Flat(const Eigen::Vector3d& corner,
                  const Eigen::Vector3d& u,
                  const Eigen::Vector3d& v) {
  const SplineBasis line(1, {0, 0, 1, 1});
  Eigen::Matrix3Xd net(3, 4);
  net << corner, corner + v, corner + u, corner + u + v;
  return NurbsSurface(line, line, net);
}

TEST(AuditSolidTest, ABoxHasItsVolumeAndAreaWhereverItLies) {
  const Eigen::Vector3d x(2, 0, 0), y(0, 3, 0), z(0, 0, 5);
  for (const Eigen::Vector3d& low : {Eigen::Vector3d(-1, -1.5, -2.5), Eigen::Vector3d(7, 4, 9)}) {
    SolidModel box;
    for (const auto& [u, v, w] : {std::array{x, y, z}, std::array{y, z, x}, std::array{z, x, y}}) {
      box.faces.push_back({Flat(low + w, u, v), {}});
      box.faces.push_back({Flat(low, v, u), {}});
    }
    const SolidAudit audit = AuditSolid(box);
    EXPECT_NEAR(audit.volume, 30, 30 * kRounding);
    EXPECT_NEAR(audit.area, 62, 62 * kRounding);
    EXPECT_LE(audit.turn, kRounding);
  }
}

TEST(AuditSolidTest, FindsByHowMuchAFaceIsOff) {
  const Eigen::Vector3d off(0.01, -0.02, 0.005);
  for (const QuadMesh& mesh : {Cube(), Torus(5, 4)}) {
    SolidModel solid = Rounded(mesh);
    solid.faces.back().surface = solid.faces.back().surface.Translated(off);
    const SolidAudit audit = AuditSolid(solid);
    EXPECT_NEAR(audit.gap, off.norm(), kRounding * 10);
    EXPECT_EQ(audit.open_edges, 0);
  }
}

TEST(AuditSolidTest, FindsFoldsAndWhere) {
  // In a plane a fold turns at once: a vertex beyond the one beside it.
  QuadMesh folded = Refined(Refined(Cube()));
  folded.vertices.colwise() -= folded.vertices.rowwise().mean();
  for (auto vertex : folded.vertices.colwise()) vertex /= vertex.cwiseAbs().maxCoeff();
  EXPECT_LE(AuditSolid(Rounded(folded)).turn, 1);
  for (const double side : {-1.0, 1.0}) {
    QuadMesh one = folded;
    int inner = 0;
    (one.vertices.topRows(2).colwise().norm() + (one.vertices.row(2).array() - side).abs().matrix())
        .minCoeff(&inner);
    one.vertices(0, inner) += 1.5;
    const SolidAudit audit = AuditSolid(Rounded(one));
    EXPECT_GT(audit.turn, 2.5);
    // Between the vertex's places, beside no other.
    EXPECT_NEAR(audit.turn_at[0], 0.75, 0.75);
    EXPECT_NEAR(audit.turn_at[1], 0, 0.5);
    EXPECT_NEAR(audit.turn_at[2], side, kRounding);
  }
}

TEST(AuditSolidTest, FindsTheAngleOfFacesAndWhere) {
  for (const double angle : {1e-6, 0.1, 1.5, 3.0}) {
    const Eigen::Vector3d y = Eigen::Vector3d::UnitY();
    const Eigen::Vector3d aside(-std::cos(angle), 0, std::sin(angle));
    SolidModel fold;
    fold.vertices.resize(3, 2);
    fold.vertices << Eigen::Vector3d::Zero(), y;
    fold.edges.push_back({NurbsCurve<3>(SplineBasis(1, {0, 0, 1, 1}), fold.vertices), 0, 1});
    fold.faces.push_back({Flat({0, 0, 0}, {1, 0, 0}, y), {{0, true, {0, 0}, {0, 1}}}});
    fold.faces.push_back({Flat({0, 0, 0}, y, aside), {{0, false, {0, 0}, {1, 0}}}});
    const SolidAudit audit = AuditSolid(fold);
    EXPECT_NEAR(audit.edge_angle, angle, kRounding);
    EXPECT_LE(audit.gap, kRounding);
    EXPECT_LE(audit.edge_angle_at.head<1>().norm() + audit.edge_angle_at.tail<1>().norm(),
              kRounding);
    EXPECT_EQ(audit.open_edges, 0);
  }
}

TEST(AuditSolidTest, CountsEdgesThatAreNotOfTwoFacesInOppositeDirections) {
  const SolidModel whole = Rounded(Cube());
  EXPECT_EQ(AuditSolid(whole).open_edges, 0);
  SolidModel open = whole;
  open.faces.pop_back();
  EXPECT_EQ(AuditSolid(open).open_edges, static_cast<int>(whole.faces.back().loop.size()));
  SolidModel turned = whole;
  SolidCoedge& coedge = turned.faces[0].loop[1];
  coedge.reversed = !coedge.reversed;
  EXPECT_EQ(AuditSolid(turned).open_edges, 1);
  SolidModel twice = whole;
  twice.faces.push_back(twice.faces[0]);
  EXPECT_EQ(AuditSolid(twice).open_edges, static_cast<int>(whole.faces[0].loop.size()));
}

}  // namespace batten::internal::solid_model_test
