// SPDX-License-Identifier: MIT
#include "batten/fitting/local_approximation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "fitting/interpolation/smooth_tangents.h"
#include "batten/geometry/knot_vectors.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::local_approximation_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr ApproximationPieces kBoth[] = {ApproximationPieces::kConics,
                                         ApproximationPieces::kCubics};

template <int Dim>
void ExpectWithin(const LocalApproximation<Dim>& result,
                  const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points,
                  double tolerance) {
  ASSERT_EQ(result.parameters.size(), points.cols());
  EXPECT_LE(result.largest_distance, tolerance);
  double most = 0;
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    most = std::max(most, (result.curve.At(result.parameters[k]) - points.col(k)).norm());
  }
  EXPECT_NEAR(most, result.largest_distance, kRounding * 10 * (1 + ExtentOf(result.curve)));
}

// The largest turn of the tangent at knots, radians.
template <int Dim>
double LargestTurn(const NurbsCurve<Dim>& curve) {
  const std::vector<KnotMultiplicity> knots = DomainKnots(curve.basis());
  const bool closed = curve.basis().periodic();
  double most = 0;
  for (size_t k = closed ? 0 : 1; k + 1 < knots.size(); ++k) {
    const double before = k > 0 ? knots[k - 1].knot : knots[knots.size() - 2].knot - 1;
    const double near = 1e-7 * std::min(knots[k + 1].knot - knots[k].knot, knots[k].knot - before);
    const double left = knots[k].knot - near + (k == 0 ? 1 : 0);
    const auto a = curve.JetAt(left).first.normalized(),
               b = curve.JetAt(knots[k].knot + near).first.normalized();
    most = std::max(most, 2 * std::atan2((a - b).norm(), (a + b).norm()));
  }
  return most;
}

template <int Dim>
void ExpectFitsASpline(unsigned seed) {
  RandomSplines random(seed);
  const bool closed = random.Coin();
  const NurbsCurve<Dim> truth =
      random.Curve<Dim>(5, false, {.highest_multiplicity = 1, .periodic = closed});
  const SplineBasis& basis = truth.basis();
  if (!(SizeOf(truth) > 0)) return;  // a periodic curve of one control point
  const int count = random.Integer(30, 400);
  Eigen::Matrix<double, Dim, Eigen::Dynamic> points(Dim, count);
  for (int k = 0; k < count; ++k) {
    points.col(k) = truth.At(basis.lower() +
                             (basis.upper() - basis.lower()) * k / (closed ? count : count - 1));
  }
  const double tolerance = random.Logarithmic(1e-5, 1e-2) * SizeOf(truth);
  LocalApproximationOptions options;
  options.closed = closed;
  options.corner_angle.reset();
  for (const ApproximationPieces kind : kBoth) {
    options.pieces = kind;
    const LocalApproximation<Dim> result = ApproximateLocally<Dim>(points, tolerance, options);
    ExpectWithin<Dim>(result, points, tolerance);
    EXPECT_EQ(result.curve.basis().periodic(), closed);
    // What the second derivative turns over the distance of both sides.
    EXPECT_LE(LargestTurn(result.curve), 1e-4);
    EXPECT_LE(result.pieces, 2 * count);
  }
}

TEST(LocalApproximationTest, EveryPointIsWithinTheToleranceAndPiecesJoinSmoothly) {
  for (unsigned seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    ExpectFitsASpline<2>(seed);
    ExpectFitsASpline<3>(seed);
  }
}

Eigen::Matrix2Xd Flower(int count, double noise, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  Eigen::Matrix2Xd points(2, count);
  for (int k = 0; k < count; ++k) {
    const double a = 2 * std::numbers::pi * k / count, r = 1 + 0.3 * std::cos(5 * a);
    points.col(k) << r * std::cos(a) + noise * normal(generator),
        r * std::sin(a) + noise * normal(generator);
  }
  return points;
}

