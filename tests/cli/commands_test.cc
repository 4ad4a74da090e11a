// SPDX-License-Identifier: MIT
// Laws of convert, evaluate, info and sample, and what holds for every command.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "batten/io/geometry_file.h"
#include "test_clouds.h"

namespace batten::internal::commands_test {

using ::testing::HasSubstr;

class CommandsTest : public ::testing::Test {
 protected:
  static void Run(const std::vector<std::string>& arguments) {
    const ProgramRun run = Batten(arguments);
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(run.err, "");
  }
  static Json RunJson(std::vector<std::string> arguments) {
    arguments.push_back("--json");
    const ProgramRun run = Batten(arguments);
    EXPECT_EQ(run.code, 0) << run.err;
    return Json::parse(run.out);  // throws where there is more than one value
  }

  TemporaryFolder folder_;
  std::string patch_ = folder_.With("patch.json", kRationalPatch);
  std::string parabola_ = folder_.With("parabola.json", kParabola);
  std::string cloud_ = folder_.With("cloud.xyz", ToText(WavySheet(2000)));
};

TEST_F(CommandsTest, JsonToStepToJsonIsTheSameGeometry) {
  Run({"convert", patch_, folder_.File("first.json")});
  Run({"convert", patch_, folder_.File("a.step")});
  Run({"convert", folder_.File("a.step"), folder_.File("back.json")});
  constexpr double kRelative = 1e-12, kExtent = 3;
  EXPECT_LT(Difference(Entry(folder_.Text("back.json")), Entry(folder_.Text("first.json"))),
            kRelative * kExtent);
  Run({"convert", folder_.File("first.json"), folder_.File("second.json")});
  EXPECT_EQ(folder_.Text("second.json"), folder_.Text("first.json"));
  Run({"convert", patch_, folder_.File("b.step")});
  EXPECT_EQ(folder_.Text("b.step"), folder_.Text("a.step"));
}

TEST_F(CommandsTest, TrimmedSurfacesPassThroughIgesAndStep) {
  const std::string hole =
      R"("trims": {"count": 1, "data": [{"type": "spline", "degree": 1, "knotvector": [0, 0, 1, 2, 3, 3],
      "control_points": {"points": [[0.5, 0.25], [1.5, 0.25], [1, 0.75], [0.5, 0.25]]}, "reversed": 0}]},
      "degree_u")";
  std::string text = kRationalPatch;
  text.replace(text.find("\"degree_u\""), std::string("\"degree_u\"").size(), hole);
  const std::string trimmed = folder_.With("trimmed.json", text);
  Run({"convert", trimmed, folder_.File("first.json")});
  EXPECT_EQ(Entry(folder_.Text("first.json"))["trims"]["count"], 1);
  for (const std::string name : {"a.igs", "a.iges", "a.step"}) {
    Run({"convert", trimmed, folder_.File(name)});
    Run({"convert", folder_.File(name), folder_.File("back.json")});
    EXPECT_EQ(folder_.Text("back.json"), folder_.Text("first.json")) << name;
  }
}

TEST_F(CommandsTest, PlaneAndPeriodicCurvesBecomeStepAsHelpSays) {
  Run({"convert", parabola_, folder_.File("flat.step")});
  Run({"convert", folder_.File("flat.step"), folder_.File("flat.json")});
  const Json flat = Entry(folder_.Text("flat.json"));
  EXPECT_EQ(flat["dimension"], 3);
  EXPECT_EQ(flat["control_points"]["points"][1], Json({1.0, 2.0, 0.0}));

  const std::string round = folder_.With(
      "round.json",
      R"({"shape": {"type": "curve", "count": 1, "data": [{"type": "spline", "dimension": 3, "degree": 2,
      "periodic": [true], "knotvector": [-2, -1, 0, 1, 2, 3, 4, 5, 6], "control_points":
      {"points": [[0, 0, 1], [1, 0, 2], [1, 1, 1], [0, 1, 2], [0, 0, 1], [1, 0, 2]]}}]}})");
  Run({"convert", round, folder_.File("first.json")});
  EXPECT_EQ(Entry(folder_.Text("first.json"))["periodic"], Json({true}));
  Run({"convert", folder_.File("first.json"), folder_.File("second.json")});
  EXPECT_EQ(folder_.Text("second.json"), folder_.Text("first.json"));
  Run({"convert", round, folder_.File("round.step")});
  Run({"convert", folder_.File("round.step"), folder_.File("closed.json")});
  const Json closed = Entry(folder_.Text("closed.json"));
  EXPECT_FALSE(closed.contains("periodic"));
  const Json& points = closed["control_points"]["points"];
  EXPECT_EQ(points.front(), points.back());
  EXPECT_LT(
      Difference(
          RunJson({"evaluate", round, "--at", "0.7"})["results"][0]["point"],
          RunJson({"evaluate", folder_.File("closed.json"), "--at", "0.7"})["results"][0]["point"]),
      1e-12);
}

