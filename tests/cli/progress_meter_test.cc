// SPDX-License-Identifier: MIT
// What the progress bar says of stages, rates and time.
#include "cli/terminal/progress_meter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace batten::internal::progress_meter_test {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

TEST(ProgressMeterTest, TheFractionNeverGoesBackWithinAStage) {
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> any(-0.5, 1.5);
  ProgressMeter meter;
  double before = 0;
  for (int k = 0; k < 200; ++k) {
    meter.Note("prepare", any(engine), k);
    const double fraction = meter.At(k).fraction;
    EXPECT_GE(fraction, before);
    EXPECT_LE(fraction, 1);
    before = fraction;
  }
  EXPECT_EQ(before, 1);
  meter.Note("solve", 0.25, 200);
  EXPECT_EQ(meter.At(200).stage, "solve");
  EXPECT_EQ(meter.At(200).fraction, 0.25);
}

TEST(ProgressMeterTest, AtAnEvenPaceTheTimeLeftIsWhatWillPass) {
  for (const double start : {0.0, 0.4}) {
    ProgressMeter meter;
    constexpr double kAll = 60;  // seconds of the stage
    for (double t = 0; t <= 0.7 * kAll; t += 0.5) {
      meter.Note("parameterize", start + (1 - start) * t / kAll, 1000 + t);
      const ProgressFigures figures = meter.At(1000 + t);
      EXPECT_DOUBLE_EQ(figures.seconds, t);
      if (t < 1) {
        EXPECT_EQ(figures.left, std::nullopt);  // too early to tell
      } else if (t > 2) {
        EXPECT_NEAR(figures.left.value(), kAll - t, 1e-9);
      }
      EXPECT_FALSE(figures.at_most);
    }
  }
}

TEST(ProgressMeterTest, WhileNothingIsHeardTheTimeCountsDownAndIsThenLeftOut) {
  ProgressMeter meter;
  meter.Note("prepare", 0, 0);
  meter.Note("prepare", 0.5, 10);
  EXPECT_EQ(meter.At(10).left, 10);
  EXPECT_EQ(meter.At(17).left, 3);
  EXPECT_EQ(meter.At(21).left, std::nullopt);
}

TEST(ProgressMeterTest, RatesAreOfTheAmountKnown) {
  ProgressMeter meter;
  meter.SetAmount("read", 800e6, "B");
  meter.SetAmount("project", 3e6, "points");
  meter.Note("read", 0, 0);
  meter.Note("read", 0.5, 1);
  EXPECT_EQ(meter.At(1).rate, "400 MB/s");
  meter.Note("project", 0, 2);
  EXPECT_EQ(meter.At(2).rate, "");
  meter.Note("project", 0.4, 3);
  EXPECT_EQ(meter.At(3).rate, "1.2 M points/s");
  meter.SetAmount("read", 0, "B");  // a pipe
  meter.Note("read", 0.5, 4);
  meter.Note("read", 0.75, 5);
  EXPECT_EQ(meter.At(5).rate, "");
}

TEST(ProgressMeterTest, ASecondFileBeginsReadingAnew) {
  ProgressMeter meter;
  meter.SetAmount("read", 100e6, "B");
  meter.Note("read", 0, 0);
  meter.Note("read", 1, 50);
  meter.SetAmount("read", 100e6, "B");
  meter.Note("read", 0, 60);
  meter.Note("read", 0.5, 61);
  EXPECT_EQ(meter.At(61).fraction, 0.5);
  EXPECT_EQ(meter.At(61).rate, "50 MB/s");
}

TEST(ProgressMeterTest, RoundsAreCountedAndTheirTimeIsABound) {
  ProgressMeter meter;
  for (int round = 0; round <= 10; ++round) meter.Note("optimize", round / 50.0, 0.4 * round);
  const ProgressFigures joint = meter.At(4);
  EXPECT_EQ(joint.rate, "2.5 rounds/s");
  EXPECT_TRUE(joint.at_most);
  EXPECT_NEAR(joint.left.value(), 16, 1e-9);
  EXPECT_THAT(ProgressLine(joint, 80), EndsWith("  20 %  2.5 rounds/s  at most 0:16 left"));
  // Rounds of refinement end whenever they end.
  for (int round = 0; round <= 10; ++round) meter.Note("refine", 0.02 * round, 10 + 2 * round);
  EXPECT_EQ(meter.At(30).left, std::nullopt);
  EXPECT_EQ(meter.At(30).rate, "0.5 rounds/s");
}

ProgressFigures Halfway() { return {"read", 0.5, 2, "412 MB/s", 2.0, false}; }

TEST(ProgressLineTest, AtFullWidthEverythingIsSaid) {
  EXPECT_EQ(ProgressLine(Halfway(), 80),
            "read         [" + std::string(15, '#') + std::string(15, '.') +
                "]  50 %  412 MB/s  0:02 left");
}

TEST(ProgressLineTest, AnyWidthIsKeptAndThePercentageStaysLongest) {
  for (const double fraction : {0.0, 0.004, 0.5, 0.999, 1.0}) {
    ProgressFigures figures = Halfway();
    figures.fraction = fraction;
    for (int columns = 0; columns <= 200; ++columns) {
      const std::string line = ProgressLine(figures, columns);
      EXPECT_LE(static_cast<int>(line.size()), std::max(columns - 1, 0)) << columns << line;
      if (columns > 6 && fraction == 0.5) {
        EXPECT_THAT(line, HasSubstr(" 50 %"));
      }
    }
  }
  EXPECT_EQ(ProgressLine(Halfway(), 40), "read  50 %  412 MB/s  0:02 left");
  EXPECT_EQ(ProgressLine(Halfway(), 24), "read  50 %  0:02 left");
  EXPECT_EQ(ProgressLine(Halfway(), 12), "read  50 %");
}

TEST(ProgressLineTest, HundredPerCentIsSaidAtTheEndOnly) {
  ProgressFigures figures = Halfway();
  figures.fraction = 0.9999;
  EXPECT_THAT(ProgressLine(figures, 80), HasSubstr(".]  99 %"));
  figures.fraction = 1;
  EXPECT_THAT(ProgressLine(figures, 80), HasSubstr("#] 100 %"));
}

TEST(ProgressLineTest, WhatIsNotKnownIsLeftOut) {
  EXPECT_EQ(ProgressLine({"parameterize", 0, 75.9, "", std::nullopt, false}, 80),
            "parameterize  1:15");
  const std::string begun = ProgressLine({"prepare", 0.1, 3, "", std::nullopt, false}, 80);
  EXPECT_THAT(begun, StartsWith("prepare      [###."));
  EXPECT_THAT(begun, EndsWith("  10 %  0:03"));
  EXPECT_THAT(begun, Not(HasSubstr("left")));
  EXPECT_THAT(ProgressLine({"prepare", 0.1, 3, "", 7200.0, false}, 80), EndsWith("2:00:00 left"));
}

}  // namespace batten::internal::progress_meter_test
