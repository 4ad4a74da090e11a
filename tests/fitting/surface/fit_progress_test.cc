// SPDX-License-Identifier: MIT
// The progress of whole fits: it names its stages and never goes back.
#include "batten/fitting/fit_progress.h"

#include <gtest/gtest.h>

#include <set>
#include <vector>

#include "batten/fitting/fit_surface.h"
#include "known_clouds.h"

namespace batten::internal::fit_progress_test {

const PointCloud& Cloud() {
  static const PointCloud cloud = PointCloud::FromWorld(Scatter(Franke, 4000, 1e-3, 0.02, 1));
  return cloud;
}

TEST(FitProgressTest, TheFractionOfAFitNeverGoesBack) {
  std::vector<FitProgress> seen;
  SurfaceFitOptions options{.tolerance = 0.01};
  options.optimize = FreeVariables{.parameters = true};
  options.progress = WholeFit([&](const FitProgress& at) {
    seen.push_back(at);
    return true;
  });
  FitSurface(Cloud(), options);
  ASSERT_GT(seen.size(), 5U);
  std::set<FitStage> stages;
  double before = 0;
  for (const FitProgress& at : seen) {
    EXPECT_GE(at.fraction, before);
    EXPECT_LE(at.fraction, 1);
    EXPECT_GE(at.stage_fraction, 0);
    EXPECT_LE(at.stage_fraction, 1);
    before = at.fraction;
    stages.insert(at.stage);
  }
  EXPECT_EQ(seen.front().fraction, 0);
  EXPECT_GT(before, 0.7);
  for (const FitStage stage :
       {FitStage::kPrepare, FitStage::kParameterize, FitStage::kSolve, FitStage::kOptimize}) {
    EXPECT_TRUE(stages.contains(stage)) << static_cast<int>(stage);
  }
}

TEST(FitProgressTest, ItStopsTheFit) {
  SurfaceFitOptions options;
  options.progress = WholeFit([](const FitProgress& at) { return at.stage == FitStage::kPrepare; });
  EXPECT_THROW(FitSurface(Cloud(), options), Cancelled);
}

TEST(FitProgressTest, NamesThatAreNoStagesChangeNothing) {
  FitProgress last;
  const Progress progress = WholeFit([&](const FitProgress& at) {
    last = at;
    return true;
  });
  progress("solve", 0.5);
  const double fraction = last.fraction;
  progress("draw", 0.9);
  EXPECT_EQ(last.stage, FitStage::kSolve);
  EXPECT_EQ(last.fraction, fraction);
  progress("prepare", 0.1);  // a second fit of the same points
  EXPECT_EQ(last.stage, FitStage::kPrepare);
  EXPECT_EQ(last.fraction, fraction);
}

}  // namespace batten::internal::fit_progress_test
