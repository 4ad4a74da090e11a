// SPDX-License-Identifier: MIT
#include "batten/io/report_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace batten::internal::report_json_test {

using Json = nlohmann::ordered_json;
using Words = std::vector<std::string>;

FitReport Example() {
  FitReport report;
  report.input.files = {"a.ply", "b.ply"};
  report.input.points = 1000;
  report.input.used = 980;
  report.input.non_finite = 1;
  report.input.duplicates = 2;
  report.input.outliers = 17;
  report.input.spacing = 0.1;
  report.input.noise = 0.001;
  report.input.box_min << -1, -2, -3;
  report.input.box_max << 1, 2, 3;
  report.input.origin << 500000, 5400000, 300;
  report.geometry = {"surface", "plane", {3, 2}, {12, 9}, false, {false, true}, 1};
  report.error.rms = 0.0011;
  report.error.tolerance = 0.01;
  report.error.within_tolerance = 0.75;
  report.error.out_of_tolerance = 245;
  report.error.points = 980;
  report.error_all.max = 4;
  report.optimize = {true, "the residuals exceed the noise", 5, 0.002, 0.0011};
  report.termination = Termination::kMaxControlPoints;
  report.end = {EndCode::kMaxControlPoints, "used up", Eigen::Vector3d(4, 5, 6)};
  report.base_candidates = {{"plane", 0.002, 108, ""}, {"sheet", std::nullopt, 0, "folds"}};
  report.iterations = {{"refine", 6, 7, 0.5, 2, 1.5, 0.25}};
  report.seconds.total = 1.25;
  report.warnings = {"far from the origin"};
  report.threads = 2;
  return report;
}

ReportContext Context() {
  return {"batten fit surface a.ply", "out.step", "m", {1, 2, 3}, 123456789, "0.1.0"};
}

Words Keys(const Json& object) {
  Words keys;
  for (const auto& [key, value] : object.items()) keys.push_back(key);
  return keys;
}

TEST(ReportJsonTest, HasEveryFieldOfTheContractInItsOrder) {
  const Json json = Json::parse(ToReportJson(Example(), Context()));
  const Words error = {"rms",
                       "mean",
                       "max",
                       "p50",
                       "p95",
                       "p99",
                       "signed_p5",
                       "signed_p95",
                       "tolerance",
                       "within_tolerance",
                       "out_of_tolerance",
                       "points",
                       "kind"};
  EXPECT_EQ(Keys(json),
            (Words{"schema",
                   "command",
                   "input",
                   "geometry",
                   "error",
                   "error_all",
                   "optimize",
                   "termination",
                   "end",
                   "tolerance_reached",
                   "iterations",
                   "seconds",
                   "peak_memory_bytes",
                   "threads",
                   "warnings",
                   "doubt",
                   "version",
                   "base_candidates"}));
  EXPECT_EQ(json["end"],
            (Json{{"code", "max_control_points"}, {"words", "used up"}, {"where", {4, 5, 6}}}));
  EXPECT_EQ(
      json["base_candidates"][0],
      (Json{{"name", "plane"}, {"score", 0.002}, {"control_points", 108}, {"refused", nullptr}}));
  EXPECT_EQ(json["base_candidates"][1],
            (Json{{"name", "sheet"},
                  {"score", nullptr},
                  {"control_points", nullptr},
                  {"refused", "folds"}}));
  EXPECT_EQ(Keys(json["input"]),
            (Words{"files",
                   "points",
                   "used",
                   "non_finite",
                   "duplicates",
                   "outliers",
                   "spacing",
                   "noise",
                   "bounding_box",
                   "origin",
                   "shift",
                   "unit"}));
  EXPECT_EQ(
      Keys(json["geometry"]),
      (Words{"kind", "base", "degree", "control_points", "rational", "closed", "trims", "file"}));
  EXPECT_EQ(Keys(json["error"]), error);
  EXPECT_EQ(Keys(json["error_all"]), error);
  EXPECT_EQ(Keys(json["optimize"]), (Words{"ran", "why", "iterations", "rms_before", "rms_after"}));
  EXPECT_EQ(Keys(json["iterations"][0]),
            (Words{"stage", "control_points", "rms", "max", "score", "seconds"}));
  EXPECT_EQ(Keys(json["seconds"]),
            (Words{"read",
                   "prepare",
                   "parameterize",
                   "solve",
                   "project",
                   "refine",
                   "optimize",
                   "trim",
                   "write",
                   "total"}));
}

