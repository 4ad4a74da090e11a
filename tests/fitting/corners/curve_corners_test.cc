// SPDX-License-Identifier: MIT
#include "fitting/corners/curve_corners.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

namespace batten::internal::curve_corners_test {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kTight = 1e-9;  // exact places, from differences of numbers near 1

// Points with their chord lengths, and the gap that closes them.
struct Outline {
  Matrix3Xd points;
  VectorXd parameters;
  double period = 0;
};

Outline Of(const std::vector<Vector3d>& points) {
  Outline outline{Matrix3Xd(3, points.size()), VectorXd(points.size()), 0};
  for (size_t k = 0; k < points.size(); ++k) {
    const auto i = static_cast<Index>(k);
    outline.points.col(i) = points[k];
    outline.parameters[i] =
        k == 0 ? 0 : outline.parameters[i - 1] + (points[k] - points[k - 1]).norm();
  }
  outline.period =
      outline.parameters[outline.parameters.size() - 1] + (points.front() - points.back()).norm();
  return outline;
}

std::vector<CurveCorner> Corners(const Outline& outline, bool closed, double noise = 0) {
  return FindCorners(outline.points,
                     outline.parameters,
                     {.noise = noise, .closed = closed, .period = outline.period});
}

// A polyline by arc length.
class Polyline {
 public:
  explicit Polyline(std::vector<Vector3d> corners) : corners_(std::move(corners)) {
    for (size_t k = 1; k < corners_.size(); ++k)
      lengths_.push_back(lengths_.back() + (corners_[k] - corners_[k - 1]).norm());
  }

  double length() const { return lengths_.back(); }
  const std::vector<double>& corner_parameters() const { return lengths_; }

  Vector3d At(double s) const {
    const auto above = std::upper_bound(lengths_.begin() + 1, lengths_.end() - 1, s);
    const auto k = static_cast<size_t>(above - lengths_.begin());
    const double share = (s - lengths_[k - 1]) / (lengths_[k] - lengths_[k - 1]);
    return corners_[k - 1] + share * (corners_[k] - corners_[k - 1]);
  }

  // `count` points of a closed polyline, the first at `offset` of a step.
  std::vector<Vector3d> Around(int count, double offset) const {
    std::vector<Vector3d> points;
    for (int k = 0; k < count; ++k) points.push_back(At((k + offset) * length() / count));
    return points;
  }

