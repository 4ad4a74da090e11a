// SPDX-License-Identifier: MIT
#include "batten/geometry/foot_point.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "dense_samples.h"
#include "exact_shapes.h"
#include "nasty_surfaces.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::foot_point_test {

Eigen::Vector3d CentreOf(const NurbsSurface& surface) {
  return surface.control_points().rowwise().mean();
}

// Near the surface, around it, far away, on it, and near its centre, where much is equally far.
Eigen::Vector3d Query(const NurbsSurface& surface, RandomSplines& random) {
  const double size = SizeOf(surface);
  const double u = random.Parameter(surface.basis_u()), v = random.Parameter(surface.basis_v());
  switch (random.Integer(0, 5)) {
    case 0:
      return surface.At(u, v) + random.Vector(0.02 * size);
    case 1:
      return surface.At(u, v) + random.Vector(0.3 * size);
    case 2:
      return CentreOf(surface) + random.Vector(std::pow(10.0, random.Integer(2, 10)) * size);
    case 3:
      return CentreOf(surface) + random.Vector(kRounding * size);
    case 4:
      return surface.At(u, v);
    default:
      return CentreOf(surface) + random.Vector(1.5 * size);
  }
}

// The gradient of the distance vanishes, or leads out of the domain at its boundary. What a Newton
// step would still gain, slope² / |second derivative of f|, is lost in the rounding of f =
// |difference|²/2.
void ExpectStationary(double u,
                      const SplineBasis& basis,
                      const Eigen::Vector3d& difference,
                      const Eigen::Vector3d& first,
                      const Eigen::Vector3d& second,
                      double size) {
  const double slope = difference.dot(first);
  const double bend = first.squaredNorm() + std::abs(difference.dot(second));
  const double flat = kHalfDigits * std::sqrt(bend) * (difference.norm() + size);
  const double end = kRounding * (basis.upper() - basis.lower());  // as near as that is at the end
  if (u > basis.lower() + end) {
    EXPECT_LE(slope, flat) << "descends towards lower parameters";
  }
  if (u < basis.upper() - end) {
    EXPECT_GE(slope, -flat) << "descends towards higher parameters";
  }
}

TEST(SurfaceFootPointTest, LiesOnTheSurfaceAtItsParametersAndDistance) {
  for (unsigned seed = 0; seed < 120; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsSurface surface = NastySurface(static_cast<int>(seed) % kNastyKinds, random);
    const SurfaceFootPoints feet(surface);
    for (int trial = 0; trial < 10; ++trial) {
      const Eigen::Vector3d q = Query(surface, random);
      const SurfaceFoot foot = feet.Nearest(q);
      EXPECT_EQ(foot.u, surface.basis_u().Clamp(foot.u));
      EXPECT_EQ(foot.v, surface.basis_v().Clamp(foot.v));
      EXPECT_NEAR(
          (foot.point - surface.At(foot.u, foot.v)).norm(), 0, kRounding * ExtentOf(surface));
      EXPECT_NEAR(foot.distance, (q - foot.point).norm(), kRounding * foot.distance);
    }
  }
}

TEST(SurfaceFootPointTest, DifferenceIsPerpendicularToTheTangentsOrLeadsOut) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    // Continuous tangents, so that the gradient has a meaning at knots.
    const int degree_u = random.Integer(2, 6), degree_v = random.Integer(2, 6);
    const bool rational = random.Coin();
    const NurbsSurface surface =
        random.Surface(degree_u, degree_v, rational, {.most_spans = 4, .highest_multiplicity = 1});
    const SurfaceFootPoints feet(surface);
    for (int trial = 0; trial < 10; ++trial) {
      const Eigen::Vector3d q = Query(surface, random);
      const SurfaceFoot foot = feet.Nearest(q);
      const SurfaceJet jet = surface.JetAt(foot.u, foot.v);
      const double size = SizeOf(surface);
      ExpectStationary(foot.u, surface.basis_u(), jet.point - q, jet.du, jet.duu, size);
      ExpectStationary(foot.v, surface.basis_v(), jet.point - q, jet.dv, jet.dvv, size);
    }
  }
}

// Against a distance that the surface surely has: nothing may be missed by more than 1e-10 of its
// size, and the lower bound may not be above it, nor far below what was found.
class Comparison {
 public:
  Comparison(double size, double extent) : size_(size), extent_(extent) {}

