// SPDX-License-Identifier: MIT
// Laws of analyze, and of info for geometry, which says the same.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "test_clouds.h"

namespace batten::internal::analyze_test {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

Json File(const char* type, std::vector<Json> entries) {
  return {{"shape", {{"type", type}, {"count", entries.size()}, {"data", std::move(entries)}}}};
}

Json CurveEntry(int degree, const Json& knots, const Json& points, const Json& weights = nullptr) {
  Json entry{{"type", "spline"},
             {"rational", !weights.is_null()},
             {"dimension", points[0].size()},
             {"degree", degree},
             {"knotvector", knots},
             {"control_points", {{"points", points}}}};
  if (!weights.is_null()) entry["control_points"]["weights"] = weights;
  return entry;
}

// The upper half of the circle about (3, 1) with radius 2, from right to left.
Json HalfCircle() {
  const double h = std::sqrt(0.5);
  return CurveEntry(
      2, {0, 0, 0, 1, 1, 2, 2, 2}, {{5, 1}, {5, 3}, {3, 3}, {1, 3}, {1, 1}}, {1, h, 1, h, 1});
}

Json Line(double x0, double y0, double x1, double y1) {
  return CurveEntry(1, {0, 0, 1, 1}, {{x0, y0}, {x1, y1}});
}

// The cylinder of radius 2 about the z axis, as high as 3, its first `quarters` quarters.
Json CylinderEntry(int quarters) {
  const double h = std::sqrt(0.5);
  const int corners[9][2] = {
      {1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}, {1, 0}};
  Json knots{0, 0, 0};
  for (int k = 1; k < quarters; ++k) knots.insert(knots.end(), {k, k});
  knots.insert(knots.end(), {quarters, quarters, quarters});
  Json points = Json::array(), weights = Json::array();
  for (int k = 0; k <= 2 * quarters; ++k) {
    for (const int z : {0, 3}) {
      points.push_back({2 * corners[k][0], 2 * corners[k][1], z});
      weights.push_back(k % 2 == 1 ? h : 1.0);
    }
  }
  return {{"type", "spline"},
          {"rational", true},
          {"dimension", 3},
          {"degree_u", 2},
          {"degree_v", 1},
          {"knotvector_u", knots},
          {"knotvector_v", {0, 0, 1, 1}},
          {"size_u", 2 * quarters + 1},
          {"size_v", 2},
          {"control_points", {{"points", points}, {"weights", weights}}}};
}

// The rectangle between two corners at z = 0.
Json PatchEntry(double x0, double y0, double x1, double y1) {
  return {{"type", "spline"},
          {"rational", false},
          {"dimension", 3},
          {"degree_u", 1},
          {"degree_v", 1},
          {"knotvector_u", {0, 0, 1, 1}},
          {"knotvector_v", {0, 0, 1, 1}},
          {"size_u", 2},
          {"size_v", 2},
          {"control_points", {{"points", {{x0, y0, 0}, {x0, y1, 0}, {x1, y0, 0}, {x1, y1, 0}}}}}};
}

class AnalyzeTest : public ::testing::Test {
 protected:
  static Json RunJson(std::vector<std::string> arguments) {
    arguments.push_back("--json");
    const ProgramRun run = Batten(arguments);
    EXPECT_EQ(run.code, 0) << run.err;
    return Json::parse(run.out);
  }
  static void ExpectRefused(const std::vector<std::string>& arguments,
                            int code,
                            const std::string& reason) {
    const ProgramRun run = Batten(arguments);
    EXPECT_EQ(run.code, code) << run.err;
    EXPECT_THAT(run.err, HasSubstr(reason));
    EXPECT_EQ(run.error_lines(), 1) << run.err;
    EXPECT_EQ(run.out, "");
  }
  std::string Curves(const std::string& name, const std::vector<Json>& entries) {
    return folder_.With(name, File("curve", entries).dump());
  }
  std::string Surfaces(const std::string& name, const std::vector<Json>& entries) {
    return folder_.With(name, File("surface", entries).dump());
  }

