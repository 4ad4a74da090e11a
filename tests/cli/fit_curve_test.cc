// SPDX-License-Identifier: MIT
// Laws of `batten fit curve`, and of `batten fit surface` at given parameters.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test_clouds.h"

namespace batten::internal::fit_curve_test {

using ::testing::HasSubstr;

// x, y of a steep step on [0, 1].
std::vector<Row> Step(int points) {
  std::vector<Row> rows;
  for (int k = 0; k < points; ++k) {
    const double x = k / (points - 1.0);
    rows.push_back({x, 1 / (1 + std::exp(-30 * (x - 0.4)))});
  }
  return rows;
}

// u, v, x, y, z on half a cylinder, u the angle in degrees.
std::vector<Row> HalfCylinder(int points) {
  std::mt19937_64 engine(5);
  const auto uniform = [&] { return static_cast<double>(engine() >> 11) * 0x1p-53; };
  std::vector<Row> rows;
  for (int k = 0; k < points; ++k) {
    const double a = 180 * uniform(), h = 4 * uniform(), angle = a * std::numbers::pi / 180;
    rows.push_back({a, h, std::cos(angle), std::sin(angle), h});
  }
  return rows;
}

class FitCurveCommandTest : public ::testing::Test {
 protected:
  Json Fit(std::vector<std::string> arguments, const std::string& kind = "curve", int code = 0) {
    arguments.insert(arguments.begin(), {"fit", kind});
    arguments.insert(arguments.end(), {"-o", folder_.File("out.json"), "--json"});
    const ProgramRun run = Batten(arguments);
    EXPECT_EQ(run.code, code) << run.err;
    return Json::parse(run.out);
  }

  void ExpectRefused(std::vector<std::string> arguments,
                     int code,
                     const std::string& reason,
                     const std::string& kind = "curve") {
    SCOPED_TRACE(reason);
    arguments.insert(arguments.begin(), {"fit", kind});
    arguments.insert(arguments.end(), {"-o", folder_.File("refused.json")});
    const ProgramRun run = Batten(arguments);
    EXPECT_EQ(run.code, code);
    EXPECT_THAT(run.err, HasSubstr(reason));
    EXPECT_EQ(run.error_lines(), 1);
    EXPECT_EQ(run.out, "");
    EXPECT_EQ(folder_.Text("refused.json"), "");
  }

  TemporaryFolder folder_;
  std::string step_ = folder_.With("step.xy", ToText(Step(201)));
  std::vector<std::string> given_ = {
      step_, "--parameterization", "given", "--columns", "u=1,x=1,y=2"};
};

TEST_F(FitCurveCommandTest, APlaneCurveStaysInItsPlaneWhateverTheOriginSays) {
  const Json report = Fit({step_, "--origin", "1,2,3"});
  EXPECT_EQ(report["input"]["shift"], Json::array({1.0, 2.0, 0.0}));
}

TEST_F(FitCurveCommandTest, FitsAPlaneCurveAtItsAbscissae) {
  std::vector<std::string> arguments = given_;
  arguments.insert(arguments.end(), {"--distance", "parameter", "--control-points", "9"});
  const Json report = Fit(arguments);
  EXPECT_EQ(report["geometry"]["kind"], "curve");
  EXPECT_EQ(report["geometry"]["control_points"], Json({9}));
  EXPECT_EQ(report["error"]["kind"], "orthogonal");
  EXPECT_EQ(report["parameter_error"]["kind"], "parameter");
  const Json entry = Entry(folder_.Text("out.json"));
  EXPECT_EQ(entry["dimension"], 2);
  EXPECT_EQ(entry["degree"], 3);
  EXPECT_EQ(entry["knotvector"].front(), 0.0);
  EXPECT_EQ(entry["knotvector"].back(), 1.0);

  // The sum of squares, once more from the file that was written.
  std::vector<std::string> evaluate = {"evaluate", folder_.File("out.json"), "--json"};
  for (const Row& row : Step(201)) evaluate.insert(evaluate.end(), {"--at", Shortest(row[0])});
  const ProgramRun run = Batten(evaluate);
  ASSERT_EQ(run.code, 0) << run.err;
  const Json results = Json::parse(run.out)["results"];
  double squares = 0;
  const std::vector<Row> rows = Step(201);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Json& point = results[k]["point"];
    squares += std::pow(point[0].get<double>() - rows[k][0], 2) +
               std::pow(point[1].get<double>() - rows[k][1], 2);
  }
  EXPECT_NEAR(report["parameter_error"]["sum_of_squares"].get<double>(), squares, 1e-9 * squares);
}

