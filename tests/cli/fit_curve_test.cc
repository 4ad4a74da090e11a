// SPDX-License-Identifier: MIT
// Laws of `batten fit curve`, and of `batten fit surface` at given parameters.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "batten/geometry/foot_point.h"
#include "batten/io/geometry_file.h"
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
           {{"--spline", "natural"}, "--spline is for --interpolate"},
           {{"--interpolate", "--spline", "clamped"}, "needs --start-tangent and --end-tangent"},
           {{"--interpolate", "--spline", "curvature"}, "--start-curvature and --end-curvature"},
           {{"--interpolate", "--spline", "natural", "--closed", "yes"}, "--spline periodic"},
           {{"--interpolate", "--spline", "periodic", "--closed", "no"}, "closes the curve"},
           {{"--interpolate", "--spline", "natural", "--degree", "4"}, "--degree 4 is not 3"},
           {{"--interpolate", "--start-curvature", "1"}, "--interpolate --spline"},
           {{"--interpolate",
             "--spline",
             "curvature",
             "--start-curvature",
             "1,2",
             "--end-curvature",
             "1"},
            "is not one number"},
           {{"--interpolate", "--through", "1"}, "--through"},
           {{"--method", "local-cubic", "--control-points", "9"}, "--control-points"},
           {{"--method", "local-cubic", "--interpolate"}, "--interpolate"},
           {{"--method", "local-parabolic", "--tolerance", "1"}, "goes through every point"},
           {{"--method", "local"}, "--method"},
           {{"--through", "0"}, "there is no point 0"},
           {{"--through", "999"}, "they are 1 to 201"},
           {{"--through", "1", "--component", "1"}, "--component"},
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

// The curve that was written.
NurbsCurve<2> Written(const TemporaryFolder& folder) {
  return std::get<NurbsCurve<2>>(ReadGeometry(folder.File("out.json")).at(0));
}

// y of the function at x.
double ValueAt(const NurbsCurve<2>& curve, double x) {
  EXPECT_NEAR(curve.At(x).x(), x, 1e-12 * (1 + std::abs(x)));
  return curve.At(x).y();
}

TEST_F(FitCurveCommandTest, SplinesHaveTheEndsAskedFor) {
  const std::string sine = folder_.With("sine.xy",
                                        "2 0.9092974268256817\n0 0\n1 0.8414709848078965\n3 "
                                        "0.1411200080598672\n4 -0.7568024953079282\n");
  const std::vector<std::string> function = {
      sine, "--interpolate", "--parameterization", "x", "--spline"};
  const auto fit = [&](std::vector<std::string> flags) {
    std::vector<std::string> all = function;
    all.insert(all.end(), flags.begin(), flags.end());
    EXPECT_LT(Fit(all)["error"]["max"], 1e-14);
    return Written(folder_);
  };
  const NurbsCurve<2> natural = fit({"natural"});
  EXPECT_NEAR(natural.JetAt(0).second.norm(), 0, 1e-12);
  EXPECT_NEAR(natural.JetAt(4).second.norm(), 0, 1e-12);
  ValueAt(natural, 2.5);
  const NurbsCurve<2> clamped =
      fit({"clamped", "--start-tangent", "2,2", "--end-tangent", "1,-0.65"});
  EXPECT_NEAR((clamped.JetAt(0).first - Eigen::Vector2d(1, 1)).norm(), 0, 1e-12);
  EXPECT_NEAR((clamped.JetAt(4).first - Eigen::Vector2d(1, -0.65)).norm(), 0, 1e-12);
  EXPECT_NEAR(ValueAt(clamped, 0.5), std::sin(0.5), 2e-3);
  const NurbsCurve<2> bent = fit({"curvature", "--start-curvature", "0", "--end-curvature", "0.4"});
  const CurveJet<2> end = bent.JetAt(4);
  EXPECT_NEAR(end.second.y() / std::pow(end.first.norm(), 3), 0.4, 1e-9);
  EXPECT_NEAR(end.second.x(), 0, 1e-12);
  EXPECT_EQ(fit({"not-a-knot"}).basis().size(), 5);
  // Along chords, ends given one by one.
  Fit({sine, "--interpolate", "--spline", "natural", "--start-tangent", "0,1"});
  EXPECT_NEAR(Written(folder_).JetAt(0).first.x(), 0, 1e-12);
  EXPECT_NEAR(Written(folder_).JetAt(1).second.norm(), 0, 1e-9);
  Fit({sine, "--interpolate", "--spline", "periodic"});
  EXPECT_TRUE(Written(folder_).basis().periodic());
}

