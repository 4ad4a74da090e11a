// SPDX-License-Identifier: MIT
// Tangent planes along the edges of a constrained surface.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <random>
#include <stdexcept>
#include <string>

#include "fitting/constraints/constrained_surface.h"
#include "fitting/least_squares/fitting_bases.h"
#include "batten/fitting/solve_linear.h"
#include "batten/geometry/iso_curve.h"
#include "batten/geometry/joins.h"
#include "neighbour_edge.h"
#include "tolerances.h"

namespace batten::internal::tangent_edges_test {

constexpr std::array<SurfaceEdge, 4> kEdges = {SurfaceEdge{Direction::kU, false},
                                               SurfaceEdge{Direction::kU, true},
                                               SurfaceEdge{Direction::kV, false},
                                               SurfaceEdge{Direction::kV, true}};

Eigen::Vector3d Sheet(double u, double v) {
  return {u + 0.1 * std::sin(2 * v), v - 0.1 * u * u, 0.3 * std::sin(3 * u) * std::cos(2 * v + u)};
}

// Points of the sheet over a rectangle, about which the parameters run with their own origin.
std::shared_ptr<FittingData> Sampled(
    double u0, double u1, double v0, double v1, int count, unsigned seed, double noise) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> place(0, 1);
  std::normal_distribution<double> error(0, 1);
  auto data = std::make_shared<FittingData>();
  data->parameters.resize(2, count);
  data->values.resize(3, count);
  for (int k = 0; k < count; ++k) {
    const double u = u0 + (u1 - u0) * place(generator), v = v0 + (v1 - v0) * place(generator);
    data->parameters.col(k) << u, v;
    data->values.col(k) = Sheet(u, v);
    for (int d = 0; d < 3; ++d) data->values(d, k) += noise * error(generator);
  }
  return data;
}

FittingProblem ProblemOver(double u0,
                           double u1,
                           double v0,
                           double v1,
                           int p,
                           int q,
                           int cells,
                           unsigned seed,
                           double noise) {
  return FittingProblem(FittingBasis(p, cells, u0, u1),
                        FittingBasis(q, cells + 1, v0, v1),
                        Sampled(u0, u1, v0, v1, 4000, seed, noise),
                        1e-7);
}

NurbsSurface Free(const FittingProblem& problem, ThreadPool& pool) {
  return NurbsSurface(
      problem.basis_u(), problem.basis_v(), SolveLinear(problem, pool).coefficients);
}

// The widest angle between the tangent planes of two surfaces along a common edge over the same
// parameter.
double WidestAngle(const NurbsSurface& a,
                   const SurfaceEdge& edge_a,
                   const NurbsSurface& b,
                   const SurfaceEdge& edge_b) {
  const auto normal = [](const NurbsSurface& surface, const SurfaceEdge& edge, double s) {
    const SplineBasis &u = surface.basis_u(), &v = surface.basis_v();
    return edge.direction == Direction::kU
               ? *surface.NormalAt(edge.upper ? u.upper() : u.lower(), s)
               : *surface.NormalAt(s, edge.upper ? v.upper() : v.lower());
  };
  const SplineBasis& along = edge_a.direction == Direction::kU ? a.basis_v() : a.basis_u();
  double widest = 0;
  for (int k = 0; k <= 2000; ++k) {
    const double s = along.lower() + (along.upper() - along.lower()) * k / 2000;
    const Eigen::Vector3d n = normal(a, edge_a, s), m = normal(b, edge_b, s);
    widest = std::max(widest, std::atan2(n.cross(m).norm(), n.dot(m)));
  }
  return widest;
}

// The neighbour of the unit square beyond each edge.
FittingProblem Beyond(
    const SurfaceEdge& edge, int p, int q, int cells, unsigned seed, double noise) {
  const double low = edge.upper ? 1 : -1;
  return edge.direction == Direction::kU
             ? ProblemOver(low, low + 1, 0, 1, p, q, cells, seed, noise)
             : ProblemOver(0, 1, low, low + 1, p, q, cells, seed, noise);
}

SurfaceEdge Facing(const SurfaceEdge& edge) { return {edge.direction, !edge.upper}; }

TEST(TangentEdgesTest, GoOnFromANeighbourOfOtherKnotsAcrossAnyEdge) {
  ThreadPool pool(2);
  for (unsigned seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const SurfaceEdge own = kEdges[seed % 4];
    const int p = 3, q = seed % 3 == 0 ? 4 : 3;
    const NurbsSurface neighbour = Free(Beyond(own, p, q, 7, seed, 1e-3), pool);
    const FittingProblem problem = ProblemOver(0, 1, 0, 1, p, q, 6, seed + 50, 1e-3);
    const ConstrainedSolution solution =
        SolveConstrained(problem, {{EdgeOfNeighbour(neighbour, Facing(own), own, true)}, {}}, pool);
    for (const MissedConstraint& missed : solution.missed) ADD_FAILURE() << missed.Text();
    EXPECT_LE(WidestAngle(solution.surface, own, neighbour, Facing(own)), 1e-6);
    const SurfaceJoin join = TestJoin(neighbour, solution.surface);
    EXPECT_GE(join.geometric, 1) << join.position_gap << " " << join.angle_gap.value_or(-1);
    EXPECT_LE(join.position_gap, kRounding);
  }
}

}  // namespace batten::internal::tangent_edges_test
