// SPDX-License-Identifier: MIT
#include "batten/fitting/local_interpolation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "batten/geometry/knot_vectors.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::local_interpolation_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr LocalPieces kAll[] = {
    LocalPieces::kParabolas, LocalPieces::kConics, LocalPieces::kCubics};

template <int Dim>
Eigen::Matrix<double, Dim, Eigen::Dynamic> Walk(RandomSplines& random, int count) {
  Eigen::Matrix<double, Dim, Eigen::Dynamic> points(Dim, count);
  for (int k = 0; k < count; ++k) {
    points.col(k) = random.Vector(1).template head<Dim>();
    if (k > 0) points.col(k) += points.col(k - 1);
  }
  return points;
}

template <int Dim>
void ExpectThroughAndSmooth(unsigned seed) {
  RandomSplines random(seed);
  TangentOptions options;
  options.closed = random.Coin();
  options.rule = random.Coin() ? TangentRule::kAkima : TangentRule::kBessel;
  const auto points = Walk<Dim>(random, random.Integer(options.closed ? 3 : 2, 25));
  for (const LocalPieces kind : kAll) {
    SCOPED_TRACE(static_cast<int>(kind));
    const InterpolatedCurve<Dim> result = InterpolateLocally<Dim>(points, kind, options);
    const NurbsCurve<Dim>& curve = result.curve;
    const double size = SizeOf(curve);
    for (Eigen::Index k = 0; k < points.cols(); ++k) {
      EXPECT_LE((curve.At(result.parameters[k]) - points.col(k)).norm(),
                kRounding * (size + ExtentOf(curve)));
    }
    EXPECT_EQ(curve.basis().lower(), 0);
    EXPECT_EQ(curve.basis().upper(), 1);
    EXPECT_EQ(curve.basis().periodic(), options.closed);
    // One tangent on both sides of every knot. Knots lie no nearer than the drift of domains lets
    // them; the curve turns by what its second derivative says over the difference.
    std::vector<KnotMultiplicity> knots = DomainKnots(curve.basis());
    for (size_t k = options.closed ? 0 : 1; k + 1 < knots.size(); ++k) {
      const double near = 1e-7 * std::min(knots[k + 1].knot - knots[k].knot,
                                          k > 0 ? knots[k].knot - knots[k - 1].knot
                                                : 1 - knots[knots.size() - 2].knot);
      const double before = k > 0 ? knots[k].knot - near : 1 - near;
      const auto a = curve.JetAt(before).first.normalized(),
                 b = curve.JetAt(knots[k].knot + near).first.normalized();
      EXPECT_LE((a - b).norm(), 1e-4) << "knot " << knots[k].knot;
    }
    if (kind == LocalPieces::kCubics && !options.closed) {
      for (size_t k = 1; k + 1 < knots.size(); ++k) EXPECT_EQ(knots[k].multiplicity, 2);
    }
  }
}

TEST(LocalInterpolationTest, GoesThroughItsPointsWithoutCorners) {
  for (unsigned seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    ExpectThroughAndSmooth<2>(seed);
    ExpectThroughAndSmooth<3>(seed);
  }
}

TEST(LocalInterpolationTest, ConicsThroughPointsOfACircleAreTheCircle) {
  for (unsigned seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    TangentOptions options;
    options.rule = TangentRule::kBessel;
    options.closed = random.Coin();
    const Eigen::Matrix3d turn = random.Orthogonal();
    const Eigen::Vector3d centre = random.Vector(10);
    const double radius = random.Logarithmic(1e-3, 1e3);
    std::vector<double> angles;
    for (double angle = 0; angle < (options.closed ? 4.5 : 6); angle += random.Real(0.1, 1.6)) {
      angles.push_back(angle);
    }
    Eigen::Matrix3Xd points(3, angles.size());
    for (Eigen::Index k = 0; k < points.cols(); ++k) {
      const double a = angles[static_cast<size_t>(k)];
      points.col(k) = centre + radius * (turn * Eigen::Vector3d(std::cos(a), std::sin(a), 0));
    }
    const NurbsCurve<3> curve = InterpolateLocally<3>(points, LocalPieces::kConics, options).curve;
    // Points are rounded at their distance from zero; a tangent at a short step loses that over it.
    const double allowed = 100 * kRounding * (radius + 10);
    for (int k = 0; k <= 300; ++k) {
      const Eigen::Vector3d point = turn.transpose() * (curve.At(k / 300.0) - centre);
      EXPECT_NEAR(point.head<2>().norm(), radius, allowed);
      EXPECT_NEAR(point.z(), 0, allowed);
    }
  }
}

