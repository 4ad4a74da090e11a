// SPDX-License-Identifier: MIT
// What is proven of a triangle holds at places close together, and what holds clearly is proven.
#include "geometry/mesh/triangle_proof.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::triangle_proof_test {

struct TriangleCase {
  NurbsSurface surface;
  std::array<Eigen::Vector2d, 3> corners;  // counter-clockwise
  Eigen::Vector3d normal;
  double offset;
};

TriangleCase RandomCase(RandomSplines& random) {
  const int p = random.Integer(1, 6), q = random.Integer(1, 6);
  const NurbsSurface surface =
      random.Surface(p, q, random.Coin(), {.most_spans = 3, .highest_multiplicity = 3});
  const SplineBasis &u = surface.basis_u(), &v = surface.basis_v();
  std::array<Eigen::Vector2d, 3> corners;
  const double reach = random.Logarithmic(1e-3, 1);
  const Eigen::Vector2d centre(random.Parameter(u), random.Parameter(v));
  double turn = 0;
  while (std::abs(turn) < kHalfDigits * reach * reach) {
    for (Eigen::Vector2d& corner : corners) {
      corner[0] = std::clamp(centre[0] + random.Real(-reach, reach), u.lower(), u.upper());
      corner[1] = std::clamp(centre[1] + random.Real(-reach, reach), v.lower(), v.upper());
    }
    const Eigen::Vector2d a = corners[1] - corners[0], b = corners[2] - corners[0];
    turn = a[0] * b[1] - a[1] * b[0];
  }
  if (turn < 0) std::swap(corners[1], corners[2]);
  Eigen::Vector3d normal(random.Real(-1, 1), random.Real(-1, 1), random.Real(-1, 1));
  const Eigen::Vector3d at = surface.At(corners[0][0], corners[0][1]);
  const Eigen::Vector3d first = surface.At(corners[1][0], corners[1][1]) - at;
  const Eigen::Vector3d second = surface.At(corners[2][0], corners[2][1]) - at;
  const Eigen::Vector3d cross = first.cross(second);
  if (cross.norm() > kHalfDigits * first.norm() * second.norm()) normal = cross;
  normal.normalize();
  return {surface, corners, normal, normal.dot(at)};
}

double OffPlane(const TriangleCase& given, const Eigen::Vector2d& place) {
  return std::abs(given.normal.dot(given.surface.At(place[0], place[1])) - given.offset);
}

// The greatest distance at places of a grid over the triangle.
double MeasuredOffPlane(const TriangleCase& given) {
  constexpr int kSteps = 40;
  double greatest = 0;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; j <= kSteps - i; ++j) {
      const double a = static_cast<double>(i) / kSteps, b = static_cast<double>(j) / kSteps;
      const auto& c = given.corners;
      greatest = std::max(greatest, OffPlane(given, (1 - a - b) * c[0] + a * c[1] + b * c[2]));
    }
  }
  return greatest;
}

TEST(TriangleProofTest, WhatIsProvenHoldsAndWhatHoldsClearlyIsProven) {
  RandomSplines random(96);
  int proven = 0, refuted = 0;
  for (int round = 0; round < 600; ++round) {
    SCOPED_TRACE(round);
    const TriangleCase given = RandomCase(random);
    TriangleProof proof(given.surface);
    const double measured = MeasuredOffPlane(given), rounding = kRounding * SizeOf(given.surface);
    const auto off = [&](double tolerance) {
      return proof.OffPlane(given.corners, given.normal, given.offset, tolerance);
    };
    // Just below what was measured there is a place that is off.
    if (measured > 10 * rounding) {
      const double less = measured * 0.999;
      const std::optional<Eigen::Vector2d> place = off(less);
      ASSERT_TRUE(place.has_value());
      refuted += OffPlane(given, *place) > less;
    }
    // Twice as much is proven, where some hundred boxes see enough.
    proven += !off(2 * measured + 10 * rounding).has_value();
    // More than the whole surface is away is proven at once.
    EXPECT_FALSE(off(3 * SizeOf(given.surface)).has_value());
  }
  EXPECT_GT(proven, 590);
  EXPECT_GT(refuted, 300);
}

