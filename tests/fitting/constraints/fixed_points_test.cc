// SPDX-License-Identifier: MIT
// Points and normals that a surface meets, corners where edges ask for more, and contradictions.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>

#include "batten/fitting/solve_linear.h"
#include "batten/geometry/insert_knots.h"
#include "batten/geometry/iso_curve.h"
#include "batten/geometry/knot_vectors.h"
#include "fitting/constraints/constrained_surface.h"
#include "fitting/least_squares/fairness.h"
#include "fitting/least_squares/fitting_bases.h"
#include "fitting/least_squares/penalised_system.h"
#include "neighbour_edge.h"
#include "random_splines.h"
#include "refusal.h"
#include "tolerances.h"

namespace batten::internal::fixed_points_test {

Eigen::Vector3d Sheet(double u, double v) {
  return {u + 0.1 * std::sin(2 * v), v - 0.1 * u * u, 0.3 * std::sin(3 * u) * std::cos(2 * v + u)};
}

std::shared_ptr<FittingData> Sampled(int count, unsigned seed, double noise) {
  RandomSplines random(seed);
  auto data = std::make_shared<FittingData>();
  data->parameters.resize(2, count);
  data->values.resize(3, count);
  for (int k = 0; k < count; ++k) {
    const double u = random.Real(0, 1), v = random.Real(0, 1);
    data->parameters.col(k) << u, v;
    data->values.col(k) = Sheet(u, v) + random.Vector(noise);
  }
  return data;
}

FittingProblem Problem(unsigned seed, int cells = 6, double noise = 1e-3) {
  return FittingProblem(
      FittingBasis(3, cells, 0, 1), FittingBasis(3, cells, 0, 1), Sampled(2000, seed, noise), 1e-6);
}

FittingProblem Moved(const FittingProblem& problem, double unit, const Eigen::Vector3d& shift) {
  auto data = std::make_shared<FittingData>(problem.data());
  data->values = (unit * data->values).colwise() + shift;
  return problem.WithData(data);
}

NurbsSurface Free(const FittingProblem& problem, ThreadPool& pool) {
  return NurbsSurface(
      problem.basis_u(), problem.basis_v(), SolveLinear(problem, pool).coefficients);
}

// The edge of a surface that goes on the way the surface does, on the same side.
FixedEdge EdgeOf(const NurbsSurface& surface, const SurfaceEdge& edge, bool tangent) {
  FixedEdge fixed = EdgeOfNeighbour(surface, edge, edge, tangent);
  if (fixed.across)
    fixed.across = NurbsCurve<3>(fixed.across->basis(), -fixed.across->control_points());
  return fixed;
}

// Fixed points off the surface by some noise, with turned normals.
SurfaceConstraints RandomPoints(RandomSplines& random, int count) {
  SurfaceConstraints constraints;
  for (int k = 0; k < count; ++k) {
    FixedPoint point{random.Real(0.02, 0.98), random.Real(0.02, 0.98)};
    const int kind = random.Integer(0, 2);
    if (kind != 1) point.place = Sheet(point.u, point.v) + random.Vector(0.02);
    if (kind != 0) point.normal = Eigen::Vector3d(0, 0, 1) + random.Vector(0.3);
    constraints.points.push_back(point);
  }
  return constraints;
}

double AngleOff(const NurbsSurface& surface, const FixedPoint& point) {
  const Eigen::Vector3d normal = *surface.NormalAt(point.u, point.v);
  return std::atan2(normal.cross(*point.normal).norm(), std::abs(normal.dot(*point.normal)));
}

TEST(FixedPointsTest, AreMetWithTheirNormalsToRoundingInEveryUnitAndPlace) {
  ThreadPool pool(2);
  for (unsigned seed = 1; seed <= 24; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    RandomSplines random(seed);
    SurfaceConstraints constraints = RandomPoints(random, random.Integer(1, 8));
    const double unit = std::array{1.0, 1e6, 1e-6}[seed % 3];
    const Eigen::Vector3d shift =
        seed % 4 == 0 ? Eigen::Vector3d(5e6, -5e6, 3e6) * unit : Eigen::Vector3d(0, 0, 0);
    for (FixedPoint& point : constraints.points) {
      if (point.place) *point.place = unit * *point.place + shift;
    }
    const ConstrainedSolution solution =
        SolveConstrained(Moved(Problem(seed), unit, shift), constraints, pool);
    EXPECT_TRUE(solution.missed.empty());
    const double rounding = kRounding * unit + 4 * 2.3e-16 * shift.norm();
    for (const FixedPoint& point : constraints.points) {
      if (point.place) {
        EXPECT_LE((solution.surface.At(point.u, point.v) - *point.place).norm(), rounding);
      }
      if (point.normal) {
        EXPECT_LE(AngleOff(solution.surface, point), 1e2 * rounding / unit);
      }
    }
  }
}

// Scaling and moving data and constraints does the same to the surface.
TEST(FixedPointsTest, GiveTheSameSurfaceInEveryUnit) {
  ThreadPool pool(1);
  RandomSplines random(5);
  const SurfaceConstraints constraints = RandomPoints(random, 5);
  const NurbsSurface plain = SolveConstrained(Problem(5), constraints, pool).surface;
  for (const double unit : {1e-6, 1e6}) {
    SurfaceConstraints scaled = constraints;
    const Eigen::Vector3d shift = unit * Eigen::Vector3d(10, -20, 5);
    for (FixedPoint& point : scaled.points) {
      if (point.place) *point.place = unit * *point.place + shift;
    }
    const NurbsSurface other =
        SolveConstrained(Moved(Problem(5), unit, shift), scaled, pool).surface;
    EXPECT_LE((((other.control_points().colwise() - shift) / unit) - plain.control_points())
                  .cwiseAbs()
                  .maxCoeff(),
              kIterated);
  }
}

// Surfaces brought to the same knots.
void ToCommonKnots(NurbsSurface& a, NurbsSurface& b) {
  const auto missing = [](const SplineBasis& have, const SplineBasis& other) {
    std::vector<double> more;
    std::set_difference(other.knots().begin(),
                        other.knots().end(),
                        have.knots().begin(),
                        have.knots().end(),
                        std::back_inserter(more));
    return more;
  };
  for (const Direction direction : {Direction::kU, Direction::kV}) {
    const auto basis = [&](const NurbsSurface& surface) {
      return direction == Direction::kU ? surface.basis_u() : surface.basis_v();
    };
    const std::vector<double> to_a = missing(basis(a), basis(b)),
                              to_b = missing(basis(b), basis(a));
    if (!to_a.empty()) a = RefineKnots(a, direction, to_a);
    if (!to_b.empty()) b = RefineKnots(b, direction, to_b);
  }
}

// What is minimised, integrated over the surface's own knots.
double Objective(const FittingProblem& problem, const NurbsSurface& surface, double lambda) {
  double sum = 0;
  for (Eigen::Index k = 0; k < problem.size(); ++k) {
    const Eigen::Vector2d at = problem.data().parameters.col(k);
    sum += problem.data().weights[k] *
           (surface.At(at[0], at[1]) - problem.data().values.col(k)).squaredNorm();
  }
  const FairnessForm form(surface.basis_u(), &surface.basis_v());
  for (int d = 0; d < 3; ++d) {
    sum += lambda * form.Energy(surface.control_points().row(d).transpose());
  }
  return sum;
}

// Feasible surfaces form an affine space: towards another of them, made of other data, the
// objective is flat at the solution.
TEST(FixedPointsTest, NoFeasibleChangeLowersTheSum) {
  ThreadPool pool(2);
  for (unsigned seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    RandomSplines random(seed);
    auto data = std::make_shared<FittingData>(Problem(seed).data());
    data->weights.resize(data->parameters.cols());
    for (double& weight : data->weights) weight = random.Real(0, 2);
    const FittingProblem problem = Problem(seed).WithData(data).WithSmoothing(1e-3);
    SurfaceConstraints constraints = RandomPoints(random, random.Integer(0, 5));
    const NurbsSurface neighbour = Free(Problem(seed + 40, 5, 0.01), pool);
    const SurfaceEdge edges[] = {
        {Direction::kV, false}, {Direction::kU, true}, {Direction::kV, true}};
    for (int k = random.Integer(0, 3); k > 0; --k) {
      constraints.edges.push_back(EdgeOf(neighbour, edges[k - 1], random.Coin()));
    }
    NurbsSurface best = SolveConstrained(problem, constraints, pool).surface;
    NurbsSurface other =
        SolveConstrained(Problem(seed + 20, 6, 0.05).WithSmoothing(1e-4), constraints, pool)
            .surface;
    ToCommonKnots(best, other);
    const double lambda = PenalisedSystem(problem, pool).Lambda(problem.smoothing());
    const auto at = [&](double step) {
      return Objective(problem,
                       NurbsSurface(best.basis_u(),
                                    best.basis_v(),
                                    best.control_points() +
                                        step * (other.control_points() - best.control_points())),
                       lambda);
    };
    const double slope = (at(1) - at(-1)) / 2, bend = (at(1) + at(-1)) / 2 - at(0);
    EXPECT_GT(bend, 0);
    // Tangent rows are thinned to 1e-5 of themselves; the rest is rounding.
    EXPECT_LE(std::abs(slope), 1e-5 * bend);
  }
}

testing::Matcher<const MissedConstraint&> MissedNear(const std::string& words, double amount) {
  return testing::AllOf(
      testing::Field(&MissedConstraint::condition, testing::HasSubstr(words)),
      testing::Field(&MissedConstraint::amount, testing::DoubleNear(amount, 1e-6 * amount)));
}

TEST(FixedPointsTest, SayWhichOfTwoPlacesAtOneParameterIsMissedAndByHowMuch) {
  ThreadPool pool(1);
  const Eigen::Vector3d place = Sheet(0.3, 0.4), shift(0, 0.03, 0.04);
  const ConstrainedSolution twice =
      SolveConstrained(Problem(1), {{}, {{0.3, 0.4, place}, {0.3, 0.4, place}}}, pool);
  EXPECT_TRUE(twice.missed.empty());
  const ConstrainedSolution against =
      SolveConstrained(Problem(1), {{}, {{0.3, 0.4, place}, {0.3, 0.4, place + shift}}}, pool);
  EXPECT_THAT(against.missed,
              testing::ElementsAre(MissedNear("the place of point 1 at (0.3, 0.4)", 0.05)));
  EXPECT_LE((against.surface.At(0.3, 0.4) - place).norm(), kRounding);
  EXPECT_THAT(against.missed[0].Text(), testing::HasSubstr("missed by 0.05"));
}

TEST(FixedPointsTest, OnAFixedEdgeFollowOrContradictIt) {
  ThreadPool pool(1);
  const NurbsSurface neighbour = Free(Problem(2), pool);
  const FixedEdge edge = EdgeOf(neighbour, {Direction::kU, false}, false);
  const Eigen::Vector3d on = edge.curve.At(0.3);
  const Eigen::Vector3d tangent = edge.curve.Derivatives(0.3, 1).col(1).normalized();
  const Eigen::Vector3d across = tangent.unitOrthogonal();
  EXPECT_TRUE(SolveConstrained(Problem(1), {{edge}, {{0, 0.3, on, across}}}, pool).missed.empty());
  const double angle = 0.1;
  const Eigen::Vector3d turned = std::cos(angle) * across + std::sin(angle) * tangent;
  const ConstrainedSolution solution = SolveConstrained(
      Problem(1), {{edge}, {{0, 0.3, on + 0.01 * across}, {0, 0.3, std::nullopt, turned}}}, pool);
  ASSERT_EQ(solution.missed.size(), 2u);
  EXPECT_THAT(solution.missed[0], MissedNear("the place of point 0", 0.01));
  // The edge alone keeps the normal off by the angle; the tangent across is free to be worse.
  EXPECT_THAT(solution.missed[1].condition, testing::HasSubstr("the normal of point 1"));
  EXPECT_NEAR(solution.missed[1].amount,
              AngleOff(solution.surface, {0, 0.3, std::nullopt, turned}),
              kIterated);
  EXPECT_GE(solution.missed[1].amount, angle - kIterated);
  EXPECT_TRUE(solution.missed[1].angle);
}

// A bilinear net of four points takes four places; the fifth is one too many.
TEST(FixedPointsTest, BeyondTheFreedomAreReported) {
  ThreadPool pool(1);
  const SplineBasis line = SplineBasis::Uniform(1, 2, 0, 1);
  const FittingProblem problem(line, line, Sampled(50, 1, 0.01), 1e-6);
  SurfaceConstraints constraints;
  for (const auto& [u, v] : {std::pair{0.1, 0.2}, {0.8, 0.3}, {0.2, 0.9}, {0.7, 0.6}, {0.5, 0.5}}) {
    constraints.points.push_back({u, v, Sheet(u, v)});
  }
  const ConstrainedSolution solution = SolveConstrained(problem, constraints, pool);
  ASSERT_EQ(solution.missed.size(), 1u);
  EXPECT_THAT(solution.missed[0].condition, testing::HasSubstr("point 4"));
  EXPECT_NEAR(solution.missed[0].amount,
              (solution.surface.At(0.5, 0.5) - Sheet(0.5, 0.5)).norm(),
              kRounding);
}

std::string Refusal(const SurfaceConstraints& constraints) {
  ThreadPool pool(1);
  return internal::RefusalOf([&] { SolveConstrained(Problem(1), constraints, pool); }, "");
}

NurbsCurve<3> Line(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  Eigen::Matrix3Xd ends(3, 2);
  ends << from, to;
  return NurbsCurve<3>(SplineBasis::Uniform(1, 2, 0, 1), ends);
}

TEST(FixedPointsTest, WhatCannotBeAskedIsRefusedByName) {
  const SurfaceEdge low_u{Direction::kU, false}, low_v{Direction::kV, false};
  const Eigen::Vector3d o(0, 0, 0), x(1, 0, 0), y(0, 1, 0), off(0, 0, 1e-3);
  const FixedEdge left{low_u, Line(o, y)}, bottom{low_v, Line(o + off, x)};
  EXPECT_THAT(Refusal({{left, bottom}, {}}),
              testing::AllOf(testing::HasSubstr("the edge v = lower and the edge u = lower do not "
                                                "meet at their corner: they are 0.001 apart")));
  EXPECT_THAT(Refusal({{left, left}, {}}), testing::HasSubstr("u = lower is given twice"));
  EXPECT_THAT(Refusal({{{low_u, Line(o, y), Line(y, y)}}, {}}), testing::HasSubstr("parallel"));
  EXPECT_THAT(Refusal({{{low_u, Line(o, y), Line(o, o)}}, {}}), testing::HasSubstr("vanishes"));
  Eigen::Matrix3Xd bend(3, 3);
  bend << o, y, y + x;
  EXPECT_THAT(
      Refusal({{{low_u, NurbsCurve<3>(SplineBasis(1, {0, 0, 0.4, 1, 1}), bend), Line(x, x)}}, {}}),
      testing::HasSubstr("has a corner at 0.4"));
  EXPECT_THAT(Refusal({{{low_u, NurbsCurve<3>(SplineBasis::Uniform(1, 3, 0, 2), bend)}}, {}}),
              testing::HasSubstr("is over [0, 2]"));
  EXPECT_THAT(
      Refusal({{{low_u,
                 NurbsCurve<3>(SplineBasis::Uniform(2, 3, 0, 1), bend, Eigen::Vector3d(1, 2, 1))}},
               {}}),
      testing::HasSubstr("has weights"));
  EXPECT_THAT(
      Refusal({{{low_u,
                 NurbsCurve<3>(SplineBasis::Uniform(4, 5, 0, 1), Eigen::Matrix3Xd::Random(3, 5))}},
               {}}),
      testing::HasSubstr("has degree 4"));
  EXPECT_THAT(Refusal({{}, {{0.5, 1.5, o}}}), testing::HasSubstr("outside the domain"));
  EXPECT_THAT(Refusal({{}, {{0.5, 0.5, std::nullopt, o}}}), testing::HasSubstr("normal"));
  EXPECT_THAT(Refusal({{}, {{0.5, 0.5}}}), testing::HasSubstr("neither place nor normal"));
}

TEST(FixedPointsTest, SurfacesThatCloseOrHaveAPoleAreRefused) {
  ThreadPool pool(1);
  const FittingProblem open = Problem(1);
  const SplineBasis round = PeriodicUniformKnots(3, 9, 0, 1);
  const FittingProblem closing[] = {
      FittingProblem(round, open.basis_v(), Sampled(2000, 1, 1e-3), 1e-6),
      FittingProblem(open.basis_u(), round, Sampled(2000, 1, 1e-3), 1e-6),
      open.WithPoles({PoleKind::kSmooth, PoleKind::kNone})};
  for (const FittingProblem& problem : closing) {
    EXPECT_THAT(RefusalOf(
                    [&] {
                      SolveConstrained(problem, {{}, {{0.5, 0.5, Sheet(0.5, 0.5)}}}, pool);
                    },
                    ""),
                testing::HasSubstr("closes or has a pole"));
  }
}

// A smooth surface about the unit square gives neighbours on all sides that go together.
TEST(FixedPointsTest, TangentPlanesOnAllSidesGoTogetherAtTheirCorners) {
  ThreadPool pool(2);
  for (unsigned seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    RandomSplines random(seed);
    const FittingProblem problem = Problem(seed);
    const NurbsSurface whole = Free(Problem(seed + 10, 5, 0.01), pool);
    SurfaceConstraints constraints;
    for (const SurfaceEdge edge : {SurfaceEdge{Direction::kU, false},
                                   {Direction::kU, true},
                                   {Direction::kV, false},
                                   {Direction::kV, true}}) {
      constraints.edges.push_back(EdgeOf(whole, edge, true));
    }
    const ConstrainedSolution solution = SolveConstrained(problem, constraints, pool);
    for (const MissedConstraint& missed : solution.missed) ADD_FAILURE() << missed.Text();
    // A field turned out of the plane of the neighbouring edge contradicts it by that angle.
    const FixedEdge& low = constraints.edges[2];
    const Eigen::Vector3d along = low.curve.Derivatives(0, 1).col(1).normalized();
    const Eigen::AngleAxisd turn(1e-3, along);
    constraints.edges[2].across =
        NurbsCurve<3>(low.across->basis(), turn.toRotationMatrix() * low.across->control_points());
    const ConstrainedSolution turned = SolveConstrained(problem, constraints, pool);
    ASSERT_FALSE(turned.missed.empty());
    EXPECT_THAT(turned.missed[0].condition,
                testing::HasSubstr("the tangent plane at the corner of the edge v = lower"));
    // As far as the other edge does not run along the first it leaves the turned plane.
    EXPECT_GT(turned.missed[0].amount, 0.5e-3);
    EXPECT_LE(turned.missed[0].amount, 1e-3 + kHalfDigits);
  }
}

TEST(FixedPointsTest, AFieldRunBackwardsIsReportedAsAFold) {
  ThreadPool pool(1);
  const NurbsSurface whole = Free(Problem(2), pool);
  const SurfaceEdge edge{Direction::kV, false};
  FixedEdge fixed = EdgeOfNeighbour(whole, edge, edge, true);
  const ConstrainedSolution solution = SolveConstrained(Problem(1), {{fixed}, {}}, pool);
  ASSERT_EQ(solution.missed.size(), 1u);
  EXPECT_NEAR(solution.missed[0].amount, std::numbers::pi, 1e-6);
}

}  // namespace batten::internal::fixed_points_test
