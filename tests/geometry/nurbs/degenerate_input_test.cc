// SPDX-License-Identifier: MIT
// Degenerate input is normal input: the laws hold at the edges of what the types accept, and what
// they do not accept is refused.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"
#include "exact_shapes.h"
#include "extended_evaluation.h"
#include "law_cases.h"
#include "tolerances.h"

namespace batten::internal::degenerate_input_test {

// Bases that stress the arithmetic: spans of 1e-12 next to spans of 1, knots 1e6 away on a
// thousandth of a unit, domains of 1e-9 and 1e9. Clamped or unclamped, with multiplicities.
SplineBasis HardBasis(int degree, int kind, bool clamped, RandomSplines& random) {
  std::vector<double> breaks(1, kind == 1 ? 1e6 : 0);
  for (int spans = random.Integer(2, 6); spans > 0; --spans) {
    double length = random.Coin() ? random.Real(0.2, 1) : random.Logarithmic(1e-12, 1);
    if (kind == 1) length = random.Logarithmic(1e-8, 1e-3);
    if (kind == 2) length *= 1e-9;
    if (kind == 3) length *= 1e9;
    breaks.push_back(std::max(breaks.back() + length, std::nextafter(breaks.back(), 1e300)));
  }
  std::vector<double> knots(1, breaks.front());
  while (static_cast<int>(knots.size()) < degree + 1) {
    const double step = clamped || random.Coin() ? 0 : breaks[1] - breaks[0];
    knots.insert(knots.begin(), knots.front() - step);
  }
  for (size_t k = 1; k + 1 < breaks.size(); ++k) {
    knots.insert(knots.end(), random.Integer(1, degree), breaks[k]);
  }
  for (int i = 0; i <= degree; ++i) {
    const double step = i == 0 || clamped || random.Coin() ? 0 : breaks[1] - breaks[0];
    knots.push_back(std::max(knots.back(), breaks.back()) + step);
  }
  return SplineBasis(degree, std::move(knots));
}

constexpr int kHardKinds = 4;

template <typename Law>
void ForHardBases(const Law& law) {
  for (int degree = 1; degree <= kHighestDegree; ++degree) {
    for (int kind = 0; kind < kHardKinds; ++kind) {
      for (unsigned seed = 0; seed < 6; ++seed) {
        SCOPED_TRACE("degree " + std::to_string(degree) + ", kind " + std::to_string(kind) +
                     ", seed " + std::to_string(seed));
        RandomSplines random(10000 * kind + 100 * degree + seed);
        law(HardBasis(degree, kind, seed % 2 == 0, random), random);
        if (testing::Test::HasFailure()) return;
      }
    }
  }
}

// A place on every span, and its ends.
std::vector<double> PlacesOfSpans(const SplineBasis& basis, RandomSplines& random) {
  std::vector<double> places(1, basis.upper());
  for (const int span : basis.Spans()) {
    const double a = basis.knots()[span], b = basis.knots()[span + 1];
    places.push_back(a);
    places.push_back(std::min(b, a + random.Real(0, 1) * (b - a)));
  }
  return places;
}

// The bounds of spline_basis.h do not ask how uneven the knots are.
TEST(DegenerateInputTest, BasesKeepTheirBoundsOnHardKnots) {
  ForHardBases([](const SplineBasis& basis, RandomSplines& random) {
    const int p = basis.degree();
    for (const double u : PlacesOfSpans(basis, random)) {
      const int span = basis.Span(u);
      std::vector<double> values((p + 1) * (p + 1));
      basis.Derivatives(span, u, p, values.data());
      const Sized exact = ExtendedBasis(basis, span, u, p);
      double sum = 0;
      for (int r = 0; r <= p; ++r) {
        sum += values[r];
        EXPECT_GE(values[r], 0);
        for (int k = 0; k <= p; ++k) {
          EXPECT_LE(std::abs(static_cast<double>(values[k * (p + 1) + r] - exact.value(r, k))),
                    3 * p * kEpsilon * static_cast<double>(exact.size(r, k)))
              << "order " << k << " at " << u;
        }
      }
      EXPECT_NEAR(sum, 1, 4 * p * kEpsilon);
    }
  });
}

// The bounds of nurbs_curve.h, for coordinates of 1e-9, 1 and 1e9.
TEST(DegenerateInputTest, CurvesKeepTheirBoundsOnHardKnotsAndScales) {
  ForHardBases([](const SplineBasis& basis, RandomSplines& random) {
    const int p = basis.degree();
    for (const double scale : {1e-9, 1.0, 1e9}) {
      Eigen::Matrix3Xd points(3, basis.size());
      for (double& x : points.reshaped()) x = scale * random.Real(-1, 1);
      const bool rational = random.Coin();
      const NurbsCurve<3> curve(
          basis, points, rational ? random.Weights(basis.size()) : Eigen::VectorXd());
      for (const double u : PlacesOfSpans(basis, random)) {
        const int span = basis.Span(u);
        const double low = basis.knots()[span], high = basis.knots()[span + 1];
        const Eigen::VectorXd origin = points.col(u - low > high - u ? span : span - p);
        const Sized exact = ExtendedCurve(curve, u, 3, origin);
        const Eigen::Matrix3Xd got = curve.Derivatives(u, 3);
        const Eigen::Vector3d error =
            (got.col(0) - origin).cast<double>() - exact.value.col(0).cast<double>();
        EXPECT_LE(error.cwiseAbs().maxCoeff(), scale * (14 * p + 10) * kEpsilon) << "u = " << u;
        for (int k = 1; k <= 3; ++k) {
          const LongMatrix off = got.col(k).cast<long double>() - exact.value.col(k);
          const LongMatrix bound = (k + 1) * (7 * p + k + 4) * kEpsilon * exact.size.col(k);
          EXPECT_LE(static_cast<double>((off.cwiseAbs() - bound).maxCoeff()), 0)
              << "order " << k << " at " << u;
        }
      }
    }
  });
}

TEST(DegenerateInputTest, ScalingTheCoordinatesByAPowerOfTwoScalesTheResultExactly) {
  ForRandomCurves<3>([](const NurbsCurve<3>& curve, RandomSplines& random) {
    const double u = random.Parameter(curve.basis());
    for (const double scale : {0x1p-30, 0x1p30}) {
      const NurbsCurve<3> scaled(curve.basis(), scale * curve.control_points(), curve.weights());
      EXPECT_EQ(scaled.At(u), scale * curve.At(u));
      EXPECT_EQ(scaled.Derivatives(u, 3), scale * curve.Derivatives(u, 3));
    }
  });
  ForRandomSurfaces([](const NurbsSurface& surface, RandomSplines& random) {
    const double u = random.Parameter(surface.basis_u()), v = random.Parameter(surface.basis_v());
    for (const double scale : {0x1p-30, 0x1p30}) {
      const NurbsSurface scaled(surface.basis_u(),
                                surface.basis_v(),
                                scale * surface.control_points(),
                                surface.weights());
      EXPECT_EQ(scaled.At(u, v), scale * surface.At(u, v));
      EXPECT_EQ(scaled.JetAt(u, v).duv, scale * surface.JetAt(u, v).duv);
    }
  });
}

TEST(DegenerateInputTest, ParametersJustOutsideTheDomainAreTakenAtItsEnd) {
  ForHardBases([](const SplineBasis& basis, RandomSplines& random) {
    Eigen::Matrix2Xd points(2, basis.size());
    for (double& x : points.reshaped()) x = random.Real(-1, 1);
    const NurbsCurve<2> curve(basis, points);
    const double infinity = std::numeric_limits<double>::infinity();
    const double lower = basis.lower(), upper = basis.upper();
    for (const double u : {std::nextafter(lower, -infinity), -1e300, -infinity}) {
      EXPECT_EQ(curve.At(u), curve.At(lower));
      EXPECT_EQ(curve.Derivatives(u, 2), curve.Derivatives(lower, 2));
    }
    for (const double u : {std::nextafter(upper, infinity), 1e300, infinity}) {
      EXPECT_EQ(curve.At(u), curve.At(upper));
      EXPECT_EQ(curve.Derivatives(u, 2), curve.Derivatives(upper, 2));
    }
  });
}

// The pieces meet at a knot of multiplicity p, in its control point exactly; a knot repeated p + 1
// times would tear the curve and is refused.
TEST(DegenerateInputTest, FullMultiplicityIsContinuousAndOneMoreIsRefused) {
  for (int p = 1; p <= kHighestDegree; ++p) {
    SCOPED_TRACE("degree " + std::to_string(p));
    RandomSplines random(p);
    std::vector<double> knots(p + 1, 0.0);
    knots.insert(knots.end(), p, 0.4);
    knots.insert(knots.end(), p + 1, 1.0);
    const SplineBasis basis(p, knots);
    Eigen::Matrix3Xd points(3, basis.size());
    for (double& x : points.reshaped()) x = random.Real(-1, 1);
    const NurbsCurve<3> curve(basis, points, random.Weights(basis.size()));
    EXPECT_EQ(curve.At(0.4), points.col(p));
    const Eigen::Vector3d before = curve.At(std::nextafter(0.4, 0));
    const double speed = curve.Derivatives(std::nextafter(0.4, 0), 1).col(1).norm();
    EXPECT_NEAR((before - points.col(p)).norm(), 0, kEpsilon * (speed + 20 * p + 10));
    knots.insert(knots.begin() + p + 1, 0.4);
    EXPECT_THROW(SplineBasis(p, knots), std::invalid_argument);
  }
}

// On each side of a knot of multiplicity k, derivatives agree up to order p − k.
TEST(DegenerateInputTest, CurvesAreAsSmoothAtAKnotAsItsMultiplicityAllows) {
  ForRandomCurves<3>([](const NurbsCurve<3>& curve, RandomSplines&) {
    const SplineBasis& basis = curve.basis();
    const int p = basis.degree();
    const std::vector<int> spans = basis.Spans();
    for (size_t i = 1; i < spans.size(); ++i) {
      const double knot = basis.knots()[spans[i]];
      const int k = basis.Multiplicity(knot);
      // The curve up to the knot: there its last piece is taken from the left.
      const int before = spans[i - 1];
      const auto end = basis.knots().begin() + before + p + 2;
      const NurbsCurve<3> left(SplineBasis(p, std::vector<double>(basis.knots().begin(), end)),
                               curve.control_points().leftCols(before + 1),
                               curve.weights().head(before + 1));
      const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
      const Sized left_size = ExtendedCurve(left, knot, p, zero);
      const Sized right_size = ExtendedCurve(curve, knot, p, zero);
      const Eigen::Matrix3Xd from_left = left.Derivatives(knot, p);
      const Eigen::Matrix3Xd from_right = curve.Derivatives(knot, p);
      for (int order = 0; order + k <= p; ++order) {
        const double size = static_cast<double>(left_size.size.col(order).maxCoeff() +
                                                right_size.size.col(order).maxCoeff());
        EXPECT_LE((from_left - from_right).col(order).cwiseAbs().maxCoeff(),
                  (order + 1) * (7 * p + order + 4) * kEpsilon * size)
            << "order " << order << " at " << knot;
      }
    }
  });
}

// Where whole rows of the net coincide there is a pole; along it nothing moves, exactly.
TEST(DegenerateInputTest, DerivativesAlongACollapsedEdgeAreZeroExactly) {
  for (unsigned seed = 0; seed < 80; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int p = 1 + static_cast<int>(seed) % 7, q = random.Integer(1, 5),
              edge = random.Integer(0, 3);
    const NurbsSurface whole = random.Surface(p, q, random.Coin());
    Eigen::Matrix3Xd points = whole.control_points();
    const int n = whole.size_u(), m = whole.size_v();
    const Eigen::Vector3d pole = random.Vector(1e3);
    const bool along_u = edge < 2;  // the collapsed edge runs along u
    for (int k = 0; k < (along_u ? n : m); ++k) {
      const int row = along_u ? k : edge == 2 ? 0 : n - 1;
      const int column = along_u ? (edge == 0 ? 0 : m - 1) : k;
      points.col(row * m + column) = pole;
    }
    const NurbsSurface surface(whole.basis_u(), whole.basis_v(), points, whole.weights());
    for (int trial = 0; trial < 10; ++trial) {
      double u = random.Parameter(surface.basis_u()), v = random.Parameter(surface.basis_v());
      if (along_u) v = edge == 0 ? surface.basis_v().lower() : surface.basis_v().upper();
      if (!along_u) u = edge == 2 ? surface.basis_u().lower() : surface.basis_u().upper();
      const SurfaceJet jet = surface.JetAt(u, v);
      EXPECT_EQ(surface.At(u, v), pole);
      EXPECT_EQ(jet.point, pole);
      EXPECT_TRUE((along_u ? jet.du : jet.dv).isZero(0));
      EXPECT_TRUE((along_u ? jet.duu : jet.dvv).isZero(0));
      const SurfaceDerivatives all = surface.Derivatives(u, v, 3);
      for (int k = 1; k <= 3; ++k) EXPECT_TRUE((along_u ? all(k, 0) : all(0, k)).isZero(0));
    }
  }
}

TEST(DegenerateInputTest, ASurfaceCollapsedToAPointIsThatPoint) {
  ForRandomSurfaces([](const NurbsSurface& surface, RandomSplines& random) {
    const Eigen::Vector3d point = random.Vector(1e9);
    const NurbsSurface dot(surface.basis_u(),
                           surface.basis_v(),
                           point.replicate(1, surface.control_points().cols()),
                           surface.weights());
    const double u = random.Parameter(surface.basis_u()), v = random.Parameter(surface.basis_v());
    const SurfaceJet jet = dot.JetAt(u, v);
    EXPECT_EQ(dot.At(u, v), point);
    EXPECT_TRUE(jet.du.isZero(0) && jet.dv.isZero(0) && jet.duu.isZero(0) && jet.duv.isZero(0) &&
                jet.dvv.isZero(0));
    EXPECT_FALSE(dot.NormalAt(u, v));
  });
}

// The net of a sphere has two poles, each met by all of its meridians.
TEST(DegenerateInputTest, PolesOfASphereArePoints) {
  for (const double radius : {1e-9, 1.0, 1e9}) {
    const NurbsSurface sphere = Sphere(radius);
    for (double u = 0; u <= 1; u += 0.01) {
      EXPECT_EQ(sphere.At(u, 0), sphere.At(0, 0));
      EXPECT_EQ(sphere.At(u, 1), sphere.At(0, 1));
      EXPECT_TRUE(sphere.JetAt(u, 0).du.isZero(0));
      EXPECT_TRUE(sphere.JetAt(u, 1).du.isZero(0));
      EXPECT_NEAR(sphere.At(u, 0.3).norm() / radius, 1, kRounding);
    }
  }
}

TEST(DegenerateInputTest, TheSmallestCurveAndSurfaceWork) {
  const SplineBasis unit(1, {0, 0, 1, 1});
  const NurbsCurve<2> segment(unit, Eigen::Matrix2d{{0, 2}, {0, 4}});
  EXPECT_EQ(segment.At(0.5), Eigen::Vector2d(1, 2));
  EXPECT_EQ(segment.JetAt(0.25).first, Eigen::Vector2d(2, 4));
  EXPECT_TRUE(segment.JetAt(0.25).third.isZero(0));
  const NurbsCurve<2> dot(unit, Eigen::Matrix2d{{3, 3}, {4, 4}}, Eigen::Vector2d(1e-2, 1e2));
  EXPECT_EQ(dot.At(0.7), Eigen::Vector2d(3, 4));
  EXPECT_TRUE(dot.Derivatives(0.7, 5).rightCols(5).isZero(0));
}

// A line traversed through coincident inner control points stands still there, and goes on.
TEST(DegenerateInputTest, CoincidentControlPointsStopACurveWithoutHarm) {
  const SplineBasis basis = SplineBasis::Uniform(3, 8, 0, 1);
  Eigen::Matrix2Xd points(2, 8);
  for (int i = 0; i < 8; ++i) points.col(i) << (i < 2 ? i : i < 6 ? 2 : i - 3), 0;
  const NurbsCurve<2> curve(basis, points);
  EXPECT_EQ(curve.At(0.5), Eigen::Vector2d(2, 0));
  EXPECT_TRUE(curve.JetAt(0.5).first.isZero(0));
  double last = -1;
  for (int k = 0; k <= 1000; ++k) {
    const double x = curve.At(k / 1000.0).x();
    EXPECT_GE(x, last - 4 * kEpsilon);
    last = x;
  }
  EXPECT_EQ(last, 4);
}

// Whatever numbers and sizes come: a shape that evaluates, or a refusal.
TEST(DegenerateInputTest, HostileArgumentsAreRefusedOrWork) {
  const double infinity = std::numeric_limits<double>::infinity();
  const double hostile[] = {0,
                            -0.0,
                            1,
                            -1,
                            1e308,
                            -1e308,
                            5e-324,
                            1e-9,
                            infinity,
                            1e-308,
                            -infinity,
                            1e-320,
                            std::nan(""),
                            2,
                            3,
                            0.5,
                            0.25,
                            1e300};
  int accepted = 0, refused = 0;
  for (unsigned seed = 0; seed < 4000; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const bool sorted = random.Integer(0, 3) > 0;
    const auto number = [&] {
      return random.Integer(0, 9) == 0 ? hostile[random.Integer(0, 17)] : random.Real(0, 3);
    };
    const int degree = random.Integer(0, 4), size = random.Integer(0, 8);
    std::vector<double> knots;
    for (int i = random.Coin() ? size + degree + 1 : random.Integer(0, 14); i > 0; --i) {
      knots.push_back(number());
    }
    if (sorted) {
      std::sort(knots.begin(), knots.end(), [](double a, double b) {
        return std::isnan(b) ? !std::isnan(a) : a < b;
      });
    }
    try {
      const SplineBasis basis = random.Integer(0, 3) == 0 ? SplineBasis::Periodic(degree, knots)
                                                          : SplineBasis(degree, knots);
      Eigen::Matrix3Xd points(3, random.Coin() ? basis.size() : size);
      for (double& x : points.reshaped()) x = number();
      Eigen::VectorXd weights(random.Coin() ? points.cols() : random.Integer(0, 8));
      for (double& w : weights) w = number();
      const NurbsCurve<3> curve(basis, points, weights);
      ++accepted;
      for (const double u : {basis.lower(), basis.upper(), basis.lower() / 2 + basis.upper() / 2}) {
        EXPECT_TRUE(curve.At(u).allFinite());
        curve.JetAt(u);
        curve.Derivatives(u, 4);
      }
    } catch (const std::invalid_argument&) {
      ++refused;
    }
  }
  EXPECT_GT(accepted, 50);
  EXPECT_GT(refused, 1000);
}

}  // namespace batten::internal::degenerate_input_test