TEST(LocalInterpolationTest, CornersBetweenStraightStretchesStay) {
  // An L and a way back: two corners.
  const Eigen::Matrix2Xd points{{0, 1, 2, 3, 3, 3, 3, 5}, {0, 0, 0, 0, 1, 2, 3, 5}};
  TangentOptions options;
  for (const LocalPieces kind : kAll) {
    const InterpolatedCurve<2> result = InterpolateLocally<2>(points, kind, options);
    const double corner = result.parameters[3];
    for (int k = 0; k <= 100; ++k) {
      const double u = k / 100.0 * result.parameters[5];
      const Eigen::Vector2d point = result.curve.At(u);
      EXPECT_NEAR(u < corner ? point.y() : point.x() - 3, 0, kRounding * 5);
    }
  }
  EXPECT_THAT(TangentsAt<2>(points, options).corners, ElementsAre(3));
  options.find_corners = false;
  EXPECT_THAT(TangentsAt<2>(points, options).corners, IsEmpty());
  const NurbsCurve<2> round = InterpolateLocally<2>(points, LocalPieces::kCubics, options).curve;
  const double u = InterpolateLocally<2>(points, LocalPieces::kCubics, options).parameters[3];
  EXPECT_NEAR(round.JetAt(u).first.normalized().dot(Eigen::Vector2d(1, 1).normalized()), 1, 1e-9);
}

TEST(LocalInterpolationTest, CornersAreFoundFarFromZeroAndInAClosedPolygon) {
  Eigen::Matrix3Xd points(3, 16);  // a square of four steps a side
  for (int k = 0; k < 16; ++k) {
    const Eigen::Vector3d corners[] = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {0, 0, 0}};
    points.col(k) = corners[k / 4] + (corners[k / 4 + 1] - corners[k / 4]) * (k % 4) / 4;
  }
  RandomSplines random(3);
  const Eigen::Matrix3d turn = random.Orthogonal();
  for (const double away : {0.0, 5e6}) {
    const Eigen::Matrix3Xd moved =
        (0.1 * turn * points).colwise() + away * Eigen::Vector3d(1, 0.3, -0.7);
    TangentOptions options;
    options.closed = true;
    EXPECT_THAT(TangentsAt<3>(moved, options).corners, ElementsAre(0, 4, 8, 12));
    for (const LocalPieces kind : kAll) {
      const InterpolatedCurve<3> result = InterpolateLocally<3>(moved, kind, options);
      for (int k = 0; k < 16; ++k) {
        const double next = k < 15 ? result.parameters[k + 1] : 1;
        const Eigen::Vector3d middle = result.curve.At((result.parameters[k] + next) / 2);
        const Eigen::Vector3d chord = moved.col((k + 1) % 16) - moved.col(k);
        EXPECT_LE((middle - moved.col(k)).cross(chord).norm() / chord.norm(),
                  8e-16 * away + kRounding);
      }
    }
  }
}

TEST(LocalInterpolationTest, CornersThatAreGivenAreKept) {
  // Two half circles, one after the other: a cusp between them.
  Eigen::Matrix2Xd points(2, 13);
  for (int k = 0; k < 13; ++k) {
    const double angle = std::numbers::pi * (k < 7 ? 6 - k : 12 - k) / 6;
    points.col(k) << (k < 7 ? 0 : 2) + std::cos(angle), std::sin(angle);
  }
  TangentOptions options;
  options.rule = TangentRule::kBessel;
  options.corners = {6};
  const InterpolatedCurve<2> result = InterpolateLocally<2>(points, LocalPieces::kConics, options);
  for (int k = 0; k <= 200; ++k) {
    const Eigen::Vector2d point = result.curve.At(k / 200.0);
    EXPECT_NEAR((point - Eigen::Vector2d(point.x() < 1 ? 0 : 2, 0)).norm(), 1, 100 * kRounding);
  }
  options.closed = true;
  options.corners = {0, 6};
  points.conservativeResize(2, 12);  // the last point would be the first one's mirror
  const PointTangents<2> tangents = TangentsAt<2>(points, options);
  EXPECT_THAT(tangents.corners, ElementsAre(0, 6));
  EXPECT_LT(tangents.arriving.col(6).dot(tangents.leaving.col(6)), 0);
}

