// SPDX-License-Identifier: MIT
#include "fitting/streaming/height_distances.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "batten/fitting/distances.h"
#include "fitting/parameterization/height_field.h"
#include "tolerances.h"

namespace batten::internal::height_distances_test {

// Heights over a turned plane away from zero; bumps so high that points between them have several
// feet, in cells of uneven size.
struct Heights {
  PlaneBase plane;
  NurbsSurface surface;
};
Heights RandomHeights(int degree, double bumps, std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  PlaneBase plane;
  plane.axes = Eigen::Quaterniond(uniform(random), uniform(random), uniform(random), 2)
                   .normalized()
                   .toRotationMatrix();
  plane.origin = {100, -50, 7};
  plane.length_u = 6;
  plane.length_v = 4;
  const auto basis = [&](double length, int cells) {
    std::vector<double> breaks{0};
    for (int k = 1; k < cells; ++k) breaks.push_back(length * (k + 0.3 * uniform(random)) / cells);
    breaks.push_back(length);
    return SplineBasis::Clamped(degree, breaks);
  };
  const SplineBasis u = basis(6, 12), v = basis(4, 9);
  Eigen::MatrixXd heights(1, u.size() * v.size());
  for (double& height : heights.reshaped()) height = bumps * uniform(random);
  return {plane, HeightSurface(plane, u, v, heights)};
}

TEST(HeightDistancesTest, AreThoseFromTheWholeSurface) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const Heights heights = RandomHeights(1 + seed % 4, seed % 2 == 0 ? 0.05 : 1, random);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform(-0.1, 1.1);
    Eigen::Matrix3Xd points(3, 3000);
    for (Eigen::Index k = 0; k < points.cols(); ++k) {
      const double u = 6 * uniform(random), v = 4 * uniform(random);  // some beside the rectangle
      const double off = (k % 10 == 0 ? 0.7 : 0.02) * normal(random);
      points.col(k) = heights.surface.At(u, v) + off * heights.plane.axes.col(2);
      if (k % 7 == 0) points.col(k) += 0.3 * heights.plane.axes.col(0);
    }
    ThreadPool pool(2), one(1);
    const auto found = HeightDistances::Of(heights.surface, heights.plane, pool);
    ASSERT_TRUE(found);
    const PointDistances expected = DistancesTo(heights.surface, points, pool),
                         quick = found->To(points, pool);
    EXPECT_LT((quick.distances.cwiseAbs() - expected.distances.cwiseAbs()).cwiseAbs().maxCoeff(),
              kIterated);
    EXPECT_EQ(quick.distances, found->To(points, one).distances);
  }
}

TEST(HeightDistancesTest, OtherSurfacesAreLeftToOthers) {
  std::mt19937_64 random(1);
  const Heights heights = RandomHeights(3, 0.1, random);
  ThreadPool pool(1);
  Eigen::Matrix3Xd moved = heights.surface.control_points();
  moved.col(30) += 0.01 * heights.plane.axes.col(0);
  EXPECT_FALSE(
      HeightDistances::Of(NurbsSurface(heights.surface.basis_u(), heights.surface.basis_v(), moved),
                          heights.plane,
                          pool));
}

}  // namespace batten::internal::height_distances_test
