// SPDX-License-Identifier: MIT
// Meshes of the solids of files: watertight across their faces.
#include <gtest/gtest.h>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepFilletAPI_MakeFillet.hxx>
#include <BRepGProp.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <GProp_GProps.hxx>
#include <STEPControl_Writer.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <gp_Ax2.hxx>

#include <fstream>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "batten/geometry/tessellate.h"
#include "batten/io/geometry_file.h"
#include "batten/io/solid_writer.h"
#include "body_clouds.h"
#include "geometry/subdivision/spline_faces.h"
#include "shell_laws.h"
#include "temporary_folder.h"

namespace batten::internal::shell_mesh_test {

struct Part {
  std::string name;
  TopoDS_Shape shape;
};

TopoDS_Shape Rounded(const TopoDS_Shape& shape, double radius) {
  BRepFilletAPI_MakeFillet fillet(shape);
  for (TopExp_Explorer edges(shape, TopAbs_EDGE); edges.More(); edges.Next()) {
    fillet.Add(radius, TopoDS::Edge(edges.Current()));
  }
  return fillet.Shape();
}

std::vector<Part> Parts() {
  const gp_Ax2 across({1, 1, -1}, {0.1, 0.2, 1});
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(3, 2, 1).Shape();
  gp_Trsf mirror, far;
  mirror.SetMirror(gp_Ax2({5, 0, 0}, {1, 0, 0}));
  far.SetTranslation({5e6, 4e5, 100});
  const TopoDS_Shape drilled =
      BRepAlgoAPI_Cut(box, BRepPrimAPI_MakeCylinder(across, 0.4, 4).Shape()).Shape();
  return {
      {"box", box},
      {"cylinder", BRepPrimAPI_MakeCylinder(1, 2).Shape()},
      {"cone", BRepPrimAPI_MakeCone(1, 0, 2).Shape()},
      {"sphere", BRepPrimAPI_MakeSphere(2).Shape()},
      {"torus", BRepPrimAPI_MakeTorus(3, 1).Shape()},
      {"drilled box", drilled},
      {"drilled box, mirrored", BRepBuilderAPI_Transform(drilled, mirror, true).Shape()},
      {"drilled box, far away", BRepBuilderAPI_Transform(drilled, far).Shape()},
      {"ball with a pipe",
       BRepAlgoAPI_Fuse(BRepPrimAPI_MakeSphere(2).Shape(),
                        BRepPrimAPI_MakeCylinder(gp_Ax2({0.3, 0, 0}, {0, 0, 1}), 0.7, 4).Shape())
           .Shape()},
      {"hollow ball",
       BRepAlgoAPI_Cut(BRepPrimAPI_MakeSphere(2).Shape(), BRepPrimAPI_MakeSphere(1).Shape())
           .Shape()},
      {"rounded box", Rounded(box, 0.2)},
      {"drilled through a wall twice",
       BRepAlgoAPI_Cut(BRepPrimAPI_MakeCylinder(2, 5).Shape(),
                       BRepPrimAPI_MakeCylinder(gp_Ax2({0, -3, 2}, {0, 1, 0}), 1, 6).Shape())
           .Shape()}};
}

std::string Saved(const TemporaryFolder& folder, const Part& part, bool step) {
  if (step) {
    STEPControl_Writer writer;
    writer.Transfer(part.shape, STEPControl_AsIs);
    writer.Write(folder.File("a.step").c_str());
    return folder.File("a.step");
  }
  std::ofstream stream(folder.File("a.brep"));
  BRepTools::Write(part.shape, stream);
  return folder.File("a.brep");
}

std::vector<NurbsSurface> SurfacesOf(const GeometryContents& contents, const GeometryBody& body) {
  std::vector<NurbsSurface> surfaces;
  for (const size_t k : body.surfaces)
    surfaces.push_back(std::get<NurbsSurface>(contents.geometry[k]));
  return surfaces;
}

GProp_GProps Volume(const TopoDS_Shape& shape) {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(shape, properties, 1e-6);
  return properties;
}

double AreaOf(const TopoDS_Shape& shape) {
  GProp_GProps properties;
  BRepGProp::SurfaceProperties(shape, properties, 1e-6);
  return properties.Mass();
}

TEST(ShellMeshTest, SolidsOfFilesAreWatertightWithTheirVolume) {
  for (const Part& part : Parts()) {
    for (const bool step : {true, false}) {
      const TemporaryFolder folder;
      const GeometryContents contents = ReadGeometryContents(Saved(folder, part, step));
      ASSERT_EQ(contents.bodies.size(), 1U) << part.name;
      const std::vector<NurbsSurface> surfaces = SurfacesOf(contents, contents.bodies[0]);
      for (const double tolerance : {0.3, 0.03, 0.003}) {
        SCOPED_TRACE(part.name + (step ? ".step " : ".brep ") + std::to_string(tolerance));
        const ShellMesh mesh =
            TessellateShell(surfaces, contents.bodies[0].borders, {.chord_tolerance = tolerance});
        ExpectWatertight(mesh);
        ExpectNear(mesh, surfaces, tolerance, 30);
        EXPECT_LE(mesh.gap, tolerance / 4);
        const double volume = Volume(part.shape).Mass();
        EXPECT_NEAR(VolumeOf(mesh), volume, tolerance * AreaOf(part.shape));
      }
    }
  }
}

// The faces of a solid that batten writes have sides of several edges.
TEST(ShellMeshTest, SolidsOfSplineFacesAreTheSameFromTheirModelAndFromTheirFile) {
  for (const QuadMesh& layout : {Cube(), Torus(6, 5), Shaken(Prism(5), 0.05, 3), CubeSphere(2)}) {
    const QuadTopology topology(layout.faces, static_cast<int>(layout.vertices.cols()));
    const SolidModel solid = SplineSolid(topology, layout.vertices, MotorcycleBlocks(topology));
    std::vector<NurbsSurface> faces;
    for (const SolidFace& face : solid.faces) faces.push_back(face.surface);
    const TemporaryFolder folder;
    WriteSolid(solid, folder.File("a.step"));
    const GeometryContents contents = ReadGeometryContents(folder.File("a.step"));
    const SolidAudit audit = AuditSolid(solid);
    for (const double tolerance : {0.1, 0.002}) {
      const TessellateOptions options{.chord_tolerance = tolerance};
      for (const ShellMesh& mesh :
           {TessellateShell(faces, BordersOf(solid), options),
            TessellateShell(
                SurfacesOf(contents, contents.bodies[0]), contents.bodies[0].borders, options)}) {
        ExpectWatertight(mesh);
        EXPECT_LE(mesh.gap, tolerance / 4);
        EXPECT_NEAR(VolumeOf(mesh), audit.volume, tolerance * audit.area);
      }
      ExpectNear(TessellateShell(faces, BordersOf(solid), options), faces, tolerance, 30);
    }
  }
}

// The faces of an open shell meet where they did; its free edges are the mesh's.
TEST(ShellMeshTest, OpenShellsAreOpenAtTheirFreeEdgesAlone) {
  const TemporaryFolder folder;
  const Part box{"box", BRepPrimAPI_MakeBox(3, 2, 1).Shell()};
  GeometryContents contents = ReadGeometryContents(Saved(folder, box, false));
  ASSERT_EQ(contents.bodies.size(), 1U);
  std::vector<NurbsSurface> surfaces = SurfacesOf(contents, contents.bodies[0]);
  std::vector<FaceBorder> borders = contents.bodies[0].borders;
  surfaces.pop_back();
  borders.pop_back();
  const ShellMesh mesh = TessellateShell(surfaces, borders);
  int open = 0;
  std::map<std::pair<int, int>, int> edges;
  for (size_t f = 0; f < mesh.faces.size(); ++f) {
    for (const auto triangle : mesh.faces[f].triangles.colwise()) {
      for (int e = 0; e < 3; ++e) {
        const int a = mesh.joints[f][size_t(triangle[e])],
                  b = mesh.joints[f][size_t(triangle[(e + 1) % 3])];
        ASSERT_GE(std::min(a, b), 0);
        edges[std::minmax(a, b)] += a < b ? 1 : -1;
      }
    }
  }
  for (const auto& [ends, sum] : edges) open += sum != 0;
  EXPECT_EQ(open, 4);
}

}  // namespace batten::internal::shell_mesh_test
