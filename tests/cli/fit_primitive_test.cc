// SPDX-License-Identifier: MIT
// Laws of `batten fit primitive`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test_clouds.h"

namespace batten::internal::fit_primitive_test {

using ::testing::HasSubstr;

constexpr double kDegree = std::numbers::pi / 180;

// On a circle of radius 2 about (5, 7), in the plane or at z = x.
std::vector<Row> Arc(int points, double degrees, bool plane, double wobble = 0) {
  std::vector<Row> rows;
  for (int k = 0; k < points; ++k) {
    const double a = degrees * kDegree * k / (points - 1), r = 2 + (k % 2 == 0 ? wobble : -wobble);
    const double x = r * std::cos(a), y = r * std::sin(a), half = std::sqrt(0.5);
    if (plane) {
      rows.push_back({5 + x, 7 + y});
    } else {
      rows.push_back({5 + half * x, 7 + y, half * x});
    }
  }
  return rows;
}

std::vector<Row> Line(int points) {
  std::vector<Row> rows;
  for (int k = 0; k < points; ++k) rows.push_back({1.0 + 3 * k, 2.0, 4.0 * k});
  return rows;
}

class FitPrimitiveCommandTest : public ::testing::Test {
 protected:
  std::string File(const std::vector<Row>& rows, const std::string& name = "cloud.xyz") {
    return folder_.With(name, ToText(rows));
  }

  Json Fit(std::vector<std::string> arguments, int code = 0) {
    arguments.insert(arguments.begin(), {"fit", "primitive"});
    arguments.insert(arguments.end(), {"-o", folder_.File("out.json"), "--json"});
    const ProgramRun run = Batten(arguments);
    EXPECT_EQ(run.code, code) << run.err;
    return Json::parse(run.out);
  }

  void ExpectRefused(std::vector<std::string> arguments, int code, const std::string& reason) {
    SCOPED_TRACE(reason);
    arguments.insert(arguments.begin(), {"fit", "primitive"});
    arguments.insert(arguments.end(), {"-o", folder_.File("refused.json")});
    const ProgramRun run = Batten(arguments);
    EXPECT_EQ(run.code, code);
    EXPECT_THAT(run.err, HasSubstr(reason));
    EXPECT_EQ(run.error_lines(), 1);
    EXPECT_EQ(run.out, "");
    EXPECT_EQ(folder_.Text("refused.json"), "");
  }

