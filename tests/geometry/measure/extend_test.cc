// SPDX-License-Identifier: MIT
#include "batten/geometry/extend.h"

#include <gtest/gtest.h>

#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "batten/geometry/arc_length.h"
#include "batten/geometry/iso_curve.h"
#include "batten/geometry/make_curve.h"
#include "batten/geometry/make_surface.h"
#include "batten/geometry/reparameterize.h"
#include "batten/geometry/split.h"
#include "exact_shapes.h"
#include "geometry/numeric/gauss_rule.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::extend_test {

constexpr unsigned kSeeds = 60;

// The old part and the strip of a surface that was longer by extension.
struct Parts {
  NurbsSurface old, strip;
};

Parts PartsOf(const NurbsSurface& longer, const NurbsSurface& surface, const SurfaceEdge& edge) {
  const SplineBasis& was = edge.direction == Direction::kU ? surface.basis_u() : surface.basis_v();
  auto [low, high] = Split(longer, edge.direction, edge.upper ? was.upper() : was.lower());
  return edge.upper ? Parts{low, high} : Parts{high, low};
}

double MeanStripLength(const NurbsSurface& strip, const SurfaceEdge& edge) {
  const bool across_u = edge.direction == Direction::kU;
  const SplineBasis& along = across_u ? strip.basis_v() : strip.basis_u();
  const Direction fixed = across_u ? Direction::kV : Direction::kU;
  const GaussRule rule = GaussLegendre(40);
  double sum = 0;
  for (const int span : along.Spans()) {
    const double a = along.knots()[span], width = along.knots()[span + 1] - a;
    for (int k = 0; k < rule.nodes.size(); ++k) {
      sum += rule.weights[k] * width * ArcLength(IsoCurve(strip, fixed, a + rule.nodes[k] * width));
    }
  }
  return sum / (along.upper() - along.lower());
}

SurfaceEdge RandomEdge(RandomSplines& random) {
  return {random.Coin() ? Direction::kU : Direction::kV, random.Coin()};
}

// Of a sheet the strip is regular, so that G2 can be measured.
TEST(ExtendSurfaceTest, KeepsTheOldPartAndGoesOnWithItsCurvature) {
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsSurface surface =
        random.Sheet(random.Integer(2, 6), random.Integer(2, 6), 0.5, {.most_spans = 6});
    const SurfaceEdge edge = RandomEdge(random);
    const double length = random.Logarithmic(0.01, 2);
    const Continuation how = random.Coin() ? Continuation::kFair : Continuation::kNatural;
    const NurbsSurface longer = Extended(surface, edge, length, how);
    const Parts parts = PartsOf(longer, surface, edge);
    const double bound = 1e-13 * SizeOf(longer);
    for (int k = 0; k < 200; ++k) {
      const double u = random.Parameter(surface.basis_u()), v = random.Parameter(surface.basis_v());
      EXPECT_LE((surface.At(u, v) - longer.At(u, v)).norm(), bound) << u << ", " << v;
    }
    const SurfaceJoin join = TestJoin(surface, parts.strip);
    EXPECT_EQ(join.parametric, 2) << join.position_gap;
    EXPECT_EQ(join.geometric, 2);
    EXPECT_LE(join.position_gap, bound);
    EXPECT_NEAR(MeanStripLength(parts.strip, edge), length, 1e-6 * length);
    // What does not act at the edge is the same bit by bit.
    const bool along_u = edge.direction == Direction::kU;
    const int n = along_u ? surface.size_u() : surface.size_v();
    const int p = along_u ? surface.basis_u().degree() : surface.basis_v().degree();
    if (n > p) {
      const int far = edge.upper ? 0 : n - 1;
      const int longer_far = edge.upper ? 0 : (along_u ? longer.size_u() : longer.size_v()) - 1;
      const Eigen::Vector3d was =
          along_u ? surface.control_point(far, 0) : surface.control_point(0, far);
      const Eigen::Vector3d is =
          along_u ? longer.control_point(longer_far, 0) : longer.control_point(0, longer_far);
      EXPECT_EQ(was, is);
    }
    if (testing::Test::HasFailure()) return;
  }
}

TEST(ExtendSurfaceTest, CalmHasNoThirdDerivativeInTheStrip) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsSurface surface = random.Sheet(random.Integer(3, 6), 3, 0.5, {.most_spans = 6});
    const NurbsSurface longer = Extended(surface, {Direction::kU, true}, 1.0);
    const double u = (surface.basis_u().upper() + longer.basis_u().upper()) / 2;
    const double v = random.Parameter(surface.basis_v());
    const SurfaceDerivatives jet = longer.Derivatives(u, v, 3);
    EXPECT_LE(jet(3, 0).norm(), 1e-8 * (jet(1, 0).norm() + jet(2, 0).norm()));
    const SurfaceDerivatives end =
        longer.Derivatives(surface.basis_u().upper() * (1 + 1e-15), v, 2);
    EXPECT_LE((jet(2, 0) - end(2, 0)).norm(), 1e-7 * (jet(1, 0).norm() + jet(2, 0).norm()));
  }
}

