// SPDX-License-Identifier: MIT
#include "batten/geometry/insert_knots.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "fixtures.h"
#include "law_cases.h"
#include "random_splines.h"
#include "same_shape.h"
#include "shape_edits.h"

namespace batten::internal::insert_knots_test {

// Up to `most` parameters that may be inserted together: places inside spans, near and at knots,
// ends where they are not clamped.
std::vector<double> KnotsToInsert(const SplineBasis& basis, RandomSplines& random, int most) {
  std::vector<double> knots;
  const double reach = basis.upper() - basis.lower();
  for (int k = random.Integer(1, most); k > 0; --k) {
    double u = random.Parameter(basis);
    if (random.Integer(0, 9) == 0) u = std::min(u + 1e-9 * reach, basis.upper());
    if (basis.periodic() && u == basis.upper()) u = basis.lower();
    const auto chosen = static_cast<int>(std::count(knots.begin(), knots.end(), u));
    const int room = basis.degree() - basis.Multiplicity(u) - chosen;
    if (room > 0) knots.insert(knots.end(), random.Integer(1, room), u);
  }
  return knots;
}

TEST(InsertKnotTest, LeavesACurveUnchangedUpToRounding) {
  const auto law = [](const auto& curve, RandomSplines& random) {
    for (const double u : KnotsToInsert(curve.basis(), random, 2)) {
      const auto more = InsertKnot(curve, u);
      EXPECT_EQ(more.basis().periodic(), curve.basis().periodic());
      EXPECT_EQ(more.basis().lower(), curve.basis().lower());
      EXPECT_EQ(more.basis().upper(), curve.basis().upper());
      EXPECT_EQ(more.basis().size(), curve.basis().size() + 1);
      EXPECT_EQ(more.basis().Multiplicity(u), curve.basis().Multiplicity(u) + 1);
      ExpectSame(curve, more, random);
    }
  };
  ForRandomCurves<2>(law);
  ForRandomCurves<3>(law);
}

TEST(RefineKnotsTest, LeavesACurveUnchangedUpToRounding) {
  const auto law = [](const auto& curve, RandomSplines& random) {
    const std::vector<double> knots = KnotsToInsert(curve.basis(), random, 20);
    const auto more = RefineKnots(curve, knots);
    EXPECT_EQ(more.basis().size(), curve.basis().size() + std::ssize(knots));
    ExpectSame(curve, more, random);
  };
  ForRandomCurves<2>(law);
  ForRandomCurves<3>(law);
}

TEST(RefineKnotsTest, LeavesASurfaceUnchangedUpToRounding) {
  ForRandomSurfaces([](const NurbsSurface& surface, RandomSplines& random) {
    for (const Direction direction : {Direction::kU, Direction::kV}) {
      const bool along_u = direction == Direction::kU;
      const SplineBasis& basis = along_u ? surface.basis_u() : surface.basis_v();
      const std::vector<double> knots = KnotsToInsert(basis, random, 6);
      const NurbsSurface more = RefineKnots(surface, direction, knots);
      EXPECT_EQ(along_u ? more.basis_v() : more.basis_u(),
                along_u ? surface.basis_v() : surface.basis_u());
      ExpectSame(surface, more, random);
    }
  });
}

TEST(RefineKnotsTest, IsInsertionOfOneAfterTheOther) {
  ForRandomCurves<3>([](const NurbsCurve<3>& curve, RandomSplines& random) {
    const std::vector<double> knots = KnotsToInsert(curve.basis(), random, 4);
    NurbsCurve<3> one_by_one = curve;
    for (const double u : knots) one_by_one = InsertKnot(one_by_one, u);
    const NurbsCurve<3> at_once = RefineKnots(curve, knots);
    EXPECT_EQ(at_once.basis().lower(), one_by_one.basis().lower());
    ASSERT_EQ(at_once.basis().size(), one_by_one.basis().size());
    ExpectSame(one_by_one, at_once, random, 64.0 * (1 + std::ssize(knots)));
  });
}

TEST(RefineKnotsTest, OfNothingChangesNothing) {
  ForRandomCurves<2>(
      [](const NurbsCurve<2>& curve, RandomSplines&) { EXPECT_EQ(RefineKnots(curve, {}), curve); });
}

// Insertion one after the other by the textbook, with 64 bits of mantissa. Homogeneous columns.
struct ExactSpline {
  int p;
  std::vector<long double> U;
  std::vector<std::vector<long double>> P;

