// SPDX-License-Identifier: MIT
// Laws of streamed fits: the answer of the fit in memory, whatever the order and the parts.
#include "batten/fitting/fit_streamed.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "batten/fitting/distances.h"
#include "batten/fitting/fit_surface.h"
#include "known_clouds.h"
#include "tolerances.h"

namespace batten::internal::fit_streamed_test {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

constexpr std::int64_t kLittle = std::int64_t{1} << 25;  // bytes: 134 000 points take more
constexpr double kSigma = 0.005;

double Wavy(double x, double y) {
  return 0.08 * std::sin(7 * x) + 0.05 * std::cos(6 * y) + 0.02 * std::sin(14 * x + 8 * y);
}

Eigen::Matrix3Xd Cloud(Eigen::Index count, double outliers = 0, std::uint64_t seed = 1) {
  return Scatter(Wavy, count, kSigma, outliers, seed);
}

// rms distance of the true shape from the surface.
double TruthError(const NurbsSurface& surface, const Eigen::Matrix3Xd& truth) {
  ThreadPool pool(1);
  const Eigen::VectorXd d = DistancesTo(surface, truth, pool).distances;
  return std::sqrt(d.squaredNorm() / static_cast<double>(d.size()));
}

SurfaceFitOptions Untrimmed() {
  SurfaceFitOptions options;
  options.trim = Trimming::kNone;
  options.threads = 1;
  return options;
}

// A matrix in pieces, in some order of them.
class PiecesSource : public PointSource {
 public:
  PiecesSource(const Eigen::Matrix3Xd& points, int pieces, bool backwards)
      : points_(points), pieces_(pieces), backwards_(backwards) {}
  void Pass(const TakePoints& take) override {
    ++passes;
    for (int k = 0; k < pieces_; ++k) {
      const int at = backwards_ ? pieces_ - 1 - k : k;
      const Eigen::Index begin = points_.cols() * at / pieces_,
                         end = points_.cols() * (at + 1) / pieces_;
      take(points_.middleCols(begin, end - begin));
    }
    if (change_after > 0 && passes == change_after)
      points_.conservativeResize(3, points_.cols() - 1);
  }
  int passes = 0, change_after = 0;