TEST_F(CommandsTest, UnitOfTheDataIsDeclaredButChangesNoNumber) {
  Run({"convert", patch_, folder_.File("mm.step"), "--unit", "mm"});
  Run({"convert", patch_, folder_.File("inch.step"), "--unit", "inch"});
  EXPECT_NE(folder_.Text("mm.step"), folder_.Text("inch.step"));
  Run({"convert", folder_.File("mm.step"), folder_.File("mm.json")});
  Run({"convert", folder_.File("inch.step"), folder_.File("inch.json")});
  EXPECT_LT(Difference(Entry(folder_.Text("mm.json")), Entry(folder_.Text("inch.json"))), 1e-12);
}

TEST_F(CommandsTest, CloudFormatsHoldTheSamePoints) {
  Run({"convert", cloud_, folder_.File("a.ply")});
  Run({"convert", folder_.File("a.ply"), folder_.File("b.pcd")});
  Run({"convert", folder_.File("b.pcd"), folder_.File("c.csv")});
  Run({"convert", folder_.File("c.csv"), folder_.File("d.xyz")});
  EXPECT_EQ(folder_.Text("d.xyz"), folder_.Text("cloud.xyz"));
}

TEST_F(CommandsTest, ConvertReadsAndWritesStandardStreams) {
  const ProgramRun csv = Batten({"convert", cloud_, "-", "--format", "csv"});
  EXPECT_EQ(csv.code, 0) << csv.err;
  EXPECT_EQ(csv.out.substr(0, 6), "x,y,z\n");
  const ProgramRun back =
      Batten({"convert", "-", "-", "--format", "csv", "--output-format", "xyz"}, {csv.out, {}});
  EXPECT_EQ(back.out, folder_.Text("cloud.xyz"));
  Run({"convert", cloud_, folder_.File("a.pcd")});
  EXPECT_EQ(Batten({"convert", folder_.File("a.pcd"), "-", "--format", "xyz"}).out,
            folder_.Text("cloud.xyz"));
  EXPECT_THAT(Batten({"convert", patch_, "-", "--format", "step"}).out,
              ::testing::StartsWith("ISO-10303-21;"));
}

TEST_F(CommandsTest, EvaluateGivesWhatTheLibraryGives) {
  constexpr int kOrder = 3;
  const NurbsSurface surface = std::get<NurbsSurface>(ReadGeometry(patch_).front());
  const Json results = RunJson({"evaluate",
                                patch_,
                                "--at",
                                "0.3,0.8",
                                "--at",
                                "1,0",
                                "--at",
                                "2,1",
                                "--derivatives",
                                "3"})["results"];
  ASSERT_EQ(results.size(), 3u);
  for (const Json& result : results) {
    const double u = result["at"][0], v = result["at"][1];
    const SurfaceDerivatives expected = surface.Derivatives(u, v, kOrder);
    const Json& d = result["derivatives"];
    ASSERT_EQ(d.size(), kOrder + 1u);
    for (int k = 0; k <= kOrder; ++k) {
      ASSERT_EQ(d[k].size(), static_cast<std::size_t>(kOrder + 1 - k));  // k + l ≤ K
      for (int l = 0; k + l <= kOrder; ++l) {
        for (int c = 0; c < 3; ++c) EXPECT_DOUBLE_EQ(d[k][l][c].get<double>(), expected(k, l)[c]);
      }
    }
    EXPECT_EQ(result["point"], d[0][0]);
    const Eigen::Vector3d normal = *surface.NormalAt(u, v);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(result["normal"][c].get<double>(), normal[c], 1e-14);
    const Json& curvature = result["curvature"];
    const double low = curvature["principal"][0], high = curvature["principal"][1];
    EXPECT_LE(low, high);
    EXPECT_NEAR(low * high, curvature["gaussian"].get<double>(), 1e-12);
    EXPECT_NEAR((low + high) / 2, curvature["mean"].get<double>(), 1e-12);
  }
}

TEST_F(CommandsTest, EvaluateOfAPlaneCurveGivesPairs) {
  const Json result =
      RunJson({"evaluate", parabola_, "--at", "0.5", "--derivatives", "2"})["results"][0];
  EXPECT_EQ(result["derivatives"], Json({{1.0, 1.0}, {2.0, 0.0}, {0.0, -8.0}}));
  EXPECT_DOUBLE_EQ(result["curvature"]["curvature"].get<double>(), 2.0);
  EXPECT_EQ(result["curvature"]["torsion"], 0.0);
}

