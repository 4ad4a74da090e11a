// SPDX-License-Identifier: MIT
// Laws of `batten fit curve` as a stranger meets them: interpolation, points in any order, closed
// curves, several components, corners, outliers, exact conics.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "angles.h"
#include "test_clouds.h"

namespace batten::internal::fit_curve_unordered_test {

using ::testing::AllOf;
using ::testing::HasSubstr;

double Uniform(std::mt19937_64& engine) { return static_cast<double>(engine() >> 11) * 0x1p-53; }

double Normal(std::mt19937_64& engine) {
  return std::sqrt(-2 * std::log(1 - Uniform(engine))) * std::cos(2 * kPi * Uniform(engine));
}

std::vector<Row> Shuffled(std::vector<Row> rows, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  for (std::size_t k = rows.size(); k > 1; --k) std::swap(rows[k - 1], rows[engine() % k]);
  return rows;
}

double FlowerRadius(double angle) { return 1 + 0.25 * std::cos(5 * angle); }

// A closed curve of five lobes, with normal noise.
std::vector<Row> Flower(int points, double noise, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::vector<Row> rows;
  for (int k = 0; k < points; ++k) {
    const double angle = 2 * kPi * k / points, radius = FlowerRadius(angle);
    rows.push_back({radius * std::cos(angle) + noise * Normal(engine),
                    radius * std::sin(angle) + noise * Normal(engine)});
  }
  return rows;
}

// Points of an ellipse's arc from angle a to b, turned about its centre.
std::vector<Row> EllipseArc(int points, double x, double y, double a, double b) {
  std::vector<Row> rows;
  for (int k = 0; k < points; ++k) {
    const double angle = a + (b - a) * k / (points - 1.0);
    const double p = x * std::cos(angle), q = y * std::sin(angle);
    rows.push_back({0.8 * p - 0.6 * q, 0.6 * p + 0.8 * q});
  }
  return rows;
}

std::vector<Row> Wave(int points) {
  std::vector<Row> rows;
  for (int k = 0; k < points; ++k) {
    const double t = (k + 0.3 * std::sin(7.0 * k)) / points;
    rows.push_back({3 * std::cos(5 * t), 2 * std::sin(4 * t), t});
  }
  return rows;
}

std::vector<Row> Square(int points_of_a_side) {
  const std::vector<Row> corners = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}};
  std::vector<Row> rows;
  for (int side = 0; side < 4; ++side) {
    for (int k = 0; k < points_of_a_side; ++k) {
      const double t = static_cast<double>(k) / points_of_a_side;
      rows.push_back({corners[side][0] + t * (corners[side + 1][0] - corners[side][0]),
                      corners[side][1] + t * (corners[side + 1][1] - corners[side][1])});
    }
  }
  return rows;
}

class FitCurveUnorderedTest : public ::testing::Test {
 protected:
  std::string File(const std::string& name, const std::vector<Row>& rows) {
    return folder_.With(name, ToText(rows));
  }

  Json Fit(std::vector<std::string> arguments, int code = 0) {
    arguments.insert(arguments.begin(), {"fit", "curve"});
    arguments.insert(arguments.end(), {"-o", out_, "--json"});
    return Run(arguments, code);
  }

  Json Run(const std::vector<std::string>& arguments, int code = 0) {
    const ProgramRun run = Batten(arguments);
    EXPECT_EQ(run.code, code) << run.err;
    return Json::parse(run.out, nullptr, false);
  }

  Json Entries() { return Json::parse(folder_.Text("out.json"))["shape"]["data"]; }

  void ExpectRefused(std::vector<std::string> arguments, int code, const std::string& reason) {
    SCOPED_TRACE(reason);
    arguments.insert(arguments.begin(), {"fit", "curve"});
    arguments.insert(arguments.end(), {"-o", folder_.File("refused.json")});
    const ProgramRun run = Batten(arguments);
    EXPECT_EQ(run.code, code);
    EXPECT_THAT(run.err, HasSubstr(reason));
    EXPECT_EQ(run.out, "");
    EXPECT_EQ(folder_.Text("refused.json"), "");
  }

  // The curve that was written lies on the points, as `compare` measures it and as reported.
  void ExpectPassesThrough(const Json& report, const std::string& points, double tolerance) {
    const Json compared = Run({"compare", out_, points, "--json"});
    EXPECT_LE(compared["error"]["max"].get<double>(), tolerance);
    EXPECT_NEAR(compared["error"]["max"].get<double>(), report["error"]["max"].get<double>(), 1e-9);
    EXPECT_NEAR(compared["error"]["rms"].get<double>(), report["error"]["rms"].get<double>(), 1e-9);
  }