 private:
  Eigen::Matrix3Xd points_;
  int pieces_;
  bool backwards_;
};

TEST(FitStreamedTest, AnswersAsTheFitInMemoryDoes) {
  for (const double outliers : {0.0, 0.02}) {
    SCOPED_TRACE(outliers);
    const Eigen::Matrix3Xd points = Cloud(160000, outliers);
    const Eigen::Matrix3Xd truth = TruthGrid(Wavy, 60);
    const SurfaceFit whole = FitSurface(PointCloud(points), Untrimmed());
    ArraySource source(points);
    const StreamedFit streamed = FitStreamed(source, Untrimmed(), {.memory = kLittle});
    EXPECT_FALSE(streamed.in_memory);
    EXPECT_EQ(streamed.surface.size_u(), whole.surface.size_u());
    EXPECT_EQ(streamed.surface.size_v(), whole.surface.size_v());
    constexpr double kAsGood = 1.02;
    EXPECT_LT(TruthError(streamed.surface, truth), kAsGood * TruthError(whole.surface, truth));
    EXPECT_EQ(streamed.report.input.points, points.cols());
    EXPECT_EQ(streamed.report.error_all.points, points.cols());
  }
}

TEST(FitStreamedTest, TheReportIsThatOfAllPoints) {
  const Eigen::Matrix3Xd points = Cloud(140000, 0.01);
  ArraySource source(points);
  const StreamedFit fit = FitStreamed(source, Untrimmed(), {.memory = kLittle});
  ThreadPool pool(1);
  const ErrorSummary all = Summarise(DistancesTo(fit.surface, points, pool).distances, {});
  EXPECT_NEAR(fit.report.error_all.rms, all.rms, kIterated * all.rms);
  EXPECT_NEAR(fit.report.error_all.mean, all.mean, kIterated * all.mean);
  EXPECT_NEAR(fit.report.error_all.max, all.max, kIterated * all.max);
  constexpr double kStep = 2e-3;  // quantiles are told in 512 steps an octave
  EXPECT_NEAR(fit.report.error_all.p50, all.p50, kStep * all.p50);
  EXPECT_NEAR(fit.report.error_all.p99, all.p99, kStep * all.p99);
  EXPECT_NEAR(fit.report.error_all.signed_p5, all.signed_p5, kStep * -all.signed_p5);
  EXPECT_NEAR(fit.report.input.noise, kSigma, 0.5 * kSigma);  // along the normal of steep flanks
  EXPECT_GT(fit.report.input.outliers, 0);
}

TEST(FitStreamedTest, OrderAndPartsDoNotMatterBeyondRounding) {
  const Eigen::Matrix3Xd points = Cloud(140000, 0.01);
  PiecesSource forwards(points, 3, false), backwards(points, 7, true);
  const StreamedFit a = FitStreamed(forwards, Untrimmed(), {.memory = kLittle, .sample = 20000}),
                    b = FitStreamed(backwards, Untrimmed(), {.memory = kLittle, .sample = 20000});
  ASSERT_EQ(a.surface.size_u(), b.surface.size_u());
  ASSERT_EQ(a.surface.size_v(), b.surface.size_v());
  EXPECT_LT((a.surface.control_points() - b.surface.control_points()).cwiseAbs().maxCoeff(),
            kIterated);
  EXPECT_EQ(a.report.input.outliers, b.report.input.outliers);
  EXPECT_EQ(a.sample.points(), b.sample.points());
}

TEST(FitStreamedTest, FewPointsAreFittedInMemory) {
  const Eigen::Matrix3Xd points = Cloud(5000);
  ArraySource source(points);
  const StreamedFit streamed = FitStreamed(source, Untrimmed());
  const SurfaceFit whole = FitSurface(PointCloud::FromWorld(points), Untrimmed());
  EXPECT_TRUE(streamed.in_memory);
  EXPECT_EQ(streamed.surface.control_points(), whole.surface.control_points());
  EXPECT_EQ(streamed.residuals, whole.residuals);
}

TEST(FitStreamedTest, FarFromZeroAndTinyAreTheSameShape) {
  const Eigen::Matrix3Xd points = Cloud(140000);
  const StreamOptions stream{.memory = kLittle, .sample = 20000};
  ArraySource here(points);
  const StreamedFit a = FitStreamed(here, Untrimmed(), stream);
  const Eigen::Vector3d far(5e6, 4e5, 100);
  constexpr double kTiny = 0x1p-20;
  const Eigen::Matrix3Xd moved = points.colwise() + far, small = kTiny * points;
  ArraySource there(moved), tiny(small);
  const StreamedFit b = FitStreamed(there, Untrimmed(), stream),
                    c = FitStreamed(tiny, Untrimmed(), stream);
  // Samples differ with the coordinates.
  constexpr double kAlike = 0.02;
  EXPECT_NEAR(b.report.error.rms, a.report.error.rms, kAlike * a.report.error.rms);
  EXPECT_NEAR(c.report.error.rms, kTiny * a.report.error.rms, kAlike * kTiny * a.report.error.rms);
  EXPECT_NEAR(c.surface.size_u(), a.surface.size_u(), 2);
  EXPECT_NEAR(b.surface.size_v(), a.surface.size_v(), 2);
}

// Of a bent sheet, of whose parameters only the sample's are laid out flat.
TEST(FitStreamedTest, SheetsAreFollowedToTheNoise) {
  const auto radius = [](double turn) { return 5 + 0.3 * std::sin(3 * turn); };
  Eigen::Matrix3Xd points = Scatter([](double, double) { return 0.0; }, 140000, kSigma, 0, 3);
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    const double turn = 5.4 * points(0, k), r = radius(turn) + points(2, k);
    points.col(k) = Eigen::Vector3d(r * std::cos(turn), r * std::sin(turn), 4 * points(1, k));
  }
  ArraySource source(points);
  const StreamedFit fit = FitStreamed(source, Untrimmed(), {.memory = kLittle, .sample = 20000});
  EXPECT_EQ(fit.report.geometry.base, "sheet");
  Eigen::Matrix3Xd truth = TruthGrid([](double, double) { return 0.0; }, 80);
  for (Eigen::Index k = 0; k < truth.cols(); ++k) {
    const double turn = 5.4 * truth(0, k), r = radius(turn);
    truth.col(k) = Eigen::Vector3d(r * std::cos(turn), r * std::sin(turn), 4 * truth(1, k));
  }
  // The standard error of a linear fit, and as much again for the shape.
  const double freedom = fit.surface.size_u() * fit.surface.size_v();
  EXPECT_LT(TruthError(fit.surface, truth),
            2 * kSigma * std::sqrt(freedom / static_cast<double>(points.cols())));
}

