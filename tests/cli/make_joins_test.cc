// SPDX-License-Identifier: MIT
// batten make conic, blend and fill; edit unify, continue and the forms; what analyze says of
// pieces.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "batten/geometry/classify_shape.h"
#include "batten/io/geometry_file.h"
#include "run_program.h"
#include "tolerances.h"

namespace batten::internal::make_joins_test {

using ::testing::HasSubstr;
using Json = nlohmann::json;

class MakeJoinsTest : public ::testing::Test {
 protected:
  std::string File(const std::string& name) const { return folder_.File(name); }

  ProgramRun Run(std::vector<std::string> words, const std::string& out) const {
    words.insert(words.end(), {"-o", File(out)});
    return Batten(words);
  }
  NurbsCurve<3> Curve(const std::vector<std::string>& words) const {
    const ProgramRun run = Run(words, "made.json");
    EXPECT_EQ(run.code, 0) << run.err;
    return std::get<NurbsCurve<3>>(ReadGeometry(File("made.json")).at(0));
  }
  void Refused(const std::vector<std::string>& words, const std::string& said, int code = 2) const {
    const std::ptrdiff_t before = folder_.Entries();
    const ProgramRun run = Run(words, "never.json");
    EXPECT_EQ(run.code, code) << run.err;
    EXPECT_EQ(run.error_lines(), 1) << run.err;
    EXPECT_THAT(run.err, HasSubstr(said));
    EXPECT_EQ(folder_.Entries(), before);
  }
  Json Analyzed(const std::string& name) const {
    return Json::parse(Batten({"analyze", File(name), "--json"}).out);
  }
  std::string Shape(const NurbsCurve<3>& curve) const { return NameOf(ClassifyShape(curve)); }

