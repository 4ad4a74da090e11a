// SPDX-License-Identifier: MIT
// Laws of `batten fit surface` on shapes that close: flags, the report, and files others read.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <numbers>

#include "closed_shapes.h"
#include "test_clouds.h"

namespace batten::internal::fit_closed_test {

using ::testing::HasSubstr;

constexpr double kNoise = 2e-3;

std::string TextOf(const TurnedShape& shape, Eigen::Index count = 4000, std::uint64_t seed = 1) {
  const Eigen::Matrix3Xd points = PointsOn(shape, count, kNoise, seed).points;
  std::vector<Row> rows;
  for (const auto& p : points.colwise()) rows.push_back({p[0], p[1], p[2]});
  return ToText(rows);
}

class FitClosedCommandTest : public ::testing::Test {
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

  // One line that names the reason, nothing written.
  void ExpectRefusal(const std::vector<std::string>& arguments, int code, const char* word) {
    const ProgramRun run = Run(arguments, "none.json");
    EXPECT_EQ(run.code, code) << run.out;
    EXPECT_EQ(run.error_lines(), 1) << run.err;
    EXPECT_EQ(run.out, "");
    EXPECT_THAT(run.err, HasSubstr(word));
    EXPECT_FALSE(std::filesystem::exists(folder_.File("none.json")));
  }

  Json Answer(const std::vector<std::string>& arguments) {
    const ProgramRun run = Batten(arguments);
    EXPECT_EQ(run.code, 0) << run.err;
    return Json::parse(run.out);
  }