TEST(FitStreamedTest, APartTheSampleMissesIsNamed) {
  Eigen::Matrix3Xd points = Cloud(140000);
  // A part beside the others, of which a sample of a thousand has hardly a point.
  for (Eigen::Index k = 0; k < 40; ++k)
    points.col(k) = Eigen::Vector3d(3, 3, 0) + 0.01 * points.col(k);
  ArraySource source(points);
  SurfaceFitOptions options = Untrimmed();
  options.seed = 2;  // of 1 the sample has one of them, and takes it for an outlier
  const StreamedFit fit = FitStreamed(source, options, {.memory = kLittle, .sample = 1000});
  ASSERT_EQ(fit.report.input.outliers, 40);
  EXPECT_THAT(fit.report.warnings,
              Contains(AllOf(HasSubstr("40 points"),
                             HasSubstr("it may miss a part; they are between (3"))));
  EXPECT_GT(fit.report.error_all.max, 2);
  EXPECT_LT(fit.report.error.max, 0.1);
}

TEST(FitStreamedTest, PartsThatDoNotTouchAreNamed) {
  Eigen::Matrix3Xd points = Cloud(140000);
  for (auto point : points.colwise())
    if (point[0] > 0.6) point[0] += 2;
  ArraySource source(points);
  const StreamedFit fit = FitStreamed(source, Untrimmed(), {.memory = kLittle, .sample = 20000});
  EXPECT_THAT(fit.report.warnings,
              Contains(AllOf(HasSubstr("2 parts that do not touch: "),
                             HasSubstr("between (2.6"),
                             HasSubstr("one surface runs through the gaps"))));
}

