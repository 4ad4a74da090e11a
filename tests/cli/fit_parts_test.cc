// SPDX-License-Identifier: MIT
// Parts of a cloud, and limits of time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "test_clouds.h"

namespace batten::internal::fit_parts_test {

using ::testing::HasSubstr;

class FitPartsTest : public ::testing::Test {
 protected:
  FitPartsTest() {
    std::vector<Row> rows = WavySheet(3000);
    for (Row row : WavySheet(1000, 2)) {
      row[0] += 30;
      rows.push_back(row);
    }
    for (int k = 0; k < 40; ++k) rows.push_back({-50 + 0.01 * k, 0, 0});  // on a line
    cloud_ = folder_.With("c.xyz", ToText(rows));
  }

  Json Report() const { return Json::parse(folder_.Text("r.json")); }
  ProgramRun Fit(std::vector<std::string> flags) const {
    flags.insert(flags.begin(),
                 {"fit", "surface", cloud_, "-o", out_, "--report", folder_.File("r.json")});
    return Batten(flags);
  }

  TemporaryFolder folder_;
  std::string cloud_, out_ = folder_.File("o.json");
};

TEST_F(FitPartsTest, InfoListsThem) {
  const Json info = Json::parse(Batten({"info", cloud_, "--json"}).out);
  ASSERT_EQ(info["parts"].size(), 3u);
  EXPECT_EQ(info["parts"][0]["points"], 3000);
  EXPECT_EQ(info["parts"][1]["points"], 1000);
  EXPECT_NEAR(info["parts"][1]["box"][0][0].get<double>(), 30, 0.1);
  EXPECT_EQ(info["stray"], 0);
}

TEST_F(FitPartsTest, OneOrAllAreFitted) {
  ProgramRun run = Fit({"--part", "2"});
  ASSERT_EQ(run.code, 0) << run.err;
  Json report = Report();
  EXPECT_EQ(report["error_all"]["points"], 1000);
  EXPECT_GT(report["input"]["bounding_box"][0][0], 29);
  ASSERT_EQ(report["parts"].size(), 3u);
  EXPECT_FALSE(report["parts"][0]["used"]);
  EXPECT_TRUE(report["parts"][1]["used"]);

  run = Fit({"--part", "all", "--residuals", folder_.File("e.csv")});
  ASSERT_EQ(run.code, 0) << run.err;
  report = Report();
  EXPECT_EQ(Json::parse(folder_.Text("o.json"))["shape"]["data"].size(), 2u);
  EXPECT_EQ(report["error_all"]["points"], 4000);
  EXPECT_LT(report["error"]["rms"], 0.006);
  EXPECT_TRUE(report["parts"][0]["used"]);
  EXPECT_THAT(report["parts"][2]["refused"].get<std::string>(), HasSubstr("line"));
  const std::string residuals = folder_.Text("e.csv");
  EXPECT_EQ(std::count(residuals.begin(), residuals.end(), '\n'), 4001);
}

// Two halves of one plane, a gap between them.
TEST_F(FitPartsTest, AreSewnWhereTheirEdgesMeet) {
  std::vector<Row> rows;
  for (int i = 0; i <= 40; ++i) {
    for (int j = 0; j <= 40; ++j) {
      for (const double at : {0.0, 5.0}) rows.push_back({at + 0.1 * i, 0.1 * j, 0});
    }
  }
  cloud_ = folder_.With("halves.xyz", ToText(rows));
  out_ = folder_.File("o.step");
  ProgramRun run = Fit({"--part", "all", "--trim", "none", "--sew", "1.2"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("2 surfaces sewn into an open shell; 1 shared edges"));
  EXPECT_EQ(Json::parse(Batten({"info", out_, "--json"}).out)["bodies"].size(), 1u);
  run = Fit({"--sew", "1.2"});
  EXPECT_EQ(run.code, 2);
  EXPECT_THAT(run.err, HasSubstr("it needs --part all"));
  out_ = folder_.File("o.json");
  run = Fit({"--part", "all", "--sew", "1.2"});
  EXPECT_EQ(run.code, 2);
  EXPECT_THAT(run.err, HasSubstr("holds no shells"));
}

TEST(CleaningTest, TakesStrayPointsAwayBeforeTheFitOrNone) {
  const TemporaryFolder folder;
  std::vector<Row> rows = WavySheet(3000);
  for (int k = 0; k < 12; ++k) rows.push_back({0.8 * k, 5 - 0.3 * k, 40 + 2.0 * k});
  const std::string cloud = folder.With("c.xyz", ToText(rows));
  const auto fit = [&](const std::string& how) {
    const ProgramRun run = Batten({"fit",
                                   "surface",
                                   cloud,
                                   "-o",
                                   folder.File("o.json"),
                                   "--report",
                                   folder.File("r.json"),
                                   "--base",
                                   "plane",
                                   "--accept-doubt",
                                   "--clean",
                                   how});
    EXPECT_EQ(run.code, 0) << run.err;
    return Json::parse(folder.Text("r.json"));
  };
  Json report = fit("statistical");
  EXPECT_EQ(report["input"]["points"], 3000);
  EXPECT_LT(report["error_all"]["max"], 1);
  EXPECT_THAT(report["warnings"].dump(), HasSubstr("--clean statistical removed 12 stray points"));
  EXPECT_EQ(fit("statistical:16,1e6")["input"]["points"], 3012);
  report = fit("auto");
  EXPECT_EQ(report["input"]["points"], 3012);
  EXPECT_EQ(report["input"]["outliers"], 12);
  EXPECT_EQ(fit("none")["input"]["outliers"], 0);

  const ProgramRun curve =
      Batten({"fit", "curve", cloud, "-o", folder.File("o.json"), "--clean", "none"});
  EXPECT_EQ(curve.code, 2);
  EXPECT_THAT(curve.err, HasSubstr("--clean none"));
  for (const std::string wrong : {"statistical:0,3",
                                  "statistical:2.5,3",
                                  "statistical:8",
                                  "statistical:8,0",
                                  "statistical:1001,3",
                                  "statistical:a,b",
                                  "statistical:",
                                  "none:3",
                                  "all"}) {
    SCOPED_TRACE(wrong);
    const ProgramRun run =
        Batten({"fit", "surface", cloud, "-o", folder.File("p.json"), "--clean", wrong});
    EXPECT_EQ(run.code, 2);
    EXPECT_THAT(run.err, HasSubstr("--clean"));
    if (wrong.find("statistical") == 0) {
      EXPECT_THAT(run.err, HasSubstr("statistical:K,S"));
    }
  }
}

TEST_F(FitPartsTest, APartThatIsNotThereIsRefused) {
  const ProgramRun run = Fit({"--part", "4"});
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.err, HasSubstr("falls into 3 parts: there is no part 4"));
  EXPECT_EQ(Fit({"--part", "0"}).code, 2);
  EXPECT_EQ(Fit({"--part", "1", "--grid", "2,2"}).code, 2);
}

TEST_F(FitPartsTest, ALimitOfTimeLeavesTheBestSoFar) {
  const ProgramRun run = Fit({"--part", "1", "--time-limit", "1e-6"});
  EXPECT_EQ(run.code, 3) << run.err;
  const Json report = Report();
  EXPECT_EQ(report["end"]["code"], "time_limit");
  EXPECT_LT(report["error"]["rms"], 0.1);
  EXPECT_EQ(Fit({"--part", "1", "--time-limit", "1000"}).code, 0);
  EXPECT_EQ(Fit({"--time-limit", "-1"}).code, 2);
}

TEST(TimeLimitTest, HoldsForCurvesToo) {
  const TemporaryFolder folder;
  std::vector<Row> rows;
  for (int k = 0; k < 500; ++k) rows.push_back({0.01 * k, std::sin(0.02 * k), 0});
  const ProgramRun run = Batten({"fit",
                                 "curve",
                                 folder.With("c.xyz", ToText(rows)),
                                 "-o",
                                 folder.File("o.json"),
                                 "--time-limit",
                                 "1e-6"});
  EXPECT_EQ(run.code, 3) << run.err;
}

}  // namespace batten::internal::fit_parts_test
