// SPDX-License-Identifier: MIT
// A mesh is a surface: what `batten` makes of closed ones.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "nlohmann/json.hpp"
#include "test_clouds.h"

namespace batten::internal::fit_mesh_test {

using ::testing::HasSubstr;
using ::testing::Not;

using Corner = Eigen::Vector3d;

// The STL of triangles, and the volume that they enclose.
struct StlBody {
  std::string facets;
  double volume = 0;

  std::string text() const { return "solid body\n" + facets + "endsolid body\n"; }

  void Add(const Corner& a, const Corner& b, const Corner& c) {
    facets += "facet normal 0 0 0\nouter loop\n";
    for (const Corner& p : {a, b, c})
      facets += fmt::format("vertex {:.9g} {:.9g} {:.9g}\n", p[0], p[1], p[2]);
    facets += "endloop\nendfacet\n";
    volume += a.cross(b).dot(c) / 6;
  }
};

// A bar of a regular polygon's section: few triangles, and no vertex but on its ends.
StlBody Bar(int sides, double height) {
  StlBody body;
  const auto corner = [&](int k, double z) {
    const double angle = 2 * std::numbers::pi * k / sides;
    return Corner(std::cos(angle), std::sin(angle), z);
  };
  for (int k = 0; k < sides; ++k) {
    body.Add(corner(k, 0), corner(k + 1, 0), corner(k + 1, height));
    body.Add(corner(k, 0), corner(k + 1, height), corner(k, height));
    body.Add({0, 0, 0}, corner(k + 1, 0), corner(k, 0));
    body.Add({0, 0, height}, corner(k, height), corner(k + 1, height));
  }
  return body;
}

// An octahedron with each face drawn to a spike: neither exact faces nor a smooth surface.
StlBody Star(unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> reach(0.6, 1.9);
  StlBody body;
  for (int octant = 0; octant < 8; ++octant) {
    const double x = octant & 1 ? -1 : 1, y = octant & 2 ? -1 : 1, z = octant & 4 ? -1 : 1;
    Corner a(x, 0, 0), b(0, y, 0);
    const Corner c(0, 0, z), spike = reach(random) / std::sqrt(3) * Corner(x, y, z);
    if (x * y * z < 0) std::swap(a, b);
    body.Add(a, b, spike);
    body.Add(b, c, spike);
    body.Add(c, a, spike);
  }
  return body;
}

double VolumeIn(const std::string& words) {
  const auto at = words.find("volume ");
  return at == words.npos ? std::nan("") : std::strtod(words.c_str() + at + 7, nullptr);
}

TEST(FitMeshTest, ARoundBarIsACylinderThoughItHasVerticesAtItsEndsOnly) {
  for (const double height : {1.0, 4.0}) {
    SCOPED_TRACE(height);
    TemporaryFolder folder;
    const StlBody bar = Bar(96, height);
    const std::string out = folder.File("bar.step"), report = folder.File("bar.json");
    const ProgramRun run =
        Batten({"fit", folder.With("bar.stl", bar.text()), "-o", out, "--report", report});
    EXPECT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.err, HasSubstr("a mesh of 384 triangles"));
    EXPECT_THAT(run.err, HasSubstr("a watertight solid of 3 faces"));
    EXPECT_NEAR(VolumeIn(run.err), bar.volume, 0.002 * bar.volume);
    EXPECT_THAT(folder.Text("bar.step"), HasSubstr("CYLINDRICAL_SURFACE"));
    EXPECT_EQ(nlohmann::json::parse(folder.Text("bar.json"))["doubt"].size(), 0u);
  }
}

