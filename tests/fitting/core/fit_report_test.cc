// SPDX-License-Identifier: MIT
#include "batten/fitting/fit_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::fit_report_test {

using testing::HasSubstr;
using testing::Not;

Eigen::VectorXd RandomDistances(RandomSplines& random, Eigen::Index count) {
  Eigen::VectorXd distances(count);
  for (double& d : distances) d = random.Real(-1, 2);
  return distances;
}

// The value that a share of the sorted sample lies below, linear between neighbours.
double SortedQuantile(Eigen::VectorXd values, double share) {
  std::sort(values.begin(), values.end());
  const double position = share * static_cast<double>(values.size() - 1);
  const auto low = static_cast<Eigen::Index>(position);
  const Eigen::Index high = std::min(low + 1, values.size() - 1);
  return std::lerp(values[low], values[high], position - static_cast<double>(low));
}

void ExpectEqual(const ErrorSummary& a, const ErrorSummary& b) {
  EXPECT_EQ(a.rms, b.rms);
  EXPECT_EQ(a.mean, b.mean);
  EXPECT_EQ(a.max, b.max);
  EXPECT_EQ(a.p50, b.p50);
  EXPECT_EQ(a.p95, b.p95);
  EXPECT_EQ(a.p99, b.p99);
  EXPECT_EQ(a.signed_p5, b.signed_p5);
  EXPECT_EQ(a.signed_p95, b.signed_p95);
  EXPECT_EQ(a.tolerance, b.tolerance);
  EXPECT_EQ(a.within_tolerance, b.within_tolerance);
  EXPECT_EQ(a.out_of_tolerance, b.out_of_tolerance);
  EXPECT_EQ(a.points, b.points);
}

// Of a cube of side 10, noise 0.01, a thousand points.
FitReport FitOfACube() {
  FitReport report;
  report.input.points = report.input.used = 1000;
  report.input.noise = 0.01;
  report.input.box_max = Eigen::Vector3d::Constant(10);
  report.end = {EndCode::kNoiseReached, "at the noise"};
  return report;
}

std::vector<std::string> DoubtsOf(const FitReport& report) {
  std::vector<std::string> codes;
  for (const Doubt& doubt : report.Doubts()) codes.push_back(doubt.code);
  return codes;
}

TEST(DoubtsTest, TellWhatPassesItsLevelAndNothingElse) {
  using Codes = std::vector<std::string>;
  FitReport report = FitOfACube();
  EXPECT_EQ(DoubtsOf(report), Codes{});
  report.input.outliers = 100;
  EXPECT_EQ(DoubtsOf(report), Codes{});
  report.input.outliers = 101;
  EXPECT_EQ(DoubtsOf(report), Codes{"points_left_out"});

  // Ten times the noise and a hundredth of the diagonal: both.
  const double hundredth = 0.1 * std::sqrt(3.0);
  report = FitOfACube();
  report.error.max = 0.99 * hundredth;
  EXPECT_EQ(DoubtsOf(report), Codes{});
  report.error.max = 1.01 * hundredth;
  EXPECT_EQ(DoubtsOf(report), Codes{"points_missed"});
  report.input.noise = 0.2 * hundredth;
  EXPECT_EQ(DoubtsOf(report), Codes{});
  report.error.max = 2.1 * hundredth;
  EXPECT_EQ(DoubtsOf(report), Codes{"points_missed"});

  report = FitOfACube();
  report.end.code = EndCode::kStructuredResiduals;
  report.doubts.push_back({"volume", "its volume is 1, that of the mesh 2"});
  EXPECT_EQ(DoubtsOf(report), (Codes{"volume", "structured_residuals"}));

  report = FitOfACube();
  report.overshoot = OvershootSummary();
  report.overshoot->of_box = 1;
  EXPECT_EQ(DoubtsOf(report), Codes{"leaves_points"});
  report.end.code = EndCode::kStructuredResiduals;  // which is told for it
  EXPECT_EQ(DoubtsOf(report), Codes{"structured_residuals"});

  report = {};  // a comparison fits nothing
  report.error.max = 1e9;
  report.input.box_max.setOnes();
  EXPECT_EQ(DoubtsOf(report), Codes{});
}

TEST(SummariseTest, FollowsTheFormulas) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const Eigen::VectorXd d = RandomDistances(random, random.Integer(1, 300));
    const Eigen::VectorXd size = d.cwiseAbs();
    const double tolerance = random.Real(0.1, 2), m = static_cast<double>(d.size());
    const ErrorSummary summary = Summarise(d, tolerance);
    EXPECT_NEAR(summary.rms, d.norm() / std::sqrt(m), kRounding);
    EXPECT_NEAR(summary.mean, size.mean(), kRounding);
    EXPECT_EQ(summary.max, size.maxCoeff());
    EXPECT_NEAR(summary.p50, SortedQuantile(size, 0.50), kRounding);
    EXPECT_NEAR(summary.p95, SortedQuantile(size, 0.95), kRounding);
    EXPECT_NEAR(summary.p99, SortedQuantile(size, 0.99), kRounding);
    EXPECT_NEAR(summary.signed_p5, SortedQuantile(d, 0.05), kRounding);
    EXPECT_NEAR(summary.signed_p95, SortedQuantile(d, 0.95), kRounding);
    EXPECT_EQ(summary.tolerance, tolerance);
    EXPECT_EQ(summary.out_of_tolerance, (size.array() > tolerance).count());
    EXPECT_NEAR(summary.within_tolerance,
                static_cast<double>((size.array() <= tolerance).count()) / m,
                kRounding);
    EXPECT_EQ(summary.points, d.size());
  }
}

