// SPDX-License-Identifier: MIT
// The user's own terms in whole fits of surfaces.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>

#include "batten/fitting/fit_surface.h"
#include "known_clouds.h"
#include "placed_term.h"
#include "refusal.h"

namespace batten::internal::fit_terms_test {

constexpr double kHeavy = 1e4;    // squared beside some thousand points of weight 1
constexpr double kMissed = 1e-4;  // 1e8 pulls against thousands of points times their residuals

const Eigen::Vector3d& Away() {
  static const Eigen::Vector3d away(4e5, 5e6, 200);
  return away;
}

PointCloud Cloud() {
  Eigen::Matrix3Xd points = Scatter(Tilted, 3000, 1e-3, 0.01, 1);
  points.colwise() += Away();
  return PointCloud::FromWorld(std::move(points));
}

SurfaceFitOptions Options() {
  SurfaceFitOptions options;
  options.trim = Trimming::kNone;
  options.threads = 2;
  return options;
}

// Lifts the first control point above where the stage starts.
SurfaceFitOptions Lifting(Eigen::Vector3d& place, double height = 0.02) {
  SurfaceFitOptions options = Options();
  options.terms = [&place, height](const NurbsSurface& start) -> ResidualTerms {
    place = start.control_points().col(0) + Eigen::Vector3d(0, 0, height);
    return {std::make_shared<PlacedTerm>(0, place, kHeavy)};
  };
  return options;
}

TEST(FitTermsTest, ATermIsMetInWorldCoordinatesAndTheReportIsThatOfTheSurface) {
  Eigen::Vector3d place;
  const SurfaceFit fit = FitSurface(Cloud(), Lifting(place));
  EXPECT_LT((place - Away() - Eigen::Vector3d(0, 0, 0.02)).norm(), 0.5);  // the cloud's corner
  EXPECT_LT((fit.surface.control_points().col(0) - place).norm(), kMissed);
  EXPECT_TRUE(fit.report.optimize.ran);
  EXPECT_EQ(fit.report.optimize.why.rfind("the user's terms", 0), 0U);
  EXPECT_GT(fit.outliers.count(), 5);
  const double squares = fit.outliers.select(0, fit.residuals.array().square()).sum();
  EXPECT_NEAR(fit.report.error.rms,
              std::sqrt(squares / static_cast<double>(fit.report.error.points)),
              1e-9);
  // It leads away from the points, and the report says so.
  EXPECT_GT(fit.report.error.rms, FitSurface(Cloud(), Options()).report.error.rms);
}

// Under a robust loss the edges would retreat from the outermost points.
TEST(FitTermsTest, ATermThatIsMetAlreadyLeavesTheFitAsGood) {
  Eigen::Vector3d place;
  const SurfaceFit plain = FitSurface(Cloud(), Options());
  const SurfaceFit fit = FitSurface(Cloud(), Lifting(place, 0));
  ASSERT_GT(plain.outliers.count(), 0);
  EXPECT_LE(fit.report.error.rms, plain.report.error.rms);
  EXPECT_LE(fit.report.error.max, 1.2 * plain.report.error.max);
}

TEST(FitTermsTest, CoordinatesAreThoseOfTheResult) {
  Eigen::Vector3d place;
  SurfaceFitOptions options = Lifting(place);
  options.shift = Away();
  const SurfaceFit fit = FitSurface(Cloud(), options);
  EXPECT_LT(place.norm(), 1);
  EXPECT_LT((fit.surface.control_points().col(0) - place).norm(), kMissed);
}

TEST(FitTermsTest, RefusesWhatHoldsControlPointsOtherwise) {
  Eigen::Vector3d place;
  SurfaceFitOptions options = Lifting(place);
  options.snap = true;
  EXPECT_NE(RefusalOf([&] { FitSurface(Cloud(), options); }), "accepted");
  options = Lifting(place);
  options.symmetric = MirrorPlane{Eigen::Vector3d::UnitX(), 0};
  EXPECT_NE(RefusalOf([&] { FitSurface(Cloud(), options); }), "accepted");
  options = Options();
  options.terms = [](const NurbsSurface& start) -> ResidualTerms {
    const int outside = start.size_u() * start.size_v();
    return {std::make_shared<PlacedTerm>(outside, Eigen::Vector3d::Zero(), 1)};
  };
  EXPECT_NE(RefusalOf([&] { FitSurface(Cloud(), options); }), "accepted");
}

}  // namespace batten::internal::fit_terms_test