TEST(LocalApproximationTest, TheNumberOfPiecesFollowsTheToleranceAndNotThePoints) {
  LocalApproximationOptions options;
  options.closed = true;
  for (const ApproximationPieces kind : kBoth) {
    options.pieces = kind;
    for (const double noise : {0.0, 1e-4}) {
      const auto pieces = [&](int count, double tolerance) {
        const Eigen::Matrix2Xd points = Flower(count, noise, 1);
        const LocalApproximation<2> result = ApproximateLocally<2>(points, tolerance, options);
        ExpectWithin<2>(result, points, tolerance);
        EXPECT_THAT(result.corners, IsEmpty());
        return result.pieces;
      };
      const Eigen::Index few = pieces(1000, 1e-3);
      EXPECT_LE(few, 50);
      EXPECT_LE(pieces(20000, 1e-3), 2 * few);
      EXPECT_LT(pieces(1000, 1e-2), few);
    }
  }
}

TEST(LocalApproximationTest, FewConicsDescribeAnEllipse) {
  Eigen::Matrix3Xd points(3, 500);
  RandomSplines random(4);
  const Eigen::Matrix3d turn = random.Orthogonal();
  for (int k = 0; k < 500; ++k) {
    const double a = 2 * std::numbers::pi * k / 500;
    points.col(k) = turn * Eigen::Vector3d(3 * std::cos(a), std::sin(a), 0);
  }
  LocalApproximationOptions options;
  options.closed = true;
  options.pieces = ApproximationPieces::kConics;
  const LocalApproximation<3> result = ApproximateLocally<3>(points, 1e-4, options);
  ExpectWithin<3>(result, points, 1e-4);
  EXPECT_LE(result.pieces, 8);
}

TEST(LocalApproximationTest, CornersAreFoundAndKept) {
  // Three quarters of a circle and two straight sides: corners at the centre and where they meet
  // the circle.
  const double step = 0.01;
  std::vector<Eigen::Vector2d> shape;
  for (double a = 0; a < 1.5 * std::numbers::pi - step / 2; a += step) {
    shape.emplace_back(std::cos(a), std::sin(a));
  }
  const auto second = static_cast<Eigen::Index>(shape.size());
  for (double t = 1; t > step / 2; t -= step) shape.emplace_back(0, -t);
  const auto third = static_cast<Eigen::Index>(shape.size());
  for (double t = 0; t < 1 - step / 2; t += step) shape.emplace_back(t, 0);
  Eigen::Matrix2Xd points(2, shape.size());
  for (size_t k = 0; k < shape.size(); ++k) points.col(static_cast<Eigen::Index>(k)) = shape[k];
  LocalApproximationOptions options;
  options.closed = true;
  for (const ApproximationPieces kind : kBoth) {
    for (const double tolerance : {1e-5, 1e-3}) {
      for (const double away : {0.0, 1e6}) {
        options.pieces = kind;
        const Eigen::Matrix2Xd moved = points.array() + away;
        const LocalApproximation<2> result = ApproximateLocally<2>(moved, tolerance, options);
        ExpectWithin<2>(result, moved, tolerance);
        EXPECT_THAT(result.corners, ElementsAre(0, second, third));
        EXPECT_LE(result.pieces, tolerance > 1e-4 ? 8 : 20);
        for (const Eigen::Index k : result.corners) {
          EXPECT_LE((result.curve.At(result.parameters[k]) - moved.col(k)).norm(),
                    kRounding * (1 + 1e-3 * away));
        }
      }
    }
  }
  options.corner_angle.reset();
  options.corners = {third};
  EXPECT_THAT(ApproximateLocally<2>(points, 1e-3, options).corners, ElementsAre(third));
}