 private:
  std::vector<Vector3d> corners_;
  std::vector<double> lengths_{0};
};

const Polyline& Rectangle() {
  static const Polyline rectangle({{0, 0, 0}, {4, 0, 0}, {4, 2, 0}, {0, 2, 0}, {0, 0, 0}});
  return rectangle;
}

// Samples of a smooth curve by arc length with noise of so many spacings.
Outline Sampled(const std::function<Vector3d(double)>& curve,
                int count,
                bool closed,
                double noise,
                bool plane,
                std::mt19937& generator) {
  std::vector<Vector3d> dense;
  for (int k = 0; k <= 20000; ++k) dense.push_back(curve(k / 20000.0));
  const Polyline line(dense);
  std::normal_distribution<double> normal;
  const double sigma = noise * line.length() / count;
  Outline outline{Matrix3Xd(3, count), VectorXd(count), line.length()};
  for (Index k = 0; k < count; ++k) {
    outline.parameters[k] = line.length() * static_cast<double>(k) / (closed ? count : count - 1);
    outline.points.col(k) =
        line.At(outline.parameters[k]) +
        sigma * Vector3d(normal(generator), normal(generator), plane ? 0 : normal(generator));
  }
  return outline;
}

Vector3d Flower(double s) {
  const double angle = 2 * std::numbers::pi * s, radius = 1 + 0.25 * std::cos(5 * angle);
  return radius * Vector3d(std::cos(angle), std::sin(angle), 0);
}

Vector3d Ellipse(double s) {
  const double angle = 2 * std::numbers::pi * s;
  return {10 * std::cos(angle), std::sin(angle), 0};
}

Vector3d Helix(double s) {
  const double angle = 8 * std::numbers::pi * s;
  return {1.3 * std::cos(angle), 1.3 * std::sin(angle), 2 * s};
}

TEST(CurveCornersTest, CornersOfARectangleAreFoundWhereverItsPointsLie) {
  for (const int count : {24, 61, 300}) {
    for (int shift = 0; shift < 20; ++shift) {
      SCOPED_TRACE(std::to_string(count) + " points, shift " + std::to_string(shift));
      const Outline outline = Of(Rectangle().Around(count, shift / 20.0));
      const std::vector<CurveCorner> corners = Corners(outline, true);
      ASSERT_EQ(corners.size(), 4u);
      for (const CurveCorner& corner : corners) {
        EXPECT_NEAR(corner.angle, 90 * kDegree, 3 * kDegree);  // a cut tip bends what it touches
        const double x = std::min(std::abs(corner.place.x()), std::abs(corner.place.x() - 4)),
                     y = std::min(std::abs(corner.place.y()), std::abs(corner.place.y() - 2));
        EXPECT_LT(std::hypot(x, y), 0.06 * 12 / count);  // snapped to points within 5 % of a gap
      }
    }
  }
}

TEST(CurveCornersTest, ThreePointsASideAreEnough) {
  const Polyline triangle({{0, 0, 0}, {1, 0, 0}, {0.5, 0.9, 0}, {0, 0, 0}});
  EXPECT_EQ(Corners(Of(triangle.Around(9, 0.5)), true).size(), 3u);
  std::vector<Vector3d> points;
  const Vector3d tips[3] = {{0, 0, 0}, {1, 0, 0}, {0.5, 0.9, 0}};
  for (int side = 0; side < 3; ++side) {
    points.push_back(tips[side]);
    points.push_back(0.5 * (tips[side] + tips[(side + 1) % 3]));
  }
  const std::vector<CurveCorner> corners = Corners(Of(points), true);
  ASSERT_EQ(corners.size(), 3u);
  for (int k = 0; k < 3; ++k) EXPECT_EQ(corners[static_cast<size_t>(k)].place, tips[k]);
}

TEST(CurveCornersTest, ASharpTrailingEdgeIsACornerAtTheSeamAndTheRoundNoseIsNone) {
  // A symmetric wing section of 12 %, NACA 0012 with a closed edge: 2.5 degrees of half angle… its
  // nose has a radius of 0.0158 and turns by 180 degrees within a few of 2·n points.
  const auto half = [](double x) {
    return 0.6 * (0.2969 * std::sqrt(x) - 0.126 * x - 0.3516 * x * x + 0.2843 * x * x * x -
                  0.1036 * x * x * x * x);
  };
  for (const int n : {15, 20, 30, 60, 150}) {
    SCOPED_TRACE(n);
    std::vector<Vector3d> points;
    for (int k = -n; k < n; ++k) {
      const double x = 0.5 * (1 - std::cos(std::numbers::pi * std::abs(k) / n));
      points.push_back({x, k < 0 ? half(x) : -half(x), 0});
    }
    const std::vector<CurveCorner> corners = Corners(Of(points), true);
    ASSERT_EQ(corners.size(), 1u);
    EXPECT_EQ(corners[0].parameter, 0);
    EXPECT_NEAR(corners[0].place.x(), 1, kTight);
    EXPECT_GT(corners[0].angle, 155 * kDegree);
    EXPECT_TRUE(Corners(Of(points), false).empty());
  }
}

TEST(CurveCornersTest, RoundsOfTwoSpacingsAreSmoothAndOfATenthAreCorners) {
  for (const double radius : {0.1, 0.3, 2.0, 3.0, 6.0}) {
    for (int shift = 0; shift < 20; ++shift) {
      SCOPED_TRACE(std::to_string(radius) + ", shift " + std::to_string(shift));
      const double straight = 20 - 2 * radius, arc = radius * std::numbers::pi / 2,
                   side = straight + arc;
      const int count = static_cast<int>(4 * side);
      std::vector<Vector3d> points;
      for (int k = 0; k < count; ++k) {
        const double s = (k + shift / 20.0) * 4 * side / count;
        const int turn = static_cast<int>(s / side) % 4;
        const double rest = s - turn * side, f = (rest - straight) / radius;
        const Vector3d place =
            rest < straight
                ? Vector3d(radius + rest, 0, 0)
                : Vector3d(20 - radius + radius * std::sin(f), radius - radius * std::cos(f), 0);
        points.push_back(Eigen::AngleAxisd(turn * std::numbers::pi / 2, Vector3d::UnitZ()) *
                         (place - Vector3d(10, 10, 0)));
      }
      EXPECT_EQ(Corners(Of(points), true).size(), radius < 1 ? 4u : 0u);
    }
  }
}

TEST(CurveCornersTest, SingleOutliersAreNoCornersAndHideNone) {
  std::mt19937 generator(3);
  std::vector<Vector3d> points = Rectangle().Around(200, 0.0);
  for (size_t k = 12; k < points.size(); k += 33) points[k] += Vector3d(0.3, 0.7, 0);
  EXPECT_EQ(Corners(Of(points), true).size(), 4u);
}

TEST(CurveCornersTest, UnitsPlaceRotationOrderAndStartDoNotMatter) {
  std::mt19937 generator(11);
  for (const double noise : {0.0, 0.5}) {
    std::vector<Vector3d> points = Rectangle().Around(600, 0.3);
    std::normal_distribution<double> normal;
    for (Vector3d& point : points)
      point += noise * 0.02 * Vector3d(normal(generator), normal(generator), 0);
    Outline outline{Of(points).points, VectorXd(600), 12};
    for (Index k = 0; k < 600; ++k) outline.parameters[k] = 0.02 * static_cast<double>(k);
    const double sigma = noise * 0.02;
    const std::vector<CurveCorner> corners = Corners(outline, true, sigma);
    ASSERT_EQ(corners.size(), 4u);

    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(1.1, Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
    for (const double scale : {1e-6, 1.0, 1e6}) {
      Outline moved = outline;
      moved.points = ((scale * turn) * outline.points).colwise() + scale * Vector3d(5e4, 3, -2e4);
      moved.parameters *= scale;
      moved.period *= scale;
      const std::vector<CurveCorner> same = Corners(moved, true, scale * sigma);
      ASSERT_EQ(same.size(), 4u) << "scale " << scale << " noise " << noise;
      for (size_t k = 0; k < 4; ++k) {
        // Exact: 1e-16 of 5e4 against steps of 0.02. With noise rounding may decide which of two
        // windows measures a corner, both to a fraction of the noise.
        const double near = noise > 0 ? 0.01 : 1e-6;
        EXPECT_NEAR(same[k].parameter, scale * corners[k].parameter, near * scale);
        EXPECT_NEAR(same[k].angle, corners[k].angle, 5 * near);
      }
    }

    Outline back = outline;
    for (Index k = 0; k < 600; ++k) back.points.col(k) = outline.points.col(599 - k);
    const std::vector<CurveCorner> reversed = Corners(back, true, sigma);
    ASSERT_EQ(reversed.size(), 4u);
    Outline shifted = outline;
    for (Index k = 0; k < 600; ++k) shifted.points.col(k) = outline.points.col((k + 217) % 600);
    const std::vector<CurveCorner> later = Corners(shifted, true, sigma);
    ASSERT_EQ(later.size(), 4u);
    // Windows begin elsewhere, which moves a place by less than the noise and a spacing.
    for (const std::vector<CurveCorner>& others : {reversed, later}) {
      for (const CurveCorner& corner : corners) {
        double nearest = 1;
        for (const CurveCorner& other : others)
          nearest = std::min(nearest, (other.place - corner.place).norm());
        EXPECT_LT(nearest, noise > 0 ? 0.02 : kTight);
      }
    }
  }
}

TEST(CurveCornersTest, NoisyRectanglesHaveFourCornersAtTheirPlaces) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 generator(seed);
    for (const double noise : {0.1, 1.0, 4.0}) {
      SCOPED_TRACE("noise of spacings " + std::to_string(noise));
      const auto curve = [](double s) { return Rectangle().At(std::fmod(12 * s + 1, 12)); };
      const Outline outline = Sampled(curve, 3000, true, noise, true, generator);
      const double spacing = outline.period / 3000;
      const std::vector<CurveCorner> corners = Corners(outline, true, noise * spacing);
      ASSERT_EQ(corners.size(), 4u);
      for (const CurveCorner& corner : corners) {
        const double x = std::min(std::abs(corner.place.x()), std::abs(corner.place.x() - 4)),
                     y = std::min(std::abs(corner.place.y()), std::abs(corner.place.y() - 2));
        EXPECT_LT(std::hypot(x, y), std::max(1.0, 3 * noise) * spacing);
        EXPECT_NEAR(corner.angle, 90 * kDegree, 15 * kDegree);
      }
    }
  }
}

