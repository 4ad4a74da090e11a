// SPDX-License-Identifier: MIT
#include "batten/geometry/split.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "batten/geometry/knot_vectors.h"
#include "exact_shapes.h"
#include "fixtures.h"
#include "law_cases.h"
#include "random_splines.h"
#include "same_shape.h"
#include "shape_edits.h"

namespace batten::internal::split_test {

double Inside(const SplineBasis& basis, RandomSplines& random) {
  const double u = random.Parameter(basis);
  return u > basis.lower() && u < basis.upper() ? u : (basis.lower() + basis.upper()) / 2;
}

TEST(SplitTest, MakesTwoClampedCurvesThatAreTheWholeUpToRounding) {
  const auto law = [](const auto& curve, RandomSplines& random) {
    const double u = Inside(curve.basis(), random);
    const auto [low, high] = Split(curve, u);
    for (const auto& piece : {low, high}) {
      EXPECT_TRUE(piece.basis().clamped());
      EXPECT_FALSE(piece.basis().periodic());
      ExpectSame(curve, piece, random);
    }
    EXPECT_EQ(low.basis().lower(), curve.basis().lower());
    EXPECT_EQ(low.basis().upper(), u);
    EXPECT_EQ(high.basis().lower(), u);
    EXPECT_EQ(high.basis().upper(), curve.basis().upper());
    EXPECT_EQ(low.control_points().rightCols(1), high.control_points().leftCols(1));
    EXPECT_EQ(low.weights()[low.weights().size() - 1], high.weights()[0]);
  };
  ForRandomCurves<2>(law, 12);
  ForRandomCurves<3>(law, 12);
}

TEST(SplitTest, MakesTwoSurfacesThatAreTheWholeUpToRounding) {
  ForRandomSurfaces([](const NurbsSurface& surface, RandomSplines& random) {
    const auto [low, high] = Split(surface, Direction::kU, Inside(surface.basis_u(), random));
    const auto [left, right] = Split(surface, Direction::kV, Inside(surface.basis_v(), random));
    for (const NurbsSurface& piece : {low, high, left, right}) ExpectSame(surface, piece, random);
    EXPECT_EQ(low.basis_v(), surface.basis_v());
    EXPECT_EQ(left.basis_u(), surface.basis_u());
    EXPECT_EQ(low.control_points().rightCols(low.size_v()),
              high.control_points().leftCols(high.size_v()));
  });
}

TEST(SegmentTest, IsThePieceOfTheCurve) {
  const auto law = [](const auto& curve, RandomSplines& random) {
    double a = random.Parameter(curve.basis()), b = random.Parameter(curve.basis());
    if (a == b) return;
    if (a > b) std::swap(a, b);
    const auto piece = Segment(curve, a, b);
    EXPECT_EQ(piece.basis().lower(), a);
    EXPECT_EQ(piece.basis().upper(), b);
    EXPECT_TRUE(piece.basis().clamped());
    ExpectSame(curve, piece, random);
  };
  ForRandomCurves<2>(law, 12);
  ForRandomCurves<3>(law, 12);
}

TEST(SegmentTest, RunsThroughThePeriodicSeam) {
  ForRandomCurves<3>(
      [](const NurbsCurve<3>& curve, RandomSplines& random) {
        const SplineBasis& basis = curve.basis();
        if (!basis.periodic()) return;
        const double period = basis.upper() - basis.lower();
        const double a = random.Real(basis.lower(), basis.upper());
        const double b = random.Coin() ? a + period : random.Real(basis.upper(), a + period);
        const NurbsCurve<3> piece = Segment(curve, a, b);
        EXPECT_EQ(piece.basis().lower(), a);
        EXPECT_EQ(piece.basis().upper(), b);
        // Wrapping rounds the parameter, which moves a point by that times the speed.
        const double units = 64 * DomainExtent(basis) / ShortestSpan(basis) * WeightRatio(curve);
        for (int k = 0; k < kComparedPlaces; ++k) {
          const double u = random.Real(a, b);
          EXPECT_LE((curve.At(u) - piece.At(u)).cwiseAbs().maxCoeff(),
                    units * (basis.degree() + 1) * kUnitRoundoff);
        }
      },
      20);
}

TEST(SegmentTest, IsThePieceOfTheSurface) {
  ForRandomSurfaces([](const NurbsSurface& surface, RandomSplines& random) {
    const double a = Inside(surface.basis_u(), random), c = Inside(surface.basis_v(), random);
    const double b = surface.basis_u().upper(), d = surface.basis_v().upper();
    const NurbsSurface piece = Segment(surface, a, b, c, d);
    EXPECT_EQ(piece.basis_u().lower(), a);
    EXPECT_EQ(piece.basis_v().upper(), d);
    ExpectSame(surface, piece, random, 128);  // cut twice
  });
}

TEST(DecomposeTest, MakesTheBezierPiecesOfACurve) {
  const auto law = [](const auto& curve, RandomSplines& random) {
    const auto pieces = Decompose(curve);
    const std::vector<int> spans = curve.basis().Spans();
    ASSERT_EQ(pieces.size(), spans.size());
    for (size_t k = 0; k < spans.size(); ++k) {
      const auto& basis = pieces[k].basis();
      EXPECT_EQ(basis.size(), curve.basis().degree() + 1);
      EXPECT_TRUE(basis.clamped());
      EXPECT_EQ(basis.lower(), curve.basis().knots()[spans[k]]);
      EXPECT_EQ(basis.upper(), curve.basis().knots()[spans[k] + 1]);
      ExpectSame(curve, pieces[k], random);
      if (k == 0) continue;
      EXPECT_EQ(pieces[k - 1].control_points().rightCols(1),
                pieces[k].control_points().leftCols(1));
    }
  };
  ForRandomCurves<2>(law, 8);
  ForRandomCurves<3>(law, 8);
}

TEST(DecomposeTest, MakesTheBezierPiecesOfASurfaceInOrder) {
  ForRandomSurfaces([](const NurbsSurface& surface, RandomSplines& random) {
    const std::vector<NurbsSurface> pieces = Decompose(surface);
    const std::vector<int> in_u = surface.basis_u().Spans(), in_v = surface.basis_v().Spans();
    ASSERT_EQ(pieces.size(), in_u.size() * in_v.size());
    for (size_t k = 0; k < pieces.size(); ++k) {
      EXPECT_EQ(pieces[k].size_u(), surface.basis_u().degree() + 1);
      EXPECT_EQ(pieces[k].size_v(), surface.basis_v().degree() + 1);
      EXPECT_EQ(pieces[k].basis_u().lower(), surface.basis_u().knots()[in_u[k / in_v.size()]]);
      EXPECT_EQ(pieces[k].basis_v().lower(), surface.basis_v().knots()[in_v[k % in_v.size()]]);
    }
    const size_t any = static_cast<size_t>(random.Integer(0, static_cast<int>(pieces.size()) - 1));
    ExpectSame(surface, pieces[any], random, 128);
  });
}

TEST(DecomposeTest, KeepsCollapsedEdgesCollapsed) {
  for (const NurbsSurface& piece : Decompose(Sphere(1))) {
    const Eigen::Matrix3Xd& points = piece.control_points();
    const int n = piece.size_v();
    const bool south = piece.basis_v().lower() == 0;
    for (int i = 0; i < piece.size_u(); ++i) {
      EXPECT_EQ(points.col(south ? i * n : i * n + n - 1), points.col(south ? 0 : n - 1));
    }
  }
}

TEST(SplitTest, RefusesWhatIsNotInside) {
  const NurbsCurve<2> line(SplineBasis(1, {0, 0, 1, 1}), Eigen::Matrix2d{{0, 4}, {0, 2}});
  for (const double u : {0.0, 1.0, -1.0, 2.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_NE(RefusalOf([&] { Split(line, u); }), "accepted") << u;
  }
  EXPECT_EQ(RefusalOf([&] { Split(line, 1); }),
            "Split: u = 1 is not strictly inside the domain [0, 1]");
  EXPECT_EQ(RefusalOf([&] { Segment(line, 0.5, 0.5); }),
            "Segment: [0.5, 0.5] is not a piece of the domain [0, 1]");
  EXPECT_NE(RefusalOf([&] { Segment(line, 0.5, 1.5); }), "accepted");
  EXPECT_NE(RefusalOf([&] { Segment(line, -0.5, 0.5); }), "accepted");
  EXPECT_NE(RefusalOf([&] { Segment(line, std::nan(""), 0.5); }), "accepted");
  EXPECT_EQ(RefusalOf([&] { Split(Sphere(1), Direction::kV, 1); }),
            "Split: at = 1 is not strictly inside the domain [0, 1]");
}

template <int Dim>
void CheckSplit(const fixtures::Json& input, const fixtures::Json& expected, double tolerance) {
  const auto curve = fixtures::Curve<Dim>(input.at("curve"));
  const auto [low, high] = Split(curve, input.at("u").get<double>());
  const auto check = [&](const NurbsCurve<Dim>& got, const fixtures::Json& json) {
    const auto wanted = fixtures::Curve<Dim>(json);
    EXPECT_EQ(got.basis(), wanted.basis());
    fixtures::ExpectClose(got.control_points(), wanted.control_points(), tolerance);
    fixtures::ExpectClose(got.weights(), wanted.weights(), tolerance);
  };
  check(low, expected.at("left"));
  check(high, expected.at("right"));
}

template <int Dim>
void CheckPieces(const fixtures::Json& input, const fixtures::Json& expected, double tolerance) {
  const auto pieces = Decompose(fixtures::Curve<Dim>(input.at("curve")));
  const fixtures::Json& wanted = expected.at("segments");
  ASSERT_EQ(pieces.size(), wanted.size());
  for (size_t k = 0; k < pieces.size(); ++k) {
    EXPECT_EQ(pieces[k].basis().lower(), expected.at("intervals")[k][0].template get<double>());
    EXPECT_EQ(pieces[k].basis().upper(), expected.at("intervals")[k][1].template get<double>());
    fixtures::ExpectClose(
        pieces[k].control_points(), fixtures::Columns(wanted[k].at("points")), tolerance);
    if (wanted[k].at("weights").is_null()) {
      EXPECT_FALSE(pieces[k].rational());
    } else {
      fixtures::ExpectClose(
          pieces[k].weights(), fixtures::Vector(wanted[k].at("weights")), tolerance);
    }
  }
}

TEST(SplitTest, AgreesWithOtherImplementations) {
  fixtures::CheckAll("split_bezier.json",
                     [](const auto& input, const auto& expected, double tolerance) {
                       const bool plane = fixtures::InPlane(input.at("curve"));
                       if (input.at("op") == "split") {
                         (plane ? CheckSplit<2> : CheckSplit<3>)(input, expected, tolerance);
                       } else {
                         (plane ? CheckPieces<2> : CheckPieces<3>)(input, expected, tolerance);
                       }
                     });
}

}  // namespace batten::internal::split_test