  void Insert(long double u) {
    size_t k = 0;
    while (U[k + 1] <= u) ++k;
    std::vector<std::vector<long double>> Q(P.size() + 1);
    for (size_t i = 0; i < Q.size(); ++i) {
      if (i + p <= k) {
        Q[i] = P[i];
      } else if (U[i] >= u) {
        Q[i] = P[i - 1];
      } else {
        const long double a = (u - U[i]) / (U[i + p] - U[i]);
        for (size_t d = 0; d < P[i].size(); ++d) {
          Q[i].push_back(a * P[i][d] + (1 - a) * P[i - 1][d]);
        }
      }
    }
    P = Q;
    U.insert(U.begin() + static_cast<std::ptrdiff_t>(k) + 1, u);
  }
};

ExactSpline ExactOf(const NurbsCurve<2>& curve) {
  ExactSpline exact{curve.basis().degree(), {}, {}};
  for (const double u : curve.basis().knots()) exact.U.push_back(u);
  for (int i = 0; i < curve.basis().size(); ++i) {
    const long double w = curve.weights()[i];
    exact.P.push_back({w * curve.control_points()(0, i), w * curve.control_points()(1, i), w});
  }
  return exact;
}

// The bound of the header, (6p + 3)·ε·D + ε·|P|, with D over the old control points that act at the
// place of the new one.
void ExpectBoundHolds(const NurbsCurve<2>& curve, const std::vector<double>& knots) {
  ExactSpline exact = ExactOf(curve);
  for (const double u : knots) exact.Insert(u);
  const NurbsCurve<2> more = RefineKnots(curve, knots);
  const int p = curve.basis().degree();
  ASSERT_EQ(exact.P.size(), static_cast<size_t>(more.basis().size()));
  for (int j = 0; j < more.basis().size(); ++j) {
    const double middle = more.basis().knots()[j + p / 2 + 1];
    const int span = curve.basis().Span(middle);
    const auto acting = curve.control_points().middleCols(span - p, p + 1);
    const long double w = exact.P[j][2];
    EXPECT_LE(std::abs(static_cast<double>(more.weights()[j] / w - 1)),
              (3 * p + 1) * kUnitRoundoff);
    for (int d = 0; d < 2; ++d) {
      const double x = static_cast<double>(exact.P[j][d] / w);
      const double range = acting.row(d).maxCoeff() - acting.row(d).minCoeff();
      const double error =
          static_cast<double>(std::abs(exact.P[j][d] / w - more.control_points()(d, j)));
      EXPECT_LE(error, kUnitRoundoff * ((6 * p + 3) * range + std::abs(x)));
    }
  }
}

TEST(RefineKnotsTest, MovesControlPointsByNoMoreThanTheStatedBound) {
  ForRandomCurves<2>([](const NurbsCurve<2>& curve, RandomSplines& random) {
    const SplineBasis& basis = curve.basis();
    if (!basis.clamped()) return;  // outside the domain "acting" is not so simple
    const std::vector<double> knots = KnotsToInsert(basis, random, 8);
    for (const double scale : kCoordinateScales) ExpectBoundHolds(Enlarged(curve, scale), knots);
    // Far from the origin only the last place of the coordinates suffers.
    ExpectBoundHolds(NurbsCurve<2>(basis, curve.control_points().array() + 1e6, curve.weights()),
                     knots);
  });
}

TEST(RefineKnotsTest, MovesControlPointsByNoMoreThanTheStatedBoundOverTinyKnotsFarFromZero) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsCurve<2> curve = random.Curve<2>(random.Integer(1, 11), seed % 2 == 1);
    std::vector<double> knots = curve.basis().knots();
    const double a = curve.basis().lower(), b = curve.basis().upper();
    for (double& u : knots) u = 1e6 + 1e-3 * (u - a) / (b - a);
    const NurbsCurve<2> far(
        SplineBasis(curve.basis().degree(), knots), curve.control_points(), curve.weights());
    ExpectBoundHolds(far, KnotsToInsert(far.basis(), random, 8));
  }
}

