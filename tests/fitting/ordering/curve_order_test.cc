// SPDX-License-Identifier: MIT
#include "batten/fitting/curve_order.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>
#include <string>

namespace batten::internal::curve_order_test {

using std::numbers::pi;

// A curve on [0, 1] by name.
struct Shape {
  std::string name;
  bool closed;
  int dimension;
  std::function<Eigen::Vector3d(double)> at;
};

Eigen::Vector3d Corner(const std::vector<Eigen::Vector2d>& corners, double t) {
  const auto sides = static_cast<double>(corners.size() - 1);
  const auto side = std::min(static_cast<size_t>(t * sides), corners.size() - 2);
  const double s = t * sides - static_cast<double>(side);
  Eigen::Vector3d place(0, 0, 0);
  place.head<2>() = (1 - s) * corners[side] + s * corners[side + 1];
  return place;
}

std::vector<Shape> SmoothShapes() {
  return {
      {"circle",
       true,
       2,
       [](double t) { return Eigen::Vector3d(std::cos(2 * pi * t), std::sin(2 * pi * t), 0); }},
      {"ellipse",
       true,
       2,
       [](double t) {
         return Eigen::Vector3d(2 * std::cos(2 * pi * t), 0.7 * std::sin(2 * pi * t), 0);
       }},
      {"flower",
       true,
       2,
       [](double t) {
         const double r = 1 + 0.25 * std::cos(5 * 2 * pi * t);
         return Eigen::Vector3d(r * std::cos(2 * pi * t), r * std::sin(2 * pi * t), 0);
       }},
      {"arc",
       false,
       2,
       [](double t) { return Eigen::Vector3d(std::cos(4 * t), std::sin(4 * t), 0); }},
      {"wave", false, 2, [](double t) { return Eigen::Vector3d(4 * t, std::sin(7 * t), 0); }},
      {"spiral",
       false,
       2,
       [](double t) {
         const double a = 2 * pi * (0.5 + 2 * t);
         return Eigen::Vector3d(0.15 * a * std::cos(a), 0.15 * a * std::sin(a), 0);
       }},
      {"helix",
       false,
       3,
       [](double t) { return Eigen::Vector3d(std::cos(13 * t), std::sin(13 * t), 2.5 * t); }},
      {"trefoil",
       true,
       3,
       [](double t) {
         const double a = 2 * pi * t;
         return Eigen::Vector3d(std::sin(a) / 2 + std::sin(2 * a),
                                std::cos(a) / 2 - std::cos(2 * a),
                                -std::sin(3 * a) / 2);
       }},
  };
}

std::vector<Shape> SharpShapes() {
  return {
      {"square",
       true,
       2,
       [](double t) {
         return Corner({{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}}, t);
       }},
      {"wedge of 10 degrees",
       true,
       2,
       [](double t) {
         const double s = 0.5 + 0.5 * std::cos(2 * pi * t);  // x, 1 at the edge
         const double y = 0.0875 * (1 - s) * std::sqrt(s);
         return Eigen::Vector3d(s, t < 0.5 ? y : -y, 0);
       }},
      {"staircase",
       false,
       2,
       [](double t) {
         return Corner({{0, 0}, {1, 0}, {1, 1}, {2, 1}, {2, 2}, {3, 2}}, t);
       }},
  };
}

// How points are spread over a curve.
enum class Spread { kEven, kRandom, kUneven };

struct Sample {
  PointCloud cloud;
  Eigen::VectorXd arcs;  // of the true places
  double length = 0;
};

constexpr int kDense = 20000;

// Points at parameters that are even in arc length, random, or ten times denser at one end.
Sample SampleOf(const Shape& shape, int count, double noise, Spread spread, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> normal(0, 1);
  Eigen::VectorXd along = Eigen::VectorXd::Zero(kDense + 1);
  for (int i = 1; i <= kDense; ++i) {
    along[i] =
        along[i - 1] + (shape.at(i / double{kDense}) - shape.at((i - 1) / double{kDense})).norm();
  }
  Sample sample;
  sample.length = along[kDense];
  std::vector<double> arcs;
  for (int k = 0; k < count; ++k) {
    double s = (k + 0.0) / (shape.closed ? count : count - 1);
    if (spread == Spread::kRandom) s = uniform(random);
    if (spread == Spread::kUneven) {
      s = uniform(random);
      s = shape.closed ? s - 0.9 * std::sin(2 * pi * s) / (2 * pi)
                       : (0.1 * s + 0.45 * s * s) / 0.55;
    }
    arcs.push_back(std::min(s, 1.0) * sample.length);
  }
  std::shuffle(arcs.begin(), arcs.end(), random);
  sample.arcs = Eigen::Map<Eigen::VectorXd>(arcs.data(), count);
  Eigen::Matrix3Xd points(3, count);
  for (int k = 0; k < count; ++k) {
    const auto i = std::clamp<Eigen::Index>(
        std::upper_bound(along.begin(), along.end(), arcs[k]) - along.begin() - 1, 0, kDense - 1);
    const double t =
        (static_cast<double>(i) + (arcs[k] - along[i]) / (along[i + 1] - along[i])) / kDense;
    points.col(k) = shape.at(t);
    for (int d = 0; d < shape.dimension; ++d) points(d, k) += noise * normal(random);
  }
  sample.cloud = PointCloud(points, Eigen::Vector3d::Zero(), shape.dimension);
  return sample;
}

CurveOrder Ordered(const PointCloud& cloud, ClosedChoice closed = ClosedChoice::kAuto) {
  ThreadPool pool(2);
  try {
    return OrderAlongCurves(cloud, {.closed = closed}, pool);
  } catch (const std::invalid_argument& error) {
    ADD_FAILURE() << error.what();
    return {};
  }
}

// The largest step backwards in the true order; infinity when the curve is not run through once.
double WorstStepBack(const Sample& sample, const CurvePath& path) {
  double forward = 0, back = 0, total = 0;
  const size_t count = path.points.size();
  for (size_t i = 1; i < count + path.closed; ++i) {
    double step = sample.arcs[path.points[i % count]] - sample.arcs[path.points[i - 1]];
    if (path.closed) step = std::remainder(step, sample.length);
    total += step;
    forward = std::max(forward, step);
    back = std::max(back, -step);
  }
  const double once = std::abs(total) / sample.length;
  if (once < 0.8 || once > 1.01) return std::numeric_limits<double>::infinity();
  return total > 0 ? back : forward;
}

void ExpectOrdered(const Shape& shape,
                   const Sample& sample,
                   double noise,
                   const CurveOrder& order) {
  ASSERT_EQ(order.paths.size(), 1u);
  const CurvePath& path = order.paths[0];
  EXPECT_EQ(path.closed, shape.closed);
  // Sides of a wedge that are closer than points along them cannot be told apart.
  const double sharp = shape.name == "wedge of 10 degrees" ? 3 : 0;
  EXPECT_LE(order.outliers.size(),
            noise > 0 || sharp > 0 ? 0.002 * static_cast<double>(sample.arcs.size()) : 0);
  EXPECT_EQ(path.points.size() + order.outliers.size(), static_cast<size_t>(sample.arcs.size()));
  EXPECT_TRUE(std::is_sorted(path.parameters.begin(), path.parameters.end()));
  EXPECT_NEAR(path.length, sample.length, 0.05 * sample.length + 3 * noise);
  // Two points may be exchanged by their noise along the curve and by what the noise of both makes
  // of the guide's direction; ten is beyond what happens in so many draws.
  EXPECT_LE(WorstStepBack(sample, path), 10 * noise + (sharp + (noise > 0)) * path.spacing);
}

TEST(LongOrderAlongCurvesTest, FindsTheOrderOfExactPoints) {
  std::vector<Shape> shapes = SmoothShapes();
  for (const Shape& shape : SharpShapes()) shapes.push_back(shape);
  for (const Shape& shape : shapes) {
    for (const int count : {60, 200, 1500, 6000}) {
      for (const Spread spread : {Spread::kEven, Spread::kRandom, Spread::kUneven}) {
        if (spread != Spread::kEven && count < 1500) continue;
        SCOPED_TRACE(shape.name + " " + std::to_string(count) + " " +
                     std::to_string(static_cast<int>(spread)));
        const Sample sample = SampleOf(shape, count, 0, spread, count);
        ExpectOrdered(shape, sample, 0, Ordered(sample.cloud));
      }
    }
  }
}

TEST(LongOrderAlongCurvesTest, FindsTheOrderOfNoisyPoints) {
  for (const Shape& shape : SmoothShapes()) {
    for (const int count : {300, 2000, 10000}) {
      for (const double noise : {1e-4, 1e-3, 5e-3, 2e-2}) {
        for (const Spread spread : {Spread::kEven, Spread::kRandom, Spread::kUneven}) {
          if (spread == Spread::kUneven && count < 2000) continue;
          SCOPED_TRACE(shape.name + " " + std::to_string(count) + " noise " +
                       std::to_string(noise) + " " + std::to_string(static_cast<int>(spread)));
          const Sample sample = SampleOf(shape, count, noise, spread, count + 1);
          ExpectOrdered(shape, sample, noise, Ordered(sample.cloud));
        }
      }
    }
  }
}

PointCloud Together(const std::vector<PointCloud>& clouds) {
  Eigen::Index count = 0;
  int dimension = 2;
  for (const PointCloud& cloud : clouds) {
    count += cloud.size();
    dimension = std::max(dimension, cloud.dimension());
  }
  Eigen::Matrix3Xd points(3, count);
  Eigen::Index next = 0;
  for (const PointCloud& cloud : clouds) {
    points.middleCols(next, cloud.size()) = cloud.points();
    next += cloud.size();
  }
  return PointCloud(points, Eigen::Vector3d::Zero(), dimension);
}

PointCloud Placed(const PointCloud& cloud, double scale, const Eigen::Vector3d& shift) {
  return PointCloud(
      (scale * cloud.points()).colwise() + shift, Eigen::Vector3d::Zero(), cloud.dimension());
}

Shape Line(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  return {"line", false, from[2] == 0 && to[2] == 0 ? 2 : 3, [=](double t) -> Eigen::Vector3d {
            return from + t * (to - from);
          }};
}

TEST(LongOrderAlongCurvesTest, RefusesBranchesAndSaysWhere) {
  struct Case {
    std::string name;
    std::vector<Shape> parts;
    Eigen::Vector3d place;
  };
  const auto turned = [](double degrees, double length) {
    return Eigen::Vector3d(
        length * std::cos(degrees * pi / 180), length * std::sin(degrees * pi / 180), 0);
  };
  const Eigen::Vector3d zero(0, 0, 0);
  const std::vector<Case> cases = {
      {"T", {Line({-1, 0, 0}, {1, 0, 0}), Line(zero, {0, 1, 0})}, zero},
      {"Y",
       {Line(zero, turned(90, 1)), Line(zero, turned(210, 1)), Line(zero, turned(330, 1))},
       zero},
      {"X", {Line({-1, 0, 0}, {1, 0, 0}), Line({0, -1, 0}, {0, 1, 0})}, zero},
      {"X of 40 degrees", {Line({-1, 0, 0}, {1, 0, 0}), Line(turned(220, 1), turned(40, 1))}, zero},
      {"figure eight",
       {{"eight",
         true,
         2,
         [](double t) {
           return Eigen::Vector3d(std::sin(2 * pi * t), std::sin(4 * pi * t) / 2, 0);
         }}},
       zero},
      {"T in space", {Line({-1, 0, 0}, {1, 0, 0}), Line(zero, {0, 0.5, 0.8})}, zero},
      {"loop with a tail",
       {{"circle",
         true,
         2,
         [](double t) {
           return Eigen::Vector3d(1 + std::cos(2 * pi * t), std::sin(2 * pi * t), 0);
         }},
        Line({-2, 0, 0}, zero)},
       zero},
  };
  for (const Case& test : cases) {
    for (const int count : {60, 300, 3000}) {
      for (const double noise : {0.0, 2e-3, 1e-2}) {
        for (const Spread spread : {Spread::kEven, Spread::kRandom}) {
          // So few random points do not show the crossing.
          if (count == 60 && noise == 1e-2 && spread == Spread::kRandom) continue;
          SCOPED_TRACE(test.name + " " + std::to_string(count) + " noise " + std::to_string(noise) +
                       " " + std::to_string(static_cast<int>(spread)));
          std::vector<PointCloud> parts;
          double length = 0;
          for (const Shape& part : test.parts) {
            const Sample sample = SampleOf(part, count, noise, spread, 7 * count + parts.size());
            parts.push_back(sample.cloud);
            length += sample.length;
          }
          const PointCloud cloud = Together(parts);
          const Eigen::Vector3d origin(5e6, -4e6, cloud.dimension() == 3 ? 100 : 0);
          const PointCloud far(cloud.points(), origin, cloud.dimension());
          ThreadPool pool(2);
          try {
            const CurveOrder order = OrderAlongCurves(far, {}, pool);
            ADD_FAILURE() << order.paths.size() << " paths, closed " << order.paths[0].closed
                          << ", outliers " << order.outliers.size();
          } catch (const std::invalid_argument& error) {
            const std::string text = error.what();
            ASSERT_NE(text.find("the points branch near ("), std::string::npos) << text;
            Eigen::Vector3d place = origin;
            const char* at = text.c_str() + text.find('(') + 1;
            for (int d = 0; d < cloud.dimension(); ++d) {
              char* end = nullptr;
              place[d] = std::strtod(at, &end);
              at = end + 1;
            }
            const double spacing = length / static_cast<double>(cloud.size());
            EXPECT_LE((place - origin - test.place).norm(), 6 * spacing + 12 * noise) << text;
          }
        }
      }
    }
  }
}

TEST(OrderAlongCurvesTest, TellsComponentsApart) {
  const std::vector<Shape> shapes = SmoothShapes();
  for (const int count : {200, 3000}) {
    for (const double noise : {0.0, 1e-3, 1e-2}) {
      SCOPED_TRACE(std::to_string(count) + " noise " + std::to_string(noise));
      const PointCloud cloud = Together(
          {Placed(SampleOf(shapes[0], count, noise, Spread::kEven, 1).cloud, 1, {0, 0, 0}),
           Placed(
               SampleOf(shapes[0], count / 2, 2 * noise, Spread::kEven, 2).cloud, 0.5, {0.1, 0, 0}),
           Placed(SampleOf(shapes[2], count, noise, Spread::kEven, 3).cloud, 1, {3, 0, 0}),
           Placed(SampleOf(shapes[3], count, noise, Spread::kEven, 4).cloud, 1, {0, 4, 0})});
      const CurveOrder order = Ordered(cloud);
      ASSERT_EQ(order.paths.size(), 4u);
      std::vector<bool> closed;
      double last = std::numeric_limits<double>::infinity();
      for (const CurvePath& path : order.paths) {
        EXPECT_LE(path.length, last);
        last = path.length;
        closed.push_back(path.closed);
      }
      EXPECT_THAT(closed, testing::ElementsAre(true, true, false, true));
      EXPECT_LE(order.outliers.size(), 0.002 * static_cast<double>(cloud.size()));
    }
  }
}

TEST(OrderAlongCurvesTest, KeepsApartStrandsFourSpacingsOrNoiseWidthsAway) {
  for (const double noise : {0.0, 5e-3}) {
    for (const int count : {100, 400, 4000}) {
      SCOPED_TRACE(std::to_string(count) + " noise " + std::to_string(noise));
      const double apart = std::max(4 * 2.0 / count, 16 * noise);
      const PointCloud cloud = Together(
          {SampleOf(Line({0, 0, 0}, {2, 0, 0}), count, noise, Spread::kEven, 1).cloud,
           SampleOf(Line({0.5, apart, 0}, {2.5, apart, 0}), count, noise, Spread::kEven, 2).cloud});
      const CurveOrder order = Ordered(cloud);
      ASSERT_EQ(order.paths.size(), 2u);
      for (const CurvePath& path : order.paths) EXPECT_FALSE(path.closed);
    }
  }
}

TEST(LongOrderAlongCurvesTest, FindsTheOrderAmongGrossOutliers) {
  for (const Shape& shape : SmoothShapes()) {
    for (const double noise : {0.0, 2e-3, 1e-2}) {
      for (const double share : {0.05, 0.3}) {
        SCOPED_TRACE(shape.name + " noise " + std::to_string(noise) + " share " +
                     std::to_string(share));
        constexpr int kCount = 3000;
        Sample sample = SampleOf(shape, kCount, noise, Spread::kRandom, 5);
        const auto extra = static_cast<int>(kCount * share / (1 - share));
        std::mt19937 random(17);
        std::uniform_real_distribution<double> uniform(0, 1);
        const Eigen::Vector3d low = sample.cloud.points().rowwise().minCoeff();
        const Eigen::Vector3d high = sample.cloud.points().rowwise().maxCoeff();
        Eigen::Matrix3Xd points(3, kCount + extra);
        points.leftCols(kCount) = sample.cloud.points();
        for (int k = kCount; k < kCount + extra; ++k) {
          for (int d = 0; d < 3; ++d) points(d, k) = low[d] + uniform(random) * (high[d] - low[d]);
        }
        if (shape.dimension == 2) points.row(2).setZero();
        const CurveOrder order =
            Ordered(PointCloud(points, Eigen::Vector3d::Zero(), shape.dimension));
        EXPECT_EQ(order.paths.size(), 1u);
        if (order.paths.empty()) continue;
        EXPECT_EQ(order.paths[0].closed, shape.closed);
        CurvePath good = order.paths[0];
        std::erase_if(good.points, [&](Eigen::Index k) { return k >= kCount; });
        EXPECT_GE(good.points.size(), 0.98 * kCount);
        EXPECT_LE(order.paths[0].points.size() - good.points.size(), 0.3 * extra);
        EXPECT_LE(WorstStepBack(sample, good), 20 * noise + 0.02 * sample.length);
      }
    }
  }
}

TEST(OrderAlongCurvesTest, OrdersFewPoints) {
  const std::vector<Shape> shapes = SmoothShapes();
  for (const int count : {4, 5, 6, 8, 12, 20}) {
    SCOPED_TRACE(count);
    const Sample circle = SampleOf(shapes[0], count, 0, Spread::kEven, count);
    const CurveOrder order = Ordered(circle.cloud);
    ASSERT_EQ(order.paths.size(), 1u);
    EXPECT_TRUE(order.paths[0].closed);
    EXPECT_EQ(order.paths[0].points.size(), static_cast<size_t>(count));
    EXPECT_EQ(WorstStepBack(circle, order.paths[0]), 0);
  }
  for (const double angle : {1.0, 2.0, 4.0, 5.0}) {
    for (const int count : {2, 3, 5, 8, 20}) {
      if (angle / (count - 1) > 1) continue;
      SCOPED_TRACE(std::to_string(count) + " angle " + std::to_string(angle));
      const Shape arc{"arc", false, 2, [=](double t) {
                        return Eigen::Vector3d(std::cos(angle * t), std::sin(angle * t), 0);
                      }};
      const Sample sample = SampleOf(arc, count, 0, Spread::kEven, count);
      const CurveOrder order = Ordered(sample.cloud);
      ASSERT_EQ(order.paths.size(), 1u);
      EXPECT_FALSE(order.paths[0].closed);
      EXPECT_EQ(order.paths[0].points.size(), static_cast<size_t>(count));
      EXPECT_EQ(WorstStepBack(sample, order.paths[0]), 0);
      EXPECT_NEAR(order.paths[0].gap, 2 * std::sin(angle / 2), 1e-12);
    }
  }
}

TEST(OrderAlongCurvesTest, DoesNotDependOnTheOrderOfThePoints) {
  for (const Shape& shape : SmoothShapes()) {
    for (const double noise : {0.0, 1e-2}) {
      SCOPED_TRACE(shape.name + " noise " + std::to_string(noise));
      const Sample sample = SampleOf(shape, 1500, noise, Spread::kRandom, 9);
      std::vector<Eigen::Index> order(1500);
      std::iota(order.begin(), order.end(), 0);
      std::shuffle(order.begin(), order.end(), std::mt19937(10));
      const PointCloud shuffled = sample.cloud.Picked(order);
      const CurveOrder first = Ordered(sample.cloud), second = Ordered(shuffled);
      ASSERT_EQ(first.paths.size(), second.paths.size());
      for (size_t p = 0; p < first.paths.size(); ++p) {
        EXPECT_EQ(first.paths[p].parameters, second.paths[p].parameters);
        EXPECT_EQ(first.paths[p].guide, second.paths[p].guide);
        std::vector<Eigen::Index> back = second.paths[p].points;
        for (Eigen::Index& k : back) k = order[k];
        EXPECT_EQ(first.paths[p].points, back);
      }
    }
  }
}

TEST(OrderAlongCurvesTest, CurvesAreEvidentAndPathsThroughASurfaceAreNot) {
  for (const Shape& shape : SmoothShapes()) {
    for (const double noise : {0.0, 1e-2}) {
      const Sample sample = SampleOf(shape, 1500, noise, Spread::kRandom, 11);
      EXPECT_TRUE(Ordered(sample.cloud).evident) << shape.name << ' ' << noise;
    }
  }
  std::mt19937 random(12);
  std::normal_distribution<double> normal(0, 1);
  for (const bool flat : {false, true}) {
    Eigen::Matrix3Xd points(3, 2000);
    for (double& coordinate : points.reshaped()) coordinate = normal(random);
    if (flat) points.row(2) *= 1e-3;
    if (!flat) points.colwise().normalize();
    ThreadPool pool(1);
    try {
      EXPECT_FALSE(OrderAlongCurves(PointCloud(points), {}, pool).evident) << flat;
    } catch (const std::invalid_argument&) {  // a refusal is as good
    }
  }
}

TEST(LongOrderAlongCurvesTest, MovesWithItsPoints) {
  std::mt19937 random(4);
  std::normal_distribution<double> normal(0, 1);
  for (const Shape& shape : SmoothShapes()) {
    for (const double noise : {0.0, 1e-2}) {
      for (const double unit : {1e-6, 1.0, 1e6}) {
        SCOPED_TRACE(shape.name + " noise " + std::to_string(noise) + " unit " +
                     std::to_string(unit));
        const Sample sample = SampleOf(shape, 1500, noise, Spread::kRandom, 11);
        Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
        if (shape.dimension == 3) {
          turn = Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
                     .normalized()
                     .toRotationMatrix();
        } else {
          turn = Eigen::AngleAxisd(normal(random), Eigen::Vector3d::UnitZ()).toRotationMatrix();
        }
        // So far away, coordinates are exact to 1e-9 of the size.
        const Eigen::Vector3d shift = Eigen::Vector3d(5e6, -3e6, 0) * unit;
        const PointCloud moved((unit * turn * sample.cloud.points()).colwise() + shift,
                               Eigen::Vector3d::Zero(),
                               shape.dimension);
        Sample other = sample;
        other.cloud = moved;
        const CurveOrder order = Ordered(moved);
        ASSERT_EQ(order.paths.size(), 1u);
        EXPECT_EQ(order.paths[0].closed, shape.closed);
        EXPECT_LE(WorstStepBack(other, order.paths[0]), 10 * noise + 1e-8);
        const CurveOrder still = Ordered(sample.cloud);
        // Turning and rounding decide which of close points become nodes.
        EXPECT_NEAR(order.paths[0].length / unit, still.paths[0].length, 1e-5 + noise);
        EXPECT_NEAR(order.paths[0].noise / unit, still.paths[0].noise, 1e-6 + 0.1 * noise);
        EXPECT_NEAR(still.paths[0].noise, noise, 0.1 * noise);
      }
    }
  }
}

TEST(OrderAlongCurvesTest, BridgesAGapWhoseEndsFaceEachOther) {
  const auto arc = [](double angle) {
    return Shape{"arc", false, 2, [=](double t) {
                   return Eigen::Vector3d(std::cos(angle * t), std::sin(angle * t), 0);
                 }};
  };
  for (const int count : {100, 1000}) {
    for (const double noise : {0.0, 5e-3}) {
      SCOPED_TRACE(std::to_string(count) + " noise " + std::to_string(noise));
      const Sample nearly = SampleOf(arc(2 * pi - 0.45), count, noise, Spread::kEven, 1);
      const CurveOrder closed = Ordered(nearly.cloud);
      EXPECT_TRUE(closed.paths[0].closed);
      EXPECT_NEAR(closed.paths[0].gap, 2 * std::sin(0.225), 8 * noise + 1e-12);
      const Sample wide = SampleOf(arc(2 * pi - 0.8), count, noise, Spread::kEven, 1);
      EXPECT_FALSE(Ordered(wide.cloud).paths[0].closed);
      const CurveOrder forced = Ordered(wide.cloud, ClosedChoice::kYes);
      EXPECT_TRUE(forced.paths[0].closed);
      EXPECT_NEAR(forced.paths[0].gap, 2 * std::sin(0.4), 8 * noise + 1e-12);
      const CurveOrder opened = Ordered(nearly.cloud, ClosedChoice::kNo);
      EXPECT_FALSE(opened.paths[0].closed);
      EXPECT_NEAR(opened.paths[0].gap, 2 * std::sin(0.225), 8 * noise + 1e-12);
      EXPECT_NEAR(opened.paths[0].length, nearly.length, 0.02 * nearly.length);
      EXPECT_EQ(opened.paths[0].parameters[0], 0);
      EXPECT_LE(WorstStepBack(nearly, opened.paths[0]), 10 * noise);
    }
  }
}

TEST(OrderAlongCurvesTest, KeepsDuplicatesTogetherAndLeavesStraysOut) {
  const Sample sample = SampleOf(SmoothShapes()[2], 500, 0, Spread::kEven, 3);
  Eigen::Matrix3Xd points(3, 1004);
  points << sample.cloud.points(), sample.cloud.points(), Eigen::Vector3d(5, 5, 0),
      Eigen::Vector3d(5, 5.01, 0), Eigen::Vector3d(-4, 0, 0), Eigen::Vector3d(0, 0, 0);
  const CurveOrder order = Ordered(PointCloud(points, Eigen::Vector3d::Zero(), 2));
  ASSERT_EQ(order.paths.size(), 1u);
  EXPECT_THAT(order.outliers, testing::ElementsAre(1000, 1001, 1002, 1003));
  const CurvePath& path = order.paths[0];
  ASSERT_EQ(path.points.size(), 1000u);
  for (size_t i = 0; i < 1000; i += 2) {
    EXPECT_EQ(path.points[i] % 500, path.points[i + 1] % 500);
    EXPECT_EQ(path.parameters[i], path.parameters[i + 1]);
  }
}

TEST(OrderAlongCurvesTest, RefusesFewerThanTwoPlaces) {
  EXPECT_THROW(
      {
        ThreadPool pool(1);
        OrderAlongCurves(PointCloud(Eigen::Matrix3Xd::Ones(3, 7)), {}, pool);
      },
      std::invalid_argument);
  ThreadPool pool(1);
  EXPECT_THROW(OrderAlongCurves(PointCloud(), {}, pool), std::invalid_argument);
  EXPECT_THROW(OrderAlongCurves(PointCloud(Eigen::Matrix3Xd::Random(3, 50)),
                                {},
                                pool,
                                [](const char*, double) { return false; }),
               Cancelled);
}

// Points of sizes that differ by many orders: there is a path, or a refusal.
TEST(OrderAlongCurvesTest, FindsAPathOrRefuses) {
  for (unsigned seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> power(0, 20);
    Eigen::Matrix3Xd points(3, 3 + seed % 40);
    for (auto point : points.colwise()) {
      point << normal(random), normal(random), normal(random);
      if (random() % 5 == 0) point *= std::pow(10, power(random));
    }
    ThreadPool pool(1);
    try {
      const CurveOrder order = OrderAlongCurves(PointCloud::FromWorld(points), {}, pool);
      ASSERT_FALSE(order.paths.empty());
      for (const CurvePath& path : order.paths) EXPECT_TRUE(path.guide.allFinite());
    } catch (const std::invalid_argument&) {
    }
  }
}

// Most points are a rounding error away from another, so that the links between nodes are short;
// the guide needs no more nodes than there are points.
TEST(OrderAlongCurvesTest, TakesPointsThatAgreeButForRounding) {
  for (const unsigned seed : {1u, 2u, 3u, 4u, 5u}) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, 60);
    for (int k = 0; k < 60; ++k) {
      points.col(k) << (k % 2), 0.5 * (k % 2), 0;
      for (int d = 0; d < 3; ++d) points(d, k) += 1e-15 * normal(random);
    }
    try {
      const CurveOrder order = Ordered(PointCloud(points));
      for (const CurvePath& path : order.paths) {
        EXPECT_TRUE(path.guide.allFinite());
        EXPECT_TRUE(path.parameters.allFinite());
        EXPECT_LE(path.guide.cols(), 61);
      }
    } catch (const std::invalid_argument&) {
    }
  }
}

}  // namespace batten::internal::curve_order_test
