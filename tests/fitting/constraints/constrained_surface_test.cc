// SPDX-License-Identifier: MIT
#include "fitting/constraints/constrained_surface.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <string>

#include "batten/fitting/solve_linear.h"
#include "batten/geometry/insert_knots.h"
#include "batten/geometry/iso_curve.h"
#include "batten/geometry/joins.h"
#include "fitting/least_squares/fitting_bases.h"
#include "fitting/linear/collocation.h"
#include "known_clouds.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::constrained_surface_test {

constexpr std::array<SurfaceEdge, 4> kEdges = {SurfaceEdge{Direction::kU, false},
                                               SurfaceEdge{Direction::kU, true},
                                               SurfaceEdge{Direction::kV, false},
                                               SurfaceEdge{Direction::kV, true}};

bool AlongU(const SurfaceEdge& edge) { return edge.direction == Direction::kV; }

// A smooth bent sheet with detail of a few coarse cells.
Eigen::Vector3d Sheet(double u, double v) {
  return {
      u + 0.05 * std::sin(2 * v), v - 0.05 * u * u, 0.3 * std::sin(3 * u) * std::cos(2 * v + u)};
}

template <typename Shape>
std::shared_ptr<FittingData> Sampled(
    const Shape& shape, int count, double lower, double upper, unsigned seed, double noise = 0) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> place(lower, upper);
  std::normal_distribution<double> error(0, 1);
  auto data = std::make_shared<FittingData>();
  data->parameters.resize(2, count);
  data->values.resize(3, count);
  for (int k = 0; k < count; ++k) {
    const double u = place(generator), v = place(generator);
    data->parameters.col(k) << u, v;
    data->values.col(k) = shape(u, v);
    for (int d = 0; d < 3; ++d) data->values(d, k) += noise * error(generator);
  }
  return data;
}

double Size(const Eigen::Matrix3Xd& points) {
  return (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
}

// How far the surface is from an edge, at a thousand places.
double EdgeError(const NurbsSurface& surface, const FixedEdge& edge) {
  const SplineBasis& u = surface.basis_u();
  const SplineBasis& v = surface.basis_v();
  double worst = 0;
  for (int k = 0; k <= 1000; ++k) {
    const double t = k / 1000.0;
    const double a = AlongU(edge.edge) ? u.lower() + t * (u.upper() - u.lower())
                                       : (edge.edge.upper ? u.upper() : u.lower());
    const double b = AlongU(edge.edge) ? (edge.edge.upper ? v.upper() : v.lower())
                                       : v.lower() + t * (v.upper() - v.lower());
    const double s = AlongU(edge.edge) ? a : b;
    worst = std::max(worst, (surface.At(a, b) - edge.curve.At(s)).norm());
  }
  return worst;
}

// The four boundary curves of a surface with extra knots, of which some are kept.
std::vector<FixedEdge> EdgesOf(const NurbsSurface& surface, unsigned mask) {
  const auto curves = BoundaryCurves(surface);
  std::vector<FixedEdge> edges;
  for (size_t k = 0; k < 4; ++k) {
    if (mask >> k & 1) edges.push_back({kEdges[k], curves[k]});
  }
  return edges;
}

// A random surface over the bases' domain whose knots have nothing to do with theirs.
NurbsSurface Foreign(RandomSplines& random, const SplineBasis& u, const SplineBasis& v) {
  const auto basis = [&](const SplineBasis& like) {
    std::vector<double> knots(static_cast<size_t>(like.degree()) + 1, like.lower());
    std::vector<double> inner;
    for (int k = random.Integer(0, 30); k > 0; --k) inner.push_back(random.Real(0.02, 0.98));
    std::sort(inner.begin(), inner.end());
    for (const double t : inner) knots.push_back(like.lower() + t * (like.upper() - like.lower()));
    knots.insert(knots.end(), static_cast<size_t>(like.degree()) + 1, like.upper());
    return SplineBasis(like.degree(), knots);
  };
  SplineBasis a = basis(u), b = basis(v);
  Eigen::Matrix3Xd net(3, a.size() * b.size());
  for (double& x : net.reshaped()) x = random.Real(-1, 1);
  return NurbsSurface(std::move(a), std::move(b), std::move(net));
}

TEST(ConstrainedSurfaceTest, MeetsAnyOfItsEdgesAtAThousandPlaces) {
  for (unsigned seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    RandomSplines random(seed);
    ThreadPool pool(2);
    const int p = random.Integer(1, 5), q = random.Integer(1, 5);
    const SplineBasis u = SplineBasis::Uniform(p, p + random.Integer(1, 6), 0, 1),
                      v = SplineBasis::Uniform(q, q + random.Integer(1, 6), 0, 1);
    const NurbsSurface foreign = Foreign(random, u, v);
    const FittingProblem problem(u, v, Sampled(Sheet, 500, 0, 1, seed, 0.01), 1e-6);
    const unsigned mask = static_cast<unsigned>(random.Integer(1, 15));
    const SurfaceConstraints constraints{EdgesOf(foreign, mask), {}};
    const ConstrainedSolution solution = SolveConstrained(problem, constraints, pool);
    EXPECT_TRUE(solution.missed.empty());
    const double size = Size(solution.surface.control_points());
    for (const FixedEdge& edge : constraints.edges) {
      EXPECT_LE(EdgeError(solution.surface, edge), kRounding * size);
    }
  }
}

TEST(ConstrainedSurfaceTest, RecoversASurfaceThatMeetsItsConstraints) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    RandomSplines random(seed);
    ThreadPool pool(2);
    const int p = random.Integer(2, 4), q = random.Integer(2, 4);
    const SplineBasis u = SplineBasis::Uniform(p, p + random.Integer(2, 6), 0, 1),
                      v = SplineBasis::Uniform(q, q + random.Integer(2, 6), 0, 1);
    const NurbsSurface foreign = Foreign(random, u, v);
    const SurfaceConstraints constraints{
        EdgesOf(foreign, static_cast<unsigned>(random.Integer(1, 15))), {}};
    const auto first = Sampled(Sheet, 3000, 0, 1, seed, 0.01);
    const NurbsSurface truth =
        SolveConstrained(FittingProblem(u, v, first, 1e-6), constraints, pool).surface;
    const auto exact =
        Sampled([&](double a, double b) { return truth.At(a, b); }, 3000, 0, 1, seed + 100);
    const ConstrainedSolution again =
        SolveConstrained(FittingProblem(u, v, exact, 0), constraints, pool);
    const double size = Size(truth.control_points());
    EXPECT_LE((again.surface.control_points() - truth.control_points()).cwiseAbs().maxCoeff(),
              kIterated * size);
  }
}