  TemporaryFolder folder_;
  std::string out_ = folder_.File("out.json");
};

TEST_F(FitCurveUnorderedTest, InterpolationPassesThroughEveryPoint) {
  const std::string wave = File("wave.xyz", Wave(17)), ring = File("ring.xy", Flower(23, 0, 1));
  for (const char* how : {"chord", "centripetal", "uniform", "foley", "universal"}) {
    for (const char* degree : {"1", "3", "4"}) {
      SCOPED_TRACE(std::string(how) + " degree " + degree);
      const std::vector<std::string> flags = {
          "--interpolate", "--parameterization", how, "--degree", degree};
      std::vector<std::string> arguments = flags;
      arguments.insert(arguments.begin(), wave);
      const Json open = Fit(arguments);
      EXPECT_EQ(open["geometry"]["control_points"], Json({17}));
      ExpectPassesThrough(open, wave, 1e-11);

      arguments = flags;
      arguments.insert(arguments.begin(), ring);
      arguments.insert(arguments.end(), {"--closed", "yes"});
      ExpectPassesThrough(Fit(arguments), ring, 1e-11);
      EXPECT_EQ(Entries()[0]["periodic"], Json({true}));
      EXPECT_EQ(Run({"analyze", out_, "--json"})["continuity"], Json({std::stoi(degree) - 1}));
    }
  }
}

TEST_F(FitCurveUnorderedTest, InterpolationKeepsTheTangentsAtItsEnds) {
  const std::string wave = File("wave.xyz", Wave(12));
  ExpectPassesThrough(
      Fit({wave, "--interpolate", "--start-tangent", "1,0,0", "--end-tangent", "0,0,-2"}),
      wave,
      1e-11);
  const Json points = Entries()[0]["control_points"]["points"];
  const auto step = [&](std::size_t k, int axis) {
    return points[k + 1][axis].get<double>() - points[k][axis].get<double>();
  };
  EXPECT_GT(step(0, 0), 0);
  EXPECT_NEAR(step(0, 1), 0, 1e-12);
  EXPECT_NEAR(step(0, 2), 0, 1e-12);
  EXPECT_LT(step(points.size() - 2, 2), 0);
  EXPECT_NEAR(step(points.size() - 2, 0), 0, 1e-12);
}

TEST_F(FitCurveUnorderedTest, AShuffledRingIsFoundClosedAndSmooth) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    SCOPED_TRACE(seed);
    const double noise = 2e-3;
    const std::string ring = File("ring.xy", Shuffled(Flower(1200, noise, seed), seed));
    const Json report = Fit({ring});
    EXPECT_EQ(report["geometry"]["closed"], Json({true}));
    EXPECT_NEAR(report["error"]["rms"].get<double>(), noise, 0.1 * noise);
    EXPECT_LE(report["geometry"]["control_points"][0].get<int>(), 80);
    EXPECT_EQ(Entries()[0]["periodic"], Json({true}));
    const Json analysis = Run({"analyze", out_, "--json"});
    EXPECT_EQ(analysis["continuity"], Json({2}));
    EXPECT_NEAR(report["error"]["max"].get<double>(),
                Run({"compare", out_, ring, "--json"})["error"]["max"].get<double>(),
                1e-9);
    // STEP carries the same curve.
    ASSERT_EQ(Batten({"fit", "curve", ring, "-o", folder_.File("ring.step")}).code, 0);
    EXPECT_NEAR(Run({"analyze", folder_.File("ring.step"), "--json"})["length"].get<double>(),
                analysis["length"].get<double>(),
                1e-9);
  }
}

TEST_F(FitCurveUnorderedTest, UnitsAndOrderLeaveTheCurveAsItIs) {
  const std::vector<Row> rows = Shuffled(Flower(800, 2e-3, 4), 4);
  const Json once = Fit({File("ring.xy", rows), "--threads", "2"});
  const std::string bytes = folder_.Text("out.json");
  Fit({File("ring.xy", rows), "--threads", "2"});
  EXPECT_EQ(folder_.Text("out.json"), bytes);
  Fit({File("ring.xy", rows), "--threads", "1"});
  EXPECT_LE(Difference(Json::parse(folder_.Text("out.json")), Json::parse(bytes)), 1e-9);
  for (const double unit : {1e6, 1e-6}) {
    SCOPED_TRACE(unit);
    std::vector<Row> scaled = rows;
    for (Row& row : scaled) row = {row[0] * unit, row[1] * unit};
    const Json report = Fit({File("scaled.xy", scaled)});
    EXPECT_EQ(report["geometry"]["control_points"], once["geometry"]["control_points"]);
    const double rms = once["error"]["rms"];
    EXPECT_NEAR(report["error"]["rms"].get<double>() / unit, rms, 1e-6 * rms);
  }
}