TEST_F(CommandsTest, EvaluateTakesParametersFromAFile) {
  const std::string file = folder_.With("at.csv", "u,v\n0.25,0.5\n1 1\n# done\n");
  const Json from_file = RunJson({"evaluate", patch_, "--at-file", file});
  EXPECT_EQ(from_file, RunJson({"evaluate", patch_, "--at", "0.25,0.5", "--at", "1,1"}));
}

TEST_F(CommandsTest, InfoDescribesACloud) {
  const std::string path = folder_.With(
      "c.xyz", ToText(WavySheet(500), "x y z\n") + "nan 0 0\n" + ToText({WavySheet(500)[0]}));
  const Json info = RunJson({"info", path});
  EXPECT_EQ(info["kind"], "cloud");
  EXPECT_EQ(info["points"], 502);
  EXPECT_EQ(info["non_finite"], 1);
  EXPECT_EQ(info["duplicates"], 1);
  EXPECT_EQ(info["fields"], Json({"x", "y", "z"}));
  EXPECT_NEAR(info["bounding_box"][1][0].get<double>(), 10, 0.1);
  EXPECT_NEAR(info["noise"].get<double>(), 0.005, 0.003);
  for (const char* key : {"origin", "spacing", "outliers"}) EXPECT_TRUE(info.contains(key)) << key;
}

TEST_F(CommandsTest, InfoSaysInAFewLinesWhatACloudIs) {
  const std::string text = Batten({"info", cloud_}).out;
  EXPECT_LE(std::count(text.begin(), text.end(), '\n'), 8);
  EXPECT_THAT(text, HasSubstr("kind         cloud of 2000 points\n"));
  EXPECT_THAT(text, HasSubstr("noise        0.00"));
  EXPECT_THAT(text, HasSubstr("columns      1 2 3\n"));
  EXPECT_THAT(Batten({"info", cloud_, "--all"}).out, HasSubstr("bounding_box "));
  // Places keep their digits far from zero.
  const std::string far =
      folder_.With("far.xyz", "500000.25 4e6 0\n500010.25 4000004 1\n500003.25 4000009 2\n");
  EXPECT_THAT(Batten({"info", far}).out, HasSubstr("from 500000.25, 4000000, 0\n"));
}

TEST_F(CommandsTest, InfoDescribesACurve) {
  const Json info = RunJson({"info", parabola_});
  EXPECT_EQ(info["kind"], "curve");
  EXPECT_EQ(info["degree"], Json({2}));
  EXPECT_EQ(info["control_points"], Json({3}));
  EXPECT_EQ(info["knots"], Json({{0.0, 0.0, 0.0, 1.0, 1.0, 1.0}}));
  EXPECT_EQ(info["domain"], Json({{0.0, 1.0}}));
  EXPECT_EQ(info["rational"], false);
  EXPECT_EQ(info["closed"], Json({false}));
  EXPECT_EQ(info["periodic"], Json({false}));
  constexpr double kQuadrature = 1e-9;
  EXPECT_LT(Difference(info["bounding_box"], Json({{0.0, 0.0}, {2.0, 1.0}})), kQuadrature);
  EXPECT_NEAR(info["length"].get<double>(), std::sqrt(5) + std::asinh(2) / 2, kQuadrature);
  EXPECT_NEAR(info["curvature"]["max"].get<double>(), 2, kQuadrature);
}

TEST_F(CommandsTest, InfoFindsTheAreaAndBoxOfACylinder) {
  const double r = std::sqrt(0.5);
  Json entry{{"type", "spline"},
             {"rational", true},
             {"dimension", 3},
             {"degree_u", 2},
             {"degree_v", 1},
             {"knotvector_u", {0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4}},
             {"knotvector_v", {0, 0, 1, 1}},
             {"size_u", 9},
             {"size_v", 2}};
  const int corners[9][2] = {
      {1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}, {1, 0}};
  for (int k = 0; k < 9; ++k) {
    for (int z : {0, 3}) {
      entry["control_points"]["points"].push_back({2 * corners[k][0], 2 * corners[k][1], z});
      entry["control_points"]["weights"].push_back(k % 2 == 1 ? r : 1.0);
    }
  }
  const Json file{{"shape", {{"type", "surface"}, {"count", 1}, {"data", Json::array({entry})}}}};
  const Json info = RunJson({"info", folder_.With("cylinder.json", file.dump())});
  EXPECT_EQ(info["closed"], Json({true, false}));
  EXPECT_EQ(info["rational"], true);
  EXPECT_NEAR(info["area"].get<double>(), 12 * std::numbers::pi, 1e-6);
  EXPECT_LT(Difference(info["bounding_box"], Json({{-2, -2, 0}, {2, 2, 3}})), 1e-9);
  const double low = info["curvature"]["min"], high = info["curvature"]["max"];
  EXPECT_NEAR(std::max(std::abs(low), std::abs(high)), 0.5, 1e-9);
}

