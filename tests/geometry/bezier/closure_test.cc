// SPDX-License-Identifier: MIT
#include "batten/geometry/closure.h"

#include <gtest/gtest.h>

#include <string>

#include "exact_shapes.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::closure_test {

TEST(ClosureTest, OfExactShapesIsKnown) {
  for (const double r : {1e-9, 1.0, 1e9}) {
    EXPECT_TRUE(Closed(Circle(r)));
    EXPECT_TRUE(Closed(Torus(3 * r, r), Direction::kU));
    EXPECT_TRUE(Closed(Torus(3 * r, r), Direction::kV));
    for (const NurbsSurface& once : {Sphere(r), Cylinder(r, r), Cone(r, r)}) {
      EXPECT_TRUE(Closed(once, Direction::kU));
      EXPECT_FALSE(Closed(once, Direction::kV));
    }
  }
}

TEST(ClosureTest, FollowsTheTolerance) {
  Eigen::Matrix2Xd points = Circle(1).control_points();
  points(1, 8) += 1e-6;
  const NurbsCurve<2> gap(Circle(1).basis(), points, Circle(1).weights());
  EXPECT_FALSE(Closed(gap));
  EXPECT_TRUE(Closed(gap, 1e-6));
  EXPECT_FALSE(SeamContinuity(gap));
}

TEST(ClosureTest, PeriodicShapesAreClosedAsSmoothlyAsTheirKnots) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int p = random.Integer(1, 6);
    const bool rational = random.Coin();
    const auto curve = random.Curve<3>(p, rational, {.highest_multiplicity = 1, .periodic = true});
    EXPECT_TRUE(Closed(curve));
    ASSERT_TRUE(SeamContinuity(curve));
    EXPECT_GE(*SeamContinuity(curve), p - 1);
    const NurbsSurface surface = random.Surface(
        p, 2, rational, {.highest_multiplicity = 1, .periodic = true}, {.most_spans = 2});
    EXPECT_TRUE(Closed(surface, Direction::kU));
    ASSERT_TRUE(SeamContinuity(surface, Direction::kU));
    EXPECT_GE(*SeamContinuity(surface, Direction::kU), p - 1);
    EXPECT_FALSE(Closed(surface, Direction::kV));
    EXPECT_FALSE(SeamContinuity(surface, Direction::kV));
  }
}

TEST(ClosureTest, OneOpenParameterLineIsEnough) {
  // A cylinder of degree 5 in v slit at one inner height only.
  Eigen::Matrix2Xd profile(2, 6);
  for (int j = 0; j < 6; ++j) profile.col(j) << 1, j;
  const NurbsSurface whole =
      Revolved(SplineBasis::Uniform(5, 6, 0, 1), profile, Eigen::VectorXd::Ones(6));
  EXPECT_TRUE(Closed(whole, Direction::kU));
  Eigen::Matrix3Xd points = whole.control_points();
  points(0, 2) += 1e-3;
  const NurbsSurface slit(whole.basis_u(), whole.basis_v(), points, whole.weights());
  EXPECT_FALSE(Closed(slit, Direction::kU));
}

TEST(ContinuityTest, OfRandomControlPointsIsWhatTheMultiplicityLeaves) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int p = random.Integer(1, 7);
    const auto curve = random.Curve<3>(p, random.Coin(), {.clamped = random.Coin()});
    const std::vector<KnotContinuity> knots = ContinuityAtKnots(curve);
    EXPECT_EQ(knots.size() + 1, curve.basis().Spans().size());
    for (const KnotContinuity& knot : knots) {
      EXPECT_EQ(knot.multiplicity, curve.basis().Multiplicity(knot.knot));
      EXPECT_EQ(knot.guaranteed, p - knot.multiplicity);
      EXPECT_EQ(knot.actual, knot.guaranteed) << "at " << knot.knot;
    }
    const int q = random.Integer(1, 4);
    const NurbsSurface surface = random.Surface(p, q, random.Coin(), {.most_spans = 3});
    for (const Direction direction : {Direction::kU, Direction::kV}) {
      for (const KnotContinuity& knot : ContinuityAtKnots(surface, direction)) {
        EXPECT_EQ(knot.actual, knot.guaranteed) << "at " << knot.knot;
      }
    }
  }
}