TEST(FitMeshTest, WhatIsNeitherExactNorSmoothComesOutAsItIsAndIsDoubtful) {
  for (const unsigned seed : {1u, 2u}) {
    SCOPED_TRACE(seed);
    TemporaryFolder folder;
    const StlBody star = Star(seed);
    const std::string stl = folder.With("star.stl", star.text()), out = folder.File("star.step");
    const ProgramRun run =
        Batten({"fit", "solid", stl, "-o", out, "--report", folder.File("r.json")});
    EXPECT_EQ(run.code, 4) << run.err;
    EXPECT_THAT(run.out, HasSubstr("star.step: doubtful: the mesh as it is, in plane faces"));
    EXPECT_THAT(run.err, HasSubstr("a watertight solid of 24 plane faces, 36 edges"));
    EXPECT_NEAR(VolumeIn(run.err), star.volume, 1e-5 * star.volume);
    EXPECT_EQ(nlohmann::json::parse(folder.Text("r.json"))["doubt"][0]["code"], "faceted");
    EXPECT_EQ(Batten({"fit", "solid", stl, "-o", out, "--accept-doubt"}).code, 0);
  }
}

// Smooth faces that were asked for are written though they are not the body.
TEST(FitMeshTest, ASolidOfAnotherVolumeThanTheMeshIsDoubtful) {
  TemporaryFolder folder;
  const std::string stl = folder.With("bar.stl", Bar(12, 6).text()), out = folder.File("bar.step"),
                    report = folder.File("r.json");
  const ProgramRun run = Batten(
      {"fit", "solid", stl, "-o", out, "--kind", "organic", "--faces", "24", "--report", report});
  EXPECT_EQ(run.code, 4) << run.err;
  EXPECT_EQ(nlohmann::json::parse(folder.Text("r.json"))["doubt"][0]["code"], "volume");
  EXPECT_THAT(run.out, HasSubstr("its volume is "));
}

TEST(FitMeshTest, InfoTellsWhatAMeshEncloses) {
  TemporaryFolder folder;
  const StlBody bar = Bar(6, 2);
  const ProgramRun run = Batten({"info", folder.With("bar.stl", bar.text()), "--json"});
  EXPECT_EQ(run.code, 0) << run.err;
  const auto mesh = nlohmann::json::parse(run.out)["mesh"];
  EXPECT_EQ(mesh["faces"], 24);
  EXPECT_EQ(mesh["closed"], true);
  EXPECT_EQ(mesh["bodies"], 1);
  EXPECT_NEAR(mesh["volume"].get<double>(), bar.volume, 1e-5 * bar.volume);
  EXPECT_FALSE(
      nlohmann::json::parse(
          Batten({"info", folder.With("p.xyz", "0 0 0\n1 0 0\n0 1 0\n1 1 1\n"), "--json"}).out)
          .contains("mesh"));
}

// Parts are found on the triangles of a mesh of eight vertices, and what lies between these is
// compared too, unless vertices alone count.
TEST(FitMeshTest, TrianglesCountInFitsAndComparisons) {
  TemporaryFolder folder;
  const std::string stl = folder.With("bar.stl", Bar(4, 2).text()), bar = folder.File("bar.step"),
                    report = folder.File("r.json");
  const ProgramRun parts =
      Batten({"fit", "parts", stl, "-o", folder.File("parts.step"), "--report", report});
  EXPECT_EQ(parts.code, 0) << parts.err;
  EXPECT_THAT(parts.err, HasSubstr("a mesh of 16 triangles; "));
  const auto input = nlohmann::json::parse(folder.Text("r.json"))["input"];
  EXPECT_EQ(input["mesh"]["triangles"], 16);
  EXPECT_EQ(input["mesh"]["open_edges"], 0);
  EXPECT_EQ(input["mesh"]["non_manifold"], 0);
  EXPECT_GT(input["mesh"]["sampled"], 19000);
  EXPECT_EQ(nlohmann::json::parse(folder.Text("r.json"))["faces"].size(), 6U);
  EXPECT_EQ(Batten({"fit", "solid", stl, "-o", bar, "--quiet"}).code, 0);
  // A sheet through the middle: no vertex is off the bar, and its triangles are.
  StlBody sheet;
  const auto compare = [&](const std::string& mesh, const std::string& points) {
    EXPECT_EQ(Batten({"compare", bar, mesh, "--points", points, "--report", report}).code, 0);
    return nlohmann::json::parse(folder.Text("r.json"));
  };
  sheet.Add({1, 0, 0}, {-1, 0, 0}, {1, 0, 2});
  sheet.Add({-1, 0, 0}, {-1, 0, 2}, {1, 0, 2});
  const std::string through = folder.With("through.stl", sheet.text());
  const auto faces = compare(through, "faces"), vertices = compare(through, "vertices");
  EXPECT_LT(vertices["error"]["max"], 1e-6);
  EXPECT_EQ(vertices["input"]["points"], 4);
  EXPECT_FALSE(vertices["input"].contains("mesh"));
  EXPECT_NEAR(faces["error"]["max"], std::sqrt(0.5), 0.02);  // in the bar's middle
  EXPECT_EQ(faces["input"]["mesh"]["open_edges"], 4);
}