// The spline through a curve's points at its Greville abscissae, over equal spans.
template <typename Curve>
NurbsCurve<3> Interpolating(const Curve& curve, int size) {
  const SplineBasis basis = SplineBasis::Uniform(3, size, 0, 1);
  std::vector<SplineCondition> conditions;
  Eigen::MatrixXd values(3, size);
  for (int i = 0; i < size; ++i) {
    conditions.push_back({basis.Greville(i), 0});
    values.col(i) = curve(basis.Greville(i));
  }
  return NurbsCurve<3>(basis, *SolveConditions(basis, conditions, values));
}

template <typename Shape>
std::vector<FixedEdge> TrueEdges(const Shape& shape, int size) {
  return {{kEdges[0], Interpolating([&](double v) { return shape(0, v); }, size)},
          {kEdges[1], Interpolating([&](double v) { return shape(1, v); }, size)},
          {kEdges[2], Interpolating([&](double u) { return shape(u, 0); }, size)},
          {kEdges[3], Interpolating([&](double u) { return shape(u, 1); }, size)}};
}

template <typename Shape>
double TruthRms(const NurbsSurface& surface, const Shape& shape) {
  double sum = 0;
  for (int i = 1; i < 100; ++i) {
    for (int j = 1; j < 100; ++j) {
      sum += (surface.At(i / 100.0, j / 100.0) - shape(i / 100.0, j / 100.0)).squaredNorm();
    }
  }
  return std::sqrt(sum / (99 * 99));
}

// Edges of 120 control points bring no noise inside: only what the coarse net can follow gets in.
TEST(ConstrainedSurfaceTest, FollowsNoMoreNoiseInsideForItsEdges) {
  ThreadPool pool(2);
  const auto waves = [](double u, double v) {
    return Eigen::Vector3d(u, v, 0.15 * std::sin(7 * u) * std::cos(6 * v) + 0.1 * u * u);
  };
  const auto franke = [](double u, double v) { return Eigen::Vector3d(u, v, Franke(u, v)); };
  const auto check =
      [&](const auto& shape, int cells, double noise, double smoothing, unsigned seed) {
        const FittingProblem problem(FittingBasis(3, cells, 0, 1),
                                     FittingBasis(3, cells, 0, 1),
                                     Sampled(shape, 20000, 0, 1, seed, noise),
                                     smoothing);
        const NurbsSurface free(
            problem.basis_u(), problem.basis_v(), SolveLinear(problem, pool).coefficients);
        const SurfaceConstraints constraints{TrueEdges(shape, 120), {}};
        const ConstrainedSolution solution = SolveConstrained(problem, constraints, pool);
        EXPECT_LE(TruthRms(solution.surface, shape), 1.1 * TruthRms(free, shape));
        for (const FixedEdge& edge : constraints.edges) {
          EXPECT_LE(EdgeError(solution.surface, edge), 1e-9);
        }
      };
  for (unsigned seed = 1; seed <= 3; ++seed) {
    check(waves, 9, 1e-3, 1e-8, seed);
    check(waves, 21, 1e-3, 1e-8, seed);
    check(waves, 21, 1e-2, 1e-6, seed);
    check(franke, 21, 1e-3, 1e-8, seed);
    check(Sheet, 21, 1e-3, 1e-8, seed);
  }
}

}  // namespace batten::internal::constrained_surface_test
