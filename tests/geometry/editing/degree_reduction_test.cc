// SPDX-License-Identifier: MIT
#include "batten/geometry/degree_reduction.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "batten/geometry/degree_elevation.h"
#include "geometry/editing/deviation_bound.h"
#include "exact_shapes.h"
#include "fixtures.h"
#include "random_splines.h"
#include "tolerances.h"
#include "geometry/numeric/constants.h"

namespace batten::internal::degree_reduction_test {

using namespace fixtures;


const std::vector<BasisKind>& Kinds() {
  static const std::vector<BasisKind> kinds{{}, {.clamped = false}, {.periodic = true}};
  return kinds;
}

std::string Name(const BasisKind& kind) {
  return kind.periodic ? "periodic" : kind.clamped ? "clamped" : "unclamped";
}

// Parameters in every span.
std::vector<double> Samples(const SplineBasis& basis, int count) {
  std::vector<double> samples;
  for (const int span : basis.Spans()) {
    const double lower = basis.knots()[span], upper = basis.knots()[span + 1];
    for (int k = 0; k <= count; ++k) {
      samples.push_back(std::min(lower + (upper - lower) * k / count, upper));
    }
  }
  return samples;
}

// The greatest distance of points at the same parameter among samples.
template <int Dim>
double Sampled(const NurbsCurve<Dim>& a, const NurbsCurve<Dim>& b, int count) {
  double most = 0;
  for (const double u : Samples(a.basis(), count))
    most = std::max(most, (a.At(u) - b.At(u)).norm());
  return most;
}

double Sampled(const NurbsSurface& a, const NurbsSurface& b, int count) {
  double most = 0;
  const std::vector<double> along_v = Samples(a.basis_v(), count);
  for (const double u : Samples(a.basis_u(), count)) {
    for (const double v : along_v) most = std::max(most, (a.At(u, v) - b.At(u, v)).norm());
  }
  return most;
}

// Knots beyond the domain of a periodic basis are computed again, so they agree to rounding; those
// of an unclamped one may differ.
void ExpectSameKnots(const SplineBasis& got, const SplineBasis& wanted) {
  EXPECT_EQ(got.degree(), wanted.degree());
  EXPECT_EQ(got.periodic(), wanted.periodic());
  EXPECT_EQ(got.clamped(), wanted.clamped());
  ASSERT_EQ(got.size(), wanted.size());
  const int p = got.degree(), count = static_cast<int>(got.knots().size());
  for (int i = 0; i < count; ++i) {
    const bool inside = i >= p && i <= got.size();
    if (inside || got.clamped()) {
      EXPECT_EQ(got.knots()[i], wanted.knots()[i]);
    } else if (got.periodic()) {
      EXPECT_NEAR(got.knots()[i], wanted.knots()[i], kRounding);
    }
  }
}

template <int Dim>
void CheckUndo(RandomSplines& random, int degree, bool rational, const BasisKind& kind, int by) {
  const NurbsCurve<Dim> curve = random.Curve<Dim>(degree, rational, kind);
  const NurbsCurve<Dim> elevated = Elevated(curve, by);
  // 14 degrees up and down; measured: 3e-15.
  constexpr double kUndone = 1e-13;
  const auto back = Reduced(elevated, by, kUndone);
  ASSERT_EQ(back.reduced, by);
  EXPECT_LE(back.error, kUndone);
  EXPECT_LE(Sampled(curve, back.shape, 20), kUndone);
  ExpectSameKnots(back.shape.basis(), curve.basis());
  EXPECT_EQ(back.shape.rational(), curve.rational());
  if (kind.clamped && !kind.periodic) {
    EXPECT_LE((back.shape.control_points() - curve.control_points()).cwiseAbs().maxCoeff(),
              kIterated);
  }
}

TEST(DegreeReductionTest, UndoesElevationOfCurves) {
  for (int seed = 0; seed < 4; ++seed) {
    for (int degree = 1; degree <= 11; ++degree) {
      for (const BasisKind& kind : Kinds()) {
        for (const bool rational : {false, true}) {
          SCOPED_TRACE("seed " + std::to_string(seed) + ", degree " + std::to_string(degree) +
                       ", " + Name(kind) + (rational ? ", rational" : ""));
          RandomSplines random(1000 * seed + degree);
          const int by = random.Integer(1, 14);
          CheckUndo<2>(random, degree, rational, kind, by);
          CheckUndo<3>(random, degree, rational, kind, by);
        }
      }
    }
  }
}

TEST(DegreeReductionTest, UndoesElevationOfSurfaces) {
  for (int seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const BasisKind kind_u = Kinds()[random.Integer(0, 2)], kind_v = Kinds()[random.Integer(0, 2)];
    const NurbsSurface surface =
        random.Surface(random.Integer(1, 5), random.Integer(1, 5), random.Coin(), kind_u, kind_v);
    const int by = random.Integer(1, 4);
    const Direction direction = random.Coin() ? Direction::kU : Direction::kV;
    const auto back = Reduced(Elevated(surface, direction, by), direction, by, kRounding);
    EXPECT_EQ(back.reduced, by);
    EXPECT_LE(Sampled(surface, back.shape, 4), kRounding);
    ExpectSameKnots(back.shape.basis_u(), surface.basis_u());
    ExpectSameKnots(back.shape.basis_v(), surface.basis_v());
  }
}

TEST(DegreeReductionTest, UndoesElevationAtAnyScale) {
  for (int seed = 0; seed < 30; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsCurve<3> plain =
        random.Curve<3>(random.Integer(1, 8), random.Coin(), Kinds()[random.Integer(0, 2)]);
    const double size = random.Coin() ? 1e9 : 1e-9;
    const NurbsCurve<3> curve(plain.basis(), size * plain.control_points(), plain.weights());
    const auto back = Reduced(Elevated(curve, 3), 3, size * kRounding);
    EXPECT_EQ(back.reduced, 3);
    EXPECT_LE(Sampled(curve, back.shape, 20), size * kRounding);
  }
}

// A curve that is not elevated from anything: what is returned is near it, as near as is said.
TEST(DegreeReductionTest, ErrorBoundsTheDeviationOfCurvesAndIsWithinOnePerCent) {
  int with_weights = 0;
  for (int seed = 0; seed < 120; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const bool rational = random.Coin();
    const NurbsCurve<3> curve =
        random.Curve<3>(random.Integer(2, 11), rational, Kinds()[random.Integer(0, 2)]);
    const int by = random.Integer(1, std::min(3, curve.basis().degree() - 1));
    const auto reduced = Reduced(curve, by, kInfinity);
    if (rational && reduced.reduced > 0) ++with_weights;
    if (!rational) {
      EXPECT_EQ(reduced.reduced, by);
    }
    EXPECT_EQ(reduced.shape.basis().degree(), curve.basis().degree() - reduced.reduced);
    const double sampled = Sampled(curve, reduced.shape, 1000);
    EXPECT_GE(reduced.error, sampled * (1 - kRounding));
    // Weights that differ by 1e4 make peaks that the samples may miss.
    EXPECT_LE(reduced.error, (rational ? 1.05 : 1.011) * sampled + kRounding);
  }
  EXPECT_GE(with_weights, 10);
}

TEST(DegreeReductionTest, ErrorBoundsTheDeviationOfSurfaces) {
  for (int seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsSurface surface = random.Surface(random.Integer(2, 4),
                                                random.Integer(1, 4),
                                                random.Coin(),
                                                Kinds()[random.Integer(0, 2)],
                                                Kinds()[random.Integer(0, 2)]);
    const auto reduced = Reduced(surface, Direction::kU, 1, kInfinity);
    const double sampled = Sampled(surface, reduced.shape, 30);
    EXPECT_GE(reduced.error, sampled * (1 - kRounding));
    // 30 samples to a span: the peak may lie 1/60 beside the nearest.
    EXPECT_LE(reduced.error, 1.1 * sampled + kRounding);
  }
}

TEST(DegreeReductionTest, ReducesByAsManyAsKeepTheTolerance) {
  int some = 0;
  for (int seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    // A curve of degree 2 or 3 raised to 8, and moved by 1e-3 at random.
    const int degree = random.Integer(2, 3);
    const NurbsCurve<2> raised =
        Elevated(random.Curve<2>(degree, false, Kinds()[seed % 3]), 8 - degree);
    Eigen::Matrix2Xd points = raised.control_points();
    const int round = raised.basis().periodic() ? raised.basis().size() - 8 : raised.basis().size();
    for (int i = 0; i < round; ++i) {
      points.col(i) += 1e-3 * Eigen::Vector2d(random.Real(-1, 1), random.Real(-1, 1));
    }
    for (int i = round; i < raised.basis().size(); ++i) points.col(i) = points.col(i - round);
    const NurbsCurve<2> curve(raised.basis(), points);
    std::vector<double> errors(1, 0.0);
    for (int by = 1; by <= 7; ++by) errors.push_back(Reduced(curve, by, kInfinity).error);
    EXPECT_LE(errors[8 - degree], 3e-3);
    for (const double tolerance : {0.0, 1e-6, 1e-4, 3e-4, 1e-3, 3e-3, 0.1}) {
      const auto reduced = Reduced(curve, 7, tolerance);
      EXPECT_LE(reduced.error, tolerance);
      int most = 0;
      for (int by = 1; by <= 7; ++by) {
        // 1 %: what the bound may be above.
        if (errors[by] * 1.02 <= tolerance) most = by;
      }
      EXPECT_GE(reduced.reduced, most);
      EXPECT_EQ(reduced.shape.basis().degree(), 8 - reduced.reduced);
      if (reduced.reduced == 0) {
        EXPECT_EQ(reduced.shape, curve);
      } else {
        ++some;
      }
    }
  }
  EXPECT_GE(some, 60);
}

TEST(DegreeReductionTest, KeepsTheEndsOfClampedShapes) {
  for (int seed = 0; seed < 40; ++seed) {
    RandomSplines random(seed);
    const NurbsCurve<3> curve = random.Curve<3>(random.Integer(2, 8), random.Coin());
    const auto reduced = Reduced(curve, 1, kInfinity).shape;
    EXPECT_EQ(reduced.control_points().col(0), curve.control_points().col(0));
    EXPECT_EQ(reduced.control_points().rightCols<1>(), curve.control_points().rightCols<1>());
  }
}

TEST(DegreeReductionTest, TakesCoincidentControlPoints) {
  const SplineBasis basis(3, {0, 0, 0, 0, 1, 2, 2, 3, 3, 3, 3});
  const Eigen::Matrix3Xd points = Eigen::Vector3d(0.1, 1e9, -7).replicate(1, basis.size());
  const auto reduced = Reduced(NurbsCurve<3>(basis, points), 2, 0);
  EXPECT_EQ(reduced.reduced, 2);
  EXPECT_EQ(reduced.error, 0);
  EXPECT_EQ(reduced.shape.control_points(), points.leftCols(reduced.shape.basis().size()));
  // The poles of a sphere.
  const auto sphere = Reduced(Elevated(Sphere(1.7), Direction::kU, 3), Direction::kU, 3, 1e-12);
  ASSERT_EQ(sphere.reduced, 3);
  for (int i = 0; i < sphere.shape.size_u(); ++i) {
    EXPECT_EQ(sphere.shape.control_point(i, 0), Eigen::Vector3d(0, 0, -1.7));
  }
}

// Simple knots stay, so that a spline of many spans can be followed; a knot of multiplicity m keeps
// m − 1 copies and with them the order of continuity.
TEST(DegreeReductionTest, NoKnotVanishes) {
  const NurbsCurve<2> curve(SplineBasis(3, {0, 0, 0, 0, 1, 2, 2, 3, 3, 3, 4, 4, 4, 4}),
                            Eigen::Matrix2Xd::Random(2, 10));
  EXPECT_EQ(Reduced(curve, 1, kInfinity).shape.basis().knots(),
            (std::vector<double>{0, 0, 0, 1, 2, 3, 3, 4, 4, 4}));
  EXPECT_EQ(Reduced(curve, 2, kInfinity).shape.basis().knots(),
            (std::vector<double>{0, 0, 1, 2, 3, 4, 4}));
}

// A polyline of 40 spans written as a cubic with triple knots, and a smooth sheet of many patches.
TEST(DegreeReductionTest, FollowsShapesOfManySpans) {
  RandomSplines random(11);
  const NurbsSurface sheet = random.Sheet(4, 2, 0.01, {.most_spans = 5});
  const auto reduced = Reduced(sheet, Direction::kU, 2, 0.5);
  EXPECT_EQ(reduced.reduced, 2);
  EXPECT_LE(Sampled(sheet, reduced.shape, 10), reduced.error * (1 + kRounding));
}

TEST(DegreeReductionTest, AgreesWithOtherImplementations) {
  CheckAll("degree_ops.json", [](const Json& input, const Json& expected, double tolerance) {
    if (input.at("op") != "reduce") return;
    const auto curve = Curve<3>(input.at("curve"));
    const int by = curve.basis().degree() - input.at("to_degree").get<int>();
    const auto got = Reduced(curve, by, input.at("tol"));
    const auto wanted = Curve<3>(expected.at("curve"));
    EXPECT_EQ(got.reduced, by);
    EXPECT_EQ(got.shape.basis(), wanted.basis());
    ExpectClose(got.shape.control_points(), wanted.control_points(), tolerance);
    ExpectClose(got.shape.weights(), wanted.weights(), tolerance);
  });
}

TEST(DegreeReductionTest, RefusesWhatItCannotDo) {
  RandomSplines random(1);
  const NurbsCurve<3> curve = random.Curve<3>(3, false);
  const NurbsSurface surface = random.Surface(3, 2, false);
  EXPECT_THROW(Reduced(curve, 3, 1), std::invalid_argument);
  EXPECT_THROW(Reduced(curve, -1, 1), std::invalid_argument);
  EXPECT_THROW(Reduced(curve, 1, -1e-300), std::invalid_argument);
  EXPECT_THROW(Reduced(curve, 1, std::nan("")), std::invalid_argument);
  EXPECT_THROW(Reduced(surface, Direction::kV, 2, 1), std::invalid_argument);
  EXPECT_EQ(Reduced(curve, 0, 0).shape, curve);
  EXPECT_EQ(Reduced(random.Curve<2>(1, false), 0, 0).reduced, 0);
}

// --- the bound itself --------------------------------------------------------------------------

TEST(DeviationBoundTest, OfShapesOverDifferentKnotsIsTheDeviation) {
  for (int seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsCurve<3> a = random.Curve<3>(random.Integer(1, 7), random.Coin());
    std::vector<double> breaks{a.basis().lower()};
    for (int k = 1; k <= 3; ++k) {
      breaks.push_back(a.basis().lower() + (a.basis().upper() - a.basis().lower()) * k / 4);
    }
    breaks.push_back(a.basis().upper());
    const SplineBasis basis = SplineBasis::Clamped(random.Integer(1, 7), breaks);
    Eigen::Matrix3Xd points(3, basis.size());
    for (double& x : points.reshaped()) x = random.Real(-1, 1);
    const NurbsCurve<3> b(basis, points, random.Weights(basis.size()));
    const double bound = DeviationBound(a, b), sampled = Sampled(b, a, 4000);
    EXPECT_GE(bound, sampled * (1 - kRounding));
    EXPECT_LE(bound, 1.011 * sampled);
    EXPECT_GE(DeviationBound(a, b, sampled / 2), sampled * (1 - kRounding));
  }
}

TEST(DeviationBoundTest, OfAShapeFromItselfIsRounding) {
  RandomSplines random(3);
  const NurbsCurve<2> curve = random.Curve<2>(7, true);
  EXPECT_LE(DeviationBound(curve, curve), kRounding);
  EXPECT_LE(DeviationBound(Sphere(1), Sphere(1)), kRounding);
  // Two spheres of radius 1 and 1.25 about the same point: one distance everywhere.
  EXPECT_NEAR(DeviationBound(Sphere(1), Sphere(1.25)), 0.25, 0.0026);
  EXPECT_THROW(DeviationBound(curve, random.Curve<2>(2, false)), std::invalid_argument);
}

}  // namespace batten::internal::degree_reduction_test
