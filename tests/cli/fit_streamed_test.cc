// SPDX-License-Identifier: MIT
// Laws of fit surface --memory: the same answer in less memory.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sanitized.h"
#include "test_clouds.h"

namespace batten::internal::fit_streamed_command_test {

using ::testing::HasSubstr;

class FitStreamedCommandTest : public ::testing::Test {
 protected:
  Json Fit(std::vector<std::string> words, const std::string& out) {
    words.insert(words.begin(), {"fit", "surface"});
    words.insert(words.end(), {"-o", folder_.File(out), "--trim", "none", "--json"});
    const ProgramRun run = Batten(words);
    EXPECT_EQ(run.code, 0) << run.err;
    peak_ = run.peak_bytes;
    return Json::parse(run.out);
  }

  TemporaryFolder folder_;
  std::string a_ = folder_.With("a.xyz", ToText(WavySheet(100000))),
              b_ = folder_.With("b.xyz", ToText(WavySheet(60000, 2)));
  std::int64_t peak_ = 0;
};

TEST_F(FitStreamedCommandTest, IsTheFitInMemory) {
  const Json whole = Fit({a_, b_}, "whole.json"),
             streamed = Fit({b_, a_, "--memory", "36MB"}, "streamed.json");
  EXPECT_EQ(streamed["geometry"]["control_points"], whole["geometry"]["control_points"]);
  EXPECT_EQ(streamed["input"]["points"], 160000);
  // Sums of squares of residuals differ by what the surfaces do: far less than noise.
  constexpr double kAlike = 1e-3;
  const double rms = whole["error"]["rms"];
  EXPECT_NEAR(streamed["error"]["rms"].get<double>(), rms, kAlike * rms);
  if (kMemoryIsTheProgramsOwn) {
    EXPECT_LT(peak_ - MemoryAtStart(), 100 << 20);
  }
  // What fits is fitted in memory.
  const Json in_memory = Fit({a_, b_, "--memory", "1GB"}, "in_memory.json");
  EXPECT_EQ(folder_.Text("in_memory.json"), folder_.Text("whole.json"));
}

TEST_F(FitStreamedCommandTest, WhatNeedsAllPointsIsRefused) {
  const auto refused = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"fit", "surface", a_, "-o", folder_.File("x.json")});
    const ProgramRun run = Batten(words);
    EXPECT_EQ(run.code, 2);
    EXPECT_EQ(run.error_lines(), 1);
    return run.err;
  };
  EXPECT_THAT(refused({"--memory", "36MB", "--thin", "1"}), HasSubstr("--thin: needs all points"));
  EXPECT_THAT(refused({"--memory", "36MB", "--residuals", folder_.File("r.csv")}),
              HasSubstr("--residuals: needs"));
  EXPECT_THAT(refused({"--memory", "3MB"}), HasSubstr("--memory: '3MB' is not enough"));
  EXPECT_THAT(refused({"--memory", "much"}), HasSubstr("--memory: 'much' is not a size"));
}

}  // namespace batten::internal::fit_streamed_command_test