TEST(FitStreamedTest, WhatCannotBeIsRefused) {
  const Eigen::Matrix3Xd points = Cloud(140000);
  ArraySource source(points);
  const auto reason = [&](const SurfaceFitOptions& options, const StreamOptions& stream) {
    try {
      FitStreamed(source, options, stream);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("nothing");
  };
  SurfaceFitOptions thinned;
  thinned.thin = 0.1;
  EXPECT_THAT(reason(thinned, {}), HasSubstr("thin: needs all points in memory"));
  EXPECT_THAT(reason({}, {.memory = 1000}), HasSubstr("memory: 1000 bytes"));
  EXPECT_THAT(reason({}, {.memory = kLittle, .sample = 10}), HasSubstr("sample: 10 points"));
  const Eigen::Matrix3Xd none(3, 0);
  ArraySource nothing(none);
  EXPECT_THROW(FitStreamed(nothing), std::invalid_argument);
  PiecesSource changing(points, 3, false);
  changing.change_after = 1;
  EXPECT_THROW(FitStreamed(changing, Untrimmed(), {.memory = kLittle}), std::runtime_error);
  SurfaceFitOptions stopped = Untrimmed();
  stopped.progress = [](const char* stage, double) { return std::string(stage) != "project"; };
  EXPECT_THROW(FitStreamed(source, stopped, {.memory = kLittle}), Cancelled);
}

// Finished passes in memory.
class PassesInMemory : public PassStore {
 public:
  std::optional<std::vector<double>> Kept(int pass) override {
    const auto found = passes.find(pass);
    if (found == passes.end()) return std::nullopt;
    return found->second;
  }
  void Keep(int pass, std::span<const double> numbers) override {
    passes[pass] = {numbers.begin(), numbers.end()};
  }
  std::map<int, std::vector<double>> passes;
};

// Breaks down in pass `last`.
class BreakingSource : public PiecesSource {
 public:
  BreakingSource(const Eigen::Matrix3Xd& points, int last)
      : PiecesSource(points, 5, false), last_(last) {}
  void Pass(const TakePoints& take) override {
    int pieces = 0;
    PiecesSource::Pass([&](const Eigen::Matrix3Xd& points) {
      if (passes == last_ && ++pieces == 3) throw std::runtime_error("broken");
      take(points);
    });
  }

 private:
  int last_;
};

TEST(FitStreamedTest, GoesOnAfterTheLastFinishedPass) {
  const Eigen::Matrix3Xd points = Cloud(140000, 0.01);
  StreamOptions stream{.memory = kLittle, .sample = 20000};
  PiecesSource undisturbed(points, 5, false);
  const StreamedFit whole = FitStreamed(undisturbed, Untrimmed(), stream);
  for (int last = 1; last <= whole.passes; ++last) {
    SCOPED_TRACE(last);
    PassesInMemory store;
    stream.store = &store;
    BreakingSource breaking(points, last);
    EXPECT_THROW(FitStreamed(breaking, Untrimmed(), stream), std::runtime_error);
    EXPECT_EQ(store.passes.size(), last - 1);
    PiecesSource rest(points, 5, false);
    const StreamedFit fit = FitStreamed(rest, Untrimmed(), stream);
    EXPECT_EQ(rest.passes, whole.passes - last + 1);
    EXPECT_EQ(fit.surface, whole.surface);
    EXPECT_EQ(fit.report.error_all.p99, whole.report.error_all.p99);
    EXPECT_EQ(fit.report.end.words, whole.report.end.words);
    EXPECT_EQ(fit.residuals, whole.residuals);
  }
}

TEST(FitStreamedTest, ReadingAheadChangesNothing) {
  const Eigen::Matrix3Xd points = Cloud(140000, 0.01);
  PiecesSource source(points, 50, false), ahead(points, 50, false);
  SurfaceFitOptions two = Untrimmed();
  two.threads = 2;
  const StreamOptions stream{.memory = kLittle, .sample = 20000};
  EXPECT_EQ(FitStreamed(source, Untrimmed(), stream).surface,
            FitStreamed(ahead, two, stream).surface);
  // What the source throws arrives, and one that nobody listens to any more ends.
  BreakingSource breaking(points, 2);
  EXPECT_THROW(FitStreamed(breaking, two, stream), std::runtime_error);
  two.progress = [](const char* stage, double) { return std::string(stage) != "project"; };
  EXPECT_THROW(FitStreamed(source, two, stream), Cancelled);
}

TEST(FitStreamedTest, AToleranceIsJudgedByAllPoints) {
  const Eigen::Matrix3Xd points = Cloud(140000);
  SurfaceFitOptions options = Untrimmed();
  options.tolerance = 8 * kSigma;
  ArraySource source(points);
  const StreamedFit kept = FitStreamed(source, options, {.memory = kLittle});
  EXPECT_EQ(kept.report.tolerance_reached(), true);
  EXPECT_LE(kept.report.error.max, *options.tolerance);
  options.tolerance = 0.5 * kSigma;
  const StreamedFit missed = FitStreamed(source, options, {.memory = kLittle});
  EXPECT_EQ(missed.report.tolerance_reached(), false);
  EXPECT_GT(missed.report.error.out_of_tolerance, 0);
}

}  // namespace batten::internal::fit_streamed_test