  TemporaryFolder folder_;
};

TEST_F(FitPrimitiveCommandTest, WritesCirclesWithTheirNumbers) {
  for (const bool plane : {true, false}) {
    for (const double degrees : {40.0, 355.0}) {
      const Json report = Fit({File(Arc(50, degrees, plane)), "--kind", "auto"});
      const Json& primitive = report["geometry"]["primitive"];
      EXPECT_EQ(primitive["kind"], "circle");
      EXPECT_NEAR(primitive["radius"].get<double>(), 2, 1e-9);
      EXPECT_LT(Difference(primitive["center"], Json({5.0, 7.0, 0.0})), 1e-9);
      const double half = std::sqrt(0.5);
      EXPECT_LT(
          Difference(primitive["axis"], plane ? Json({0.0, 0.0, 1.0}) : Json({-half, 0.0, half})),
          1e-9);
      const double sweep = degrees > 300 ? 360 : degrees;
      EXPECT_NEAR(primitive["sweep"].get<double>(), sweep * kDegree, 1e-9);
      EXPECT_EQ(report["geometry"]["closed"], Json({degrees > 300}));
      EXPECT_LT(report["error"]["max"].get<double>(), 1e-12);
      const Json entry = Entry(folder_.Text("out.json"));
      EXPECT_EQ(entry["dimension"], plane ? 2 : 3);
      EXPECT_EQ(entry["degree"], 2);
      EXPECT_EQ(entry["rational"], true);
      const ProgramRun run = Batten({"analyze", folder_.File("out.json"), "--json"});
      ASSERT_EQ(run.code, 0) << run.err;
      EXPECT_EQ(Json::parse(run.out)["shape"], "circle");
      EXPECT_NEAR(Json::parse(run.out)["length"].get<double>(), 2 * sweep * kDegree, 1e-9);
    }
  }
}

TEST_F(FitPrimitiveCommandTest, WritesLinesWithTheirNumbers) {
  for (const char* kind : {"auto", "line"}) {
    const Json report = Fit({File(Line(11)), "--kind", kind});
    const Json& primitive = report["geometry"]["primitive"];
    EXPECT_EQ(primitive["kind"], "line");
    EXPECT_LT(Difference(primitive["direction"], Json({0.6, 0.0, 0.8})), 1e-12);
    EXPECT_FALSE(primitive.contains("radius"));
    const Json entry = Entry(folder_.Text("out.json"));
    EXPECT_LT(
        Difference(entry["control_points"]["points"], Json({{1.0, 2.0, 0.0}, {31.0, 2.0, 40.0}})),
        1e-12);
  }
}

TEST_F(FitPrimitiveCommandTest, SetsOutliersAside) {
  std::vector<Row> rows = Arc(100, 200, true, 1e-3);
  for (int k = 0; k < 100; k += 4) rows[k] = {5.0 + 0.05 * k, 7.5 - 0.01 * k};
  const std::string cloud = File(rows);
  const Json plain = Fit({cloud, "--kind", "circle", "--accept-doubt"});
  EXPECT_GT(std::abs(plain["geometry"]["primitive"]["radius"].get<double>() - 2), 0.05);
  for (const char* loss : {"huber", "cauchy", "tukey"}) {
    const Json report =
        Fit({cloud, "--kind", "auto", "--loss", loss, "--tolerance", "0.01", "--accept-doubt"});
    EXPECT_EQ(report["doubt"][0]["code"], "points_left_out");
    EXPECT_NEAR(report["geometry"]["primitive"]["radius"].get<double>(), 2, 1e-3) << loss;
    EXPECT_GE(report["input"]["outliers"].get<int>(), 23);
    EXPECT_TRUE(report["tolerance_reached"].get<bool>());
  }
}

TEST_F(FitPrimitiveCommandTest, WritesStepAndReportsAndResiduals) {
  const std::string cloud = File(Arc(60, 120, false, 1e-3));
  const ProgramRun run = Batten({"fit",
                                 "primitive",
                                 cloud,
                                 "--kind",
                                 "circle",
                                 "-o",
                                 folder_.File("arc.step"),
                                 "--report",
                                 folder_.File("report.json"),
                                 "--residuals",
                                 folder_.File("r.csv")});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("circle of radius 2"));
  const Json report = Json::parse(folder_.Text("report.json"));
  EXPECT_EQ(report["geometry"]["primitive"]["why"], "asked for");
  const std::string residuals = folder_.Text("r.csv");
  EXPECT_EQ(std::count(residuals.begin(), residuals.end(), '\n'), 61);
  EXPECT_EQ(Batten({"compare", folder_.File("arc.step"), cloud, "--tolerance", "1.1e-3"}).code, 0);
}

// On a cylinder of radius 2 about the axis through (5, 0, 1) along y, 120° of it.
std::vector<Row> Cylinder(double wobble) {
  std::vector<Row> rows;
  for (int i = 0; i < 40; ++i) {
    for (int k = 0; k < 20; ++k) {
      const double a = 120 * kDegree * i / 39, r = 2 + wobble * std::sin(7.3 * i * i + 3.1 * k * k);
      rows.push_back({5 + r * std::cos(a), 0.3 * k, 1 + r * std::sin(a)});
    }
  }
  return rows;
}