// A tube's vertices are two rings, which many shapes pass through: what lies between them decides
// whether the one that was chosen is right.
TEST(FitMeshTest, APrimitiveThatLeavesTheTrianglesIsDoubtful) {
  TemporaryFolder folder;
  const std::string stl = folder.With("bar.stl", Bar(40, 5).text());
  const ProgramRun run = Batten({"fit", "primitive", stl, "-o", folder.File("p.step")});
  EXPECT_EQ(run.code, 4) << run.out;
  EXPECT_THAT(run.out, HasSubstr("between its vertices half of the mesh is farther than"));
}

// The genus that was asked for is that of the mesh too.
TEST(FitMeshTest, APolyhedronOfAnotherGenusIsRefused) {
  TemporaryFolder folder;
  const std::string stl = folder.With("bar.stl", Bar(4, 2).text()), out = folder.File("bar.step");
  const ProgramRun run = Batten({"fit", "solid", stl, "-o", out, "--genus", "1"});
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.err, HasSubstr("its genus is 0, not 1"));
  EXPECT_EQ(Batten({"fit", "solid", stl, "-o", out, "--genus", "0"}).code, 0);
}

TEST(FitMeshTest, APolyhedronIsWrittenAsItIs) {
  for (const int sides : {3, 4, 6, 9, 12}) {
    SCOPED_TRACE(sides);
    TemporaryFolder folder;
    const StlBody bar = Bar(sides, 5);
    const std::string out = folder.File("bar.step"), report = folder.File("bar.json");
    const ProgramRun run =
        Batten({"fit", folder.With("bar.stl", bar.text()), "-o", out, "--report", report});
    EXPECT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.err, HasSubstr(fmt::format("a watertight solid of {} plane faces", sides + 2)));
    EXPECT_NEAR(VolumeIn(run.err), bar.volume, 1e-5 * bar.volume);
    EXPECT_EQ(nlohmann::json::parse(folder.Text("bar.json"))["doubt"].size(), 0u);
  }
}

TEST(FitMeshTest, PlaneFacesMayBeAskedFor) {
  TemporaryFolder folder;
  const StlBody bar = Bar(6, 2);
  const std::string stl = folder.With("bar.stl", bar.text()), out = folder.File("bar.step");
  const ProgramRun run = Batten(
      {"fit", "solid", stl, "-o", out, "--kind", "faceted", "--report", folder.File("r.html")});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("a watertight solid of 8 plane faces, 18 edges"));
  EXPECT_NEAR(VolumeIn(run.err), bar.volume, 1e-5 * bar.volume);
  // Points have no faces, and an open mesh does not close.
  const std::string points = folder.With("p.xyz", ToText(WavySheet(300)));
  StlBody open;
  open.Add({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  for (const std::string& none : {points, folder.With("open.stl", open.text())}) {
    const ProgramRun refused =
        Batten({"fit", "solid", none, "-o", folder.File("no.step"), "--kind", "faceted"});
    EXPECT_EQ(refused.code, 1) << refused.err;
    EXPECT_THAT(refused.err, HasSubstr("makes no solid of plane faces"));
  }
}

}  // namespace batten::internal::fit_mesh_test
