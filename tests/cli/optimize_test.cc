// SPDX-License-Identifier: MIT
// Laws of --optimize, on the command line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test_clouds.h"

namespace batten::internal::optimize_test {

using ::testing::HasSubstr;

class OptimizeCommandTest : public ::testing::Test {
 protected:
  Json Fit(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "fit");
    // Those that fix the control points may miss the points by much.
    arguments.insert(arguments.end(), {"-o", folder_.File("out.json"), "--json", "--accept-doubt"});
    const ProgramRun run = Batten(arguments);
    EXPECT_EQ(run.code, 0) << run.err;
    return Json::parse(run.out);
  }
  Json Written() { return Entry(folder_.Text("out.json")); }

  TemporaryFolder folder_;
};

// A cusp at 0.5: three of the knots have to come together there. The sum of squares is that of the
// published free-knot tables (best of many starts, six interior knots), or less.
TEST_F(OptimizeCommandTest, KnotsMeetAtACusp) {
  std::vector<Row> rows;
  for (int k = 0; k <= 200; ++k) {
    const double x = k / 200.0;
    rows.push_back({x, 100 * std::exp(-std::abs(10 * x - 5)) + std::pow(10 * x - 5, 5) / 500});
  }
  const Json report = Fit({"curve",
                           folder_.With("cusp.xy", ToText(rows)),
                           "--parameterization",
                           "given",
                           "--columns",
                           "u=1,x=1,y=2",
                           "--distance",
                           "parameter",
                           "--control-points",
                           "10",
                           "--optimize",
                           "knots"});
  EXPECT_TRUE(report["optimize"]["ran"]);
  EXPECT_LE(report["parameter_error"]["sum_of_squares"].get<double>(), 3.75483);
  int at_the_cusp = 0;
  const Json written = Written();
  for (const Json& knot : written["knotvector"]) {
    if (std::abs(knot.get<double>() - 0.5) < 1e-3) ++at_the_cusp;
  }
  EXPECT_EQ(at_the_cusp, 3);
}

TEST_F(OptimizeCommandTest, WeightsMakeAnArcExact) {
  std::vector<Row> rows;
  for (int k = 0; k < 300; ++k) rows.push_back({std::cos(k / 150.0), std::sin(k / 150.0)});
  const std::string arc = folder_.With("arc.xy", ToText(rows));
  const std::vector<std::string> flags = {"curve", arc, "--degree", "2", "--control-points", "3"};
  std::vector<std::string> arguments = flags;
  arguments.insert(arguments.end(), {"--optimize", "params"});
  EXPECT_GT(Fit(arguments)["error"]["rms"].get<double>(), 1e-4);
  arguments.back() = "params,weights";
  const Json report = Fit(arguments);
  EXPECT_TRUE(report["geometry"]["rational"]);
  EXPECT_LE(report["error"]["rms"].get<double>(), 1e-8);
  EXPECT_LE(report["optimize"]["iterations"].get<int>(), 40);
  arguments.back() = "none";
  EXPECT_FALSE(Fit(arguments)["optimize"]["ran"]);
}

// A ridge as narrow as the spacing looks like outliers to equal knots; free knots follow it.
TEST_F(OptimizeCommandTest, KnotsFollowARidge) {
  std::mt19937_64 engine(8);
  const auto uniform = [&] { return static_cast<double>(engine() >> 11) * 0x1p-53; };
  std::vector<Row> rows;
  for (int k = 0; k < 8000; ++k) {
    const double x = uniform(), y = uniform(), t = (x - 0.37) / 0.02;
    rows.push_back({x, y, std::exp(-t * t) + 0.1 * y * y});
  }
  const Json report = Fit({"surface",
                           folder_.With("ridge.xyz", ToText(rows)),
                           "--control-points",
                           "12,6",
                           "--optimize",
                           "knots"});
  EXPECT_EQ(report["input"]["outliers"], 0);
  EXPECT_LE(report["error_all"]["rms"].get<double>(), 1e-3);
}

TEST_F(OptimizeCommandTest, GivesTheSameBytesOnAnyNumberOfThreads) {
  std::mt19937_64 engine(3);
  const auto uniform = [&] { return static_cast<double>(engine() >> 11) * 0x1p-53; };
  std::vector<Row> rows;
  for (int k = 0; k < 1500; ++k) {
    const double x = uniform(), y = uniform();
    rows.push_back({x, y, std::sqrt(4 - x * x - y * y) + 1e-4 * uniform()});
  }
  const std::string cloud = folder_.With("cap.xyz", ToText(rows));
  const auto with = [&](const char* threads) {
    Fit({"surface",
         cloud,
         "--degree",
         "2",
         "--control-points",
         "4,5",
         "--optimize",
         "params,weights,knots",
         "--threads",
         threads});
    return folder_.Text("out.json");
  };
  EXPECT_EQ(with("1"), with("2"));
}

TEST_F(OptimizeCommandTest, SaysWhyItDoesNotStart) {
  std::mt19937_64 engine(4);
  const auto uniform = [&] { return static_cast<double>(engine() >> 11) * 0x1p-53; };
  std::vector<Row> rows;
  for (int k = 0; k < 3000; ++k) {
    const double x = uniform(), y = uniform();
    rows.push_back({x, y, 0.1 * x * y + 1e-3 * (uniform() + uniform() + uniform() - 1.5)});
  }
  const Json report =
      Fit({"surface", folder_.With("noisy.xyz", ToText(rows)), "--optimize", "params"});
  EXPECT_FALSE(report["optimize"]["ran"]);
  EXPECT_THAT(report["optimize"]["why"].get<std::string>(), HasSubstr("at the noise"));
  EXPECT_EQ(report["optimize"]["rms_before"], report["optimize"]["rms_after"]);
}

}  // namespace batten::internal::optimize_test