  TemporaryFolder folder_;
  static constexpr double kExact = 1e-9;
};

TEST_F(AnalyzeTest, AnArcIsDescribedWhole) {
  const Json arc = RunJson({"analyze", Curves("arc.json", {HalfCircle()})});
  EXPECT_EQ(arc["kind"], "curve");
  EXPECT_EQ(arc["degree"], Json({2}));
  EXPECT_EQ(arc["control_points"], Json({5}));
  EXPECT_EQ(arc["knots"], Json({{0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 2.0}}));
  EXPECT_EQ(arc["domain"], Json({{0.0, 2.0}}));
  EXPECT_EQ(arc["rational"], true);
  EXPECT_EQ(arc["closed"], Json({false}));
  EXPECT_EQ(arc["periodic"], Json({false}));
  EXPECT_EQ(arc["seam"], Json({nullptr}));
  EXPECT_EQ(arc["continuity"], Json({1}));  // the knot is double, the arcs go on with equal speed
  EXPECT_LT(Difference(arc["bounding_box"], Json({{1.0, 1.0}, {5.0, 3.0}})), kExact);
  EXPECT_NEAR(arc["length"].get<double>(), 2 * std::numbers::pi, kExact);
  EXPECT_NEAR(arc["curvature"]["min"].get<double>(), 0.5, kExact);
  EXPECT_NEAR(arc["curvature"]["max"].get<double>(), 0.5, kExact);
  EXPECT_EQ(arc["shape"], "circle");
  const Json& parameters = arc["shape_parameters"];
  EXPECT_LT(Difference(parameters["center"], Json({3.0, 1.0})), kExact);
  EXPECT_NEAR(parameters["radius"].get<double>(), 2, kExact);
  EXPECT_LT(Difference(parameters["normal"], Json({0.0, 0.0, 1.0})), kExact);
}

TEST_F(AnalyzeTest, ShapesAreNamed) {
  const auto shape_of = [&](const Json& entry) {
    return RunJson({"analyze", Curves("curve.json", {entry})})["shape"].get<std::string>();
  };
  const Json bezier{0, 0, 0, 1, 1, 1}, points{{0, 0}, {1, 2}, {3, 0}};
  EXPECT_EQ(shape_of(Line(0, 0, 3, 4)), "line");
  EXPECT_EQ(shape_of(CurveEntry(2, bezier, points)), "parabola");
  EXPECT_EQ(shape_of(CurveEntry(2, bezier, points, {1, 0.5, 1})), "ellipse");
  EXPECT_EQ(shape_of(CurveEntry(2, bezier, points, {1, 2, 1})), "hyperbola");
  EXPECT_EQ(shape_of(CurveEntry(1, {0, 0, 1, 2, 2}, points)), "free");
  const Json tube = RunJson({"analyze", Surfaces("tube.json", {CylinderEntry(4)})});
  EXPECT_EQ(tube["shape"], "cylinder");
  EXPECT_NEAR(tube["shape_parameters"]["radius"].get<double>(), 2, kExact);
  EXPECT_NEAR(tube["area"].get<double>(), 12 * std::numbers::pi, kExact);
  EXPECT_EQ(tube["closed"], Json({true, false}));
  EXPECT_EQ(tube["seam"], Json({1, nullptr}));
  const Json patch = RunJson({"analyze", Surfaces("patch.json", {PatchEntry(0, 0, 2, 3)})});
  EXPECT_EQ(patch["shape"], "plane");
  EXPECT_EQ(RunJson({"analyze", folder_.With("wavy.json", kRationalPatch)})["shape"], "free");
}

TEST_F(AnalyzeTest, ToleranceDecidesWhatIsNearlyALine) {
  const std::string path =
      Curves("bow.json", {CurveEntry(2, {0, 0, 0, 1, 1, 1}, {{0, 0}, {0.7, 1e-5}, {1, 0}})});
  EXPECT_NE(RunJson({"analyze", path})["shape"], "line");
  EXPECT_EQ(RunJson({"analyze", path, "--tolerance", "1e-4"})["shape"], "line");
}

TEST_F(AnalyzeTest, InfoSaysTheSameOfGeometry) {
  for (const std::string& path : {Curves("arc.json", {HalfCircle()}),
                                  Surfaces("tube.json", {CylinderEntry(3)}),
                                  Curves("two.json", {HalfCircle(), Line(0, 0, 1, 1)})}) {
    EXPECT_EQ(RunJson({"info", path}), RunJson({"analyze", path}));
  }
}

TEST_F(AnalyzeTest, SeveralGeometriesAreIndexed) {
  const std::string two = Curves("two.json", {HalfCircle(), Line(5, -1, 5, 1)});
  const Json results = RunJson({"analyze", two})["results"];
  ASSERT_EQ(results.size(), 2u);
  EXPECT_EQ(results[0]["index"], 0);
  EXPECT_EQ(results[1]["index"], 1);
  EXPECT_EQ(results[1]["shape"], "line");
  const Json joins = RunJson({"analyze", two, Curves("one.json", {Line(5, 2, 5, 1)})})["results"];
  ASSERT_EQ(joins.size(), 2u);
  EXPECT_EQ(joins[1]["index"], Json({1, 0}));
  EXPECT_EQ(joins[1]["join"]["G"], 2);
}

TEST_F(AnalyzeTest, CurvesThatMeet) {
  const std::string arc = Curves("arc.json", {HalfCircle()});
  const Json smooth = RunJson({"analyze", arc, Curves("down.json", {Line(1, 1, 1, -3)})})["join"];
  EXPECT_EQ(smooth["C"], 0);
  EXPECT_EQ(smooth["G"], 1);
  EXPECT_NEAR(smooth["position_gap"].get<double>(), 0, kExact);
  EXPECT_NEAR(smooth["angle_gap"].get<double>(), 0, kExact);
  EXPECT_NEAR(smooth["curvature_gap"].get<double>(), 0.5, kExact);
  EXPECT_EQ(smooth["at"], Json({2.0, 0.0}));
  const std::string corner = Curves("corner.json", {Line(5, 1, 7, 1)});
  const Json bent = RunJson({"analyze", arc, corner})["join"];
  EXPECT_EQ(bent["G"], 0);
  EXPECT_NEAR(bent["angle_gap"].get<double>(), std::numbers::pi / 2, kExact);
  EXPECT_EQ(bent["at"], Json({0.0, 0.0}));
  // A flag of tolerances is in degrees.
  EXPECT_EQ(RunJson({"analyze", arc, corner, "--angle-tolerance", "89"})["join"]["G"], 0);
  EXPECT_EQ(RunJson({"analyze", arc, corner, "--angle-tolerance", "91"})["join"]["G"], 1);
  const std::string apart = Curves("apart.json", {Line(1, 0.5, 1, -3)});
  const Json gap = RunJson({"analyze", arc, apart})["join"];
  EXPECT_EQ(gap["C"], -1);
  EXPECT_EQ(gap["G"], -1);
  EXPECT_NEAR(gap["position_gap"].get<double>(), 0.5, kExact);
  EXPECT_EQ(RunJson({"analyze", arc, apart, "--position-tolerance", "0.6"})["join"]["G"], 1);
}

TEST_F(AnalyzeTest, SurfacesThatMeet) {
  const std::string left = Surfaces("left.json", {PatchEntry(-1, 0, 0, 1)});
  const Json join = RunJson({"analyze", left, Surfaces("right.json", {PatchEntry(0, 0, 2, 1)})});
  EXPECT_EQ(join["join"]["G"], 2);
  EXPECT_EQ(join["join"]["C"], 0);
  EXPECT_EQ(join["join"]["edges"], Json({"u=1", "u=0"}));
  EXPECT_EQ(join["join"]["reversed"], false);
  EXPECT_EQ(join["join"]["at"][0][0], 1.0);
  EXPECT_EQ(join["join"]["at"][1][0], 0.0);
  ExpectRefused({"analyze", left, Surfaces("off.json", {PatchEntry(0, 0.5, 1, 1.5)})},
                1,
                "coincide over a part only");
}

TEST_F(AnalyzeTest, TheSameShapeTwiceIsAskedHowItCloses) {
  const std::string tube = Surfaces("tube.json", {CylinderEntry(4)});
  const Json seam = RunJson({"analyze", tube, tube});
  EXPECT_EQ(seam["direction"], "u");
  EXPECT_EQ(seam["join"]["G"], 2);
  EXPECT_EQ(seam["join"]["C"], 1);
  const std::string line = Curves("line.json", {Line(0, 0, 3, 4)});
  const Json open = RunJson({"analyze", line, line})["join"];
  EXPECT_EQ(open["G"], -1);
  EXPECT_EQ(open["position_gap"], 5.0);
}

TEST_F(AnalyzeTest, WhatCannotBeAnalyzedIsRefused) {
  const std::string curve = Curves("arc.json", {HalfCircle()});
  const std::string space =
      Curves("space.json", {CurveEntry(1, {0, 0, 1, 1}, {{0, 0, 0}, {1, 1, 1}})});
  const std::string surface = Surfaces("patch.json", {PatchEntry(0, 0, 1, 1)});
  ExpectRefused({"analyze", curve, surface}, 1, "two curves of one dimension or two surfaces");
  ExpectRefused({"analyze", curve, space}, 1, "two curves of one dimension or two surfaces");
  ExpectRefused({"analyze", folder_.File("none.json")}, 1, "none.json");
  ExpectRefused({"analyze", curve, "--tolerance", "0"}, 2, "--tolerance");
  ExpectRefused({"analyze", curve, "--tolerance", "x"}, 2, "--tolerance");
  ExpectRefused({"analyze", curve, "--angle-tolerance", "1"}, 2, "second geometry");
  ExpectRefused({"analyze", curve, curve, "--tolerance", "1"}, 2, "--position-tolerance");
  ExpectRefused({"analyze", "-", "-", "--format", "json"}, 2, "standard input");
}

TEST_F(AnalyzeTest, FirstComesWhatPeopleAskFor) {
  const std::string arc = Curves("arc.json", {HalfCircle()});
  const std::string text = Batten({"analyze", arc}).out;
  EXPECT_THAT(text, HasSubstr("kind         curve of degree 2, 5 control points, rational\n"));
  EXPECT_THAT(text, HasSubstr("shape        circle, radius 2\n"));
  EXPECT_THAT(text, HasSubstr("length       6.28319\n"));
  EXPECT_THAT(text, Not(HasSubstr("knots")));
  EXPECT_EQ(Batten({"info", arc}).out, text);
  EXPECT_EQ(Batten({"analyze", arc, "--all"}).out.substr(0, text.size()), text);
  EXPECT_EQ(Batten({"analyze", arc, "--json"}).out,
            Batten({"analyze", arc, "--json", "--all"}).out);
  const std::string many = Curves("many.json", std::vector<Json>(12, Line(0, 0, 3, 4)));
  EXPECT_THAT(Batten({"info", many}).out,
              AllOf(HasSubstr("0 surfaces, 12 curves\n"),
                    HasSubstr("shapes       12 line\n"),
                    HasSubstr("size         3 x 4 x 0, from 0, 0, 0\n"),
                    HasSubstr("… 4 more\n")));
}

TEST_F(AnalyzeTest, AllTextForPeopleHoldsTheSame) {
  const std::string arc = Curves("arc.json", {HalfCircle()});
  const ProgramRun run = Batten({"analyze", arc, "--all"});
  EXPECT_EQ(run.code, 0);
  EXPECT_THAT(run.out,
              AllOf(HasSubstr("degree               [2]\n"),
                    HasSubstr("shape                circle\n"),
                    HasSubstr("  radius             2.0\n")));
  const ProgramRun quiet = Batten({"analyze", arc, "--quiet"});
  EXPECT_EQ(quiet.out + quiet.err, "");
  EXPECT_THAT(Batten({"analyze", arc, arc}).out, HasSubstr("  position_gap "));
  EXPECT_THAT(Batten({"analyze", "--help"}).out,
              AllOf(HasSubstr("Examples:"), HasSubstr("--position-tolerance"), HasSubstr("1e-09")));
}

}  // namespace batten::internal::analyze_test
