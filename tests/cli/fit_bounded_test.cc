// SPDX-License-Identifier: MIT
// Laws of `batten fit surface` on outlines, holes, edges that are given, and grids.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test_clouds.h"

namespace batten::internal::fit_bounded_test {

using ::testing::HasSubstr;
using ::testing::Not;

class FitBoundedCommandTest : public ::testing::Test {
 protected:
  ProgramRun Run(std::vector<std::string> arguments, const std::string& out) {
    arguments.insert(arguments.begin(), {"fit", "surface"});
    arguments.insert(arguments.end(), {"-o", folder_.File(out), "--json"});
    return Batten(arguments);
  }
  Json Fit(const std::vector<std::string>& arguments, const std::string& out, int code = 0) {
    const ProgramRun run = Run(arguments, out);
    EXPECT_EQ(run.code, code) << run.err;
    return Json::parse(run.out);
  }
  Json Shape(const std::string& out) { return Json::parse(folder_.Text(out))["shape"]["data"][0]; }

  // Places along the sheet's edge y = 0.
  static std::vector<Row> SouthPoints() {
    std::vector<Row> points;
    for (int k = 0; k <= 40; ++k) points.push_back({0.25 * k, 0, std::sin(0.175 * k) + 0.5});
    return points;
  }

  // The polygon through them, as a file.
  std::string South(const std::string& name) {
    std::vector<double> knots = {0};
    for (int k = 0; k <= 40; ++k) knots.push_back(k);
    knots.push_back(40);
    const Json json = {{"shape",
                        {{"type", "curve"},
                         {"count", 1},
                         {"data",
                          {{{"type", "spline"},
                            {"rational", false},
                            {"dimension", 3},
                            {"degree", 1},
                            {"knotvector", knots},
                            {"control_points", {{"points", SouthPoints()}}}}}}}}};
    return folder_.With(name, json.dump());
  }

  // Points of the wavy sheet that a rule keeps.
  template <class Keep>
  std::string Sheet(const std::string& name, int points, const Keep& keep) {
    std::vector<Row> rows;
    for (const Row& row : WavySheet(points))
      if (keep(row[0], row[1])) rows.push_back(row);
    return folder_.With(name, ToText(rows));
  }

  // A straight edge from one point to another, as a file.
  std::string Line(const std::string& name, const Row& from, const Row& to) {
    const Json json = {{"shape",
                        {{"type", "curve"},
                         {"count", 1},
                         {"data",
                          {{{"type", "spline"},
                            {"rational", false},
                            {"dimension", 3},
                            {"degree", 1},
                            {"knotvector", {0, 0, 1, 1}},
                            {"control_points", {{"points", {from, to}}}}}}}}}};
    return folder_.With(name, json.dump());
  }

  TemporaryFolder folder_;
};

TEST_F(FitBoundedCommandTest, CutsTheSheetAndSaysSo) {
  const std::string cloud = Sheet("hole.xyz", 20000, [](double x, double y) {
    return std::hypot(x - 5, y - 3) > 1.2 && (x < 6 || y < 4.5);
  });
  const Json report = Fit({cloud}, "hole.json");
  EXPECT_EQ(report["geometry"]["trims"], 2);
  const Json shape = Shape("hole.json");
  EXPECT_EQ(shape["trims"]["count"], 2);
  EXPECT_EQ(shape["trims"]["data"].size(), 2u);

  const ProgramRun area = Batten({"analyze", folder_.File("hole.json"), "--json"});
  ASSERT_EQ(area.code, 0) << area.err;
  const ProgramRun whole = Batten(
      {"fit", "surface", cloud, "-o", folder_.File("whole.json"), "--trim", "none", "--json"});
  EXPECT_EQ(Json::parse(whole.out)["geometry"]["trims"], 0);
  const ProgramRun all = Batten({"analyze", folder_.File("whole.json"), "--json"});
  EXPECT_LT(Json::parse(area.out)["area"], 0.85 * Json::parse(all.out)["area"].get<double>());

  // The same face through STEP; a point in the hole is as far as the hole's edge.
  ASSERT_EQ(Batten({"convert", folder_.File("hole.json"), folder_.File("hole.step")}).code, 0);
  const std::string middle = folder_.With("middle.xyz", "5 3 0\n0 0 0\n");
  for (const char* file : {"hole.json", "hole.step"}) {
    const ProgramRun project = Batten({"project", folder_.File(file), middle, "--json"});
    ASSERT_EQ(project.code, 0) << project.err;
    EXPECT_GT(Json::parse(project.out)["results"][0]["distance"], 1.0) << file;
  }
}

TEST_F(FitBoundedCommandTest, EdgesThatDoNotMeetAreNamedWithTheirGap) {
  const std::string cloud = Sheet("s.xyz", 4000, [](double, double) { return true; });
  const std::vector<std::string> edges = {"--boundary",
                                          Line("south.json", {0, 0, 0}, {10, 0, 0}),
                                          "--boundary",
                                          Line("east.json", {10, 0.5, 0}, {10, 6, 0}),
                                          "--boundary",
                                          Line("north.json", {0, 6, 0}, {10, 6, 0}),
                                          "--boundary",
                                          Line("west.json", {0, 0, 0}, {0, 6, 0})};
  std::vector<std::string> arguments = {cloud};
  arguments.insert(arguments.end(), edges.begin(), edges.end());
  const ProgramRun run = Run(arguments, "x.json");
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.err, HasSubstr("south.json"));
  EXPECT_THAT(run.err, HasSubstr("east.json"));
  EXPECT_THAT(run.err, HasSubstr("0.5"));
  EXPECT_EQ(folder_.Text("x.json"), "");
}