  void Expect(const SurfaceFoot& foot, double reached) {
    Expect(foot.distance, foot.lower_bound, reached);
  }
  void Expect(double distance, double lower_bound, double reached) {
    // Some units in the last place of the coordinates and, from far away, of the distance.
    const double rounding = 64 * std::numeric_limits<double>::epsilon() * (extent_ + distance);
    EXPECT_LE(distance, reached + 1e-10 * size_ + rounding);
    EXPECT_LE(lower_bound, reached + kRounding * (extent_ + distance));
    EXPECT_LE(lower_bound, distance);
    EXPECT_GE(lower_bound, distance - 1e-10 * size_ - rounding);
    if (size_ == 0) return;
    worst_ = std::max(worst_, (distance - reached - rounding) / size_);
    loosest_ = std::max(loosest_, (distance - lower_bound - rounding) / size_);
  }
  double worst() const { return worst_; }
  double loosest() const { return loosest_; }

 private:
  double size_, extent_, worst_ = -1, loosest_ = 0;
};

// Wherever the search begins, right or wrong or outside of the domain.
TEST(SurfaceFootPointTest, FromAPlaceThoughtNearIsAsNearAsWithout) {
  for (unsigned seed = 0; seed < 5 * kNastyKinds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsSurface surface = NastySurface(static_cast<int>(seed) % kNastyKinds, random);
    const SurfaceFootPoints finder(surface);
    const SplineBasis &bu = surface.basis_u(), &bv = surface.basis_v();
    const double size = SizeOf(surface), extent = ExtentOf(surface);
    const double beyond = 0.5 * (bu.upper() - bu.lower());
    Comparison comparison(size, extent);
    for (int trial = 0; trial < 20; ++trial) {
      const Eigen::Vector3d q = Query(surface, random);
      const SurfaceFoot foot = finder.Nearest(q);
      for (const auto& [u, v] :
           {std::pair(foot.u, foot.v),
            std::pair(random.Parameter(bu), random.Parameter(bv)),
            std::pair(random.Real(bu.lower() - beyond, bu.upper() + beyond), bv.upper())}) {
        const SurfaceFoot found = finder.NearestFrom(q, u, v);
        comparison.Expect(found, foot.distance);
        comparison.Expect(foot, found.distance);
        EXPECT_NEAR((surface.At(found.u, found.v) - q).norm(),
                    found.distance,
                    kRounding * (extent + found.distance));
      }
    }
  }
}

TEST(SurfaceFootPointTest, IsNeverWorseThanADenseSampling) {
  for (unsigned seed = 0; seed < 20 * kNastyKinds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsSurface surface = NastySurface(static_cast<int>(seed) % kNastyKinds, random);
    const SurfaceFootPoints feet(surface);
    DenseSurface dense(surface, 50);
    Comparison comparison(SizeOf(surface), ExtentOf(surface));
    for (int trial = 0; trial < 20; ++trial) {
      const Eigen::Vector3d q = Query(surface, random);
      comparison.Expect(feet.Nearest(q), dense.Distance(q, 3));
    }
  }
}

TEST(SurfaceFootPointTest, OfAPointOnTheSurfaceIsThatPoint) {
  for (unsigned seed = 0; seed < 40 * kNastyKinds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsSurface surface = NastySurface(static_cast<int>(seed) % kNastyKinds, random);
    const SurfaceFootPoints feet(surface);
    Comparison comparison(SizeOf(surface), ExtentOf(surface));
    for (int trial = 0; trial < 10; ++trial) {
      const double u = random.Parameter(surface.basis_u()), v = random.Parameter(surface.basis_v());
      comparison.Expect(feet.Nearest(surface.At(u, v)), 0);
    }
  }
}

TEST(SurfaceFootPointTest, FromAWarmStartIsTheMinimumBelowIt) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsSurface surface = NastySurface(static_cast<int>(seed) % kNastyKinds, random);
    const SurfaceFootPoints feet(surface);
    Eigen::Matrix3Xd queries(3, 20);
    Eigen::Matrix2Xd starts(2, queries.cols());
    for (Eigen::Index k = 0; k < queries.cols(); ++k) {
      queries.col(k) = Query(surface, random);
      starts.col(k) << random.Parameter(surface.basis_u()), random.Parameter(surface.basis_v());
    }
    ThreadPool pool(2);
    const auto warm = feet.Near(queries, starts, pool);
    for (Eigen::Index k = 0; k < queries.cols(); ++k) {
      const Eigen::Vector3d q = queries.col(k);
      const double start = (surface.At(starts(0, k), starts(1, k)) - q).norm();
      EXPECT_LE(warm[k].distance, start + kRounding * (start + ExtentOf(surface)));
      const SurfaceFoot global = feet.Nearest(q);
      EXPECT_GE(warm[k].distance, global.lower_bound - kRounding * (start + ExtentOf(surface)));
      const SurfaceFoot again = feet.Near(q, global.u, global.v);
      EXPECT_LE(again.distance, global.distance + kRounding * (start + ExtentOf(surface)));
    }
  }
}

