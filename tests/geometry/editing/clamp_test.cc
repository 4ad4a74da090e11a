// SPDX-License-Identifier: MIT
#include "batten/geometry/clamp.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "batten/geometry/knot_vectors.h"
#include "exact_shapes.h"
#include "law_cases.h"
#include "random_splines.h"
#include "same_shape.h"
#include "shape_edits.h"
#include "tolerances.h"

namespace batten::internal::clamp_test {

TEST(ClampedTest, LeavesACurveUnchangedUpToRounding) {
  const auto law = [](const auto& curve, RandomSplines& random) {
    const auto clamped = Clamped(curve);
    EXPECT_TRUE(clamped.basis().clamped());
    EXPECT_FALSE(clamped.basis().periodic());
    EXPECT_EQ(clamped.basis().lower(), curve.basis().lower());
    EXPECT_EQ(clamped.basis().upper(), curve.basis().upper());
    ExpectSame(curve, clamped, random);
    if (curve.basis().clamped()) {
      EXPECT_EQ(clamped, curve);
    }
  };
  ForRandomCurves<2>(law, 12);
  ForRandomCurves<3>(law, 12);
}

TEST(ClampedTest, LeavesASurfaceUnchangedUpToRounding) {
  ForRandomSurfaces([](const NurbsSurface& surface, RandomSplines& random) {
    const NurbsSurface in_u = Clamped(surface, Direction::kU);
    EXPECT_TRUE(in_u.basis_u().clamped());
    EXPECT_EQ(in_u.basis_v(), surface.basis_v());
    ExpectSame(surface, in_u, random);
    const NurbsSurface both = Clamped(in_u, Direction::kV);
    EXPECT_TRUE(both.basis_v().clamped());
    ExpectSame(surface, both, random, 128);
  });
}

TEST(ClampedTest, MakesPeriodicCurvesClosedOnes) {
  ForRandomCurves<3>(
      [](const NurbsCurve<3>& curve, RandomSplines&) {
        if (!curve.basis().periodic()) return;
        const NurbsCurve<3> closed = Clamped(curve);
        const Eigen::Vector3d gap =
            closed.control_points().col(0) - closed.control_points().rightCols(1);
        const double speed = DomainExtent(curve.basis()) / ShortestSpan(curve.basis());  // of knots
        EXPECT_LE(gap.norm(), 64 * (curve.basis().degree() + 1) * kUnitRoundoff * speed);
      },
      20);
}

// The bound of the header.
template <typename Shape>
double UnclampingUnits(const Shape& unclamped) {
  const double largest =
      (unclamped.control_points().array().abs().rowwise() * unclamped.weights().transpose().array())
          .maxCoeff();
  return 64 * std::max(1.0, largest / unclamped.weights().minCoeff());
}

TEST(UnclampedTest, LeavesACurveUnchangedUpToRounding) {
  const auto law = [](const auto& curve, RandomSplines& random) {
    const auto open = Unclamped(curve);
    if (curve.basis().periodic()) {
      EXPECT_EQ(open, curve);
      return;
    }
    EXPECT_LT(open.basis().knots().front(), open.basis().lower());
    EXPECT_GT(open.basis().knots().back(), open.basis().upper());
    EXPECT_EQ(open.basis().lower(), curve.basis().lower());
    EXPECT_EQ(open.basis().upper(), curve.basis().upper());
    const double bound = UnclampingUnits(open) * curve.basis().degree() * kUnitRoundoff;
    for (int k = 0; k < kComparedPlaces; ++k) {
      const double u = random.Parameter(curve.basis());
      EXPECT_LE((curve.At(u) - open.At(u)).cwiseAbs().maxCoeff(), bound);
    }
  };
  ForRandomCurves<2>(law, 20);
  ForRandomCurves<3>(law, 20);
}

TEST(UnclampedTest, LeavesASurfaceUnchangedUpToRounding) {
  ForRandomSurfaces([](const NurbsSurface& surface, RandomSplines& random) {
    for (const Direction direction : {Direction::kU, Direction::kV}) {
      const NurbsSurface open = Unclamped(surface, direction);
      const int p =
          direction == Direction::kU ? surface.basis_u().degree() : surface.basis_v().degree();
      const double bound = UnclampingUnits(open) * (p + 16) * kUnitRoundoff;
      for (int k = 0; k < kComparedPlaces; ++k) {
        const double u = random.Parameter(surface.basis_u()),
                     v = random.Parameter(surface.basis_v());
        EXPECT_LE((surface.At(u, v) - open.At(u, v)).cwiseAbs().maxCoeff(), bound);
      }
    }
  });
}

TEST(UnclampedTest, GivesBackThePeriodicControlPointsOfAClampedPeriodicCurve) {
  for (int degree = 1; degree <= 5; ++degree) {
    RandomSplines random(static_cast<unsigned>(degree));
    const SplineBasis basis = PeriodicUniformKnots(degree, degree + 4, 0, 1);
    Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Random(3, basis.size());
    points.rightCols(degree) = points.leftCols(degree).eval();
    const NurbsCurve<3> curve(basis, points);
    const NurbsCurve<3> back = Unclamped(Clamped(curve));
    EXPECT_TRUE(SameKnots(back.basis(), SplineBasis(degree, basis.knots()), 64 * kUnitRoundoff));
    EXPECT_LE((back.control_points() - points).cwiseAbs().maxCoeff(), kRounding);
  }
}

TEST(UnclampedTest, KeepsWeightsPositive) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsCurve<3> curve = random.Curve<3>(random.Integer(1, 11), true);
    EXPECT_GT(Unclamped(curve).weights().minCoeff(), 0);
  }
}