  TemporaryFolder folder_;
  std::string pipe_ = folder_.With("pipe.xyz", TextOf(CylinderShapeOf()));
  std::string ball_ = folder_.With("ball.xyz", TextOf(WholeSphere()));
  std::string ring_ = folder_.With("ring.xyz", TextOf(TorusShapeOf(), 6000));
  std::string flat_ = folder_.With("flat.xyz", ToText(WavySheet(2000)));
};

TEST_F(FitClosedCommandTest, TheReportNamesTheBaseWhatClosesAndThePoles) {
  const struct {
    std::string cloud;
    const char* base;
    std::array<bool, 2> closed, poles;
  } cases[] = {{pipe_, "revolution", {true, false}, {false, false}},
               {ball_, "sphere", {true, false}, {true, true}},
               {ring_, "torus", {true, true}, {false, false}},
               {flat_, "plane", {false, false}, {false, false}}};
  for (const auto& [cloud, base, closed, poles] : cases) {
    SCOPED_TRACE(cloud);
    const Json report = Fit({cloud, "--report", folder_.File("r.json")}, "out.json");
    EXPECT_EQ(report["geometry"]["base"], base);
    EXPECT_EQ(report["geometry"]["closed"], Json(closed));
    EXPECT_EQ(report["geometry"]["poles"], Json(poles));
    EXPECT_NE(report["geometry"]["base_why"], "");
    EXPECT_EQ(report["termination"], "noise_reached");
    const Json written = Json::parse(folder_.Text("r.json"));
    EXPECT_EQ(written["geometry"]["closed"], Json(closed));
    EXPECT_EQ(written["geometry"]["base"], base);
  }
}

TEST_F(FitClosedCommandTest, TheGeometryFileSaysWhatIsPeriodic) {
  Fit({pipe_}, "pipe.json");
  const Json pipe = Entry(folder_.Text("pipe.json"));
  EXPECT_EQ(pipe["periodic"], Json({true, false}));
  Fit({ring_}, "ring.json");
  EXPECT_EQ(Entry(folder_.Text("ring.json"))["periodic"], Json({true, true}));
  Fit({flat_}, "flat.json");
  EXPECT_FALSE(Entry(folder_.Text("flat.json")).contains("periodic"));
  Fit({pipe_, "--closed", "none"}, "cut.json");
  EXPECT_FALSE(Entry(folder_.Text("cut.json")).contains("periodic"));
  // Read again, it is what it was.
  const Json read = Answer({"analyze", folder_.File("pipe.json"), "--json"});
  EXPECT_EQ(read["periodic"], Json({true, false}));
  EXPECT_EQ(read["closed"], Json({true, false}));
}

TEST_F(FitClosedCommandTest, AStepFileIsReadAsClosed) {
  for (const auto& [cloud, closed] : {std::pair{pipe_, Json({true, false})},
                                      std::pair{ball_, Json({true, false})},
                                      std::pair{ring_, Json({true, true})}}) {
    SCOPED_TRACE(cloud);
    const Json report = Fit({cloud}, "out.step");
    EXPECT_EQ(report["geometry"]["closed"], closed);
    for (const char* command : {"analyze", "info"}) {
      EXPECT_EQ(Answer({command, folder_.File("out.step"), "--json"})["closed"], closed) << command;
    }
    const ProgramRun run = Batten({"compare", folder_.File("out.step"), cloud, "--json"});
    EXPECT_EQ(run.code, 0) << run.err;
    const Json compared = Json::parse(run.out);
    EXPECT_EQ(compared["geometry"]["closed"], closed);
    for (const char* key : {"rms", "max"}) {
      const double value = report["error_all"][key];
      EXPECT_NEAR(compared["error"][key].get<double>(), value, 1e-9 * value) << key;
    }
  }
}

TEST_F(FitClosedCommandTest, EveryBaseMayBeAskedFor) {
  for (const auto& [cloud, base, closed] : {std::tuple{ball_, "revolution", Json({true, false})},
                                            std::tuple{ball_, "sphere", Json({true, false})},
                                            std::tuple{ring_, "torus", Json({true, true})},
                                            std::tuple{ring_, "revolution", Json({true, true})},
                                            std::tuple{pipe_, "sheet", Json({true, false})}}) {
    SCOPED_TRACE(base);
    const Json geometry = Fit({cloud, "--base", base}, "out.json")["geometry"];
    EXPECT_EQ(geometry["base"], base);
    EXPECT_EQ(geometry["closed"], closed);
  }
}

TEST_F(FitClosedCommandTest, ABaseThatDoesNotServeIsRefusedWithTheReason) {
  ExpectRefusal({pipe_, "--base", "sphere"}, 1, "off every sphere");
  ExpectRefusal({ball_, "--base", "torus"}, 1, "off every torus");
  ExpectRefusal({ball_, "--base", "sheet"}, 1, "closed");
  ExpectRefusal({ball_, "--base", "plane"}, 1, "not a height field");
  ExpectRefusal({ring_, "--base", "plane"}, 1, "not a height field");
  ExpectRefusal({pipe_, "--closed", "v"}, 1, "do not close in the direction asked for");
  ExpectRefusal({ball_, "--closed", "uv"}, 1, "do not close in the direction asked for");
  ExpectRefusal({pipe_, "--closed", "sideways"}, 2, "sideways");
  ExpectRefusal({pipe_, "--base", "shpere"}, 2, "sphere");
}

TEST_F(FitClosedCommandTest, DirectionsCloseAsAskedFor) {
  const struct {
    const char* flag;
    std::array<bool, 2> closed;
  } cases[] = {
      {"none", {false, false}}, {"u", {true, false}}, {"v", {false, true}}, {"uv", {true, true}}};
  for (const auto& [flag, closed] : cases) {
    SCOPED_TRACE(flag);
    const Json report = Fit({ring_, "--closed", flag}, "out.json");
    EXPECT_EQ(report["geometry"]["closed"], Json(closed));
    EXPECT_NEAR(report["error"]["rms"].get<double>(), kNoise, 0.1 * kNoise);
  }
}

TEST_F(FitClosedCommandTest, TooFewControlPointsToCloseAreRefusedWithHowManyItTakes) {
  ExpectRefusal({pipe_, "--control-points", "5,6"}, 1, "at least 7");
  ExpectRefusal({ring_, "--control-points", "12,5"}, 1, "at least 7");
  const Json geometry = Fit({pipe_, "--control-points", "7,4"}, "out.json")["geometry"];
  EXPECT_EQ(geometry["control_points"], Json({7, 4}));
  EXPECT_EQ(geometry["closed"], Json({true, false}));
}

TEST_F(FitClosedCommandTest, AToleranceThatIsMissedIsExitCode3AndWhatIsWrittenIsClosed) {
  Fit({ball_, "--tolerance", "2e-4"}, "out.json", 3);
  EXPECT_EQ(Entry(folder_.Text("out.json"))["periodic"], Json({true, false}));
  EXPECT_EQ(Fit({ball_, "--tolerance", "0.02"}, "out.json")["tolerance_reached"], true);
}

TEST_F(FitClosedCommandTest, SameThreadsSameBytes) {
  for (const char* format : {"json", "step"}) {
    const std::string a = std::string("a.") + format, b = std::string("b.") + format;
    Fit({ball_, "--threads", "2"}, a);
    Fit({ball_, "--threads", "2"}, b);
    EXPECT_EQ(folder_.Text(a), folder_.Text(b)) << format;
  }
}

TEST_F(FitClosedCommandTest, HelpNamesBasesAndDirections) {
  const std::string help = Batten({"fit", "surface", "--help"}).out;
  for (const char* word : {"--closed", "none u v uv", "revolution", "sphere", "torus"}) {
    EXPECT_THAT(help, HasSubstr(word));
  }
}

}  // namespace batten::internal::fit_closed_test