TEST_F(FitPrimitiveCommandTest, WritesSurfacesAsExactShapes) {
  const std::string cloud = File(Cylinder(1e-3));
  for (const char* kind : {"auto", "cylinder"}) {
    const Json report = Fit({cloud, "--kind", kind});
    EXPECT_EQ(report["geometry"]["kind"], "surface");
    const Json& primitive = report["geometry"]["primitive"];
    EXPECT_EQ(primitive["kind"], "cylinder");
    const double radius = primitive["radius"],
                 deviation = primitive["standard_deviations"]["radius"];
    EXPECT_LT(deviation, 1e-3);
    EXPECT_NEAR(radius, 2, 3 * deviation);
    EXPECT_NEAR(std::abs(primitive["axis"][1].get<double>()), 1, 1e-5);
    EXPECT_EQ(primitive["standard_deviations"]["axis"].size(), 2u);
    EXPECT_EQ(primitive["covariance"]["of"].size(), 5u);
    EXPECT_EQ(primitive["covariance"]["matrix"].size(), 5u);
    EXPECT_NEAR(primitive["covariance"]["matrix"][4][4].get<double>(),
                deviation * deviation,
                0.1 * deviation * deviation);
    EXPECT_EQ(report["geometry"]["closed"], Json({false, false}));
    EXPECT_TRUE(report["warnings"].empty());
  }
  const ProgramRun analysis = Batten({"analyze", folder_.File("out.json"), "--json"});
  EXPECT_EQ(Json::parse(analysis.out)["shape"], "cylinder");
  const ProgramRun run = Batten({"fit",
                                 "primitive",
                                 cloud,
                                 "--kind",
                                 "cylinder",
                                 "-o",
                                 folder_.File("part.step"),
                                 "--residuals",
                                 folder_.File("r.csv")});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("part.step: cylinder of radius "));
  EXPECT_THAT(run.out, HasSubstr(" ± 0.000"));
  EXPECT_THAT(folder_.Text("part.step"), HasSubstr("CYLINDRICAL_SURFACE"));
  EXPECT_THAT(folder_.Text("r.csv"), HasSubstr("distance,u,v,outlier"));
}

TEST_F(FitPrimitiveCommandTest, ExitsWithThreeWhereTheToleranceIsMissed) {
  const Json report =
      Fit({File(Arc(60, 120, true, 1e-2)), "--kind", "circle", "--tolerance", "1e-3"}, 3);
  EXPECT_FALSE(report["tolerance_reached"].get<bool>());
}

TEST_F(FitPrimitiveCommandTest, RefusesBadInputWithItsReason) {
  ExpectRefused({File({{1, 2, 3}, {1, 2, 3}}), "--kind", "line"}, 1, "at least 2 different points");
  ExpectRefused({File({{1, 2, 3}, {1, 2, 4}}), "--kind", "circle"}, 1, "at least 3 different");
  ExpectRefused({File(Line(9)), "--kind", "circle"}, 1, "collinear");
  const std::string cloud = File(Line(9));
  const std::string flat = File(Arc(9, 90, true), "flat.xyz");
  for (const char* kind : {"plane", "cylinder", "sphere", "cone", "torus"}) {
    ExpectRefused({cloud, "--kind", kind}, 1, "collinear");
    ExpectRefused({flat, "--kind", kind}, 1, "needs three coordinates");
  }
  ExpectRefused({cloud, "--kind", "cirle"}, 2, "'circle'");
  ExpectRefused({cloud, "--kind", "line", "--degree", "3"}, 2, "--degree");
  ExpectRefused({cloud, "--kind", "line", "--loss-scale", "0"}, 2, "--loss-scale");
}

TEST_F(FitPrimitiveCommandTest, GivesTheSameBytesEveryTime) {
  const std::string cloud = File(Arc(200, 300, false, 1e-2));
  Fit({cloud, "--kind", "auto", "--loss", "tukey"});
  const std::string once = folder_.Text("out.json");
  Fit({cloud, "--kind", "auto", "--loss", "tukey"});
  EXPECT_EQ(folder_.Text("out.json"), once);
}

}  // namespace batten::internal::fit_primitive_test
