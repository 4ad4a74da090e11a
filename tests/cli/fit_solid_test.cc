// SPDX-License-Identifier: MIT
// Laws of `batten fit solid`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <numbers>

#include "batten/io/polygon_reader.h"
#include "body_clouds.h"
#include "test_clouds.h"
#include "tolerances.h"

namespace batten::internal::fit_solid_command_test {

using ::testing::HasSubstr;

std::string SphereText(int count, double least_z = -2) {
  std::string text;
  const Eigen::Matrix3Xd points = SpherePoints(count, 0.003);
  for (const auto p : points.colwise()) {
    if (p[2] < least_z) continue;
    text += std::to_string(p[0]) + " " + std::to_string(p[1]) + " " + std::to_string(p[2]) + "\n";
  }
  return text;
}

double NumberAfter(const std::string& text, const std::string& word) {
  const auto at = text.find(word);
  return at == std::string::npos ? std::nan("")
                                 : std::strtod(text.c_str() + at + word.size(), nullptr);
}

TEST(FitSolidCommandTest, NeedsNothingButThePoints) {
  const TemporaryFolder folder;
  const std::string cloud = folder.With("ball.xyz", SphereText(2000));
  const ProgramRun run = Batten({"fit",
                                 "solid",
                                 cloud,
                                 "-o",
                                 folder.File("ball.step"),
                                 "--faces",
                                 "100",
                                 "--mesh-out",
                                 folder.File("mesh.ply"),
                                 "--layout-out",
                                 folder.File("q.obj"),
                                 "--json"});
  ASSERT_EQ(run.code, 0) << run.err;
  const Json report = Json::parse(run.out);
  EXPECT_EQ(report["geometry"]["kind"], "solid");
  EXPECT_LE(report["error"]["rms"].get<double>(), 0.006);
  EXPECT_THAT(folder.Text("ball.step"), HasSubstr("MANIFOLD_SOLID_BREP"));
  EXPECT_THAT(run.err, HasSubstr("a watertight solid of"));
  EXPECT_GT(ReadPolygons(folder.File("mesh.ply")).faces.size(), 100u);
  EXPECT_EQ(CheckQuadMesh(ReadQuadMesh(folder.File("q.obj"))).genus, 0);
}

TEST(FitSolidCommandTest, OpenScansAreShellsThatEndWhereTheirPointsDo) {
  const TemporaryFolder folder;
  const std::string cloud = folder.With("bowl.xyz", SphereText(3000, -0.3));
  const std::string out = folder.File("bowl.step");
  const ProgramRun refused = Batten({"fit", "solid", cloud, "-o", out});
  EXPECT_EQ(refused.code, 1);
  EXPECT_THAT(refused.err, HasSubstr("(--open leaves the borders of a scan)"));
  const ProgramRun run = Batten({"fit", "solid", cloud, "-o", out, "--open", "--json"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("an open shell of"));
  const Json report = Json::parse(run.out);
  EXPECT_EQ(report["geometry"]["kind"], "shell");
  EXPECT_LE(report["error"]["rms"].get<double>(), 0.006);
  // The sphere above −0.3, to about a spacing.
  const double area = 2 * std::numbers::pi * 1.3, border = 2 * std::numbers::pi;
  EXPECT_NEAR(NumberAfter(run.err, "area "), area, 0.08 * border);
  EXPECT_NEAR(NumberAfter(run.err, "length "), border * std::sqrt(1 - 0.09), 0.08 * border);
  EXPECT_EQ(Batten({"fit", "solid", cloud, "-o", out, "--open", "--genus", "0"}).code, 2);
  EXPECT_EQ(Batten({"fit", "solid", cloud, "-o", out, "--open", "--kind", "cad"}).code, 2);
}

TEST(FitSolidCommandTest, TakesTheFacesOfAMeshAndALayout) {
  const TemporaryFolder folder;
  WriteQuadMesh(CubeSphere(4), folder.File("ball.obj"));
  WriteQuadMesh(CubeSphere(2), folder.File("layout.obj"));
  EXPECT_EQ(
      Batten({"fit", "solid", folder.File("ball.obj"), "-o", folder.File("a.step"), "--quiet"})
          .code,
      0);
  const ProgramRun given = Batten({"fit",
                                   "solid",
                                   folder.File("ball.obj"),
                                   "-o",
                                   folder.File("b.step"),
                                   "--quads",
                                   folder.File("layout.obj")});
  EXPECT_EQ(given.code, 0);
  EXPECT_THAT(given.err,
              HasSubstr("a watertight solid of 6 faces, 12 edges and 8 vertices, genus 0"));
  EXPECT_THAT(folder.Text("a.step"), HasSubstr("MANIFOLD_SOLID_BREP"));
}

// A box of 16 × 16 squares a side, over a layout that is made and over one that is given.
TEST(FitSolidCommandTest, KeepsTheSharpEdgesOfAMesh) {
  const TemporaryFolder folder;
  QuadMesh mesh = Creased(Cube(), 1);
  QuadMesh layout;
  for (int k = 0; k < 4; ++k) {
    mesh = Refined(mesh);
    if (k == 1) layout = {mesh.vertices, mesh.faces};
  }
  WriteQuadMesh(mesh, folder.File("box.obj"));
  WriteQuadMesh(layout, folder.File("layout.obj"));
  std::vector<std::string> command = {
      "fit", "solid", folder.File("box.obj"), "-o", folder.File("box.step"), "--kind", "organic"};
  const ProgramRun made = Batten(command);
  command.insert(command.end(),
                 {"--quads", folder.File("layout.obj"), "--report", folder.File("report.json")});
  const ProgramRun given = Batten(command);
  for (const ProgramRun& run : {made, given}) {
    EXPECT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.err, HasSubstr("a watertight solid of 6 faces, 12 edges and 8 vertices"));
    EXPECT_THAT(run.err, HasSubstr("volume 8, area 24"));
    EXPECT_THAT(run.err, HasSubstr("over 12 sharp edges of length 24 at 90° to 90°"));
  }
  const Json creases = Json::parse(folder.Text("report.json"))["geometry"]["creases"];
  EXPECT_EQ(creases["edges"], 12);
  EXPECT_NEAR(creases["length"].get<double>(), 24, kHalfDigits);
  for (const char* angle : {"least_angle", "greatest_angle"})
    EXPECT_NEAR(creases[angle].get<double>(), std::numbers::pi / 2, kHalfDigits);
}

TEST(FitSolidCommandTest, WritesWatertightTriangles) {
  const TemporaryFolder folder;
  WriteQuadMesh(CubeSphere(4), folder.File("ball.obj"));
  for (const char* name : {"a.ply", "a.stl"}) {
    const ProgramRun run =
        Batten({"fit", "solid", folder.File("ball.obj"), "-o", folder.File(name)});
    EXPECT_EQ(run.code, 0) << run.out << run.err;
    EXPECT_THAT(run.err, HasSubstr("surfaces, watertight"));
    EXPECT_GT(ReadPolygons(folder.File(name)).faces.size(), 100u);
  }
}

TEST(FitSolidCommandTest, RefusesWithAReasonAndWithoutAFile) {
  const TemporaryFolder folder;
  const std::string out = folder.File("no.step");
  const auto refusal = [&](std::vector<std::string> words, int code) {
    words.insert(words.begin(), {"fit", "solid"});
    words.insert(words.end(), {"-o", out});
    const ProgramRun run = Batten(words);
    EXPECT_EQ(run.code, code) << run.err;
    EXPECT_EQ(run.error_lines(), 1) << run.err;
    EXPECT_EQ(folder.Text("no.step"), "");
    return run.err;
  };
  const std::string bowl = folder.With("bowl.xyz", SphereText(3000, 0.2));
  EXPECT_THAT(refusal({bowl}, 1), HasSubstr("the points do not go all round a body"));
  QuadMesh open = CubeSphere(2);
  open.faces.conservativeResize(4, 50);
  WriteQuadMesh(open, folder.File("open.obj"));
  EXPECT_THAT(refusal({folder.File("open.obj")}, 1), HasSubstr("the surface is open"));
  const std::string ball = folder.With("ball.xyz", SphereText(1000));
  EXPECT_THAT(refusal({ball, "--quads", folder.File("open.obj")}, 1),
              HasSubstr("the mesh is open"));
  EXPECT_THAT(refusal({ball, "--faces", "3"}, 2), HasSubstr("--faces"));
}

TEST(FitSolidCommandTest, StrayPointsCountWhereItIsSaid) {
  const TemporaryFolder folder;
  const std::string cloud = folder.With("ball.xyz", SphereText(2000) + "0 0 3\n0 3 0\n3 0 0\n");
  WriteQuadMesh(CubeSphere(2), folder.File("layout.obj"));
  const auto fit = [&](const std::string& how) {
    const ProgramRun run = Batten({"fit",
                                   "solid",
                                   cloud,
                                   "-o",
                                   folder.File("ball.step"),
                                   "--quads",
                                   folder.File("layout.obj"),
                                   "--clean",
                                   how,
                                   "--json"});
    EXPECT_EQ(run.code, how == "none" ? 4 : 0) << run.err;  // those that count are missed
    return Json::parse(run.out)["input"];
  };
  EXPECT_EQ(fit("auto")["outliers"], 3);
  EXPECT_EQ(fit("none")["outliers"], 0);
  EXPECT_EQ(fit("statistical")["points"], 2000);
}

// Bodies apart are as many solids; one in another, or through it, is no solid of its own.
TEST(FitSolidCommandTest, BodiesAreToldAndKeptApart) {
  const TemporaryFolder folder;
  const auto pair = [&](double scale, double move) {
    const QuadMesh one = CubeSphere(4);
    QuadMesh both = one;
    const Eigen::Index n = one.vertices.cols(), f = one.faces.cols();
    both.vertices.conservativeResize(3, 2 * n);
    both.vertices.rightCols(n) = (scale * one.vertices).colwise() + Eigen::Vector3d(move, 0, 0);
    both.faces.conservativeResize(4, 2 * f);
    both.faces.rightCols(f) = one.faces.array() + static_cast<int>(n);
    WriteQuadMesh(both, folder.File("two.obj"));
    return Batten({"fit", "solid", folder.File("two.obj"), "-o", folder.File("two.step")});
  };
  const ProgramRun apart = pair(1, 5);
  EXPECT_EQ(apart.code, 0) << apart.err;
  EXPECT_THAT(apart.err, HasSubstr("2 watertight solids of"));
  for (const auto& [scale, move] : {std::pair(0.5, 0.0), std::pair(1.0, 1.0)}) {
    const ProgramRun run = pair(scale, move);
    EXPECT_EQ(run.code, 1) << run.err;
    EXPECT_THAT(run.err,
                HasSubstr(scale < 1 ? "2 bodies, of which one lies in another"
                                    : "2 bodies, of which two run through one another"));
  }
}

std::string BallAt(double x, double radius, int count) {
  std::string text;
  const Eigen::Matrix3Xd points = SpherePoints(count, 0.003);
  for (const auto p : points.colwise()) {
    text += std::to_string(x + radius * p[0]) + " " + std::to_string(radius * p[1]) + " " +
            std::to_string(radius * p[2]) + "\n";
  }
  return text;
}

TEST(FitSolidCommandTest, PointsOfBodiesApartAndOfSheetsAreToldAsSuch) {
  const TemporaryFolder folder;
  const auto fit = [&](const std::string& text) {
    const std::string cloud = folder.With("points.xyz", text);
    const ProgramRun run =
        Batten({"fit", "solid", cloud, "--faces", "60", "-o", folder.File("a.step"), "--quiet"});
    EXPECT_EQ(run.out, "");  // nor what PCL prints
    EXPECT_EQ(run.error_lines(), run.code == 0 || run.code == 4 ? 0 : 1) << run.err;
    return run;
  };
  const ProgramRun two = fit(BallAt(0, 1, 1500) + BallAt(4, 0.7, 1200));
  EXPECT_EQ(two.code, 1);
  EXPECT_THAT(two.err, HasSubstr("the points are 2 separate bodies"));
  EXPECT_THAT(two.err, HasSubstr("(--box, --where)"));
  // Up to one point in twenty is debris.
  EXPECT_NE(fit(BallAt(0, 1, 1500) + BallAt(1.5, 0.05, 60)).code, 1);
  for (const double bend : {0.0, 0.2}) {
    std::string sheet;
    for (int i = 0; i < 50; ++i) {
      for (int j = 0; j < 50; ++j) {
        sheet += std::to_string(i) + " " + std::to_string(j) + " " +
                 std::to_string(20 * bend * std::sin(0.1 * i) * std::cos(0.08 * j)) + "\n";
      }
    }
    const ProgramRun open = fit(sheet);
    EXPECT_EQ(open.code, 1);
    EXPECT_THAT(open.err, HasSubstr("the points do not go all round a body"));
    EXPECT_THAT(open.err, HasSubstr("batten fit surface fits sheets"));
  }
}

TEST(FitSolidCommandTest, LayoutsGrowWithDifferentPointsOnly) {
  const TemporaryFolder folder;
  const std::string ball = BallAt(0, 1, 1500);
  const auto control_points = [&](const std::string& text) {
    const ProgramRun run = Batten({"fit",
                                   "solid",
                                   folder.With("points.xyz", text),
                                   "-o",
                                   folder.File("a.step"),
                                   "--threads",
                                   "1",
                                   "--json"});
    EXPECT_EQ(run.code, 0) << run.err;
    return Json::parse(run.out)["geometry"]["control_points"];
  };
  EXPECT_EQ(control_points(ball), control_points(ball + ball + ball));
}

TEST(FitSolidCommandTest, ASolidThatLeavesItsPointsIsDoubtful) {
  const TemporaryFolder folder;
  QuadMesh box = Cube();
  box.vertices.row(0) *= 2;
  WriteQuadMesh(box, folder.File("box.obj"));
  const std::vector<std::string> words = {
      "fit",
      "solid",
      folder.With("twins.xyz", BallAt(-1, 1, 1500) + BallAt(1, 1, 1500)),
      "--quads",
      folder.File("box.obj"),
      "--smoothing",
      "0.01",
      "-o",
      folder.File("a.step")};
  const ProgramRun run = Batten(words);
  EXPECT_EQ(run.code, 4);
  EXPECT_THAT(run.out, HasSubstr("doubtful: "));
  EXPECT_THAT(run.err, HasSubstr("the layout is too coarse, or of another shape"));
  EXPECT_THAT(folder.Text("a.step"), HasSubstr("MANIFOLD_SOLID_BREP"));
  std::vector<std::string> wide = words;
  wide.insert(wide.end(), {"--tolerance", "5"});
  EXPECT_EQ(Batten(wide).code, 0);
}

TEST(FitSolidCommandTest, TinyBodiesAndOtherFormatsAreRefusedBeforeTheFit) {
  const TemporaryFolder folder;
  QuadMesh ball = CubeSphere(4);
  WriteQuadMesh(ball, folder.File("ball.obj"));
  for (const char* out : {"ball.brep", "ball.iges", "ball.json"}) {
    const ProgramRun run =
        Batten({"fit", "solid", folder.File("ball.obj"), "-o", folder.File(out)});
    EXPECT_EQ(run.code, 2);
    EXPECT_THAT(run.err, HasSubstr("a solid is written as .step"));
  }
  ball.vertices *= 1e-5;
  WriteQuadMesh(ball, folder.File("tiny.obj"));
  const ProgramRun run =
      Batten({"fit", "solid", folder.File("tiny.obj"), "-o", folder.File("tiny.step")});
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.err, HasSubstr("use a smaller unit"));
}

}  // namespace batten::internal::fit_solid_command_test
