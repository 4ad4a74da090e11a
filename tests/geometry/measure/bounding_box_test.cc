// SPDX-License-Identifier: MIT
#include "batten/geometry/bounding_box.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "dense_samples.h"
#include "exact_shapes.h"
#include "nasty_surfaces.h"
#include "random_splines.h"
#include "tolerances.h"
#include "geometry/numeric/constants.h"

namespace batten::internal::bounding_box_test {


template <int Dim>
NurbsCurve<Dim> RandomCurve(RandomSplines& random) {
  const bool clamped = random.Coin(), periodic = random.Integer(0, 2) == 0;
  return random.Curve<Dim>(random.Integer(1, 11),
                           random.Coin(),
                           {.clamped = clamped, .most_spans = 4, .periodic = periodic});
}

// What a point may stick out: the header's bound and the rounding of the evaluation itself.
template <typename Shape>
double Allowed(const Shape& shape) {
  return 1e-14 * 2 * SizeOf(shape) + 64 * kEpsilon * ExtentOf(shape);
}

template <int Dim>
void CheckCurve(const NurbsCurve<Dim>& curve) {
  const Eigen::AlignedBox<double, Dim> box = BoundingBox(curve);
  const double allowed = Allowed(curve);
  Eigen::AlignedBox<double, Dim> sampled;
  for (const double u : DenseParameters(curve.basis(), 4000)) sampled.extend(curve.At(u));
  EXPECT_LE((box.min() - sampled.min()).maxCoeff(), allowed);
  EXPECT_LE((sampled.max() - box.max()).maxCoeff(), allowed);
  // Samples a 1/1000 of a span apart come that close to the extremes, squared.
  EXPECT_LE((sampled.min() - box.min()).maxCoeff(), 0.1 * SizeOf(curve));
  // It touches the curve: the distance from each side falls to nothing by local search.
  for (int d = 0; d < Dim; ++d) {
    for (const double sign : {-1.0, 1.0}) {
      const auto beyond = [&](double u) {
        return sign * ((sign < 0 ? box.min() : box.max())[d] - curve.At(u)[d]);
      };
      double at = 0, least = std::numeric_limits<double>::infinity();
      for (const double u : DenseParameters(curve.basis(), 4000)) {
        if (beyond(u) < least) least = beyond(at = u);
      }
      double step = (curve.basis().upper() - curve.basis().lower()) / 1000;
      for (; step > 1e-12; step /= 2) {
        for (const double u : {at - step, at + step}) {
          if (u < curve.basis().lower() || u > curve.basis().upper()) continue;
          if (beyond(u) < least) least = beyond(at = u);
        }
      }
      EXPECT_LE(least, kRounding * (SizeOf(curve) + ExtentOf(curve)));
    }
  }
}

TEST(BoundingBoxTest, OfRandomCurvesHoldsThemAndTouchesThem) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    CheckCurve(RandomCurve<2>(random));
    CheckCurve(RandomCurve<3>(random));
  }
}

TEST(BoundingBoxTest, OfExactShapesIsTheirs) {
  for (const double r : {1e-9, 1.0, 1e9}) {
    const double allowed = kRounding * r;
    const Eigen::AlignedBox2d circle = BoundingBox(Circle(r));
    EXPECT_LE((circle.max() - Eigen::Vector2d(r, r)).norm(), allowed);
    EXPECT_LE((circle.min() + Eigen::Vector2d(r, r)).norm(), allowed);
    const Eigen::AlignedBox3d sphere = BoundingBox(Sphere(r));
    EXPECT_LE((sphere.max() - Eigen::Vector3d(r, r, r)).norm(), allowed);
    EXPECT_LE((sphere.min() + Eigen::Vector3d(r, r, r)).norm(), allowed);
    const Eigen::AlignedBox3d torus = BoundingBox(Torus(3 * r, r));
    EXPECT_LE((torus.max() - Eigen::Vector3d(4 * r, 4 * r, r)).norm(), allowed);
  }
}

TEST(BoundingBoxTest, OfATurnedTorusIsItsSupport) {
  // In direction d the torus about the axis a reaches R sqrt(1 − (d·a)²) + r.
  for (unsigned seed = 0; seed < 30; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const double minor = random.Real(0.1, 2.5);
    const Eigen::Matrix3d turn = random.Orthogonal();
    const NurbsSurface torus = Torus(3, minor);
    const NurbsSurface turned(
        torus.basis_u(), torus.basis_v(), turn * torus.control_points(), torus.weights());
    const Eigen::AlignedBox3d box = BoundingBox(turned);
    for (int d = 0; d < 3; ++d) {
      const double expected = 3 * std::sqrt(1 - turn(d, 2) * turn(d, 2)) + minor;
      EXPECT_NEAR(box.max()[d], expected, kRounding * 10);
      EXPECT_NEAR(box.min()[d], -expected, kRounding * 10);
    }
  }
}