// A blunt trailing edge is open unless one says that it is not.
TEST_F(FitCurveCommandTest, ClosingIsSuggestedWhereTheEndsAreAsNearAsPoints) {
  std::vector<Row> wing;
  for (int k = -40; k <= 40; ++k) {
    const double x = std::pow(k / 40.0, 2), y = 0.1 * (std::sqrt(x) - x) + 0.004 * x;
    wing.push_back({x, k < 0 ? y : -y});
  }
  const std::string cloud = folder_.With("wing.xy", ToText(wing));
  const std::string said = "--closed yes";
  const ProgramRun open = Batten({"fit", "curve", cloud, "-o", folder_.File("out.json")});
  EXPECT_EQ(open.code, 0) << open.err;
  EXPECT_THAT(open.err, HasSubstr(said));
  for (const char* const choice : {"yes", "no"}) {
    const ProgramRun told =
        Batten({"fit", "curve", cloud, "-o", folder_.File("out.json"), "--closed", choice});
    EXPECT_THAT(told.err, ::testing::Not(HasSubstr(said))) << choice;
  }
  wing.resize(60);
  const std::string half = folder_.With("half.xy", ToText(wing));
  EXPECT_THAT(Batten({"fit", "curve", half, "-o", folder_.File("out.json")}).err,
              ::testing::Not(HasSubstr(said)));
}

TEST_F(FitCurveCommandTest, AgreesWithProjectOnItsDistances) {
  const Json report = Fit({step_, "--control-points", "12", "--residuals", folder_.File("r.csv")});
  EXPECT_FALSE(report.contains("parameter_error"));
  const ProgramRun run = Batten({"project", folder_.File("out.json"), step_, "--json"});
  ASSERT_EQ(run.code, 0) << run.err;
  double squares = 0, most = 0;
  const Json output = Json::parse(run.out);
  ASSERT_EQ(output["results"].size(), 201u);
  for (const Json& result : output["results"]) {
    squares += std::pow(result["distance"].get<double>(), 2);
    most = std::max(most, result["distance"].get<double>());
  }
  EXPECT_NEAR(report["error"]["rms"].get<double>(), std::sqrt(squares / 201), 1e-9);
  EXPECT_NEAR(report["error"]["max"].get<double>(), most, 1e-9);
  const std::string residuals = folder_.Text("r.csv");
  EXPECT_EQ(std::count(residuals.begin(), residuals.end(), '\n'), 202);
}

TEST_F(FitCurveCommandTest, WritesSpaceCurvesAndStep) {
  std::vector<Row> rows;
  for (int k = 0; k < 100; ++k) rows.push_back({std::cos(k / 20.0), std::sin(k / 20.0), k / 50.0});
  const std::string helix = folder_.With("helix.xyz", ToText(rows));
  for (const char* how : {"chord", "centripetal", "uniform"}) {
    const Json report = Fit({helix, "--parameterization", how, "--tolerance", "1e-4"});
    EXPECT_TRUE(report["tolerance_reached"].get<bool>()) << how;
    EXPECT_EQ(Entry(folder_.Text("out.json"))["dimension"], 3);
  }
  const ProgramRun run =
      Batten({"fit", "curve", helix, "-o", folder_.File("helix.step"), "--unit", "m"});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("curve of degree 3"));
  EXPECT_EQ(Batten({"compare", folder_.File("helix.step"), helix, "--tolerance", "1e-3"}).code, 0);
}

TEST_F(FitCurveCommandTest, ExitsWithThreeWhereTheToleranceIsMissed) {
  const Json report = Fit({step_, "--tolerance", "1e-6", "--control-points", "5"}, "curve", 3);
  EXPECT_FALSE(report["tolerance_reached"].get<bool>());
  EXPECT_EQ(report["termination"], "max_control_points");
  EXPECT_EQ(report["geometry"]["control_points"], Json({5}));
}

TEST_F(FitCurveCommandTest, RefusesBadInputWithItsReason) {
  const auto file = [&](const std::vector<Row>& rows) {
    return folder_.With("bad.txt", ToText(rows));
  };
  ExpectRefused({step_, "--parameterization", "given"}, 1, "no column u");
  ExpectRefused({file({{1, 2, 3}, {1, 2, 3}})}, 1, "at least 2 different points");
  const std::vector<std::string> u = {"--parameterization", "given", "--columns", "u=1,x=2,y=3"};
  const auto with_u = [&](const std::vector<Row>& rows, std::vector<std::string> more = {}) {
    more.insert(more.begin(), file(rows));
    more.insert(more.end(), u.begin(), u.end());
    return more;
  };
  ExpectRefused(with_u({{5, 0, 0}, {5, 1, 1}, {5, 2, 0}}), 1, "all equal");
  ExpectRefused(
      with_u({{3, 0, 0}, {2, 1, 1}, {1, 2, 0}}, {"--order", "given"}), 1, "decrease at point 2");
  ExpectRefused({folder_.With("nan.txt", "nan 1 2\nnan 2 3\n"), u[0], u[1], u[2], u[3]},
                1,
                "no usable point");
}

