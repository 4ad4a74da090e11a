// SPDX-License-Identifier: MIT
// Solids as STEP: what is written is proved, what can't be proved is not written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <GProp_GProps.hxx>
#include <STEPControl_Reader.hxx>
#include <TopExp_Explorer.hxx>
#include <string>

#include "batten/io/read_error.h"
#include "batten/io/solid_writer.h"
#include "batten/io/step_reader.h"
#include "body_clouds.h"
#include "geometry/subdivision/spline_faces.h"
#include "temporary_folder.h"
#include "tolerances.h"

namespace batten::internal::solid_export_test {

using ::testing::HasSubstr;
using ::testing::Not;

SolidModel SolidOf(const QuadMesh& mesh) {
  const QuadTopology topology(mesh.faces, static_cast<int>(mesh.vertices.cols()));
  return SplineSolid(topology, mesh.vertices, MotorcycleBlocks(topology));
}

TEST(SolidExportTest, IsOneValidSolidOfTheSameVolume) {
  for (const QuadMesh& mesh : {Cube(), Torus(6, 5), Shaken(Prism(5), 0.05, 3), CubeSphere(2)}) {
    const TemporaryFolder folder;
    const SolidModel solid = SolidOf(mesh);
    WriteSolid(solid, folder.File("a.step"));
    EXPECT_THAT(folder.Text("a.step"), HasSubstr("MANIFOLD_SOLID_BREP"));
    EXPECT_EQ(ReadStep(folder.File("a.step")).size(), solid.faces.size());
    STEPControl_Reader reader;
    ASSERT_EQ(reader.ReadFile(folder.File("a.step").c_str()), IFSelect_RetDone);
    reader.TransferRoots();
    int solids = 0;
    for (TopExp_Explorer one(reader.OneShape(), TopAbs_SOLID); one.More(); one.Next(), ++solids) {
      EXPECT_TRUE(BRepCheck_Analyzer(one.Current()).IsValid());
      GProp_GProps properties;
      // By default its quadrature is right to 2e-6 only.
      BRepGProp::VolumeProperties(one.Current(), properties, 1e-8);
      const double volume = AuditSolid(solid).volume;
      EXPECT_NEAR(properties.Mass(), volume, kHalfDigits * volume);
    }
    EXPECT_EQ(solids, 1);
  }
}

// The reader that proves a solid would try for ever.
TEST(SolidExportTest, ABodyTooSmallForStepIsRefused) {
  const TemporaryFolder folder;
  QuadMesh ball = CubeSphere(2);
  ball.vertices *= 6e-5;
  try {
    WriteSolid(SolidOf(ball), folder.File("a.step"));
    FAIL() << "not refused";
  } catch (const WriteError& error) {
    EXPECT_THAT(error.what(), HasSubstr("use a smaller unit"));
  }
  ball.vertices *= 10;
  WriteSolid(SolidOf(ball), folder.File("a.step"));
}

TEST(SolidExportTest, SeveralBodiesAreSeveralSolids) {
  QuadMesh two;
  two.vertices.resize(3, 16);
  two.vertices << Cube().vertices, Cube().vertices.colwise() + Eigen::Vector3d(5, 0, 0);
  two.faces.resize(4, 12);
  two.faces << Cube().faces, (Cube().faces.array() + 8).matrix();
  const TemporaryFolder folder;
  WriteSolid(SolidOf(two), folder.File("a.step"));
  const std::string text = folder.Text("a.step");
  std::size_t solids = 0;
  for (std::size_t at = 0; (at = text.find("MANIFOLD_SOLID_BREP(", at)) != text.npos; ++at)
    ++solids;
  EXPECT_EQ(solids, 2u);
}

TEST(SolidExportTest, AnOpenModelIsAShellWithItsBorders) {
  const TemporaryFolder folder;
  const SolidModel solid = SolidOf(CubeSphere(2));
  std::vector<char> left_out(solid.faces.size(), 0);
  left_out[0] = 1;
  const SolidModel shell = solid.Without(left_out);
  const SolidAudit audit = AuditSolid(shell);
  EXPECT_EQ(shell.faces.size() + 1, solid.faces.size());
  EXPECT_EQ(shell.edges.size(), solid.edges.size());
  EXPECT_EQ(audit.open_edges, std::ssize(solid.faces[0].loop));
  EXPECT_GT(audit.open_length, 0);
  WriteSolid(shell, folder.File("a.step"));
  EXPECT_THAT(folder.Text("a.step"), HasSubstr("OPEN_SHELL"));
  EXPECT_THAT(folder.Text("a.step"), Not(HasSubstr("MANIFOLD_SOLID_BREP")));
  const GeometryContents read = ReadStepContents(folder.File("a.step"));
  ASSERT_EQ(read.bodies.size(), 1u);
  EXPECT_FALSE(read.bodies[0].solid);
  EXPECT_EQ(std::ssize(read.bodies[0].free_edges), audit.open_edges);
  SolidModel doubled = shell;  // its edges belong to four faces
  for (const SolidFace& face : shell.faces) doubled.faces.push_back(face);
  EXPECT_THROW(WriteSolid(doubled, folder.File("b.step")), WriteError);
}

TEST(SolidExportTest, LeavesNoFileOfWhatIsNoSolid) {
  const TemporaryFolder folder;
  const auto error = [&](const SolidModel& solid) {
    try {
      WriteSolid(solid, folder.File("bad.step"));
    } catch (const WriteError& refusal) {
      return std::string(refusal.what());
    }
    return std::string();
  };
  SolidModel open = SolidOf(Cube());
  open.faces.pop_back();
  EXPECT_THAT(error(open), HasSubstr("the solid is not valid"));
  SolidModel doubled = SolidOf(Cube());  // its edges belong to four faces
  for (const SolidFace& face : SolidOf(Cube()).faces) doubled.faces.push_back(face);
  EXPECT_THAT(error(doubled), HasSubstr("the solid is not valid"));
  SolidModel moved = SolidOf(Cube());
  moved.faces[0].surface = moved.faces[0].surface.Translated({0, 0, 0.1});
  EXPECT_THAT(error(moved), HasSubstr("not valid"));
  SolidModel inside_out = SolidOf(Cube());
  for (Eigen::Index k = 0; k < inside_out.vertices.cols(); ++k) inside_out.vertices.col(k) *= -1;
  for (SolidEdge& edge : inside_out.edges) {
    edge.curve = NurbsCurve<3>(edge.curve.basis(), -edge.curve.control_points());
  }
  for (SolidFace& face : inside_out.faces) {
    face.surface = NurbsSurface(
        face.surface.basis_u(), face.surface.basis_v(), -face.surface.control_points());
  }
  EXPECT_THAT(error(inside_out), HasSubstr("the solid is inside out"));
  EXPECT_EQ(folder.Text("bad.step"), "");
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  EXPECT_THROW(WriteSolid(SolidOf(Cube()), folder.File("a.json")), UsageError);
}

}  // namespace batten::internal::solid_export_test