TEST(BoundingBoxTest, OfNastySurfacesHoldsThemAndTouchesThem) {
  for (int kind = 0; kind < kNastyKinds; ++kind) {
    for (unsigned seed = 0; seed < 3; ++seed) {
      SCOPED_TRACE("kind " + std::to_string(kind) + ", seed " + std::to_string(seed));
      RandomSplines random(seed);
      const NurbsSurface surface = NastySurface(kind, random);
      const Eigen::AlignedBox3d box = BoundingBox(surface);
      const double allowed = Allowed(surface);
      const SplineBasis &bu = surface.basis_u(), &bv = surface.basis_v();
      const std::vector<double> in_u = DenseParameters(bu, 60), in_v = DenseParameters(bv, 60);
      for (int d = 0; d < 3; ++d) {
        for (const double sign : {-1.0, 1.0}) {
          const double side = sign * (sign < 0 ? box.min() : box.max())[d];
          const auto beyond = [&](const Eigen::Vector2d& at) {
            return side - sign * surface.At(at[0], at[1])[d];
          };
          Eigen::Vector2d at;
          double least = std::numeric_limits<double>::infinity();
          for (const double u : in_u) {
            for (const double v : in_v) {
              if (const double value = beyond({u, v}); value < least) {
                least = value;
                at = {u, v};
              }
            }
          }
          EXPECT_GE(least, -allowed);
          const Eigen::Vector2d width(bu.upper() - bu.lower(), bv.upper() - bv.lower());
          for (double step = 1.0 / 60; step > 1e-11;) {
            Eigen::Vector2d best = at;
            for (const Eigen::Vector2d& way : {Eigen::Vector2d(1, 0),
                                               {-1, 0},
                                               {0, 1},
                                               {0, -1},
                                               {1, 1},
                                               {-1, -1},
                                               {1, -1},
                                               {-1, 1}}) {
              Eigen::Vector2d next = at + step * way.cwiseProduct(width);
              next[0] = std::clamp(next[0], bu.lower(), bu.upper());
              next[1] = std::clamp(next[1], bv.lower(), bv.upper());
              if (const double value = beyond(next); value < least) {
                least = value;
                best = next;
              }
            }
            if (best == at) step /= 2;
            at = best;
          }
          EXPECT_GE(least, -allowed);
          // The search of the test creeps along narrow ridges; what it reaches is close.
          EXPECT_LE(least, kIterated * SizeOf(surface));
        }
      }
    }
  }
}

TEST(BoundingBoxTest, FollowsAffineMapsOfTheAxes) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsCurve<3> curve = RandomCurve<3>(random);
    const Eigen::AlignedBox3d box = BoundingBox(curve);
    const Eigen::Vector3d shift = random.Vector(10);
    for (const double scale : {1e-9, 1.0, 1e9}) {
      const NurbsCurve<3> moved(curve.basis(),
                                (scale * curve.control_points()).colwise() + scale * shift,
                                curve.weights());
      const Eigen::AlignedBox3d other = BoundingBox(moved);
      EXPECT_LE((other.min() / scale - shift - box.min()).norm(), kRounding * 10);
      EXPECT_LE((other.max() / scale - shift - box.max()).norm(), kRounding * 10);
    }
  }
}

TEST(BoundingBoxTest, OfAClampedLineIsExactlyItsEnds) {
  const NurbsCurve<2> line(SplineBasis::Uniform(1, 2, 0, 1),
                           Eigen::Matrix2d{{0.1, 0.7}, {0.3, 0.3}});
  const Eigen::AlignedBox2d box = BoundingBox(line);
  EXPECT_NEAR(box.min().x(), 0.1, kEpsilon);
  EXPECT_NEAR(box.max().x(), 0.7, kEpsilon);
  EXPECT_EQ(box.min().y(), 0.3);
  EXPECT_EQ(box.max().y(), 0.3);
}

TEST(BoundingBoxTest, HasItsExtremeAlongAWholeDiagonalCurve) {
  // z = −(u − v)² is greatest all along the diagonal, which no parameter line follows.
  Eigen::Matrix3Xd points(3, 9);
  const double z[3][3] = {{0, 0, -1}, {0, 0.5, 0}, {-1, 0, 0}};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) points.col(3 * i + j) << i / 2.0, j / 2.0, z[i][j];
  }
  const NurbsSurface valley(
      SplineBasis::Uniform(2, 3, 0, 1), SplineBasis::Uniform(2, 3, 0, 1), points);
  ASSERT_NEAR(valley.At(0.3, 0.8).z(), -0.25, kRounding);
  const double top = BoundingBox(valley).max().z();
  EXPECT_GE(top, 0);
  EXPECT_LE(top, 1e-8);
}

}  // namespace batten::internal::bounding_box_test