TEST_F(FitBoundedCommandTest, AnEdgeIsTheCurveOfAFile) {
  const std::string cloud = Sheet("s.xyz", 6000, [](double, double) { return true; });
  const Json report = Fit({cloud, "--boundary", South("south.json")}, "edge.json");
  EXPECT_THAT(report["geometry"]["base_why"].get<std::string>(), HasSubstr("curves given"));
  const ProgramRun project = Batten({"project",
                                     folder_.File("edge.json"),
                                     folder_.With("on.xyz", ToText(SouthPoints())),
                                     "--json"});
  const Json said = Json::parse(project.out);
  for (const Json& one : said["results"]) EXPECT_LT(one["distance"], 1e-9);
}

TEST_F(FitBoundedCommandTest, GridsAreInterpolatedAndHolesInThemBridged) {
  std::string text, holey;
  for (int i = 0; i < 12; ++i) {
    for (int j = 0; j < 9; ++j) {
      const std::string row = Shortest(i) + " " + Shortest(j) + " " +
                              Shortest(std::sin(0.3 * i) * std::cos(0.4 * j)) + "\n";
      text += row;
      holey += i == 5 && j == 4 ? "nan nan nan\n" : row;
    }
  }
  const std::string cloud = folder_.With("g.xyz", text);
  const Json report = Fit({cloud, "--grid", "12,9"}, "g.json");
  EXPECT_EQ(report["geometry"]["control_points"], Json({12, 9}));
  EXPECT_LT(report["error"]["max"], 1e-12);
  const Json kept = Fit({cloud, "--grid", "12,9", "--tolerance", "0.02"}, "t.json");
  EXPECT_LE(kept["error"]["max"], 0.02);
  const Json bridged = Fit({folder_.With("h.xyz", holey), "--grid", "12,9"}, "h.json");
  EXPECT_EQ(bridged["input"]["non_finite"], 1);
  EXPECT_LT(bridged["error"]["max"], 0.01);
  const ProgramRun wrong = Run({cloud, "--grid", "11,9"}, "w.json");
  EXPECT_EQ(wrong.code, 1);
  EXPECT_THAT(wrong.err, HasSubstr("108"));
  EXPECT_THAT(wrong.err, HasSubstr("99"));
}

TEST_F(FitBoundedCommandTest, FlagsThatContradictAreRefused) {
  const std::string cloud = Sheet("s.xyz", 500, [](double, double) { return true; });
  for (const std::vector<std::string>& flags :
       std::vector<std::vector<std::string>>{{"--grid", "20,25", "--base", "plane"},
                                             {"--grid", "20,25", "--symmetric", "x"},
                                             {"--snap", "--meet", cloud},
                                             {"--parameterization", "given", "--symmetric", "x"}}) {
    std::vector<std::string> arguments = {cloud};
    arguments.insert(arguments.end(), flags.begin(), flags.end());
    const ProgramRun run = Run(arguments, "x.json");
    EXPECT_EQ(run.code, 2) << run.err;
    EXPECT_THAT(run.err, HasSubstr(flags[0]));
  }
}

}  // namespace batten::internal::fit_bounded_test