TEST_F(FitCurveUnorderedTest, WarningsNameTheirCurveAndAreGivenOnce) {
  // Two rings with a gap of twelve spacings each, far from each other, and strays.
  std::vector<Row> rows = {{30, 30}, {-30, 30}};
  for (int k = 0; k < 120; ++k)
    for (const double x : {0.0, 8.0}) rows.push_back({x + std::cos(0.05 * k), std::sin(0.05 * k)});
  const std::string cloud = File("rings.xy", Shuffled(rows, 3));
  const Json report = Fit({cloud, "--component", "all", "--closed", "yes"});
  std::vector<std::string> warnings = report["warnings"];
  const auto about = [&](const std::string& words) {
    return std::count_if(warnings.begin(), warnings.end(), [&](const std::string& warning) {
      return warning.find(words) != std::string::npos;
    });
  };
  EXPECT_EQ(about("curve 1: the ends of the points are"), 1);
  EXPECT_EQ(about("curve 2: the ends of the points are"), 1);
  EXPECT_EQ(about("the ends of the points are"), 2);
  EXPECT_EQ(about("left out"), 1);
  std::sort(warnings.begin(), warnings.end());
  EXPECT_EQ(std::unique(warnings.begin(), warnings.end()), warnings.end());
}

TEST_F(FitCurveUnorderedTest, SeveralComponentsAreListedChosenAndFittedAll) {
  std::vector<Row> rows = Flower(300, 1e-3, 7);
  for (const Row& row : Flower(120, 1e-3, 8)) rows.push_back({6 + 0.5 * row[0], 0.5 * row[1]});
  for (int k = 0; k < 60; ++k) rows.push_back({3 + 0.02 * k, 5 + 0.1 * std::sin(0.1 * k)});
  const std::string cloud = File("three.xy", Shuffled(rows, 7));

  ExpectRefused({cloud}, 1, "3 separate curves");
  ExpectRefused({cloud, "--component", "4"}, 1, "no component 4");
  const std::vector<int> points = {300, 120, 60};
  for (int k = 1; k <= 3; ++k) {
    const Json report = Fit({cloud, "--component", std::to_string(k)});
    EXPECT_EQ(report["input"]["points"], 480);
    EXPECT_EQ(report["input"]["used"], points[k - 1]);
    EXPECT_LE(report["error"]["max"].get<double>(), 0.01);
  }
  const Json all = Fit({cloud, "--component", "all"});
  EXPECT_EQ(all["geometry"]["closed"], Json({true, true, false}));
  EXPECT_EQ(all["geometry"]["control_points"].size(), 3u);
  EXPECT_EQ(all["error"]["points"], 480);
  EXPECT_EQ(Entries().size(), 3u);
  ExpectPassesThrough(all, cloud, 0.01);
}

TEST_F(FitCurveUnorderedTest, BranchesAreRefusedWithTheirPlace) {
  std::vector<Row> rows;
  for (int k = 1; k <= 50; ++k) {
    const double t = k / 50.0;
    rows.insert(rows.end(), {{1 - t, 2}, {1 + t, 2 + t}, {1 + t, 2 - t}});
  }
  ExpectRefused({File("fork.xy", Shuffled(rows, 3))}, 1, "branch near (1, 2");
}

TEST_F(FitCurveUnorderedTest, ClosingAnOpenArcReportsItsGap) {
  const std::string arc = File("arc.xy", EllipseArc(80, 2, 1, 0, 4));
  EXPECT_EQ(Fit({arc})["geometry"]["closed"], Json({false}));
  const Json closed = Fit({arc, "--closed", "yes"});
  EXPECT_EQ(closed["geometry"]["closed"], Json({true}));
  ASSERT_FALSE(closed["warnings"].empty());
  EXPECT_THAT(closed["warnings"][0].get<std::string>(), HasSubstr("apart"));
}