  TemporaryFolder folder_;
};

TEST_F(MakeJoinsTest, ConicsByWhatIsKnownOfThem) {
  EXPECT_EQ(Shape(Curve({"make",
                         "conic",
                         "--ends",
                         "0,0,0;4,0,0",
                         "--tangents",
                         "0,1,0;0,-1,0",
                         "--point",
                         "2,2,0"})),
            "circle");
  EXPECT_EQ(Shape(Curve(
                {"make", "conic", "--ends", "0,0;4,0", "--tangents", "1,1;1,-1", "--rho", "0.5"})),
            "parabola");
  EXPECT_EQ(
      Shape(Curve({"make", "conic", "--ends", "0,0;4,0", "--shoulder", "2,1", "--rho", "0.8"})),
      "hyperbola");
  EXPECT_EQ(Shape(Curve({"make", "conic", "--points", "2,0;0,1;-2,0;0,-1;1.2,-0.8"})), "ellipse");
  EXPECT_EQ(Shape(Curve({"make", "conic", "--implicit", "1,0,1,0,0,-4"})), "circle");
  EXPECT_EQ(
      Shape(Curve(
          {"make", "conic", "--implicit", "0,1,0,0,0,-1", "--from", "0.5,2", "--to", "2,0.5"})),
      "hyperbola");
  const NurbsCurve<3> half = Curve({"make", "conic", "--homogeneous", "3,0,0,1;0,2,0,0;-3,0,0,1"});
  EXPECT_EQ(Shape(half), "ellipse");
  EXPECT_NEAR(half.At(0.5)[1], 2, kRounding);
  const NurbsCurve<3> placed = Curve({"make",
                                      "conic",
                                      "--implicit",
                                      "1,0,1,0,0,-4",
                                      "--from",
                                      "2,0",
                                      "--to",
                                      "0,2",
                                      "--center",
                                      "10,0,0",
                                      "--axis",
                                      "1,0,0",
                                      "--x-axis",
                                      "0,1,0"});
  EXPECT_LE((placed.At(1) - Eigen::Vector3d(10, 0, 2)).norm(), kRounding * 10);
}

TEST_F(MakeJoinsTest, ConicsThatAreNoneAreRefused) {
  Refused({"make", "conic", "--implicit", "1,0,-1,0,0,0", "--from", "1,1", "--to", "2,2"},
          "two crossing lines");
  Refused({"make", "conic", "--implicit", "1,0,0,0,-1,0"}, "the conic is parabola");
  Refused({"make", "conic", "--points", "0,0;1,1;2,2;3,3;4,5"}, "lie on one line");
  Refused({"make", "conic"}, "one of --ends, --points, --implicit and --homogeneous");
  Refused({"make", "conic", "--ends", "0,0;4,0"}, "needs --tangents or --shoulder");
  Refused({"make", "conic", "--ends", "0,0;4", "--shoulder", "1,1"}, "2 points take 6");
  Refused({"make", "conic", "--homogeneous", "0,0,0,1;1,1,0,-2;2,0,0,1"}, "through infinity");
  Refused({"make", "conic", "--points", "0,0;1,1;2,1;3,0;1e308,-1e308"}, "beyond 1e100");
  Refused({"make", "conic", "--ends", "0,0;1e300,0", "--tangents", "0,1;0,-1", "--rho", "0.4"},
          "beyond 1e100");
  Refused({"make", "conic", "--ends", "0,0;0,0", "--tangents", "0,1;0,-1", "--rho", "0.4"},
          "give two that differ");
  Refused({"make", "conic", "--ends", "0,0;4,0", "--points", "0,0;1,1;2,1;3,0;4,-2"}, "not 2");
  Refused({"make",
           "conic",
           "--ends",
           "0,0;4,0",
           "--tangents",
           "0,1;0,-1",
           "--rho",
           "0.4",
           "--point",
           "2,1,0"},
          "not both");
}

TEST_F(MakeJoinsTest, FormsOfCircles) {
  EXPECT_EQ(Curve({"make", "circle", "--radius", "2", "--form", "7"}).basis().size(), 7);
  const NurbsCurve<3> quintic = Curve({"make", "circle", "--radius", "2", "--form", "degree5"});
  EXPECT_EQ(quintic.basis().size(), 6);
  EXPECT_EQ(Shape(quintic), "circle");
  EXPECT_EQ(
      Curve({"make", "arc", "--radius", "2", "--sweep", "170", "--segments", "1"}).basis().size(),
      3);
  Refused({"make", "arc", "--radius", "2", "--sweep", "200", "--segments", "1"}, "180 degrees");
  Refused({"make", "circle", "--radius", "2", "--form", "8"}, "--form");
}

TEST_F(MakeJoinsTest, BlendsSayHowTheyMeet) {
  ASSERT_EQ(Run({"make", "line", "--from", "0,0,0", "--to", "1,0,0"}, "a.json").code, 0);
  ASSERT_EQ(Run({"make", "arc", "--radius", "2", "--center", "3,3,0"}, "b.json").code, 0);
  const ProgramRun run =
      Run({"make", "blend", File("a.json"), File("b.json"), "--json"}, "ab.json");
  ASSERT_EQ(run.code, 0) << run.err;
  const Json entry = Json::parse(run.out)["files"][0];
  EXPECT_EQ(entry["join_from"]["G"], 2);
  EXPECT_EQ(entry["join_to"]["G"], 2);
  EXPECT_LE(entry["join_to"]["position_gap"], kRounding);
  EXPECT_THAT(Batten({"analyze", File("a.json"), File("ab.json")}).out,
              HasSubstr("G                  2"));
  ASSERT_EQ(Run({"make", "plane", "--size", "4,4"}, "p.json").code, 0);
  ASSERT_EQ(
      Run({"make", "cylinder", "--radius", "1", "--height", "2", "--center", "6,0,1"}, "c.json")
          .code,
      0);
  Refused({"make", "blend", File("a.json"), File("p.json")}, "not one of each");
  Refused({"make", "blend", File("a.json")}, "hold 1 geometries");
  const ProgramRun edges = Run({"make",
                                "blend",
                                File("p.json"),
                                File("p.json"),
                                "--from-edge",
                                "u1",
                                "--to-edge",
                                "u0",
                                "--continuity",
                                "1",
                                "--json"},
                               "pp.json");
  EXPECT_EQ(edges.code, 0) << edges.err << edges.out;
  Refused({"make", "blend", File("a.json"), File("b.json"), "--fullness", "1e9"},
          "more than 100 widths of the gap");
  Refused({"make", "blend", File("p.json"), File("c.json"), "--from-edge", "u1", "--to-edge", "v0"},
          "one edge closes and the other is open, its ends 4 apart");
}

TEST_F(MakeJoinsTest, HolesAreFilled) {
  ASSERT_EQ(Run({"make", "line", "--from", "0,0,0", "--to", "3,0,0"}, "a.json").code, 0);
  ASSERT_EQ(Run({"make", "line", "--from", "0,2,0", "--to", "3,0,0"}, "b.json").code, 0);
  const auto strip = [&](const std::string& far, const std::string& name) {
    return Run({"make",
                "bilinear",
                "--corner-00",
                "0,0,0",
                "--corner-10",
                "0,2,0",
                "--corner-01",
                "-1,0,0",
                "--corner-11",
                far},
               name)
        .code;
  };
  ASSERT_EQ(strip("-1,2,0", "c.json"), 0);
  ASSERT_EQ(strip("-1,2,0.5", "bent.json"), 0);
  const auto fill = [&](const std::string& third, const std::string& out) {
    return Run({"make", "fill", File("a.json"), File("b.json"), File(third) + ":v0", "--json"},
               out);
  };
  const ProgramRun run = fill("c.json", "hole.step");
  ASSERT_EQ(run.code, 0) << run.err << run.out;
  const Json entry = Json::parse(run.out)["files"][0];
  EXPECT_EQ(entry["tolerance_reached"], true);
  EXPECT_LE(entry["outer_angle"], 1e-4);
  EXPECT_EQ(ReadGeometry(File("hole.step")).size(), 3u);
  const ProgramRun sewn =
      Batten({"convert", File("hole.step"), File("sewn.step"), "--sew", "1e-5", "--json"});
  EXPECT_EQ(Json::parse(sewn.out)["files"][0]["sewing"]["shells"], 1) << sewn.out;
  // A neighbour that is not tangent to the sides at its corners can't be met there: that is said.
  const ProgramRun bent = fill("bent.json", "bent.step");
  EXPECT_EQ(bent.code, 3) << bent.err << bent.out;
  EXPECT_GT(Json::parse(bent.out)["files"][0]["outer_angle"], 0.1);
  Refused({"make", "fill", File("a.json"), File("b.json")}, "three to six");
  Refused({"make", "fill", File("a.json"), File("b.json"), File("c.json")}, "name its edge");
  Refused({"make", "fill", File("a.json"), File("b.json"), File("c.json") + ":u1"},
          "loop stays open by");
  Refused({"make", "fill", File("a.json"), File("b.json"), File("c.json") + ":u2"},
          "'u2' is no edge of a surface; they are u0, u1, v0 and v1");
}

TEST_F(MakeJoinsTest, ChainsAreUnifiedAndTheirPiecesNamed) {
  ASSERT_EQ(Run({"make", "line", "--from", "0,0,0", "--to", "4,0,0"}, "line.json").code, 0);
  ASSERT_EQ(Run({"make",
                 "arc",
                 "--radius",
                 "2",
                 "--center",
                 "4,2,0",
                 "--start-angle",
                 "-90",
                 "--sweep",
                 "180"},
                "arc.json")
                .code,
            0);
  ASSERT_EQ(Run({"edit", File("line.json"), "unify:with=" + File("arc.json")}, "chain.json").code,
            0);
  const Json chain = Analyzed("chain.json");
  EXPECT_EQ(chain["degree"][0], 3);
  ASSERT_EQ(chain["pieces"].size(), 2u);
  EXPECT_EQ(chain["pieces"][0]["shape"], "line");
  EXPECT_EQ(chain["pieces"][1]["shape"], "circle");
  EXPECT_NEAR(chain["pieces"][1]["shape_parameters"]["radius"], 2, kIterated);
  ASSERT_EQ(Run({"make", "line", "--from", "9,0,0", "--to", "8,0,0"}, "far.json").code, 0);
  Refused({"edit", File("line.json"), "unify:with=" + File("far.json")},
          "the nearest, " + File("far.json") + ", is 4 from an end");
  ASSERT_EQ(Run({"make", "circle", "--radius", "2"}, "ring.json").code, 0);
  Refused({"edit", File("line.json"), "unify:with=" + File("arc.json") + ";" + File("ring.json")},
          File("ring.json") + " is closed");
  Refused({"edit", File("ring.json"), "unify:with=" + File("arc.json")},
          "the edited file is closed");
  ASSERT_EQ(Run({"make", "plane", "--size", "4,4"}, "p.json").code, 0);
  Refused({"edit", File("p.json"), "unify"}, "only curves");
}

TEST_F(MakeJoinsTest, FormsGoRound) {
  ASSERT_EQ(Run({"make", "arc", "--radius", "2", "--sweep", "200"}, "arc.json").code, 0);
  ASSERT_EQ(Run({"edit", File("arc.json"), "elevate", "to-power"}, "power.json").code, 0);
  const Json text = Json::parse(folder_.Text("power.json"));
  EXPECT_EQ(text["shape"]["data"][0]["form"], "power");
  const NurbsCurve<3> back = Curve({"edit", File("power.json"), "to-bspline"});
  EXPECT_EQ(Shape(back), "circle");
  Refused({"edit", File("arc.json"), "to-power", "elevate"}, "last operation");
  const ProgramRun step = Run({"edit", File("arc.json"), "to-power"}, "power.step");
  EXPECT_EQ(step.code, 2);
  EXPECT_THAT(step.err, HasSubstr("only .json holds powers"));
  ASSERT_EQ(Run({"make", "torus", "--major-radius", "5", "--minor-radius", "1"}, "torus.json").code,
            0);
  ASSERT_EQ(Run({"edit", File("torus.json"), "to-power"}, "torus-power.json").code, 0);
  EXPECT_EQ(Analyzed("torus-power.json")["shape"], "torus");
  const NurbsCurve<3> spline = Curve({"edit", File("arc.json"), "insert-knot:at=0.3", "to-bezier"});
  EXPECT_EQ(spline.basis().Multiplicity(0.3), 2);
}

TEST_F(MakeJoinsTest, ContinuationsGoOn) {
  ASSERT_EQ(Run({"make", "arc", "--radius", "2"}, "arc.json").code, 0);
  ASSERT_EQ(
      Run({"edit", File("arc.json"), "continue:end=upper,to=-4;1;0,beta=0.7"}, "both.json").code,
      0);
  EXPECT_EQ(ReadGeometry(File("both.json")).size(), 2u);
  EXPECT_THAT(Batten({"analyze", File("arc.json"), File("both.json"), "--json"}).out,
              HasSubstr("\"G\": 2"));
  Refused({"edit", File("arc.json"), "continue:end=upper,to=1;2;3,beta=-1"},
          "beta = -1 is not positive");
  Refused({"edit", File("arc.json"), "continue:to=1;2;3"}, "'end' is missing");
}

TEST_F(MakeJoinsTest, AnalyzeNamesConicsAndCubics) {
  ASSERT_EQ(Run({"make", "conic", "--ends", "0,0;4,0", "--tangents", "1,1;1,-1", "--rho", "0.4"},
                "e.json")
                .code,
            0);
  const Json conic = Analyzed("e.json");
  EXPECT_EQ(conic["pieces"][0]["shape"], "ellipse");
  EXPECT_EQ(conic["pieces"][0]["shape_parameters"]["foci"].size(), 2u);
  EXPECT_NEAR(conic["pieces"][0]["shape_factor"], 2.25, kIterated);  // w1 = 2/3
  const std::string cubic =
      folder_.With("loop.json", R"({"shape": {"type": "curve", "count": 1, "data": [
    {"type": "spline", "dimension": 2, "degree": 3, "knotvector": [0,0,0,0,1,1,1,1],
     "control_points": {"points": [[0,0],[3,2],[-2,2],[1,0]]}}]}})");
  const Json loop = Analyzed("loop.json");
  EXPECT_EQ(loop["cubics"][0]["kind"], "loop");
  EXPECT_THAT(Batten({"analyze", cubic}).out, HasSubstr("crosses"));
}

}  // namespace batten::internal::make_joins_test