// Periodic(Clamped(x)) is x again, knots included.
TEST(PeriodicTest, UndoesClamping) {
  int cases = 0, found = 0;
  const auto law = [&](const auto& curve, RandomSplines& random) {
    const SplineBasis& basis = curve.basis();
    if (!basis.periodic()) return;
    const auto back = Periodic(Clamped(curve), kIterated);
    EXPECT_TRUE(back.basis().periodic());
    EXPECT_EQ(back.basis().lower(), basis.lower());
    EXPECT_EQ(back.basis().upper(), basis.upper());
    EXPECT_LE(back.basis().Multiplicity(basis.lower()), basis.Multiplicity(basis.lower()));
    for (int k = 0; k < kComparedPlaces; ++k) {
      const double u = random.Parameter(basis);
      EXPECT_LE((curve.At(u) - back.At(u)).norm(), kIterated);
    }
    ++cases;
    found += back.basis().size() == basis.size();
  };
  ForRandomCurves<2>(law, 20);
  ForRandomCurves<3>(law, 20);
  EXPECT_EQ(found, cases);
}

TEST(PeriodicTest, WorksInBothDirectionsOfASurface) {
  ForRandomSurfaces([](const NurbsSurface& surface, RandomSplines& random) {
    for (const Direction direction : {Direction::kU, Direction::kV}) {
      const SplineBasis& basis = direction == Direction::kU ? surface.basis_u() : surface.basis_v();
      if (!basis.periodic()) continue;
      const NurbsSurface back = Periodic(Clamped(surface, direction), direction, kIterated);
      EXPECT_TRUE((direction == Direction::kU ? back.basis_u() : back.basis_v()).periodic());
      for (int k = 0; k < kComparedPlaces; ++k) {
        const double u = random.Parameter(surface.basis_u()),
                     v = random.Parameter(surface.basis_v());
        EXPECT_LE((surface.At(u, v) - back.At(u, v)).norm(), kIterated);
      }
    }
  });
}

TEST(PeriodicTest, GivesTheSeamTheMultiplicityOfItsContinuity) {
  // The circle of nine points is C^0 at its quarters, in homogeneous form: multiplicity 2.
  const NurbsCurve<2> circle = Periodic(Circle(1), kRounding);
  EXPECT_EQ(circle.basis().Multiplicity(0), 2);
  EXPECT_EQ(circle.basis().size(), 8 + 2);
  EXPECT_NEAR(circle.At(0.9).norm(), 1, kRounding);
  const NurbsSurface torus =
      Periodic(Periodic(Torus(2, 1), Direction::kU, kRounding), Direction::kV, kRounding);
  EXPECT_TRUE(torus.basis_u().periodic() && torus.basis_v().periodic());
  // A triangle stays C^0; a closed cubic polygon with a corner too.
  const NurbsCurve<2> triangle(SplineBasis(1, {0, 0, 1, 2, 3, 3}),
                               Eigen::Matrix<double, 2, 4>{{0, 1, 0, 0}, {0, 0, 1, 0}});
  EXPECT_EQ(Periodic(triangle, 0).basis().size(), 4);
  const NurbsCurve<2> drop(
      SplineBasis::Uniform(3, 7, 0, 1),
      Eigen::Matrix<double, 2, 7>{{0, 1, 2, 3, 2, 1, 0}, {0, 2, 1, 0, -1, -2, 0}});
  EXPECT_EQ(Periodic(drop, kRounding).basis().Multiplicity(0), 3);
}

TEST(PeriodicTest, SmoothsASeamThatIsSmoothWithinTheTolerance) {
  const SplineBasis basis = PeriodicUniformKnots(3, 12, 0, 1);
  Eigen::Matrix2Xd points(2, basis.size());
  for (int i = 0; i < basis.size(); ++i) {
    const double angle = 2 * std::numbers::pi * (i % 12) / 12;
    points.col(i) << std::cos(angle), std::sin(angle);
  }
  NurbsCurve<2> open = Clamped(NurbsCurve<2>(basis, points));
  Eigen::Matrix2Xd moved = open.control_points();
  moved.col(0)[0] += 1e-5;
  open = NurbsCurve<2>(open.basis(), moved);
  const NurbsCurve<2> closed = Periodic(open, 1e-4);
  EXPECT_EQ(closed.basis().Multiplicity(0), 1);
  for (int k = 0; k <= 100; ++k) EXPECT_LE((closed.At(k / 100.) - open.At(k / 100.)).norm(), 1e-4);
  EXPECT_NE(RefusalOf([&] { Periodic(open, 1e-6); }), "accepted");
}

TEST(PeriodicTest, RefusesWhatIsNotClosed) {
  const NurbsCurve<2> line(SplineBasis(1, {0, 0, 1, 1}), Eigen::Matrix2d{{0, 4}, {0, 3}});
  EXPECT_EQ(RefusalOf([&] { Periodic(line, 0.1); }),
            "Periodic: the ends do not meet within the tolerance 0.1: closing them moves points by "
            "up to 2.5 (weights at the ends count too)");
  EXPECT_EQ(RefusalOf([&] { Periodic(line, -1); }),
            "Periodic: tolerance = -1 is not a number of at least 0");
  EXPECT_NE(RefusalOf([&] { Periodic(Sphere(1), Direction::kV, 1e-3); }), "accepted");
}

}  // namespace batten::internal::clamp_test