TEST(ExtendSurfaceTest, NaturalIsThePolynomialOfTheLastSpan) {
  RandomSplines random(3);
  for (int degree = 1; degree <= 6; ++degree) {
    const NurbsSurface whole = random.Sheet(degree, 2, 0.5, {.most_spans = 1});
    const double a = whole.basis_u().lower(), b = whole.basis_u().upper();
    const double middle = 0.4 * a + 0.6 * b;
    const NurbsSurface part = Segment(whole, Direction::kU, a, middle);
    const NurbsSurface strip = Segment(whole, Direction::kU, middle, b);
    const double length = MeanStripLength(strip, {Direction::kU, true});
    const NurbsSurface again =
        Extended(part, {Direction::kU, true}, length, Continuation::kNatural);
    EXPECT_NEAR(again.basis_u().upper(), b, kIterated * (b - a));
    for (int k = 0; k < 20; ++k) {
      const double u = random.Real(a, std::min(b, again.basis_u().upper()));
      const double v = random.Parameter(whole.basis_v());
      EXPECT_LE((whole.At(u, v) - again.At(u, v)).norm(), kIterated * SizeOf(whole));
    }
  }
}

TEST(ExtendSurfaceTest, AnArcOfACylinderStaysACylinder) {
  for (const double sweep : {0.3, 1.0, 1.5, 2.0, 4.0}) {
    const NurbsSurface arc = MakeCylinder({}, 2, {0, 3}, {0.2, sweep});
    for (const bool upper : {false, true}) {
      const NurbsSurface longer = Extended(arc, {Direction::kU, upper}, 1.0);
      const SplineBasis& basis = longer.basis_u();
      for (int k = 0; k <= 50; ++k) {
        const double u = basis.lower() + k * (basis.upper() - basis.lower()) / 50;
        EXPECT_NEAR(longer.At(u, 0.5).head<2>().norm(), 2, 2e-13);
      }
      // An arc of length 1 more.
      const double end = upper ? basis.upper() : basis.lower();
      const double angle = upper ? 0.2 + sweep + 0.5 : 0.2 - 0.5;
      const Eigen::Vector3d wanted(2 * std::cos(angle), 2 * std::sin(angle), 0);
      EXPECT_LE((longer.At(end, 0) - wanted).norm(), kIterated);
      EXPECT_GT(longer.weights().minCoeff(), 0);
    }
    const NurbsSurface higher = Extended(arc, {Direction::kV, true}, 5.0);
    EXPECT_NEAR(higher.At(0.3, higher.basis_v().upper())[2], 8, kIterated);
  }
}

TEST(ExtendSurfaceTest, NamesTheGreatestLengthThatKeepsTheWeights) {
  const NurbsSurface arc = MakeCylinder({}, 1, {0, 1}, {0, 1.5});
  try {
    Extended(arc, {Direction::kU, true}, 10);
    FAIL() << "weights cannot stay positive";
  } catch (const std::invalid_argument& error) {
    const std::string message = error.what();
    const size_t at = message.find("greatest is ");
    ASSERT_NE(at, std::string::npos) << message;
    const double most = std::stod(message.substr(at + 12));
    EXPECT_GT(most, 1);
    EXPECT_LT(most, std::numbers::pi);
    EXPECT_NO_THROW(Extended(arc, {Direction::kU, true}, 0.999 * most));
    EXPECT_THROW(Extended(arc, {Direction::kU, true}, 1.001 * most), std::invalid_argument);
  }
}