TEST(InsertKnotTest, KeepsControlPointsThatAreNotConcernedBitByBit) {
  ForRandomCurves<3>([](const NurbsCurve<3>& curve, RandomSplines& random) {
    if (!curve.basis().clamped()) return;
    const SplineBasis& basis = curve.basis();
    const std::vector<double> knots = KnotsToInsert(basis, random, 1);
    if (knots.empty()) return;
    const double u = knots[0];
    const NurbsCurve<3> more = InsertKnot(curve, u);
    const int span = basis.Span(u), p = basis.degree();
    for (int i = 0; i <= span - p; ++i) {
      EXPECT_EQ(more.control_points().col(i), curve.control_points().col(i));
      EXPECT_EQ(more.weights()[i], curve.weights()[i]);
    }
    for (int i = span + 1; i < more.basis().size(); ++i) {
      EXPECT_EQ(more.control_points().col(i), curve.control_points().col(i - 1));
    }
  });
}

TEST(RefineKnotsTest, KeepsCoincidentControlPointsCoincident) {
  RandomSplines random(7);
  for (int degree = 1; degree <= 7; ++degree) {
    const NurbsCurve<3> any = random.Curve<3>(degree, true);
    const Eigen::Vector3d place(0.1, -1e9, 3e-9);
    const NurbsCurve<3> point(any.basis(), place.replicate(1, any.basis().size()), any.weights());
    const NurbsCurve<3> more = RefineKnots(point, KnotsToInsert(any.basis(), random, 9));
    EXPECT_EQ(more.control_points(), place.replicate(1, more.basis().size()));
  }
}

TEST(InsertKnotTest, MeetsTheCurveAtAKnotOfFullMultiplicity) {
  ForRandomCurves<3>([](const NurbsCurve<3>& curve, RandomSplines& random) {
    const SplineBasis& basis = curve.basis();
    const double u = random.Real(basis.lower(), basis.upper());
    const int times = basis.degree() - basis.Multiplicity(u);
    if (times < 1 || basis.periodic()) return;
    const NurbsCurve<3> more = InsertKnot(curve, u, times);
    const std::vector<double>& U = more.basis().knots();
    const auto first = std::lower_bound(U.begin(), U.end(), u) - U.begin();
    EXPECT_LE((more.control_points().col(first - 1) - curve.At(u)).cwiseAbs().maxCoeff(),
              64 * (basis.degree() + 1) * kUnitRoundoff);
  });
}

TEST(InsertKnotTest, KeepsNonRationalShapesNonRational) {
  RandomSplines random(3);
  const NurbsCurve<2> curve = random.Curve<2>(5, false);
  const NurbsCurve<2> twos(
      curve.basis(), curve.control_points(), Eigen::VectorXd::Constant(curve.basis().size(), 2.0));
  const double u = random.Real(curve.basis().lower(), curve.basis().upper());
  EXPECT_FALSE(InsertKnot(curve, u, 2).rational());
  EXPECT_FALSE(InsertKnot(twos, u, 2).rational());
  EXPECT_EQ(InsertKnot(twos, u, 2).weights()[0], 2);
}

TEST(InsertKnotTest, GoesRoundThePeriodicSeam) {
  ForRandomCurves<3>([](const NurbsCurve<3>& curve, RandomSplines& random) {
    const SplineBasis& basis = curve.basis();
    if (!basis.periodic()) return;
    const int room = basis.degree() - basis.Multiplicity(basis.lower());
    if (room == 0) return;
    const NurbsCurve<3> at_start = InsertKnot(curve, basis.lower(), room);
    EXPECT_EQ(InsertKnot(curve, basis.upper(), room), at_start);
    EXPECT_TRUE(at_start.basis().periodic());
    EXPECT_EQ(at_start.basis().Multiplicity(basis.lower()), basis.degree());
    ExpectSame(curve, at_start, random);
  });
}

TEST(InsertKnotTest, TakesTheShortestDomains) {
  const NurbsCurve<2> line(SplineBasis(1, {0, 0, 1, 1}), Eigen::Matrix2d{{0, 4}, {0, 2}});
  EXPECT_EQ(InsertKnot(line, 0.25).control_points(),
            (Eigen::Matrix<double, 2, 3>{{0, 1, 4}, {0, 0.5, 2}}));
  // One span, periodic: a single point for every degree.
  for (int p = 1; p <= 11; ++p) {
    std::vector<double> knots;
    for (int i = -p; i <= p + 1; ++i) knots.push_back(i);
    const NurbsCurve<2> point(SplineBasis::Periodic(p, knots),
                              Eigen::Vector2d(3, 4).replicate(1, p + 1));
    const NurbsCurve<2> more = RefineKnots(point, std::vector<double>{0.3, 0.6});
    EXPECT_EQ(more.basis().size(), p + 3);
    EXPECT_EQ(more.control_points(), Eigen::Vector2d(3, 4).replicate(1, p + 3));
  }
}