TEST(SummariseTest, OrdersItsFigures) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const ErrorSummary s = Summarise(RandomDistances(random, random.Integer(1, 300)), {});
    EXPECT_LE(s.mean, s.rms * (1 + kRounding));
    EXPECT_LE(s.rms, s.max * (1 + kRounding));
    EXPECT_LE(s.p50, s.p95);
    EXPECT_LE(s.p95, s.p99);
    EXPECT_LE(s.p99, s.max);
    EXPECT_LE(s.signed_p5, s.signed_p95);
  }
}

TEST(SummariseTest, LooksOnlyAtThePointsOfTheMask) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    Eigen::VectorXd d = RandomDistances(random, 100);
    Eigen::Array<bool, Eigen::Dynamic, 1> mask(100);
    for (bool& k : mask) k = random.Coin();
    std::vector<double> chosen;
    for (Eigen::Index k = 0; k < 100; ++k) {
      if (mask[k]) chosen.push_back(d[k]);
      if (!mask[k]) d[k] = 1e30;
    }
    const auto count = static_cast<Eigen::Index>(chosen.size());
    ExpectEqual(Summarise(d, 0.5, mask),
                Summarise(Eigen::Map<Eigen::VectorXd>(chosen.data(), count), 0.5));
  }
}

TEST(SummariseTest, CountsAPointAtTheToleranceAsWithin) {
  const ErrorSummary summary = Summarise(Eigen::Vector3d(0.5, -0.5, 0), 0.5);
  EXPECT_EQ(summary.out_of_tolerance, 0);
  EXPECT_EQ(summary.within_tolerance, 1);
  EXPECT_EQ(Summarise(Eigen::Vector3d(0.5, std::nextafter(-0.5, -1), 0), 0.5).out_of_tolerance, 1);
}

TEST(SummariseTest, OfNoPointsIsAllZero) {
  ErrorSummary nothing;
  nothing.tolerance = 0.1;
  ExpectEqual(Summarise({}, 0.1), nothing);
  const Eigen::Array<bool, Eigen::Dynamic, 1> none = Eigen::Array<bool, 3, 1>::Constant(false);
  ExpectEqual(Summarise(Eigen::Vector3d(1, 2, 3), 0.1, none), nothing);
}

TEST(TerminationTest, IsNamedByTheWordsOfTheContract) {
  EXPECT_STREQ(Name(Termination::kToleranceReached), "tolerance_reached");
  EXPECT_STREQ(Name(Termination::kNoiseReached), "noise_reached");
  EXPECT_STREQ(Name(Termination::kMaxControlPoints), "max_control_points");
  EXPECT_STREQ(Name(Termination::kMaxIterations), "max_iterations");
  EXPECT_STREQ(Name(Termination::kStalled), "stalled");
  EXPECT_STREQ(Name(Termination::kCancelled), "cancelled");
}

TEST(FitReportTest, SaysWhetherTheToleranceIsReachedOnlyWhereThereIsOne) {
  FitReport report;
  EXPECT_EQ(report.tolerance_reached(), std::nullopt);
  report.error = Summarise(Eigen::Vector3d(0.1, -0.2, 0.3), 0.3);
  EXPECT_EQ(report.tolerance_reached(), true);
  report.error = Summarise(Eigen::Vector3d(0.1, -0.2, 0.3), 0.25);
  EXPECT_EQ(report.tolerance_reached(), false);
}

TEST(FitReportTest, TellsItselfInOneLine) {
  FitReport report;
  report.geometry.kind = "surface";
  report.geometry.degree = {3, 2};
  report.geometry.control_points = {12, 7};
  report.input.points = 1234;
  report.error = Summarise(Eigen::Vector4d(0.125, -0.125, 0.125, -0.125), {});
  report.termination = Termination::kStalled;
  const std::string line = report.OneLine();
  for (const char* part : {"surface", "3,2", "12 x 7", "0.125", "4 of 1234 points", "stalled"}) {
    EXPECT_THAT(line, HasSubstr(part));
  }
  EXPECT_THAT(line, Not(HasSubstr("tolerance")));
  EXPECT_THAT(line, Not(HasSubstr("\n")));
  report.error = Summarise(Eigen::Vector4d(0.125, -0.125, 0.125, -0.125), 0.0625);
  EXPECT_THAT(report.OneLine(), HasSubstr("4 out of tolerance 0.0625"));
}

}  // namespace batten::internal::fit_report_test
