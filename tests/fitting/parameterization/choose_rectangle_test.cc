// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "batten/fitting/solve_linear.h"
#include "fitting/knots/knot_grid_selection.h"
#include "fitting/least_squares/fitting_bases.h"
#include "fitting/parameterization/choose_parameterization.h"
#include "sheet_oracle.h"

namespace batten::internal::choose_rectangle_test {

ParameterizationChoice ChooseFor(const Eigen::Matrix3Xd& points, ThreadPool& pool) {
  const NeighbourIndex index(points);
  return ChooseBase(PointCloud(points), index, MeasureCloud(points, index, {}, pool), {}, pool);
}

const BaseCandidate* RowOf(const ParameterizationChoice& choice, const std::string& name) {
  const auto row = std::find_if(choice.candidates.begin(),
                                choice.candidates.end(),
                                [&](const BaseCandidate& one) { return one.name == name; });
  return row == choice.candidates.end() ? nullptr : &*row;
}

SheetPoints Noisy(const BentSheet& sheet, Eigen::Index count, unsigned seed) {
  return PointsOn(sheet, {.count = count, .sigma = 1e-3, .isotropic = true, .seed = seed});
}

// Laid out flat, a ramp of more than a turn lies over itself; seen from the side, a plane is steep
// nearly everywhere. Over the rectangle it is fitted nearly as at its true parameters.
TEST(ChooseRectangleTest, FitsRampsOfMoreThanATurnNearlyAsAtTheirTrueParameters) {
  ThreadPool pool(2);
  for (const double turns : {1.15, 2.5}) {
    SCOPED_TRACE(turns);
    const ChartedSheet ramp = Charted(HelicalRamp(turns), 10 * turns, 1);
    const SheetPoints cloud = Noisy(ramp.sheet, 12000, 1);
    const ParameterizationChoice choice = ChooseFor(cloud.points, pool);
    ASSERT_NE(RowOf(choice, "rectangle"), nullptr);
    EXPECT_EQ(RowOf(choice, "rectangle")->refused, "");
    EXPECT_TRUE(choice.reached.all());
    EXPECT_TRUE(choice.fits_noise);
    const FittingProblem problem =
        choice.base.ProblemOf(PointCloud(cloud.points), choice.reached, 3, 3, 1e-6);
    GridLimits limits;
    limits.near_cells_u = choice.base.settled_cells_u;
    limits.near_cells_v = choice.base.settled_cells_v;
    const GridChoice grid = ChooseGrid(problem, limits, pool);
    const FittingProblem chosen =
        problem.WithBases(FittingBasisLike(problem.basis_u(), 3, grid.cells_u),
                          FittingBasisLike(problem.basis_v(), 3, grid.cells_v));
    const NurbsSurface surface(
        chosen.basis_u(), chosen.basis_v(), SolveLinear(chosen, pool).coefficients);
    const Oracle oracle = BestUniform(ramp, cloud, 40);
    const TruthError error = ErrorToTruth(surface, SheetTruth(ramp.sheet, 40));
    EXPECT_LE(error.rms, 1.6 * oracle.rms);
    EXPECT_LE(chosen.unknowns(), 1.5 * oracle.unknowns);
  }
}

// What a plane or a flat layout fits without distortion never asks for another map.
TEST(ChooseRectangleTest, IsNotAskedWhereAFlatLayoutServes) {
  ThreadPool pool(2);
  for (const BentSheet& sheet : {FlatSheet(2, 1), SBend(200), ArcSheet(300)}) {
    SCOPED_TRACE(sheet.name);
    const ParameterizationChoice choice = ChooseFor(Noisy(sheet, 4000, 2).points, pool);
    const BaseCandidate* const row = RowOf(choice, "rectangle");
    EXPECT_TRUE(row == nullptr || !row->refused.empty());
    EXPECT_EQ(choice.base.settled_cells_u, 0);
  }
}

}  // namespace batten::internal::choose_rectangle_test