TEST(TriangleProofTest, PlacesLieInTheTriangle) {
  RandomSplines random(97);
  for (int round = 0; round < 300; ++round) {
    SCOPED_TRACE(round);
    const TriangleCase given = RandomCase(random);
    TriangleProof proof(given.surface);
    const auto place = proof.OffPlane(given.corners, given.normal, given.offset + 1, 0.5);
    ASSERT_TRUE(place.has_value());  // the first corner is off by one
    for (int e = 0; e < 3; ++e) {
      const Eigen::Vector2d along = given.corners[(e + 1) % 3] - given.corners[e];
      const Eigen::Vector2d to = *place - given.corners[e];
      EXPECT_GE(along[0] * to[1] - along[1] * to[0], -kRounding * along.norm());
    }
  }
}

// The order of the corners does not matter; without area nothing is proven; nor is it where many
// spans that are each too short for a triangle lie together.
TEST(TriangleProofTest, NothingIsProvenOfWhatIsFarOff) {
  RandomSplines random(99);
  for (int round = 0; round < 100; ++round) {
    SCOPED_TRACE(round);
    const TriangleCase given = RandomCase(random);
    TriangleProof proof(given.surface);
    const double far = 10 * SizeOf(given.surface) + 10;
    const auto& c = given.corners;
    for (const auto& corners : {std::array{c[0], c[1], c[2]},
                                std::array{c[0], c[2], c[1]},
                                std::array{c[0], c[0], c[1]},
                                std::array{c[0], c[0], c[0]},
                                std::array{c[0], Eigen::Vector2d(c[0][0], c[1][1]), c[0]}}) {
      EXPECT_TRUE(proof.OffPlane(corners, given.normal, given.offset + far, 1).has_value());
    }
  }
  std::vector<double> knots{0, 0};
  for (int k = 0; k < 2000; ++k) knots.push_back(0.5 + 3e-9 * k);
  knots.insert(knots.end(), {1, 1});
  const SplineBasis u(1, knots), v(1, {0, 0, 1, 1});
  Eigen::Matrix3Xd points(3, 2 * u.size());
  for (int i = 0; i < u.size(); ++i) {
    points.col(2 * i) << u.Greville(i), 0, 0;
    points.col(2 * i + 1) << u.Greville(i), 1, 0;
  }
  TriangleProof proof(NurbsSurface(u, v, points));
  const std::array<Eigen::Vector2d, 3> corners{Eigen::Vector2d(0.5, 0.1),
                                               Eigen::Vector2d(0.5 + 3e-9 * 1999, 0.2),
                                               Eigen::Vector2d(0.5, 0.9)};
  EXPECT_TRUE(proof.OffPlane(corners, Eigen::Vector3d::UnitZ(), 1e5, 1).has_value());
  EXPECT_FALSE(proof.OffPlane(corners, Eigen::Vector3d::UnitZ(), 0.5, 1).has_value());
}

TEST(TriangleProofTest, WhatIsProvenOfSegmentsHoldsAndWhatHoldsClearlyIsProven) {
  RandomSplines random(98);
  int proven = 0;
  for (int round = 0; round < 600; ++round) {
    SCOPED_TRACE(round);
    TriangleCase given = RandomCase(random);
    Eigen::Vector2d from = given.corners[0], to = given.corners[1];
    if (round % 3 == 0) to[0] = from[0];
    if (round % 3 == 1) to[1] = from[1];
    if (random.Coin()) std::swap(from, to);
    if ((to - from).isZero()) continue;
    const Eigen::Vector3d start = given.surface.At(from[0], from[1]);
    Eigen::Vector3d direction = given.surface.At(to[0], to[1]) - start;
    if (direction.isZero()) continue;
    direction.normalize();
    double measured = 0;
    for (int k = 0; k <= 1000; ++k) {
      const Eigen::Vector2d place = from + k / 1000.0 * (to - from);
      const Eigen::Vector3d off = given.surface.At(place[0], place[1]) - start;
      measured = std::max(measured, (off - direction.dot(off) * direction).norm());
    }
    const double rounding = kRounding * SizeOf(given.surface);
    TriangleProof proof(given.surface);
    if (measured > 10 * rounding) {
      EXPECT_TRUE(proof.OffLine(from, to, start, direction, measured * 0.999).has_value());
    }
    proven += !proof.OffLine(from, to, start, direction, 1.2 * measured + 10 * rounding);
  }
  EXPECT_GT(proven, 580);
}

}  // namespace batten::internal::triangle_proof_test