TEST(SurfaceFootPointTest, OfAPointThatIsNotFiniteIsRefused) {
  const SurfaceFootPoints feet(Sphere(1));
  EXPECT_THROW(feet.Nearest({0, NAN, 0}), std::invalid_argument);
  EXPECT_THROW(feet.Near({INFINITY, 0, 0}, 0, 0), std::invalid_argument);
}

TEST(SurfaceFootPointTest, OfASphereCylinderAndTorusHaveTheirFormulas) {
  RandomSplines random(1);
  const SurfaceFootPoints sphere(Sphere(2)), cylinder(Cylinder(1, 3)), torus(Torus(3, 1));
  for (int trial = 0; trial < 300; ++trial) {
    const Eigen::Vector3d q = random.Vector(5);
    const double axis = q.head<2>().norm();
    EXPECT_NEAR(sphere.Nearest(q).distance, std::abs(q.norm() - 2), kIterated);
    const double beyond = std::max({0.0, -q.z(), q.z() - 3});
    EXPECT_NEAR(cylinder.Nearest(q).distance, std::hypot(axis - 1, beyond), kIterated);
    EXPECT_NEAR(torus.Nearest(q).distance, std::abs(std::hypot(axis - 3, q.z()) - 1), kIterated);
  }
}

TEST(SurfaceFootPointTest, OfEquidistantPointsIsAnyOfTheNearest) {
  EXPECT_NEAR(SurfaceFootPoints(Sphere(2)).Nearest(Eigen::Vector3d::Zero()).distance, 2, kIterated);
  const SurfaceFootPoints cylinder(Cylinder(1, 3)), torus(Torus(3, 1));
  for (const double z : {0.0, 1.0, 1.5, 3.0}) {
    EXPECT_NEAR(cylinder.Nearest({0, 0, z}).distance, 1, kIterated);
  }
  EXPECT_NEAR(torus.Nearest({0, 0, 0}).distance, 2, kIterated);
  EXPECT_NEAR(torus.Nearest({0, 0, 7}).distance, std::hypot(3, 7) - 1, kIterated);
  EXPECT_NEAR(torus.Nearest({3, 0, 0}).distance, 1, kIterated);
}

TEST(SurfaceFootPointTest, ScalesWithTheData) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsSurface surface = NastySurface(static_cast<int>(seed) % kNastyKinds, random);
    const Eigen::Vector3d q = Query(surface, random);
    const double expected = SurfaceFootPoints(surface).Nearest(q).distance;
    for (const double scale : {1e-9, 1e9}) {
      const SurfaceFootPoints scaled(WithPoints(surface, scale * surface.control_points()));
      EXPECT_NEAR(scaled.Nearest(scale * q).distance / scale,
                  expected,
                  kIterated * (SizeOf(surface) + expected) + kRounding * ExtentOf(surface));
    }
  }
}

TEST(SurfaceFootPointTest, DoesNotDependOnTheNumberOfThreads) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsSurface surface = NastySurface(static_cast<int>(seed), random);
    const SurfaceFootPoints feet(surface);
    Eigen::Matrix3Xd queries(3, 700);
    for (auto q : queries.colwise()) q = Query(surface, random);
    std::vector<std::vector<SurfaceFoot>> answers;
    for (const int threads : {1, 2, 3}) {
      ThreadPool pool(threads);
      answers.push_back(feet.Nearest(queries, pool));
    }
    for (Eigen::Index k = 0; k < queries.cols(); ++k) {
      const SurfaceFoot alone = feet.Nearest(Eigen::Vector3d(queries.col(k)));
      for (const auto& answer : answers) {
        EXPECT_EQ(answer[k].u, alone.u);
        EXPECT_EQ(answer[k].v, alone.v);
        EXPECT_EQ(answer[k].distance, alone.distance);
      }
    }
  }
}

TEST(SurfaceFootPointTest, OfNoPointsAreNone) {
  ThreadPool pool(2);
  EXPECT_TRUE(SurfaceFootPoints(Sphere(1)).Nearest(Eigen::Matrix3Xd(3, 0), pool).empty());
}

