// SPDX-License-Identifier: MIT
// Edges of surfaces that are closed round.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "fitting/constraints/constrained_surface.h"
#include "fitting/least_squares/fitting_bases.h"
#include "fitting/constraints/neighbour_edge.h"
#include "batten/fitting/solve_linear.h"
#include "batten/geometry/iso_curve.h"
#include "batten/geometry/joins.h"
#include "batten/geometry/knot_vectors.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::periodic_edges_test {

Eigen::Vector3d Tube(double angle, double z) {
  const double radius = 1 + 0.1 * std::cos(3 * angle) * z + 0.05 * z * z;
  return {radius * std::cos(angle), radius * std::sin(angle), z};
}

FittingProblem Round(double low, double high, int cells, unsigned seed) {
  RandomSplines random(seed);
  auto data = std::make_shared<FittingData>();
  data->parameters.resize(2, 4000);
  data->values.resize(3, 4000);
  for (int k = 0; k < 4000; ++k) {
    const double u = random.Real(0, 2 * std::numbers::pi), v = random.Real(low, high);
    data->parameters.col(k) << u, v;
    data->values.col(k) = Tube(u, v) + random.Vector(1e-3);
  }
  return FittingProblem(PeriodicUniformKnots(3, cells, 0, 2 * std::numbers::pi),
                        FittingBasis(3, 5, low, high),
                        data,
                        1e-6);
}

NurbsSurface Free(const FittingProblem& problem, ThreadPool& pool) {
  return NurbsSurface(
      problem.basis_u(), problem.basis_v(), SolveLinear(problem, pool).coefficients);
}

TEST(PeriodicEdgesTest, ATubeGoesOnFromATubeAllTheWayRound) {
  ThreadPool pool(2);
  const SurfaceEdge low{Direction::kV, false}, high{Direction::kV, true};
  const NurbsSurface neighbour = Free(Round(-1, 0, 13, 1), pool);
  const FittingProblem problem = Round(0, 1, 11, 2);
  for (const bool tangent : {false, true}) {
    SCOPED_TRACE(tangent ? "tangent planes" : "curve");
    const SurfaceConstraints constraints{
        {EdgeOfNeighbour(neighbour, high, low, problem.basis_u(), false, tangent)}, {}};
    const ConstrainedSolution solution = SolveConstrained(problem, constraints, pool);
    for (const MissedConstraint& missed : solution.missed) ADD_FAILURE() << missed.Text();
    EXPECT_TRUE(solution.surface.basis_u().periodic());
    for (int k = 0; k <= 1000; ++k) {
      const double u = 2 * std::numbers::pi * k / 1000;
      EXPECT_LE((solution.surface.At(u, 0) - neighbour.At(u, 0)).norm(), kRounding);
      if (!tangent) continue;
      const Eigen::Vector3d a = *solution.surface.NormalAt(u, 0), b = *neighbour.NormalAt(u, 0);
      EXPECT_LE(std::atan2(a.cross(b).norm(), a.dot(b)), kHalfDigits);
    }
    // About as near to the points as without.
    EXPECT_LE(solution.residual_squares, 1.2 * SolveLinear(problem, pool).residual_squares);
  }
}

TEST(PeriodicEdgesTest, PointsAndNormalsAreMetAcrossTheSeam) {
  ThreadPool pool(1);
  const FittingProblem problem = Round(0, 1, 11, 2);
  SurfaceConstraints constraints;
  constraints.points.push_back(
      {0, 0.5, Eigen::Vector3d(1.1, 0.02, 0.5), Eigen::Vector3d(1, 0.1, 0)});
  constraints.points.push_back({6.25, 0.3, Tube(6.25, 0.3), Eigen::Vector3d(1, 0, 0.1)});
  const ConstrainedSolution solution = SolveConstrained(problem, constraints, pool);
  EXPECT_TRUE(solution.missed.empty());
  for (const FixedPoint& point : constraints.points) {
    EXPECT_LE((solution.surface.At(point.u, point.v) - *point.place).norm(), kRounding);
    const Eigen::Vector3d normal = *solution.surface.NormalAt(point.u, point.v);
    EXPECT_LE(normal.cross(point.normal->normalized()).norm(), 10 * kRounding);
  }
}

TEST(PeriodicEdgesTest, AClosedDirectionHasNoEdgesAcrossIt) {
  ThreadPool pool(1);
  const FittingProblem problem = Round(0, 1, 11, 2);
  const NurbsCurve<3> seam = IsoCurve(Free(problem, pool), Direction::kU, 0);
  EXPECT_THROW(SolveConstrained(problem, {{{{Direction::kU, false}, seam}}, {}}, pool),
               std::invalid_argument);
}

}  // namespace batten::internal::periodic_edges_test