TEST(LocalInterpolationTest, AChangedPointActsNearbyOnly) {
  RandomSplines random(5);
  Eigen::Matrix2Xd points = Walk<2>(random, 30);
  for (const LocalPieces kind : kAll) {
    const InterpolatedCurve<2> before = InterpolateLocally<2>(points, kind);
    Eigen::Matrix2Xd changed = points;
    changed.col(15) += Eigen::Vector2d(0.3, 0.2);
    const InterpolatedCurve<2> after = InterpolateLocally<2>(changed, kind);
    for (int k = 0; k < 29; ++k) {
      if (k >= 11 && k <= 18) continue;
      for (const double part : {0.25, 0.5, 0.75}) {
        const auto at = [&](const InterpolatedCurve<2>& c) -> Eigen::Vector2d {
          return c.curve.At(c.parameters[k] + part * (c.parameters[k + 1] - c.parameters[k]));
        };
        EXPECT_LE((at(before) - at(after)).norm(), 1e3 * kRounding * SizeOf(before.curve));
      }
    }
  }
}

// Between points of a smooth curve the distance falls at least with the third power of the step.
TEST(LocalInterpolationTest, ErrorsFallWithTheStep) {
  const auto error = [](int count, LocalPieces kind) {
    Eigen::Matrix2Xd points(2, count);
    for (int k = 0; k < count; ++k) {
      const double a = 2 * std::numbers::pi * k / count;
      points.col(k) << 2 * std::cos(a), std::sin(a);
    }
    TangentOptions options;
    options.closed = true;
    options.rule = TangentRule::kBessel;
    const NurbsCurve<2> curve = InterpolateLocally<2>(points, kind, options).curve;
    double most = 0;
    for (int k = 0; k < 20 * count; ++k) {
      const Eigen::Vector2d p = curve.At(k / (20.0 * count));
      most = std::max(most, std::abs(Eigen::Vector2d(p.x() / 2, p.y()).norm() - 1));
    }
    return most;
  };
  for (const LocalPieces kind : kAll) {
    SCOPED_TRACE(static_cast<int>(kind));
    EXPECT_GT(error(40, kind), 7 * error(80, kind));
    EXPECT_LT(error(80, kind), 1e-4);
  }
}

TEST(LocalInterpolationTest, ManyPointsTakeLinearTimeAndParametersKeepInProportion) {
  constexpr int kCount = 100000;
  RandomSplines random(11);
  Eigen::Matrix2Xd points(2, kCount);
  for (int k = 0; k < kCount; ++k) {
    const double a = 1e-3 * (k + random.Real(-0.45, 0.45));
    points.col(k) << a, std::sin(a);
  }
  for (const LocalPieces kind : kAll) {
    const InterpolatedCurve<2> result = InterpolateLocally<2>(points, kind);
    for (int k = 0; k < kCount; k += 997) {
      EXPECT_LE((result.curve.At(result.parameters[k]) - points.col(k)).norm(), kRounding * 100);
    }
    EXPECT_NEAR(result.parameters[kCount / 2], 0.5, 0.3);
  }
}

TEST(LocalInterpolationTest, TwoPointsAreALineAndBackIsACorner) {
  const Eigen::Matrix2Xd two{{0, 3}, {0, 4}};
  const Eigen::Matrix2Xd back{{0, 1, 2, 1, 0.5}, {0, 0, 0, 0, 0}};
  for (const LocalPieces kind : kAll) {
    const NurbsCurve<2> line = InterpolateLocally<2>(two, kind).curve;
    EXPECT_LE((line.At(0.5) - Eigen::Vector2d(1.5, 2)).norm(), kRounding * 5);
    TangentOptions options;
    options.find_corners = false;
    const NurbsCurve<2> curve = InterpolateLocally<2>(back, kind, options).curve;
    for (int k = 0; k <= 50; ++k) EXPECT_NEAR(curve.At(k / 50.0).y(), 0, kRounding);
  }
}

TEST(LocalInterpolationTest, SaysWhatItCannotDo) {
  const auto error = [](const Eigen::Matrix2Xd& points, const TangentOptions& options) {
    try {
      InterpolateLocally<2>(points, LocalPieces::kCubics, options);
    } catch (const std::invalid_argument& e) {
      return std::string(e.what());
    }
    return std::string("none");
  };
  const Eigen::Matrix2Xd twice{{0, 1, 1, 2}, {0, 1, 1, 0}};
  EXPECT_THAT(error(twice, {}), HasSubstr("points 2 and 3 lie in one place"));
  EXPECT_THAT(error(twice.leftCols(1), {}), HasSubstr("at least 2"));
  EXPECT_THAT(error(twice.leftCols(2), {.closed = true}), HasSubstr("at least 3"));
  EXPECT_THAT(error(twice.leftCols(2), {.corners = {2}}), HasSubstr("no such point"));
  const Eigen::Matrix2Xd round{{0, 1, 1, 0}, {0, 0, 1, 0}};
  EXPECT_THAT(error(round, {.closed = true}), HasSubstr("points 4 and 1 lie in one place"));
}

}  // namespace batten::internal::local_interpolation_test