// One unit in the last place above the seam: its copy one period later would round to the seam.
TEST(InsertKnotTest, KeepsCopiesOfPeriodicKnotsApartFromTheKnotsBesideThem) {
  const SplineBasis basis = SplineBasis::Periodic(1, {1.25, 1.75, 2.25, 2.75});
  const NurbsCurve<2> point(basis, Eigen::Vector2d(3, 4).replicate(1, 2));
  const double u = std::nextafter(1.75, 2.0);
  const NurbsCurve<2> more = InsertKnot(point, u);
  EXPECT_EQ(more.basis().size(), 3);
  EXPECT_EQ(more.basis().Multiplicity(1.75), 1);
  EXPECT_EQ(more.basis().Multiplicity(2.25), 1);
}

TEST(InsertKnotTest, RefusesWhatCannotBe) {
  const NurbsCurve<2> curve(SplineBasis(2, {0, 0, 0, 0.5, 1, 1, 1}),
                            Eigen::Matrix<double, 2, 4>::Zero());
  const auto refusal = [&](double u, int times) {
    return RefusalOf([&] { InsertKnot(curve, u, times); });
  };
  EXPECT_EQ(refusal(1.5, 1), "InsertKnot: u = 1.5 is outside the domain [0, 1]");
  EXPECT_EQ(refusal(std::numeric_limits<double>::quiet_NaN(), 1),
            "InsertKnot: u = nan is outside the domain [0, 1]");
  EXPECT_EQ(
      refusal(0.5, 2),
      "InsertKnot: u = 0.5 would be a knot of multiplicity 3 (now 1); at most the degree 2 is "
      "allowed");
  EXPECT_NE(refusal(0, 1), "accepted");
  EXPECT_NE(refusal(1, 1), "accepted");
  EXPECT_NE(refusal(0.25, 3), "accepted");
  EXPECT_NE(refusal(0.25, std::numeric_limits<int>::max()), "accepted");
  EXPECT_EQ(refusal(0.25, 0), "InsertKnot: times = 0 is not at least 1");
  EXPECT_EQ(RefusalOf([&] {
              RefineKnots(curve, std::vector<double>{0.1, -1.0});
            }),
            "RefineKnots: u = -1 is outside the domain [0, 1]");
  const NurbsSurface surface(
      SplineBasis(1, {0, 0, 1, 1}), SplineBasis(1, {0, 0, 2, 2}), Eigen::Matrix3Xd::Zero(3, 4));
  EXPECT_EQ(RefusalOf([&] { InsertKnot(surface, Direction::kU, 1.5); }),
            "InsertKnot: at = 1.5 is outside the domain [0, 1]");
  EXPECT_EQ(RefusalOf([&] { InsertKnot(surface, Direction::kV, 1.5); }), "accepted");
}

template <int Dim>
void CheckInsertion(const fixtures::Json& input, const fixtures::Json& expected, double tolerance) {
  const auto more = RefineKnots(fixtures::Curve<Dim>(input.at("curve")),
                                input.at("knots_to_insert").get<std::vector<double>>());
  const auto wanted = fixtures::Curve<Dim>(expected.at("curve"));
  EXPECT_EQ(more.basis(), wanted.basis());
  fixtures::ExpectClose(more.control_points(), wanted.control_points(), tolerance);
  fixtures::ExpectClose(more.weights(), wanted.weights(), tolerance);
}

TEST(RefineKnotsTest, AgreesWithOtherImplementations) {
  fixtures::CheckAll("knot_ops.json",
                     [](const auto& input, const auto& expected, double tolerance) {
                       if (input.at("op") != "insert") return;
                       if (fixtures::InPlane(input.at("curve"))) {
                         CheckInsertion<2>(input, expected, tolerance);
                       } else {
                         CheckInsertion<3>(input, expected, tolerance);
                       }
                     });
}

}  // namespace batten::internal::insert_knots_test