TEST(LocalApproximationTest, SharpTurnsAreCornersAndNotOutliersOrNoise) {
  Eigen::Matrix2Xd bent(2, 21);
  for (int k = 0; k < 21; ++k) bent.col(k) << std::min(k, 10), std::max(0, k - 10);
  EXPECT_THAT(SharpTurns<2>(bent, false, 0.5, 0), ElementsAre(10));
  EXPECT_THAT(SharpTurns<2>(bent, false, 0.5, 3.5), ElementsAre(10));
  EXPECT_THAT(SharpTurns<2>(bent, false, 1.6, 0), IsEmpty());
  Eigen::Matrix2Xd outlier(2, 21);
  for (int k = 0; k < 21; ++k) outlier.col(k) << k, k == 10 ? 3 : 0;
  EXPECT_THAT(SharpTurns<2>(outlier, false, 0.5, 0), IsEmpty());
  EXPECT_THAT(SharpTurns<2>(Flower(5000, 1e-3, 2), true, 0.5, 2e-2), IsEmpty());
}

TEST(LocalApproximationTest, ATinyToleranceInterpolates) {
  RandomSplines random(9);
  Eigen::Matrix2Xd points(2, 30);
  for (double& x : points.reshaped()) x = random.Real(-1, 1);
  LocalApproximationOptions options;
  options.corner_angle.reset();
  for (const ApproximationPieces kind : kBoth) {
    options.pieces = kind;
    const LocalApproximation<2> result = ApproximateLocally<2>(points, 1e-14, options);
    ExpectWithin<2>(result, points, 1e-14);
    // A cubic has two lengths to choose: one point between its ends may be met.
    EXPECT_GE(result.pieces, kind == ApproximationPieces::kCubics ? 15 : 29);
  }
}

TEST(LocalApproximationTest, UnitsDoNotMatter) {
  const Eigen::Matrix2Xd points = Flower(400, 0, 1);
  for (const ApproximationPieces kind : kBoth) {
    LocalApproximationOptions options;
    options.closed = true;
    options.pieces = kind;
    const LocalApproximation<2> one = ApproximateLocally<2>(points, 1e-3, options);
    for (const double scale : {1e-6, 1024.0, 1e6}) {
      const LocalApproximation<2> other =
          ApproximateLocally<2>(scale * points, scale * 1e-3, options);
      EXPECT_EQ(one.pieces, other.pieces);
      EXPECT_NEAR(other.largest_distance / scale, one.largest_distance, kHalfDigits);
    }
  }
}

TEST(LocalApproximationTest, StraightPointsAreOnePiece) {
  Eigen::Matrix3Xd points(3, 1000);
  for (int k = 0; k < 1000; ++k)
    points.col(k) = Eigen::Vector3d(1, 2, 3) + k * Eigen::Vector3d(1, -1, 0.5);
  for (const ApproximationPieces kind : kBoth) {
    LocalApproximationOptions options;
    options.pieces = kind;
    EXPECT_EQ(ApproximateLocally<3>(points, 1e-6, options).pieces, 1);
    EXPECT_EQ(ApproximateLocally<3>(points.leftCols(2).eval(), 1e-6, options).pieces, 1);
  }
}

TEST(LocalApproximationTest, SaysWhatItCannotDo) {
  const auto error = [](const Eigen::Matrix2Xd& points,
                        double tolerance,
                        const LocalApproximationOptions& options) {
    try {
      ApproximateLocally<2>(points, tolerance, options);
    } catch (const std::invalid_argument& e) {
      return std::string(e.what());
    }
    return std::string("none");
  };
  const Eigen::Matrix2Xd points{{0, 1, 1, 2}, {0, 1, 1, 0}};
  EXPECT_THAT(error(points, 0.1, {}), HasSubstr("points 2 and 3 lie in one place"));
  EXPECT_THAT(error(points.leftCols(2), 0, {}), HasSubstr("tolerance 0 is not positive"));
  EXPECT_THAT(error(points.leftCols(2), 0.1, {.closed = true}), HasSubstr("at least 3"));
  EXPECT_THAT(error(points.leftCols(2), 0.1, {.corner_angle = 4}), HasSubstr("corner angle 4"));
  EXPECT_THAT(error(points.leftCols(2), 0.1, {.corners = {5}}), HasSubstr("no such point"));
}

}  // namespace batten::internal::local_approximation_test