TEST(ExtendSurfaceTest, UnitsAndFarOriginsChangeNothing) {
  RandomSplines random(11);
  const NurbsSurface surface = random.Sheet(3, 3, 0.5, {.most_spans = 5});
  for (const double unit : {1e-6, 1.0, 1e6}) {
    for (const double far : {0.0, 5e6}) {
      SCOPED_TRACE("unit " + std::to_string(unit) + ", far " + std::to_string(far));
      const Eigen::Vector3d shift(far, -far, far);
      const NurbsSurface other(surface.basis_u(),
                               surface.basis_v(),
                               ((unit * surface.control_points()).colwise() + shift).eval());
      for (const Continuation how : {Continuation::kFair, Continuation::kNatural}) {
        const SurfaceEdge edge{Direction::kV, false};
        const NurbsSurface a = Extended(surface, edge, 0.7, how);
        const NurbsSurface b = Extended(other, edge, 0.7 * unit, how);
        // Coordinates of the far one are rounded to half a unit in their last place.
        const double bound = 1e-9 * unit + 2e-15 * far;
        if (far > 0 && unit < 1) continue;  // the surface is smaller than that unit times 1000
        EXPECT_NEAR(a.basis_v().lower(), b.basis_v().lower(), 1e-7);
        for (int k = 0; k < 20; ++k) {
          const double u = random.Parameter(surface.basis_u());
          const double v = random.Parameter(surface.basis_v());
          EXPECT_LE((unit * a.At(u, v) + shift - b.At(u, v)).norm(), bound);
        }
      }
    }
  }
}

TEST(ExtendSurfaceTest, LoopsStay) {
  const NurbsSurface plane = MakePlane({}, {0, 1}, {0, 1});
  const double ends[] = {0, 1, 2, 3};
  const NurbsCurve<2> loop(SplineBasis::Clamped(1, ends),
                           Eigen::Matrix2Xd{{0.2, 0.8, 0.5, 0.2}, {0.2, 0.2, 0.8, 0.2}});
  const NurbsSurface trimmed = plane.WithTrims({loop});
  EXPECT_EQ(Extended(trimmed, {Direction::kU, true}, 1).trims(), trimmed.trims());
}

TEST(ExtendSurfaceTest, RefusesWhatHasNoEdge) {
  const NurbsSurface sphere = Sphere(1), torus = Torus(2, 1), cylinder = Cylinder(1, 2);
  for (const Direction direction : {Direction::kU, Direction::kV}) {
    for (const bool upper : {false, true}) {
      EXPECT_THROW(Extended(sphere, {direction, upper}, 1), std::invalid_argument);
      EXPECT_THROW(Extended(torus, {direction, upper}, 1), std::invalid_argument);
    }
  }
  EXPECT_THROW(Extended(cylinder, {Direction::kU, true}, 0), std::invalid_argument);
  EXPECT_THROW(Extended(cylinder, {Direction::kU, true}, -1), std::invalid_argument);
  EXPECT_THROW(Extended(cylinder, {Direction::kU, true}, std::nan("")), std::invalid_argument);
}

TEST(ExtendCurveTest, KeepsTheOldPartItsCurvatureAndTheLength) {
  for (unsigned seed = 0; seed < 4 * kSeeds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsCurve<3> curve =
        random.Curve<3>(random.Integer(1, 7), false, {.clamped = random.Coin()});
    const bool upper = random.Coin();
    const double length = random.Logarithmic(1e-3, 1);
    const Continuation how = random.Coin() ? Continuation::kFair : Continuation::kNatural;
    const NurbsCurve<3> longer = Extended(curve, upper, length, how);
    const auto [low, high] = Split(longer, upper ? curve.basis().upper() : curve.basis().lower());
    const NurbsCurve<3>& strip = upper ? high : low;
    EXPECT_NEAR(ArcLength(strip), length, 1e-9 * length);
    for (int k = 0; k < 50; ++k) {
      const double u = random.Parameter(curve.basis());
      EXPECT_LE((curve.At(u) - longer.At(u)).norm(), 1e-13 * SizeOf(longer));
    }
    const double end = upper ? curve.basis().upper() : curve.basis().lower();
    const CurveJet<3> a = strip.JetAt(end), b = (upper ? low : high).JetAt(end);
    EXPECT_LE((a.first - b.first).norm(), 1e-9 * (1 + a.first.norm()));
    EXPECT_LE((a.second - b.second).norm(), 1e-7 * (1 + a.second.norm()));
    if (testing::Test::HasFailure()) return;
  }
}

TEST(ExtendCurveTest, ACircleStaysACircle) {
  const NurbsCurve<3> arc = MakeArc(Frame(), 3, {0, 1.2});
  const NurbsCurve<3> longer = Extended(arc, true, 1.5);
  for (int k = 0; k <= 20; ++k) {
    const SplineBasis& basis = longer.basis();
    const double u = basis.lower() + k * (basis.upper() - basis.lower()) / 20;
    EXPECT_NEAR(longer.At(u).norm(), 3, 1e-13 * 3);
  }
  EXPECT_NEAR(ArcLength(longer), 3 * 1.2 + 1.5, 1e-9);
  EXPECT_THROW(Extended(MakeArc(Frame(), 3), true, 1), std::invalid_argument);
}

}  // namespace batten::internal::extend_test