TEST_F(CommandsTest, SampledPointsLieOnTheSurfaceWhenThereIsNoNoise) {
  const std::string points = folder_.File("points.ply");
  Run({"sample", patch_, "-o", points, "--count", "2000"});
  const Json report = RunJson({"compare", patch_, points});
  EXPECT_EQ(report["input"]["points"], 2000);
  EXPECT_LT(report["error"]["max"], 1e-12);
}

TEST_F(CommandsTest, SampleIsReproducibleBySeed) {
  for (const auto& [name, seed] : {std::pair{"a.csv", "7"}, {"b.csv", "7"}, {"c.csv", "8"}}) {
    Run({"sample",
         patch_,
         "-o",
         folder_.File(name),
         "--count",
         "1000",
         "--noise",
         "0.01",
         "--outliers",
         "0.02",
         "--seed",
         seed});
  }
  EXPECT_EQ(folder_.Text("a.csv"), folder_.Text("b.csv"));
  EXPECT_NE(folder_.Text("a.csv"), folder_.Text("c.csv"));
}

TEST_F(CommandsTest, SampleNoiseHasTheDeviationAskedFor) {
  const std::string points = folder_.File("points.pcd");
  Run({"sample", patch_, "-o", points, "--count", "5000", "--noise", "0.01"});
  EXPECT_NEAR(RunJson({"compare", patch_, points})["error"]["rms"].get<double>(), 0.01, 0.001);
}

TEST_F(CommandsTest, SeveralGeometriesAreIndexed) {
  Json two = Json::parse(kRationalPatch);
  two["shape"]["data"].push_back(two["shape"]["data"][0]);
  two["shape"]["count"] = 2;
  const std::string path = folder_.With("two.json", two.dump());
  EXPECT_EQ(RunJson({"evaluate", path, "--at", "0,0"})["results"][1]["index"], 1);
  EXPECT_EQ(RunJson({"info", path})["results"][1]["index"], 1);
  EXPECT_EQ(RunJson({"convert", path, folder_.File("two.step")})["files"][0]["count"], 2);
}

TEST_F(CommandsTest, EveryCommandIsSilentWhenQuietAndOneObjectWhenJson) {
  const std::string out = folder_.File("out.json"), points = folder_.File("points.ply");
  for (const std::vector<std::string>& command :
       std::vector<std::vector<std::string>>{{"fit", "surface", cloud_, "-o", out},
                                             {"compare", patch_, cloud_},
                                             {"evaluate", patch_, "--at", "0,0"},
                                             {"project", patch_, cloud_},
                                             {"edit", patch_, "-o", out, "reverse:dir=u"},
                                             {"convert", patch_, out},
                                             {"convert", cloud_, points},
                                             {"info", cloud_},
                                             {"info", patch_},
                                             {"sample", patch_, "-o", points, "--count", "10"}}) {
    std::vector<std::string> quiet = command;
    quiet.push_back("--quiet");
    const ProgramRun run = Batten(quiet);
    EXPECT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(run.out + run.err, "") << command[0];
    EXPECT_TRUE(RunJson(command).is_object()) << command[0];
    EXPECT_NE(Batten(command).out, "") << command[0];
  }
}

TEST_F(CommandsTest, InterruptedWorkLeavesNothingWithinASecond) {
  const std::string big = folder_.File("big.ply");
  Run({"sample", patch_, "-o", big, "--count", "1000000", "--noise", "0.01"});
  constexpr double kAfter = 0.3, kWithin = 1;
  for (const std::vector<std::string>& command : std::vector<std::vector<std::string>>{
           {"fit",
            "surface",
            big,
            "-o",
            folder_.File("out.step"),
            "--residuals",
            folder_.File("out.csv")},
           {"compare", patch_, big, "--residuals", folder_.File("out.csv")},
           {"project", patch_, big},
           {"sample", patch_, "-o", folder_.File("out.xyz"), "--count", "10000000"}}) {
    const std::ptrdiff_t before = folder_.Entries();
    const ProgramRun run = Batten(command, {"", kAfter});
    EXPECT_EQ(run.code, 130) << run.err;
    EXPECT_LT(run.seconds, kAfter + kWithin) << command[0];
    EXPECT_THAT(run.err, HasSubstr("interrupted"));
    EXPECT_EQ(run.error_lines(), 1) << run.err;
    EXPECT_EQ(folder_.Entries(), before) << command[0];
  }
}

}  // namespace batten::internal::commands_test
