// SPDX-License-Identifier: MIT
#include "batten/geometry/degree_elevation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "exact_shapes.h"
#include "fixtures.h"
#include "random_splines.h"
#include "tolerances.h"
#include "geometry/numeric/constants.h"

namespace batten::internal::degree_elevation_test {

using namespace fixtures;


// The kinds of ends of a basis.
const std::vector<BasisKind>& Kinds() {
  static const std::vector<BasisKind> kinds{{}, {.clamped = false}, {.periodic = true}};
  return kinds;
}

// The bound of the header for the elevated control points, and the rounding of two evaluations: a
// value of the basis is right to 3q·ε of itself, sums of q+1 products to (q+1)·ε, twice (numerator
// and denominator).
double Bound(double extent, int q, int by) {
  return kEpsilon * extent * (by * (16 * (q + 1) + 1) + 2 * (8 * q + 4));
}

// How often each value stands in the knots, of those strictly inside the domain and at its ends.
std::map<double, int> Multiplicities(const SplineBasis& basis) {
  std::map<double, int> counts;
  for (const double u : basis.knots()) {
    if (u >= basis.lower() && u <= basis.upper()) ++counts[u];
  }
  return counts;
}

void ExpectElevated(const SplineBasis& basis, const SplineBasis& elevated, int by) {
  EXPECT_EQ(elevated.degree(), basis.degree() + by);
  EXPECT_EQ(elevated.lower(), basis.lower());
  EXPECT_EQ(elevated.upper(), basis.upper());
  EXPECT_EQ(elevated.clamped(), basis.clamped());
  EXPECT_EQ(elevated.periodic(), basis.periodic());
  std::map<double, int> expected = Multiplicities(basis);
  for (auto& [u, count] : expected) count += by;
  EXPECT_EQ(Multiplicities(elevated), expected);
  for (const double u : elevated.knots()) EXPECT_GT(basis.Multiplicity(u), 0) << u;
}

template <int Dim>
void ExpectSameCurve(const NurbsCurve<Dim>& curve, const NurbsCurve<Dim>& elevated, int by) {
  const double bound = Bound(ExtentOf(curve), elevated.basis().degree(), by);
  for (const int span : curve.basis().Spans()) {
    const double a = curve.basis().knots()[span], b = curve.basis().knots()[span + 1];
    for (const double t : {0.0, 0.1, 0.5, 0.9, 1.0}) {
      const double u = std::min(a + t * (b - a), b);
      EXPECT_LE((elevated.At(u) - curve.At(u)).cwiseAbs().maxCoeff(), bound) << "u = " << u;
    }
  }
}

template <int Dim>
void CheckCurve(RandomSplines& random, int degree, bool rational, const BasisKind& kind, int by) {
  const NurbsCurve<Dim> curve = random.Curve<Dim>(degree, rational, kind);
  const NurbsCurve<Dim> elevated = Elevated(curve, by);
  EXPECT_EQ(elevated.rational(), curve.rational());
  ExpectElevated(curve.basis(), elevated.basis(), by);
  ExpectSameCurve(curve, elevated, by);
}

TEST(DegreeElevationTest, LeavesCurvesUnchangedToRounding) {
  for (int seed = 0; seed < 6; ++seed) {
    for (int degree = 1; degree <= 11; ++degree) {
      for (const BasisKind& kind : Kinds()) {
        for (const bool rational : {false, true}) {
          SCOPED_TRACE("seed " + std::to_string(seed) + ", degree " + std::to_string(degree) +
                       (kind.periodic  ? ", periodic"
                        : kind.clamped ? ""
                                       : ", unclamped") +
                       (rational ? ", rational" : ""));
          RandomSplines random(1000 * seed + degree);
          const int by = random.Integer(1, 14);
          CheckCurve<2>(random, degree, rational, kind, by);
          CheckCurve<3>(random, degree, rational, kind, by);
        }
      }
    }
  }
}

TEST(DegreeElevationTest, LeavesSurfacesUnchangedToRounding) {
  for (int seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const BasisKind kind_u = Kinds()[random.Integer(0, 2)], kind_v = Kinds()[random.Integer(0, 2)];
    const NurbsSurface surface =
        random.Surface(random.Integer(1, 5), random.Integer(1, 5), random.Coin(), kind_u, kind_v);
    const int by = random.Integer(1, 4);
    for (const Direction direction : {Direction::kU, Direction::kV}) {
      const NurbsSurface elevated = Elevated(surface, direction, by);
      const bool along_u = direction == Direction::kU;
      EXPECT_EQ(elevated.rational(), surface.rational());
      ExpectElevated(along_u ? surface.basis_u() : surface.basis_v(),
                     along_u ? elevated.basis_u() : elevated.basis_v(),
                     by);
      EXPECT_EQ(along_u ? surface.basis_v() : surface.basis_u(),
                along_u ? elevated.basis_v() : elevated.basis_u());
      const double bound = 2 * Bound(ExtentOf(surface), 9, by);
      for (int k = 0; k < 40; ++k) {
        const double u = random.Parameter(surface.basis_u());
        const double v = random.Parameter(surface.basis_v());
        EXPECT_LE((elevated.At(u, v) - surface.At(u, v)).cwiseAbs().maxCoeff(), bound);
      }
    }
  }
}

TEST(DegreeElevationTest, KeepsCoincidentControlPointsCoincidentBitByBit) {
  const NurbsSurface sphere = Sphere(1.7), elevated = Elevated(sphere, Direction::kU, 3);
  for (int i = 0; i < elevated.size_u(); ++i) {
    EXPECT_EQ(elevated.control_point(i, 0), sphere.control_point(0, 0));
    EXPECT_EQ(elevated.control_point(i, elevated.size_v() - 1),
              sphere.control_point(0, sphere.size_v() - 1));
  }
}

TEST(DegreeElevationTest, LeavesDerivativesUnchanged) {
  for (int seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsCurve<3> curve =
        random.Curve<3>(random.Integer(1, 7), random.Coin(), Kinds()[random.Integer(0, 2)]);
    const NurbsCurve<3> elevated = Elevated(curve, random.Integer(1, 4));
    for (int k = 0; k < 10; ++k) {
      const double u = random.Parameter(curve.basis());
      const Eigen::Matrix3Xd a = curve.Derivatives(u, 3), b = elevated.Derivatives(u, 3);
      // A derivative of a B-spline function of degree q ≤ 11 over spans of 0.05 is a difference of
      // terms up to (2q/0.05)^k; weights that differ by 1e4 multiply each order by as much again.
      for (int order = 0; order <= 3; ++order) {
        const double terms = std::pow(440, order) * (curve.rational() ? std::pow(1e2, order) : 1);
        EXPECT_LE((a.col(order) - b.col(order)).norm(), 1e-13 * terms * ExtentOf(curve));
      }
    }
  }
}

// Knots 10^6 away from zero, spans of 10^-3 beside spans of one; coordinates of 10^9 and 10^-9.
TEST(DegreeElevationTest, KeepsItsBoundWhateverKnotsAndCoordinatesAre) {
  for (int seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int degree = random.Integer(1, 11), by = random.Integer(1, 14);
    std::vector<double> breaks(1, random.Coin() ? 1e6 : -0.5);
    for (int k = 0; k < 6; ++k) breaks.push_back(breaks.back() + random.Logarithmic(1e-3, 1));
    const SplineBasis basis = SplineBasis::Clamped(degree, breaks);
    const double size = random.Coin() ? 1e9 : 1e-9;
    Eigen::Matrix3Xd points(3, basis.size());
    for (double& x : points.reshaped()) x = size * random.Real(-1, 1);
    const NurbsCurve<3> curve(basis, points, random.Weights(basis.size()));
    ExpectSameCurve(curve, Elevated(curve, by), by);
  }
}

// The piece of a coordinate that all control points have in common costs nothing: the error is
// relative to the range of the coordinates, but for one rounding of the result.
TEST(DegreeElevationTest, FarFromTheOriginLosesOnlyTheLastDigit) {
  for (int seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsCurve<3> near = random.Curve<3>(random.Integer(1, 6), true);
    constexpr double kFar = 1024.0 * 1024;
    // Coordinates that a sum with kFar keeps exactly.
    const Eigen::Matrix3Xd points = (near.control_points() * 1024).array().round().matrix() / 1024;
    const NurbsCurve<3> here(near.basis(), points, near.weights());
    const NurbsCurve<3> there(near.basis(), points.array() + kFar, near.weights());
    const Eigen::Matrix3Xd difference = Elevated(there, 3).control_points().array() - kFar -
                                        Elevated(here, 3).control_points().array();
    EXPECT_LE(difference.cwiseAbs().maxCoeff(), 3 * kEpsilon * kFar);
  }
}

TEST(DegreeElevationTest, ComposesAndEndsAtTheHighestDegree) {
  for (const BasisKind& kind : Kinds()) {
    RandomSplines random(7);
    const NurbsCurve<3> curve = random.Curve<3>(3, true, kind);
    EXPECT_EQ(Elevated(curve, 0), curve);
    const NurbsCurve<3> once = Elevated(curve, 5), twice = Elevated(Elevated(curve, 2), 3);
    EXPECT_EQ(once.basis(), twice.basis());
    EXPECT_LE((once.control_points() - twice.control_points()).norm(), kRounding);
    const NurbsCurve<3> highest = Elevated(curve, kMaxDegree - 3);
    EXPECT_EQ(highest.basis().degree(), kMaxDegree);
    ExpectSameCurve(curve, highest, kMaxDegree - 3);
  }
}

// The control polygons of elevated curves come nearer to the curve.
TEST(DegreeElevationTest, StaysInTheHullAndDiminishesVariation) {
  for (int seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsCurve<2> curve =
        random.Curve<2>(random.Integer(1, 8), random.Coin(), Kinds()[random.Integer(0, 1)]);
    const NurbsCurve<2> elevated = Elevated(curve, 2);
    for (int line = 0; line < 20; ++line) {
      const Eigen::Vector2d normal(random.Real(-1, 1), random.Real(-1, 1));
      const double offset = random.Real(-1, 1);
      const auto changes = [&](const NurbsCurve<2>& shape) {
        int count = 0;
        const Eigen::VectorXd heights =
            (shape.control_points().transpose() * normal).array() - offset;
        for (Eigen::Index k = 1; k < heights.size(); ++k) {
          if (heights[k - 1] * heights[k] < 0) ++count;
        }
        return count;
      };
      EXPECT_LE(changes(elevated), changes(curve));
    }
    const auto low = curve.control_points().rowwise().minCoeff().eval();
    const auto high = curve.control_points().rowwise().maxCoeff().eval();
    EXPECT_GE((elevated.control_points().colwise() - low).minCoeff(), -kRounding);
    EXPECT_LE((elevated.control_points().colwise() - high).maxCoeff(), kRounding);
  }
}

// Copies of the ends of the domain inside it: control points that act nowhere.
TEST(DegreeElevationTest, TakesKnotVectorsWithIdleControlPoints) {
  const NurbsCurve<2> curve(
      SplineBasis(2, {0, 1, 2, 2, 3, 4, 5, 5, 6, 7}),
      Eigen::Matrix<double, 2, 7>{{0, 1, 2, 3, 4, 5, 6}, {0, 1, 0, 1, 0, 1, 0}});
  ASSERT_EQ(curve.basis().lower(), 2);
  ASSERT_EQ(curve.basis().upper(), 5);
  const NurbsCurve<2> elevated = Elevated(curve, 2);
  ExpectElevated(curve.basis(), elevated.basis(), 2);
  ExpectSameCurve(curve, elevated, 2);
  const NurbsCurve<2> inside(SplineBasis(2, {0, 1, 1, 1, 2, 3, 3, 3, 4, 5}),
                             curve.control_points());
  ASSERT_EQ(inside.basis().lower(), 1);
  ASSERT_EQ(inside.basis().upper(), 3);
  const NurbsCurve<2> higher = Elevated(inside, 3);
  ExpectElevated(inside.basis(), higher.basis(), 3);
  ExpectSameCurve(inside, higher, 3);
}

TEST(DegreeElevationTest, RefusesWhatItCannotDo) {
  RandomSplines random(1);
  const NurbsCurve<3> curve = random.Curve<3>(3, false);
  const NurbsSurface surface = random.Surface(3, 2, false);
  EXPECT_THROW(Elevated(curve, -1), std::invalid_argument);
  EXPECT_THROW(Elevated(curve, 23), std::invalid_argument);
  EXPECT_THROW(Elevated(curve, std::numeric_limits<int>::max()), std::invalid_argument);
  EXPECT_THROW(Elevated(surface, Direction::kU, 23), std::invalid_argument);
  EXPECT_THROW(Elevated(surface, Direction::kV, -1), std::invalid_argument);
  EXPECT_EQ(Elevated(surface, Direction::kV, 0), surface);
}

TEST(DegreeElevationTest, AgreesWithOtherImplementations) {
  CheckAll("degree_ops.json", [](const Json& input, const Json& expected, double tolerance) {
    if (input.at("op") != "elevate") return;
    const auto curve = Curve<3>(input.at("curve"));
    const int to = input.at("to_degree");
    const auto got = Elevated(curve, to - curve.basis().degree());
    const auto wanted = Curve<3>(expected.at("curve"));
    EXPECT_EQ(got.basis(), wanted.basis());
    ExpectClose(got.control_points(), wanted.control_points(), tolerance);
    ExpectClose(got.weights(), wanted.weights(), tolerance);
  });
}

}  // namespace batten::internal::degree_elevation_test