TEST(LocalFootPointTest, NeverLeavesItsBoxAndNeverGoesUphill) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsSurface surface = NastySurface(static_cast<int>(seed) % kNastyKinds, random);
    const auto interval = [&](const SplineBasis& basis) {
      const double a = random.Parameter(basis), b = random.Parameter(basis);
      return std::pair(std::min(a, b), std::max(a, b));
    };
    const auto [u0, u1] = interval(surface.basis_u());
    const auto [v0, v1] = interval(surface.basis_v());
    const double u = random.Real(u0, u1), v = random.Real(v0, v1);
    const Eigen::Vector3d q = Query(surface, random);
    const SurfaceFoot foot = LocalFootPoint(surface, q, u, v, {u0, u1, v0, v1});
    EXPECT_GE(foot.u, u0);
    EXPECT_LE(foot.u, u1);
    EXPECT_GE(foot.v, v0);
    EXPECT_LE(foot.v, v1);
    const double start = (surface.At(u, v) - q).norm();
    EXPECT_LE(foot.distance, start + kRounding * (start + ExtentOf(surface)));
  }
}

TEST(LocalFootPointTest, StartsOutsideTheBoxAtItsNearestSide) {
  const NurbsSurface cylinder = Cylinder(1, 3);
  const SurfaceFoot foot = LocalFootPoint(cylinder, {2, 0, 1}, -4, 9, {0, 0.25, 0, 1});
  EXPECT_NEAR(foot.distance, 1, kIterated);
}

template <typename Dimension>
class CurveFootPointTest : public testing::Test {};
using Dimensions = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(CurveFootPointTest, Dimensions);

template <int Dim>
Eigen::Vector3d InSpace(const Eigen::Matrix<double, Dim, 1>& point) {
  Eigen::Vector3d result = Eigen::Vector3d::Zero();
  result.head<Dim>() = point;
  return result;
}

// Every fourth curve is closed, every third unclamped, every fifth periodic, half of them rational.
template <int Dim>
NurbsCurve<Dim> NastyCurve(unsigned seed, RandomSplines& random) {
  if (seed % 5 == 0) {
    return random.Curve<Dim>(1 + static_cast<int>(seed % 7), seed % 2 == 0, {.periodic = true});
  }
  const NurbsCurve<Dim> curve = random.Curve<Dim>(
      1 + static_cast<int>(seed % 9), seed % 2 == 0, {.clamped = seed % 3 != 0, .most_spans = 6});
  if (seed % 4 != 0) return curve;
  auto points = curve.control_points();
  points.col(points.cols() - 1) = points.col(0);
  return NurbsCurve<Dim>(curve.basis(), points, curve.weights());
}

template <int Dim>
Eigen::Matrix<double, Dim, 1> CurveQuery(const NurbsCurve<Dim>& curve, RandomSplines& random) {
  const Eigen::Matrix<double, Dim, 1> on = curve.At(random.Parameter(curve.basis()));
  switch (random.Integer(0, 3)) {
    case 0:
      return on;
    case 1:
      return on + random.Vector(0.1).template head<Dim>();
    case 2:
      return random.Vector(std::pow(10.0, random.Integer(2, 10))).template head<Dim>();
    default:
      return random.Vector(1.5).template head<Dim>();
  }
}

TYPED_TEST(CurveFootPointTest, IsNeverWorseThanADenseSampling) {
  constexpr int kDim = TypeParam::value;
  for (unsigned seed = 0; seed < 260; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsCurve<kDim> curve = NastyCurve<kDim>(seed, random);
    const CurveFootPoints<kDim> feet(curve);
    Comparison comparison(SizeOf(curve), ExtentOf(curve));
    for (int trial = 0; trial < 10; ++trial) {
      const Eigen::Matrix<double, kDim, 1> q = CurveQuery(curve, random);
      const CurveFoot foot = feet.Nearest(InSpace<kDim>(q));
      comparison.Expect(foot.distance, foot.lower_bound, DenseDistance(curve, q, 1000));
      EXPECT_NEAR((InSpace<kDim>(curve.At(foot.u)) - foot.point).norm(), 0, kRounding);
      EXPECT_NEAR(
          (InSpace<kDim>(q) - foot.point).norm(), foot.distance, kRounding * (1 + foot.distance));
    }
  }
}

TYPED_TEST(CurveFootPointTest, DifferenceIsPerpendicularToTheTangentOrLeadsOut) {
  constexpr int kDim = TypeParam::value;
  for (unsigned seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const auto curve = random.Curve<kDim>(
        2 + static_cast<int>(seed % 6), seed % 2 == 0, {.highest_multiplicity = 1});
    const CurveFootPoints<kDim> feet(curve);
    for (int trial = 0; trial < 10; ++trial) {
      const Eigen::Vector3d q = InSpace<kDim>(CurveQuery(curve, random));
      const CurveFoot foot = feet.Nearest(q);
      const auto derivatives = curve.Derivatives(foot.u, 2);
      ExpectStationary(foot.u,
                       curve.basis(),
                       foot.point - q,
                       InSpace<kDim>(derivatives.col(1)),
                       InSpace<kDim>(derivatives.col(2)),
                       SizeOf(curve));
    }
  }
}

