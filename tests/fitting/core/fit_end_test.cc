// SPDX-License-Identifier: MIT
#include "fitting/core/fit_end.h"

#include <gtest/gtest.h>

namespace batten::internal::fit_end_test {

FitReport ReportOf(double error, std::optional<double> tolerance) {
  FitReport report;
  report.error = Summarise(Eigen::Vector3d::Constant(error), tolerance);
  return report;
}

EndCode Judged(const EndEvidence& evidence,
               double error,
               std::optional<double> tolerance = std::nullopt) {
  FitReport report = ReportOf(error, tolerance);
  JudgeEnd(evidence, report);
  EXPECT_EQ(report.termination, TerminationOf(report.end.code));
  EXPECT_FALSE(report.end.words.empty());
  const bool reached =
      report.end.code == EndCode::kToleranceReached || report.end.code == EndCode::kNoiseReached;
  EXPECT_EQ(report.end.where.has_value(), !reached && evidence.farthest.has_value());
  return report.end.code;
}

TEST(JudgeEndTest, NoEndButCancellationBeatsAKeptTolerance) {
  for (const EndCode search : {EndCode::kToleranceReached,
                               EndCode::kNoiseReached,
                               EndCode::kCrossValidated,
                               EndCode::kDetailBelowSpacing,
                               EndCode::kMaxControlPoints}) {
    EXPECT_EQ(Judged({.search = search}, 0.1, 0.2), EndCode::kToleranceReached);
    EXPECT_NE(Judged({.search = search}, 0.3, 0.2), EndCode::kToleranceReached);
  }
  EXPECT_EQ(Judged({.search = EndCode::kCancelled}, 0.1, 0.2), EndCode::kCancelled);
}

TEST(JudgeEndTest, ResidualsUpToTwiceTheNoiseAreNoise) {
  EXPECT_EQ(Judged({.noise = 0.06}, 0.1), EndCode::kNoiseReached);
  EXPECT_EQ(Judged({.noise = 0.04}, 0.1), EndCode::kCrossValidated);
  EXPECT_EQ(Judged({.noise = 0.06}, 0.1, 0.05), EndCode::kNoiseReached);
  EXPECT_EQ(Judged({.rounding = 1e-9}, 1e-10), EndCode::kNoiseReached);
  EXPECT_EQ(Judged({}, 1e-10), EndCode::kCrossValidated);  // neither is known
}

TEST(JudgeEndTest, ASurfaceThatLeavesItsPointsIsNeitherKeptNorAtTheNoise) {
  for (const std::optional<double> tolerance : {std::optional<double>(), {0.2}}) {
    FitReport report = ReportOf(0.1, tolerance);
    report.overshoot = OvershootSummary{.max = 8, .in_spacings = 4, .at = {1, 2, 3}};
    JudgeEnd({.search = EndCode::kToleranceReached, .noise = 0.1}, report);
    EXPECT_EQ(report.end.code, EndCode::kStructuredResiduals);
    EXPECT_EQ(report.end.where, Eigen::Vector3d(1, 2, 3));
    EXPECT_NE(report.end.words.find("by 8, 4 times their spacing"), std::string::npos);
    EXPECT_EQ(report.tolerance_reached(), tolerance ? std::optional(false) : std::nullopt);
  }
}

TEST(JudgeEndTest, SaysWhatWasUsedUp) {
  const EndEvidence full{.search = EndCode::kMaxControlPoints, .noise = 0.06};
  EXPECT_EQ(Judged(full, 0.1, 0.05), EndCode::kMaxControlPoints);
  EXPECT_EQ(Judged(full, 0.1), EndCode::kNoiseReached);  // more would follow the noise
  EXPECT_EQ(Judged(full, 0.2), EndCode::kMaxControlPoints);
  EXPECT_EQ(Judged({.control_points_given = true}, 0.2), EndCode::kMaxControlPoints);
}

TEST(JudgeEndTest, TellsShapeFromWhatIsTooFine) {
  const Eigen::Vector3d place(1, 2, 3);
  const EndEvidence shape{.noise = 0.01, .structured = true, .farthest = place};
  EXPECT_EQ(Judged(shape, 0.1), EndCode::kStructuredResiduals);
  EXPECT_EQ(Judged(shape, 0.1, 0.05), EndCode::kStructuredResiduals);
  EXPECT_EQ(Judged({.noise = 0.01, .farthest = place}, 0.1, 0.05), EndCode::kDetailBelowSpacing);
  EXPECT_EQ(
      Judged(
          {.search = EndCode::kDetailBelowSpacing, .noise = 0.01, .structured = true}, 0.1, 0.05),
      EndCode::kDetailBelowSpacing);
}

}  // namespace batten::internal::fit_end_test
