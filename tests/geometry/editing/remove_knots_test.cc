// SPDX-License-Identifier: MIT
#include "batten/geometry/remove_knots.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "batten/geometry/insert_knots.h"
#include "batten/geometry/knot_vectors.h"
#include "fixtures.h"
#include "law_cases.h"
#include "random_splines.h"
#include "same_shape.h"
#include "shape_edits.h"
#include "tolerances.h"

namespace batten::internal::remove_knots_test {

// Removal of what was inserted: rounding, gained by extrapolation to the control points between.
constexpr double kRemovalTolerance = 1e-9;

// A parameter where a knot can be inserted at least once, and how often, or times = 0.
struct Place {
  double u;
  int times;
};
Place PlaceFor(const SplineBasis& basis, RandomSplines& random) {
  double u = random.Parameter(basis);
  if (basis.periodic() && u == basis.upper()) u = basis.lower();
  const int room = basis.degree() - basis.Multiplicity(u);
  return {u, room > 0 ? random.Integer(1, room) : 0};
}

// The largest distance seen of two shapes at equal parameters.
template <int Dim>
double Distance(const NurbsCurve<Dim>& a, const NurbsCurve<Dim>& b) {
  double largest = 0;
  constexpr int kSamples = 1000;
  for (int k = 0; k <= kSamples; ++k) {
    const double u = a.basis().lower() + (a.basis().upper() - a.basis().lower()) * k / kSamples;
    largest = std::max(largest, (a.At(u) - b.At(u)).norm());
  }
  for (const double u : a.basis().knots()) {
    largest = std::max(largest, (a.At(u) - b.At(u)).norm());
  }
  return largest;
}
double Distance(const NurbsSurface& a, const NurbsSurface& b) {
  double largest = 0;
  constexpr int kSamples = 30;
  const SplineBasis &bu = a.basis_u(), &bv = a.basis_v();
  for (int i = 0; i <= kSamples; ++i) {
    const double u = bu.lower() + (bu.upper() - bu.lower()) * i / kSamples;
    for (int j = 0; j <= kSamples; ++j) {
      const double v = bv.lower() + (bv.upper() - bv.lower()) * j / kSamples;
      largest = std::max(largest, (a.At(u, v) - b.At(u, v)).norm());
    }
  }
  return largest;
}

template <typename Shape>
double Rounding(const Shape& shape) {
  return kRounding * ExtentOf(shape);
}

TEST(RemoveKnotTest, UndoesInsertion) {
  const auto law = [](const auto& curve, RandomSplines& random) {
    const auto [u, times] = PlaceFor(curve.basis(), random);
    if (times == 0) return;
    const auto back = RemoveKnot(InsertKnot(curve, u, times), u, times, kRemovalTolerance);
    ASSERT_EQ(back.removed, times);
    EXPECT_LE(back.error, Rounding(curve));
    EXPECT_EQ(back.shape.basis().size(), curve.basis().size());
    EXPECT_TRUE(SameKnots(back.shape.basis(), curve.basis(), kRounding));
    EXPECT_LE(Distance(curve, back.shape), Rounding(curve));
    // Control points are less certain than the shape where the basis is badly conditioned.
    if (curve.basis().degree() > 4) return;
    EXPECT_LE((back.shape.control_points() - curve.control_points()).cwiseAbs().maxCoeff(),
              kIterated);
  };
  ForRandomCurves<2>(law, 20);
  ForRandomCurves<3>(law, 20);
}

TEST(RemoveKnotTest, UndoesInsertionInPart) {
  ForRandomCurves<3>([](const NurbsCurve<3>& curve, RandomSplines& random) {
    const auto [u, times] = PlaceFor(curve.basis(), random);
    if (times < 2) return;
    const int back = random.Integer(1, times - 1);
    const auto less = RemoveKnot(InsertKnot(curve, u, times), u, back, kRemovalTolerance);
    ASSERT_EQ(less.removed, back);
    const NurbsCurve<3> wanted = InsertKnot(curve, u, times - back);
    EXPECT_TRUE(SameKnots(less.shape.basis(), wanted.basis(), kRounding));
    EXPECT_LE(Distance(wanted, less.shape), Rounding(curve));
  });
}

TEST(RemoveKnotTest, UndoesInsertionInSurfaces) {
  ForRandomSurfaces([](const NurbsSurface& surface, RandomSplines& random) {
    for (const Direction direction : {Direction::kU, Direction::kV}) {
      const bool along_u = direction == Direction::kU;
      const auto [at, times] = PlaceFor(along_u ? surface.basis_u() : surface.basis_v(), random);
      if (times == 0) continue;
      const NurbsSurface more = InsertKnot(surface, direction, at, times);
      const auto back = RemoveKnot(more, direction, at, times, kRemovalTolerance);
      ASSERT_EQ(back.removed, times);
      EXPECT_LE(back.error, Rounding(surface));
      EXPECT_LE(Distance(surface, back.shape), Rounding(surface));
    }
  });
}

TEST(RemoveKnotTest, WorksAtEveryScaleOfCoordinatesAndKnots) {
  ForRandomCurves<3>([](const NurbsCurve<3>& curve, RandomSplines& random) {
    const auto [u, times] = PlaceFor(curve.basis(), random);
    if (times == 0) return;
    for (const double scale : kCoordinateScales) {
      const NurbsCurve<3> scaled = Enlarged(curve, scale);
      const auto back =
          RemoveKnot(InsertKnot(scaled, u, times), u, times, kRemovalTolerance * scale);
      EXPECT_EQ(back.removed, times);
      EXPECT_LE(Distance(scaled, back.shape), Rounding(scaled));
    }
    if (curve.basis().periodic()) return;  // copies of knots are rounded there
    const SplineBasis tiny = Scaled(curve.basis(), 1e6, 1e6 + 1e-3);
    const NurbsCurve<3> far(tiny, curve.control_points(), curve.weights());
    const double at = 1e6 + 1e-3 * random.Real(0.01, 0.99);
    if (tiny.Multiplicity(at) > 0) return;
    const auto back =
        RemoveKnot(InsertKnot(far, at, tiny.degree()), at, tiny.degree(), kRemovalTolerance);
    EXPECT_EQ(back.removed, tiny.degree());
    EXPECT_LE(Distance(far, back.shape), Rounding(far));
  });
}

// The error reported bounds what is measured, and the tolerance bounds the error.
TEST(RemoveKnotTest, ReportsABoundOfTheDeviation) {
  int partly = 0;
  const auto law = [&](const auto& curve, RandomSplines& random) {
    for (const auto& [knot, multiplicity] : DomainKnots(curve.basis())) {
      if (knot == curve.basis().upper()) continue;
      const bool seam = knot == curve.basis().lower();
      if (seam && !curve.basis().periodic()) continue;
      const int most = seam ? multiplicity - 1 : multiplicity;
      if (most == 0) continue;
      const double tolerance = random.Logarithmic(1e-3, 10);
      const auto less = RemoveKnot(curve, knot, most, tolerance);
      if (less.removed > 0 && less.removed < most) ++partly;
      EXPECT_LE(less.error, tolerance);
      EXPECT_EQ(less.shape.basis().size(), curve.basis().size() - less.removed);
      EXPECT_EQ(less.shape.basis().Multiplicity(knot), multiplicity - less.removed);
      EXPECT_EQ(less.shape.basis().periodic(), curve.basis().periodic());
      EXPECT_EQ(less.shape.basis().lower(), curve.basis().lower());
      EXPECT_EQ(less.shape.basis().upper(), curve.basis().upper());
      EXPECT_LE(Distance(curve, less.shape), less.error + Rounding(curve));
      if (less.removed == 0) {
        EXPECT_EQ(less.shape, curve);
      }
    }
  };
  ForRandomCurves<2>(law, 12);
  ForRandomCurves<3>(law, 12);
  EXPECT_GT(partly, 20);
}

TEST(RemoveKnotTest, ReportsABoundOfTheDeviationOfSurfaces) {
  ForRandomSurfaces([](const NurbsSurface& surface, RandomSplines& random) {
    for (const Direction direction : {Direction::kU, Direction::kV}) {
      const SplineBasis& basis = direction == Direction::kU ? surface.basis_u() : surface.basis_v();
      for (const auto& [knot, multiplicity] : DomainKnots(basis)) {
        if (!(knot > basis.lower() && knot < basis.upper())) continue;
        const double tolerance = random.Logarithmic(1e-2, 10);
        const auto less = RemoveKnot(surface, direction, knot, multiplicity, tolerance);
        EXPECT_LE(less.error, tolerance);
        EXPECT_LE(Distance(surface, less.shape), less.error + Rounding(surface));
      }
    }
  });
}

// One more than the tolerance allows is too much: tightening the tolerance below the error found
// removes fewer knots.
TEST(RemoveKnotTest, RemovesFewerWhereTheToleranceIsTighter) {
  ForRandomCurves<3>([](const NurbsCurve<3>& curve, RandomSplines&) {
    for (const auto& [knot, multiplicity] : DomainKnots(curve.basis())) {
      if (!(knot > curve.basis().lower() && knot < curve.basis().upper())) continue;
      const double all = std::numeric_limits<double>::infinity();
      const auto most = RemoveKnot(curve, knot, multiplicity, all);
      if (most.removed == 0) continue;
      const auto fewer = RemoveKnot(curve, knot, multiplicity, most.error / 2);
      EXPECT_LT(fewer.removed, most.removed);
      EXPECT_LE(fewer.error, most.error / 2);
    }
  });
}

// The header grants one percent; the samples may miss the maximum by another.
TEST(RemoveKnotTest, ReportsNoLargerErrorThanThereIs) {
  ForRandomCurves<3>([&](const NurbsCurve<3>& curve, RandomSplines&) {
    for (const auto& [knot, multiplicity] : DomainKnots(curve.basis())) {
      if (!(knot > curve.basis().lower() && knot < curve.basis().upper())) continue;
      const auto less = RemoveKnot(curve, knot, 1, std::numeric_limits<double>::infinity());
      if (less.removed == 0) continue;
      EXPECT_LE(less.error, 1.02 * Distance(curve, less.shape) + Rounding(curve));
    }
  });
}

TEST(RemoveKnotTest, WithoutToleranceRemovesNothingFromACurveThatNeedsItsKnots) {
  const NurbsCurve<2> corner(SplineBasis(1, {0, 0, 0.5, 1, 1}),
                             Eigen::Matrix<double, 2, 3>{{0, 1, 2}, {0, 1, 0}});
  const auto none = RemoveKnot(corner, 0.5, 1, 0);
  EXPECT_EQ(none.removed, 0);
  EXPECT_EQ(none.error, 0);
  EXPECT_EQ(none.shape, corner);
  const auto all = RemoveKnot(corner, 0.5, 1, 1);
  EXPECT_EQ(all.removed, 1);
  EXPECT_EQ(all.error, 1);
}

TEST(RemoveKnotsTest, RemovesEverythingThatWasInserted) {
  const auto law = [](const auto& curve, RandomSplines& random) {
    std::vector<double> knots;
    for (int k = 0; k < 5; ++k) {
      const auto [u, times] = PlaceFor(curve.basis(), random);
      if (std::count(knots.begin(), knots.end(), u) == 0) knots.insert(knots.end(), times, u);
    }
    const auto more = RefineKnots(curve, knots);
    const double tolerance = kRemovalTolerance;
    const auto less = RemoveKnots(more, tolerance);
    EXPECT_GE(less.removed, std::ssize(knots));
    EXPECT_LE(less.error, tolerance);
    EXPECT_LE(Distance(curve, less.shape), less.error + Rounding(curve));
  };
  ForRandomCurves<2>(law);
  ForRandomCurves<3>(law);
}

TEST(RemoveKnotsTest, KeepsTheWholeDeviationWithinTheTolerance) {
  const auto law = [](const auto& curve, RandomSplines& random) {
    const double tolerance = random.Logarithmic(1e-2, 3);
    const auto less = RemoveKnots(curve, tolerance);
    EXPECT_LE(less.error, tolerance);
    EXPECT_EQ(less.shape.basis().size(), curve.basis().size() - less.removed);
    EXPECT_LE(Distance(curve, less.shape), less.error + Rounding(curve));
    if (less.removed == 0) {
      EXPECT_EQ(less.shape, curve);
    }
  };
  ForRandomCurves<2>(law);
  ForRandomCurves<3>(law);
}

TEST(RemoveKnotsTest, WorksInBothDirectionsOfASurface) {
  ForRandomSurfaces(
      [](const NurbsSurface& surface, RandomSplines& random) {
        const NurbsSurface more =
            InsertKnot(surface,
                       Direction::kU,
                       random.Real(surface.basis_u().lower(), surface.basis_u().upper()));
        const NurbsSurface both = InsertKnot(
            more, Direction::kV, random.Real(surface.basis_v().lower(), surface.basis_v().upper()));
        const auto exact = RemoveKnots(both, kRemovalTolerance);
        EXPECT_GE(exact.removed, 2);
        EXPECT_LE(Distance(surface, exact.shape), exact.error + Rounding(surface));
        const double tolerance = random.Logarithmic(1e-1, 3);
        const auto less = RemoveKnots(both, tolerance);
        EXPECT_GE(less.removed, exact.removed);
        EXPECT_LE(less.error, tolerance);
        EXPECT_LE(Distance(surface, less.shape), less.error + Rounding(surface));
      },
      60);
}

TEST(RemoveKnotsTest, MakesASmoothCurveOfManyKnotsCheap) {
  constexpr int kSize = 200;
  const SplineBasis basis = SplineBasis::Uniform(3, kSize, 0, 1);
  Eigen::Matrix2Xd points(2, kSize);
  for (int i = 0; i < kSize; ++i) {
    const double t = basis.Greville(i);
    points.col(i) << t, std::sin(6 * t);
  }
  const NurbsCurve<2> curve(basis, points);
  const auto less = RemoveKnots(curve, 1e-4);
  EXPECT_LE(less.shape.basis().size(), 25);
  EXPECT_LE(Distance(curve, less.shape), 1e-4);
}

TEST(RemoveKnotTest, RefusesWhatCannotBe) {
  const NurbsCurve<2> curve(SplineBasis(2, {0, 0, 0, 0.5, 0.5, 1, 1, 1}),
                            Eigen::Matrix<double, 2, 5>::Zero());
  const auto refusal = [&](double u, int times, double tolerance) {
    return RefusalOf([&] { RemoveKnot(curve, u, times, tolerance); });
  };
  EXPECT_EQ(refusal(0.5, 1, -1), "RemoveKnot: tolerance = -1 is not a number of at least 0");
  EXPECT_EQ(refusal(0.5, 1, std::nan("")),
            "RemoveKnot: tolerance = nan is not a number of at least 0");
  EXPECT_EQ(refusal(0.4, 1, 1), "RemoveKnot: u = 0.4 is not a knot of the domain [0, 1]");
  EXPECT_EQ(refusal(7, 1, 1), "RemoveKnot: u = 7 is not a knot of the domain [0, 1]");
  EXPECT_EQ(refusal(1, 1, 1), "RemoveKnot: u = 1 is an end of the domain [0, 1], which must stay");
  EXPECT_EQ(refusal(0.5, 3, 1),
            "RemoveKnot: times = 3 is not in [1, 2]: so often can the knot 0.5 be removed");
  EXPECT_EQ(refusal(0.5, 0, 1),
            "RemoveKnot: times = 0 is not in [1, 2]: so often can the knot 0.5 be removed");
  EXPECT_EQ(RefusalOf([&] { RemoveKnots(curve, -1); }),
            "RemoveKnots: tolerance = -1 is not a number of at least 0");
}

template <int Dim>
void CheckRemoval(const fixtures::Json& input, const fixtures::Json& expected, double tolerance) {
  const auto less = RemoveKnot(fixtures::Curve<Dim>(input.at("curve")),
                               input.at("u").get<double>(),
                               input.at("times").get<int>(),
                               input.at("tol").get<double>());
  const auto wanted = fixtures::Curve<Dim>(expected.at("curve"));
  EXPECT_EQ(less.removed, expected.at("removed").get<int>());
  EXPECT_EQ(less.shape.basis(), wanted.basis());
  fixtures::ExpectClose(less.shape.control_points(), wanted.control_points(), tolerance);
  fixtures::ExpectClose(less.shape.weights(), wanted.weights(), tolerance);
}

TEST(RemoveKnotTest, AgreesWithOtherImplementations) {
  fixtures::CheckAll("knot_ops.json",
                     [](const auto& input, const auto& expected, double tolerance) {
                       if (input.at("op") != "remove") return;
                       if (fixtures::InPlane(input.at("curve"))) {
                         CheckRemoval<2>(input, expected, tolerance);
                       } else {
                         CheckRemoval<3>(input, expected, tolerance);
                       }
                     });
}

}  // namespace batten::internal::remove_knots_test