TEST(ContinuityTest, SeesWhenAKnotMakesNoDifference) {
  // Greville ordinates are a straight line over any knots.
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int p = random.Integer(1, 7);
    const SplineBasis basis = random.Basis(p);
    for (const double far : {0.0, 1e6}) {
      Eigen::Matrix2Xd points(2, basis.size());
      for (int i = 0; i < basis.size(); ++i) {
        points.col(i) << far + basis.Greville(i), far - 2 * basis.Greville(i);
      }
      for (const KnotContinuity& knot : ContinuityAtKnots(NurbsCurve<2>(basis, points))) {
        EXPECT_EQ(knot.actual, p);
      }
    }
  }
}

TEST(ContinuityTest, OfRationalArcsIsTheCurvesNotItsHomogeneousForms) {
  for (const KnotContinuity& knot : ContinuityAtKnots(Circle(2))) {
    EXPECT_EQ(knot.multiplicity, 2);
    EXPECT_EQ(knot.guaranteed, 0);
    EXPECT_EQ(knot.actual, 1);
  }
  EXPECT_EQ(SeamContinuity(Circle(2)), 1);
  const NurbsSurface sphere = Sphere(3);
  for (const Direction direction : {Direction::kU, Direction::kV}) {
    for (const KnotContinuity& knot : ContinuityAtKnots(sphere, direction)) {
      EXPECT_EQ(knot.actual, 1);
    }
  }
  EXPECT_EQ(SeamContinuity(sphere, Direction::kU), 1);
}

TEST(ContinuityTest, OfAClosedPolygonIsZeroAtItsSeam) {
  const NurbsCurve<2> triangle(SplineBasis::Uniform(1, 4, 0, 3),
                               Eigen::Matrix<double, 2, 4>{{0, 1, 0, 0}, {0, 0, 1, 0}});
  EXPECT_EQ(SeamContinuity(triangle), 0);
  for (const KnotContinuity& knot : ContinuityAtKnots(triangle)) EXPECT_EQ(knot.actual, 0);
}

TEST(CollapsedEdgesTest, OfExactShapesAreTheirPoles) {
  for (const double r : {1e-9, 1.0, 1e9}) {
    EXPECT_EQ(CollapsedEdges(Sphere(r)), (CollapsedEdgeSet{false, false, true, true}));
    EXPECT_EQ(CollapsedEdges(Cone(r, r)), (CollapsedEdgeSet{false, false, true, false}));
    EXPECT_EQ(CollapsedEdges(Cylinder(r, r)), CollapsedEdgeSet{});
    EXPECT_EQ(CollapsedEdges(Torus(3 * r, r)), CollapsedEdgeSet{});
  }
}

TEST(CollapsedEdgesTest, OfRandomNetsAreThoseDrawnTogether) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsSurface whole =
        random.Surface(random.Integer(1, 4), random.Integer(1, 4), random.Coin());
    EXPECT_EQ(CollapsedEdges(whole), CollapsedEdgeSet{});
    Eigen::Matrix3Xd points = whole.control_points();
    const int m = whole.size_v();
    const bool first = random.Coin(), last = random.Coin();
    const Eigen::Vector3d at = points.col(0), end = points.rightCols(1);
    if (first) points.leftCols(m).colwise() = at;
    if (last) points.rightCols(m).colwise() = end;
    const NurbsSurface drawn(whole.basis_u(), whole.basis_v(), points, whole.weights());
    EXPECT_EQ(CollapsedEdges(drawn), (CollapsedEdgeSet{first, last, false, false}));
  }
}

}  // namespace batten::internal::closure_test