TEST_F(FitCurveUnorderedTest, CornersOfASquareAreKept) {
  const std::vector<Row> square = Square(25);
  for (const std::vector<Row>& rows : {square, Shuffled(square, 5)}) {
    const std::string file = File("square.xy", rows);
    const Json report = Fit({file});
    EXPECT_EQ(report["geometry"]["closed"], Json({true}));
    EXPECT_LE(report["geometry"]["control_points"][0].get<int>(), 16);
    ExpectPassesThrough(report, file, 1e-9);
    const Json analysis = Run({"analyze", out_, "--json"});
    EXPECT_EQ(analysis["continuity"], Json({0}));
    EXPECT_NEAR(analysis["length"].get<double>(), 4, 1e-6);
    Fit({file, "--corners", "none"});
    EXPECT_EQ(Run({"analyze", out_, "--json"})["continuity"], Json({2}));
  }
}

TEST_F(FitCurveUnorderedTest, ThirtyPercentOfOutliersAreSetAside) {
  std::mt19937_64 engine(11);
  std::vector<Row> rows = Flower(2000, 1e-3, 11);
  int outliers = 0;
  for (Row& row : rows) {
    if (Uniform(engine) >= 0.3) continue;
    row = {4 * Uniform(engine) - 2, 4 * Uniform(engine) - 2};
    ++outliers;
  }
  const std::string cloud = File("outliers.xy", Shuffled(rows, 11));
  for (const char* loss : {"tukey", "cauchy", "huber", "auto"}) {
    SCOPED_TRACE(loss);
    const Json report = Fit({cloud, "--loss", loss}, 4);  // so many are said to be doubtful
    EXPECT_EQ(report["doubt"][0]["code"], "points_left_out");
    EXPECT_NEAR(report["input"]["outliers"].get<int>(), outliers, 0.05 * outliers);
    const std::string truth = File("truth.xy", Flower(4000, 0, 1));
    EXPECT_LE(Run({"compare", out_, truth, "--json"})["error"]["max"].get<double>(), 3e-3);
  }
}

TEST_F(FitCurveUnorderedTest, FreeWeightsFindTheExactConic) {
  const std::string arc = File("arc.xy", EllipseArc(60, 2, 1, 0.1, 1.2));
  const Json report =
      Fit({arc, "--degree", "2", "--control-points", "3", "--optimize", "weights,params"});
  EXPECT_TRUE(report["optimize"]["ran"].get<bool>());
  EXPECT_TRUE(report["geometry"]["rational"].get<bool>());
  EXPECT_EQ(Run({"analyze", out_, "--json"})["shape"], "ellipse");
  ExpectPassesThrough(report, arc, 1e-9);
}

TEST_F(FitCurveUnorderedTest, ContradictoryFlagsAreRefused) {
  const std::string wave = File("wave.xyz", Wave(30));
  for (const std::vector<std::string>& flags :
       std::vector<std::vector<std::string>>{{"--control-points", "8"},
                                             {"--smoothing", "1e-3"},
                                             {"--loss", "tukey"},
                                             {"--optimize", "weights"},
                                             {"--order", "unordered"},
                                             {"--component", "all"},
                                             {"--distance", "tangent"}}) {
    std::vector<std::string> arguments = {wave, "--interpolate"};
    arguments.insert(arguments.end(), flags.begin(), flags.end());
    ExpectRefused(arguments, 2, flags[0]);
  }
  ExpectRefused({wave, "--start-tangent", "1,0,0"}, 2, "--interpolate");
  ExpectRefused({wave, "--interpolate", "--start-tangent", "0,0,0"}, 2, "no length");
  ExpectRefused({wave, "--interpolate", "--closed", "yes", "--end-tangent", "0,0,1"}, 2, "ends");
  ExpectRefused({wave, "--tolerance", "0"}, 2, "--tolerance");
  ExpectRefused({File("few.xy", {{0, 0}, {1, 1}, {2, 0}}), "--interpolate"}, 1, "degree to 2");
  ExpectRefused({File("same.xy", {{1, 2}, {1, 2}, {1, 2}})}, 1, "at least 2 different points");
}

// A panel with outliers: the few points that happen to follow one another are no curve of it.
TEST_F(FitCurveUnorderedTest, PointsOfASurfaceAreRefused) {
  ExpectRefused({std::string(BATTEN_SOURCE_DIR) + "/data/panel.ply"}, 1, "no curve is found");
}

}  // namespace batten::internal::fit_curve_unordered_test