TEST(CurveCornersTest, DenseNoisySmoothCurvesHaveNone) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 generator(seed);
    for (const double noise : {0.01, 0.3, 1.0, 3.0}) {
      SCOPED_TRACE("noise of spacings " + std::to_string(noise));
      for (const auto& curve : {Flower, Ellipse, Helix}) {
        const Outline outline =
            Sampled(curve, 10000, curve != Helix, noise, curve != Helix, generator);
        EXPECT_TRUE(Corners(outline, curve != Helix, noise * outline.period / 10000).empty());
      }
    }
  }
}

TEST(CurveCornersTest, SmoothCurvesOfFewPointsHaveNone) {
  // The ellipse is left out where its tips are narrower than the noise: those are corners then.
  int corners = 0;
  for (unsigned seed = 0; seed < 6; ++seed) {
    std::mt19937 generator(seed);
    for (const int count : {500, 2000}) {
      for (const double noise : {0.05, 0.3, 1.0}) {
        for (const auto& curve : {Flower, Ellipse, Helix}) {
          const bool closed = curve != Helix;
          const Outline outline = Sampled(curve, count, closed, noise, closed, generator);
          corners +=
              static_cast<int>(Corners(outline, closed, noise * outline.period / count).size());
        }
      }
    }
  }
  EXPECT_LE(corners, 1);  // of 108 curves
}