TYPED_TEST(CurveFootPointTest, OfAPointOnTheCurveIsThatPoint) {
  constexpr int kDim = TypeParam::value;
  for (unsigned seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsCurve<kDim> curve = NastyCurve<kDim>(seed, random);
    const CurveFootPoints<kDim> feet(curve);
    for (int trial = 0; trial < 10; ++trial) {
      const double u = random.Parameter(curve.basis());
      EXPECT_NEAR(feet.Nearest(InSpace<kDim>(curve.At(u))).distance, 0, 1e-10 * SizeOf(curve))
          << "u = " << u;
    }
  }
}

TYPED_TEST(CurveFootPointTest, DoesNotDependOnTheNumberOfThreads) {
  constexpr int kDim = TypeParam::value;
  RandomSplines random(3);
  const NurbsCurve<kDim> curve = NastyCurve<kDim>(6, random);
  const CurveFootPoints<kDim> feet(curve);
  Eigen::Matrix3Xd queries(3, 1000);
  for (auto q : queries.colwise()) q = InSpace<kDim>(CurveQuery(curve, random));
  ThreadPool one(1), two(2), three(3);
  const auto expected = feet.Nearest(queries, one);
  for (ThreadPool* pool : {&two, &three}) {
    const auto answer = feet.Nearest(queries, *pool);
    for (size_t k = 0; k < expected.size(); ++k) {
      EXPECT_EQ(answer[k].u, expected[k].u);
      EXPECT_EQ(answer[k].distance, expected[k].distance);
    }
  }
}

TEST(CurveFootPointOnCircleTest, HasTheFormulaInAndOffThePlane) {
  RandomSplines random(2);
  const CurveFootPoints<2> circle(Circle(2));
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::Vector3d q = random.Vector(4);
    EXPECT_NEAR(circle.Nearest(q).distance, std::hypot(q.head<2>().norm() - 2, q.z()), kIterated);
  }
  EXPECT_NEAR(circle.Nearest(Eigen::Vector3d::Zero()).distance, 2, kIterated);
}

// 10^6 queries over 200 shapes, every fourth of them a curve.
TEST(LongFootPointTest, OfManyNastyShapesIsNeverWorseThanAPolishedDenseSampling) {
  constexpr unsigned kSurfaces = 150, kCurves = 50;
  constexpr int kQueries = 5000;
  double worst = -1, loosest = 0;
  const auto see = [&](const Comparison& comparison) {
    worst = std::max(worst, comparison.worst());
    loosest = std::max(loosest, comparison.loosest());
  };
  for (unsigned seed = 0; seed < kSurfaces; ++seed) {
    SCOPED_TRACE("surface " + std::to_string(seed));
    RandomSplines random(10000 + seed);
    const NurbsSurface surface = NastySurface(static_cast<int>(seed) % kNastyKinds, random);
    const SurfaceFootPoints feet(surface);
    DenseSurface dense(surface, 100);
    Comparison comparison(SizeOf(surface), ExtentOf(surface));
    for (int trial = 0; trial < kQueries; ++trial) {
      const Eigen::Vector3d q = Query(surface, random);
      comparison.Expect(feet.Nearest(q), dense.Distance(q, 5));
    }
    see(comparison);
  }
  for (unsigned seed = 0; seed < kCurves; ++seed) {
    SCOPED_TRACE("curve " + std::to_string(seed));
    RandomSplines random(20000 + seed);
    const NurbsCurve<3> curve = NastyCurve<3>(seed, random);
    const CurveFootPoints<3> feet(curve);
    Comparison comparison(SizeOf(curve), ExtentOf(curve));
    for (int trial = 0; trial < kQueries; ++trial) {
      const Eigen::Vector3d q = CurveQuery(curve, random);
      const CurveFoot foot = feet.Nearest(q);
      comparison.Expect(foot.distance, foot.lower_bound, DenseDistance(curve, q, 1000));
    }
    see(comparison);
  }
  std::printf(
      "beside rounding farther than the dense sampling by at most %.2g of the size, bounds below "
      "by "
      "%.2g\n",
      worst,
      loosest);
}

}  // namespace batten::internal::foot_point_test