TEST(ReportJsonTest, SaysWhatTheReportAndItsContextHold) {
  const Json json = Json::parse(ToReportJson(Example(), Context()));
  EXPECT_EQ(json["schema"], "batten-report-2");
  EXPECT_EQ(json["command"], "batten fit surface a.ply");
  EXPECT_EQ(json["input"]["files"], Json({"a.ply", "b.ply"}));
  EXPECT_EQ(json["input"]["used"], 980);
  EXPECT_EQ(json["input"]["bounding_box"], Json::parse("[[-1.0,-2.0,-3.0],[1.0,2.0,3.0]]"));
  EXPECT_EQ(json["input"]["origin"], Json::parse("[500000.0,5400000.0,300.0]"));
  EXPECT_EQ(json["input"]["shift"], Json::parse("[1.0,2.0,3.0]"));
  EXPECT_EQ(json["input"]["unit"], "m");
  EXPECT_EQ(json["geometry"]["degree"], Json({3, 2}));
  EXPECT_EQ(json["geometry"]["closed"], Json({false, true}));
  EXPECT_EQ(json["geometry"]["file"], "out.step");
  EXPECT_EQ(json["error"]["tolerance"], 0.01);
  EXPECT_EQ(json["error"]["out_of_tolerance"], 245);
  EXPECT_EQ(json["error"]["kind"], "orthogonal");
  EXPECT_EQ(json["error_all"]["max"], 4.0);
  EXPECT_EQ(json["optimize"]["ran"], true);
  EXPECT_EQ(json["termination"], "max_control_points");
  EXPECT_EQ(json["tolerance_reached"], false);
  EXPECT_EQ(json["iterations"][0]["control_points"], Json({6, 7}));
  EXPECT_EQ(json["peak_memory_bytes"], 123456789);
  EXPECT_EQ(json["threads"], 2);
  EXPECT_EQ(json["warnings"], Json({"far from the origin"}));
  EXPECT_EQ(json["version"], "0.1.0");
}

TEST(ReportJsonTest, SaysNullForTheToleranceWhenNoneWasAsked) {
  FitReport report = Example();
  report.error.tolerance.reset();
  const Json json = Json::parse(ToReportJson(report, Context()));
  EXPECT_TRUE(json["error"]["tolerance"].is_null());
  EXPECT_TRUE(json["tolerance_reached"].is_null());
}

TEST(ReportJsonTest, CountsOneDirectionOfControlPointsForCurves) {
  FitReport report = Example();
  report.geometry = {"curve", "", {3}, {12}, false, {false}, 0};
  const Json json = Json::parse(ToReportJson(report, Context()));
  EXPECT_EQ(json["iterations"][0]["control_points"], Json::array({6}));
}

TEST(ReportJsonTest, NeverWritesANumberThatJsonHasNoFormFor) {
  FitReport report = Example();
  report.error.rms = std::numeric_limits<double>::quiet_NaN();
  report.error_all.max = std::numeric_limits<double>::infinity();
  report.error.tolerance = std::numeric_limits<double>::infinity();
  report.input.box_min[1] = -std::numeric_limits<double>::infinity();
  report.iterations[0].score = std::numeric_limits<double>::quiet_NaN();
  const Json json = Json::parse(ToReportJson(report, Context()));
  EXPECT_TRUE(json["error"]["rms"].is_null());
  EXPECT_TRUE(json["error"]["tolerance"].is_null());
  EXPECT_TRUE(json["error_all"]["max"].is_null());
  EXPECT_TRUE(json["input"]["bounding_box"][0][1].is_null());
  EXPECT_TRUE(json["iterations"][0]["score"].is_null());
  EXPECT_EQ(json["iterations"][0]["max"], 2);
  // A round that measured no greatest distance has none, not zero.
  report.iterations[0].max = 0;
  EXPECT_TRUE(Json::parse(ToReportJson(report, Context()))["iterations"][0]["max"].is_null());
}

TEST(ReportJsonTest, StaysJsonWhenAFileNameIsNotUtf8) {
  FitReport report = Example();
  report.input.files = {"caf\xE9 \"x\"\n.ply"};
  const Json json = Json::parse(ToReportJson(report, Context()));
  EXPECT_EQ(json["input"]["files"][0], "caf\xEF\xBF\xBD \"x\"\n.ply");
}

TEST(ReportJsonTest, WritesTheNumbersThatAPrimitiveHas) {
  FitReport report = Example();
  EXPECT_FALSE(Json::parse(ToReportJson(report, Context()))["geometry"].contains("primitive"));
  PrimitiveSummary circle;
  circle.kind = "circle";
  circle.center = Eigen::Vector3d(1, 2, 3);
  circle.axis = Eigen::Vector3d::UnitZ();
  circle.radius = 0.1;
  circle.sweep = 1.5;
  circle.scale = 0.01;
  circle.why = "asked for";
  report.geometry.primitive = circle;
  const Json json = Json::parse(ToReportJson(report, Context()))["geometry"]["primitive"];
  EXPECT_EQ(Keys(json), Words({"kind", "center", "axis", "radius", "sweep", "scale", "why"}));
  EXPECT_EQ(json["center"], Json({1.0, 2.0, 3.0}));
  EXPECT_EQ(json["radius"], 0.1);
}

}  // namespace batten::internal::report_json_test