TEST(CurveCornersTest, UnderstatedNoiseMakesNoCorners) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 generator(seed);
    for (const double share : {0.0, 0.03, 0.3}) {
      SCOPED_TRACE("share " + std::to_string(share));
      const Outline helix = Sampled(Helix, 5000, false, 0.5, false, generator);
      EXPECT_TRUE(Corners(helix, false, share * 0.5 * helix.period / 5000).empty());
      const auto curve = [](double s) { return Rectangle().At(std::fmod(12 * s + 1, 12)); };
      const Outline outline = Sampled(curve, 3000, true, 0.5, true, generator);
      EXPECT_EQ(Corners(outline, true, share * 0.5 * outline.period / 3000).size(), 4u);
    }
  }
}

TEST(CurveCornersTest, ExactZigzagsOfShortSidesAreNotTakenForNoise) {
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> shift(-0.3, 0.3);
  for (const int side : {3, 4, 5, 6, 12}) {
    SCOPED_TRACE(std::to_string(side) + " points a side");
    std::vector<Vector3d> points;
    Vector3d tip(0, 0, 0);
    for (int k = 0; k < 100; ++k) {
      const double angle = k % 2 == 0 ? 0 : 1.2;
      const Vector3d direction(std::cos(angle), std::sin(angle), 0);
      for (int i = 0; i < side; ++i)
        points.push_back(tip + (i + (i > 0 ? shift(generator) : 0.0)) * direction);
      tip += side * direction;
    }
    EXPECT_EQ(Corners(Of(points), false).size(), 99u);
  }
}

TEST(CurveCornersTest, ManyPointsKeepTheCornerAtTheSeam) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 generator(seed);
    for (const int count : {1000, 30000}) {
      for (const double noise : {0.03, 0.1, 1.0}) {
        SCOPED_TRACE(std::to_string(count) + " points, noise of spacings " + std::to_string(noise));
        const auto curve = [](double s) { return Rectangle().At(12 * s); };
        const Outline outline = Sampled(curve, count, true, noise, true, generator);
        const double spacing = outline.period / count;
        const std::vector<CurveCorner> corners = Corners(outline, true, noise * spacing);
        ASSERT_EQ(corners.size(), 4u);
        double nearest = 1;
        for (const CurveCorner& corner : corners) nearest = std::min(nearest, corner.place.norm());
        EXPECT_LT(nearest, std::max(1.0, 3 * noise) * spacing);
      }
    }
  }
}

TEST(CurveCornersTest, LittleDataHasNoCorners) {
  const std::vector<Vector3d> few = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  for (size_t count = 2; count <= few.size(); ++count) {
    for (const double noise : {0.0, 0.1}) {
      const Outline outline = Of({few.begin(), few.begin() + static_cast<std::ptrdiff_t>(count)});
      EXPECT_TRUE(Corners(outline, false, noise).empty());
      EXPECT_TRUE(Corners(outline, true, noise).empty());
    }
  }
  EXPECT_TRUE(FindCorners(Matrix3Xd(3, 0), VectorXd(0)).empty());
  EXPECT_TRUE(FindCorners(Matrix3Xd::Zero(3, 20), VectorXd::LinSpaced(20, 0, 1)).empty());
}

TEST(CurveCornersTest, BrokenInputIsRefused) {
  const Outline outline = Of(Rectangle().Around(16, 0));
  const auto refuses = [&](const VectorXd& parameters, const CornerOptions& options) {
    EXPECT_THROW(FindCorners(outline.points, parameters, options), std::invalid_argument);
  };
  refuses(outline.parameters.head(5), {});
  refuses(outline.parameters.reverse(), {});
  refuses(outline.parameters, {.noise = -1});
  refuses(outline.parameters, {.closed = true});
  refuses(outline.parameters, {.closed = true, .period = 3});
  refuses(outline.parameters, {.least_angle = 0});
  refuses(outline.parameters, {.least_angle = 4});
}

}  // namespace batten::internal::curve_corners_test