// A periodic function of x goes on at its ends as it begins.
TEST_F(FitCurveCommandTest, FunctionsOfXMayBePeriodic) {
  const std::string wave = folder_.With("wave.xy", "0 1\n1 3\n2.5 0\n4 -1\n5 1\n");
  Fit({wave, "--interpolate", "--parameterization", "x", "--spline", "periodic"});
  const NurbsCurve<2> curve = Written(folder_);
  EXPECT_NEAR(ValueAt(curve, 2.5), 0, 1e-12);
  const CurveJet<2> start = curve.JetAt(0), end = curve.JetAt(5);
  EXPECT_NEAR((start.first - end.first).norm(), 0, 1e-12);
  EXPECT_NEAR((start.second - end.second).norm(), 0, 1e-12);
  ExpectRefused({folder_.With("open.xy", "0 1\n1 3\n2.5 0\n5 2\n"),
                 "--interpolate",
                 "--parameterization",
                 "x",
                 "--spline",
                 "periodic"},
                1,
                "the last point is 1 off the first");
}

TEST_F(FitCurveCommandTest, WhatInterpolationSortsAndLeavesOutIsSaid) {
  const auto warnings = [&](const std::string& rows, std::vector<std::string> flags) {
    flags.insert(flags.begin(), {folder_.With("rows.xy", rows), "--interpolate"});
    return Fit(flags)["warnings"].dump();
  };
  EXPECT_THAT(warnings("0 0\n2 1\n1 3\n3 0\n", {"--parameterization", "x"}),
              HasSubstr("from point 3 on they were sorted"));
  EXPECT_THAT(warnings("0 0\n1 1\nnan 3\n2 0\n3 1\n", {}), HasSubstr("1 of the rows"));
  EXPECT_EQ(warnings("0 0\n1 1\n2 0\n3 1\n", {}), "[]");
}

TEST_F(FitCurveCommandTest, LocalMethodsMeetThePointsOrKeepTheTolerance) {
  for (const std::string method : {"local-parabolic", "local-conic", "local-cubic"}) {
    const Json met = Fit({step_, "--method", method});
    EXPECT_LT(met["error"]["max"], 1e-12) << method;
    EXPECT_EQ(met["geometry"]["rational"], method == "local-conic");
    if (method == "local-parabolic") continue;
    const Json kept = Fit({step_, "--method", method, "--tolerance", "1e-3"});
    EXPECT_LE(kept["error"]["max"], 1e-3) << method;
    EXPECT_LT(kept["geometry"]["control_points"][0], 60) << method;
    EXPECT_EQ(kept["termination"], "tolerance_reached");
  }
}

TEST_F(FitCurveCommandTest, LocalMethodsSayWhereTheOrderFollowsNoCurve) {
  std::vector<Row> rows = Step(201);
  std::shuffle(rows.begin(), rows.end(), std::mt19937_64(3));
  const std::string mixed = folder_.With("mixed.xy", ToText(rows));
  const Json report = Fit({mixed, "--method", "local-cubic"});
  EXPECT_THAT(report["warnings"].dump(), HasSubstr("do not follow one another along a curve"));
}

TEST_F(FitCurveCommandTest, PointsAndDirectionsAreMetExactly) {
  const std::string tangents = folder_.With("tangents.csv", "x,y,dx,dy\n0.4,0.5,1,6\n");
  const std::string points = folder_.With("points.xy", "0 0\n1 1\n");
  Fit({step_, "--through", points, "--tangents", tangents, "--tolerance", "0.01"});
  const NurbsCurve<2> curve = Written(folder_);
  const CurveFootPoints<2> feet(curve);
  const CurveFoot foot = feet.Nearest({0.4, 0.5, 0});
  EXPECT_LT(foot.distance, 1e-12);
  const Eigen::Vector2d along = curve.JetAt(foot.u).first;
  EXPECT_NEAR(along.y() / along.x(), 6, 1e-9);
  EXPECT_LT(feet.Nearest({0, 0, 0}).distance, 1e-12);
  Fit({step_, "--through", "1,201"});
  EXPECT_LT(CurveFootPoints<2>(Written(folder_)).Nearest({1, Step(201)[200][1], 0}).distance,
            1e-12);
  ExpectRefused({step_, "--tangents", points}, 2, "column");
  ExpectRefused({step_, "--through", "nowhere.xy"}, 1, "nowhere.xy");
}

TEST_F(FitCurveCommandTest, GivesTheSameBytesEveryTime) {
  Fit({step_, "--loss", "tukey", "--accept-doubt"});
  const std::string once = folder_.Text("out.json");
  Fit({step_, "--loss", "tukey"}, "curve", 4);  // more than a tenth of the points is left out
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