TEST_F(FitCurveCommandTest, RefusesMistakesAndFlagsThatContradictEachOther) {
  using Flags = std::vector<std::string>;
  for (const auto& [flags, word] : std::vector<std::pair<Flags, std::string>>{
           {{"--start-tangent", "1,0"}, "--interpolate"},
           {{"--end-tangent", "1,0"}, "--interpolate"},
           {{"--interpolate", "--control-points", "9"}, "--control-points"},
           {{"--interpolate", "--smoothing", "1"}, "--smoothing"},
           {{"--interpolate", "--loss", "tukey"}, "--loss"},
           {{"--interpolate", "--optimize", "knots"}, "--optimize"},
           {{"--interpolate", "--order", "unordered"}, "--order unordered"},
           {{"--interpolate", "--component", "2"}, "--component"},
           {{"--interpolate", "--start-tangent", "0,0"}, "no length"},
           {{"--interpolate", "--closed", "yes", "--end-tangent", "1,0"}, "--closed yes"},
           {{"--parameterization", "given", "--order", "unordered"}, "order"},
           {{"--parameterization", "given", "--closed", "yes"}, "close"},
           {{"--component", "0"}, "--component"},
           {{"--component", "al"}, "--component"},
           {{"--closed", "maybe"}, "--closed"},
           {{"--corners", "some"}, "--corners"}}) {
    Flags arguments = flags;
    arguments.insert(arguments.begin(), step_);
    ExpectRefused(arguments, 2, word);
  }
  ExpectRefused({step_, "--parameterization", "chrod"}, 2, "'chord'");
  ExpectRefused({step_, "--degree", "0"}, 2, "--degree");
  ExpectRefused({step_, "--control-points", "3"}, 2, "--control-points");
  ExpectRefused({step_, "--optimize", "knots,knots"}, 2, "twice");
  ExpectRefused({step_, "--optimize", "params,weight"}, 2, "list of params, weights and knots");
}

TEST_F(FitCurveCommandTest, GivesTheSameBytesEveryTime) {
  Fit({step_, "--loss", "tukey"});
  const std::string once = folder_.Text("out.json");
  Fit({step_, "--loss", "tukey"});
  EXPECT_EQ(folder_.Text("out.json"), once);
}

TEST_F(FitCurveCommandTest, SurfacesTakeGivenParametersByNameOrNumber) {
  const std::string named = folder_.With("named.txt", ToText(HalfCylinder(1500), "# u v x y z\n"));
  const std::string plain = folder_.With("plain.txt", ToText(HalfCylinder(1500)));
  const Json report = Fit({named, "--parameterization", "given", "--optimize", "none"}, "surface");
  const std::string by_name = folder_.Text("out.json");
  EXPECT_EQ(report["geometry"]["base"], "given");
  EXPECT_LT(report["error"]["max"].get<double>(), 1e-3);
  EXPECT_TRUE(report.contains("parameter_error"));
  Fit({plain,
       "--parameterization",
       "given",
       "--optimize",
       "none",
       "--columns",
       "u=1,v=2,x=3,y=4,z=5"},
      "surface");
  EXPECT_EQ(folder_.Text("out.json"), by_name);
  const Json entry = Entry(by_name);
  EXPECT_GT(entry["knotvector_u"].back().get<double>(), 170);  // degrees, as given
  EXPECT_LT(entry["knotvector_v"].back().get<double>(), 4.1);

  ExpectRefused({plain, "--parameterization", "given"}, 1, "no columns u and v", "surface");
  ExpectRefused({plain, "--parameterization", "given", "--columns", "u=1,x=3,y=4,z=5"},
                1,
                "v are all equal",
                "surface");
  ExpectRefused({plain, "--parameterization", "given", "--columns", "u=1,v=2,x=3,y=4"},
                1,
                "points in the plane",
                "surface");
  ExpectRefused(
      {named, "--parameterization", "given", "--base", "plane"}, 2, "need no base", "surface");
}

// Binary clouds hold parameters too.
TEST_F(FitCurveCommandTest, TakesParametersFromPlyByTheirNames) {
  const std::string named = folder_.With("named.txt", ToText(HalfCylinder(800), "# u v x y z\n"));
  ASSERT_EQ(Batten({"convert", named, folder_.File("named.ply")}).code, 0);
  const std::vector<std::string> flags = {"--parameterization", "given", "--optimize", "none"};
  Fit({named, flags[0], flags[1], flags[2], flags[3]}, "surface");
  const std::string from_text = folder_.Text("out.json");
  Fit({folder_.File("named.ply"), flags[0], flags[1], flags[2], flags[3]}, "surface");
  EXPECT_EQ(folder_.Text("out.json"), from_text);
}

}  // namespace batten::internal::fit_curve_test
