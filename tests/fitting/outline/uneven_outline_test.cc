// SPDX-License-Identifier: MIT
// Outlines of clouds whose density differs from place to place.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "batten/fitting/outline.h"
#include "outline_laws.h"
#include "outlined_clouds.h"

namespace batten::internal::outline_test {

// Points of a shape in number about its area, a hundred times denser at one side of its box than
// at the other.
Eigen::Matrix2Xd Thinning(const OutlinedCloud& cloud, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  const auto count = cloud.points.cols();
  Eigen::Matrix2Xd points(2, count);
  for (Eigen::Index k = 0; k < count;) {
    const Eigen::Vector2d p(cloud.length_u * uniform(engine), cloud.length_v * uniform(engine));
    if (cloud.shape.Contains(p) && uniform(engine) < std::pow(100, -p.x() / cloud.length_u))
      points.col(k++) = p;
  }
  return points;
}

// Lines √`ratio` spacings apart, of points 1/√`ratio` apart, that run at an angle.
Eigen::Matrix2Xd Lines(const OutlinedCloud& cloud, double ratio, double angle, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  const double across = std::sqrt(ratio), along = 1 / across;
  const Eigen::Vector2d way(std::cos(angle), std::sin(angle)), over(-way.y(), way.x());
  const double reach = cloud.length_u + cloud.length_v;
  Places points;
  for (double y = -reach; y < reach; y += across)
    for (double x = -reach; x < reach; x += along) {
      const Eigen::Vector2d p =
          (x + along * uniform(engine)) * way + (y + 0.1 * across * uniform(engine)) * over;
      if (cloud.shape.Contains(p)) points.push_back(p);
    }
  Eigen::Matrix2Xd all(2, static_cast<Eigen::Index>(points.size()));
  for (size_t k = 0; k < points.size(); ++k) all.col(static_cast<Eigen::Index>(k)) = points[k];
  return all;
}

// One part, its area right to a local spacing along the border, with so many chance holes at most.
void ExpectOnePart(const OutlinedCloud& cloud,
                   const Eigen::Matrix2Xd& points,
                   double spacing,
                   size_t chance = 0) {
  const OutlineOptions options = OptionsFor(cloud);
  ThreadPool pool(2);
  const Outline outline = FindOutline(points, options, pool);
  EXPECT_EQ(outline.parts, 1);
  ExpectSound(outline, options, points);
  const double area = cloud.shape.Area(), found = outline.fills
                                                      ? options.length_u * options.length_v
                                                      : TotalArea(PolygonsOf(outline));
  EXPECT_LE(outline.loops.size(), cloud.shape.loops.size() + chance);
  EXPECT_NEAR(found, area, spacing * PerimeterOf(cloud.shape.loops));
}

TEST(FindOutlineTest, DensityMayFallAHundredfold) {
  for (const OutlinedShape& shape : {RectangleShape(), DiscShape(), LShape(), RingShape()})
    for (const int count : {5000, 40000})
      for (unsigned seed = 1; seed <= 2; ++seed) {
        SCOPED_TRACE(Told(shape, count, Scatter::kRandom, seed));
        const OutlinedCloud cloud = CloudIn(shape, count, Scatter::kRandom, seed);
        ExpectOnePart(cloud, Thinning(cloud, seed), 1, 2);
      }
}

// Mean distance outside a disc whose density falls a hundredfold along x, over its sparse side and
// in the spacings there.
double OffsetWhereSparse(int count, unsigned seed) {
  const OutlinedCloud cloud = CloudIn(DiscShape(), count, Scatter::kRandom, seed);
  const Eigen::Matrix2Xd points = Thinning(cloud, seed);
  ThreadPool pool(2);
  const Outline outline = FindOutline(points, OptionsFor(cloud), pool);
  const double radius = std::sqrt(count / std::numbers::pi);
  const Eigen::Vector2d centre(cloud.length_u / 2, cloud.length_v / 2);
  const auto part = [&](double x) { return std::pow(100, -x / cloud.length_u); };
  double mean = 0;
  constexpr int kSlices = 1000;
  for (int k = 0; k < kSlices; ++k) {  // over the disc
    const double x = (k + 0.5) / kSlices;
    mean += part(x * cloud.length_u) * 8 / std::numbers::pi * std::sqrt(x - x * x) / kSlices;
  }
  const Places border = PolygonsOf(outline).at(0);
  double sum = 0, all = 0;
  for (const Eigen::Vector2d& p : border) {
    if (p.x() < 0.7 * cloud.length_u) continue;
    sum += ((p - centre).norm() - radius) / std::sqrt(mean / part(p.x()));
    all += 1;
  }
  return sum / all;
}

// Random points end a little inside of their border by the spacing there, and outlines do not.
TEST(FindOutlineTest, IsAsFarOutAsItsPointsAreSparse) {
  double sum = 0;
  constexpr int kSeeds = 6;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const double offset = OffsetWhereSparse(20000, seed);
    EXPECT_NEAR(offset, 0, 0.35) << "seed " << seed;
    sum += offset;
  }
  EXPECT_NEAR(sum / kSeeds, 0, 0.12);
}

TEST(FindOutlineTest, LinesMayBeFarApart) {
  for (const OutlinedShape& shape : {RectangleShape(), DiscShape(), LShape()})
    for (const double ratio : {6.0, 15.0, 40.0, 60.0})
      for (const double angle : {0.0, 0.4}) {
        SCOPED_TRACE(shape.name + ", " + std::to_string(ratio) + " at " + std::to_string(angle));
        const OutlinedCloud cloud = CloudIn(shape, 40000, Scatter::kRandom, 1);
        ExpectOnePart(cloud, Lines(cloud, ratio, angle, 1), 0.5 * std::sqrt(ratio));
      }
}

}  // namespace batten::internal::outline_test
