// SPDX-License-Identifier: MIT
// Boxes and curvatures of trimmed surfaces are those of the part that counts.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "batten/geometry/bounding_box.h"
#include "batten/geometry/curvature_range.h"
#include "batten/geometry/make_surface.h"
#include "batten/geometry/transform.h"
#include "tolerances.h"
#include "trim_cases.h"

namespace batten::internal::trimmed_box_test {

NurbsSurface Sheet(RandomSplines& random, double height) {
  const SplineBasis u = SplineBasis::Uniform(3, 8, -1, 5), v = SplineBasis::Uniform(2, 6, 10, 11);
  Eigen::Matrix3Xd points(3, u.size() * v.size());
  for (int i = 0; i < u.size(); ++i) {
    for (int j = 0; j < v.size(); ++j) {
      points.col(i * v.size() + j) << u.Greville(i), 4 * v.Greville(j),
          random.Real(-height, height);
    }
  }
  return NurbsSurface(u, v, points, random.Weights(points.cols(), 0.7, 1.4));
}

TEST(TrimmedBoxTest, OfADiscInAPlaneIsThatOfTheEllipse) {
  const NurbsSurface plane = MakeBilinear({0, 0, 0}, {3, 0, 0}, {0, 2, 0}, {3, 2, 0});
  const NurbsSurface disc = Trimmed(plane, {Circle({0.5, 0.5}, 0.3)});
  const Eigen::AlignedBox3d box = BoundingBox(disc);
  EXPECT_LE((box.min() - Eigen::Vector3d(0.6, 0.4, 0)).norm(), kIterated);
  EXPECT_LE((box.max() - Eigen::Vector3d(2.4, 1.6, 0)).norm(), kIterated);
  // Turned by an angle the half width of the ellipse is √(a² cos² + b² sin²).
  const double angle = 0.7;
  const Eigen::AlignedBox3d turned = BoundingBox(Transformed(disc, Rotation({0, 0, 1}, angle)));
  EXPECT_NEAR(
      turned.sizes()[0] / 2, std::hypot(0.9 * std::cos(angle), 0.6 * std::sin(angle)), kIterated);
}

TEST(TrimmedBoxTest, OfAZoneOfASphereKnowsItsEdgesAndItsTop) {
  const NurbsSurface sphere = MakeSphere({}, 2);
  const Eigen::AlignedBox3d zone = BoundingBox(Trimmed(sphere, {RectangleLoop(0, 1, 0.6, 0.8)}));
  EXPECT_NEAR(zone.min()[2], sphere.At(0, 0.6)[2], kIterated);
  EXPECT_NEAR(zone.max()[2], sphere.At(0, 0.8)[2], kIterated);
  EXPECT_NEAR(zone.max()[0], sphere.At(0, 0.6)[0], kIterated);
  const Eigen::AlignedBox3d disc = BoundingBox(Trimmed(sphere, {Circle({0.5, 0.5}, 0.2)}));
  EXPECT_NEAR(disc.min()[0], -2, kIterated);  // inside the loop, not on it
}

TEST(TrimmedBoxTest, HoldsThePartAndIsTight) {
  for (const unsigned seed : {1u, 2u}) {
    for (const LoopCase& loops : LoopCases(seed)) {
      SCOPED_TRACE(loops.name + ", seed " + std::to_string(seed));
      RandomSplines random(seed);
      const NurbsSurface surface = Trimmed(Sheet(random, 2), loops);
      const Eigen::AlignedBox3d box = BoundingBox(surface);
      const TrimRegion region(surface);
      Eigen::AlignedBox3d seen;
      for (int k = 0; k < 40000; ++k) {
        const double u = random.Parameter(surface.basis_u());
        const double v = random.Parameter(surface.basis_v());
        if (region.Contains(u, v)) seen.extend(surface.At(u, v));
      }
      for (const NurbsCurve<2>& loop : surface.trims()) {
        const Polygon polygon = LoopPolyline(loop, 1e-5);
        for (const Eigen::Vector2d uv : polygon.points.colwise()) {
          seen.extend(surface.At(uv[0], uv[1]));
        }
      }
      for (int d = 0; d < 3; ++d) {
        EXPECT_LE(box.min()[d], seen.min()[d] + kIterated);
        EXPECT_GE(box.max()[d], seen.max()[d] - kIterated);
        // Random places miss an extreme inside by the curvature times their spacing squared.
        EXPECT_GE(box.min()[d], seen.min()[d] - 0.01);
        EXPECT_LE(box.max()[d], seen.max()[d] + 0.01);
      }
    }
  }
}

TEST(TrimmedCurvatureTest, SeesOnlyThePart) {
  // A paraboloid z = x² + y², curvature 2 at its bottom.
  const SplineBasis basis = SplineBasis::Uniform(2, 3, -1, 1);
  Eigen::Matrix3Xd points(3, 9);
  const double x[] = {-1, 0, 1}, square[] = {1, -1, 1};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) points.col(3 * i + j) << x[i], x[j], square[i] + square[j];
  }
  const NurbsSurface bowl(basis, basis, points);
  const auto whole = CurvatureRange(bowl);
  ASSERT_TRUE(whole);
  EXPECT_NEAR(whole->max, 2, kIterated);
  const double r =
      0.5;  // beyond it the meridian's curvature is 2 / (1 + 4 r²)^{3/2}, the greater 2/√(1+4r²)
  const auto rim =
      CurvatureRange(Trimmed(bowl, {RectangleLoop(0, 1, 0, 1), Circle({0.5, 0.5}, r / 2)}));
  ASSERT_TRUE(rim);
  EXPECT_NEAR(rim->max, 2 / std::sqrt(1 + 4 * r * r), kHalfDigits);
  const auto dot = CurvatureRange(Trimmed(bowl, {Circle({0.5, 0.5}, 1e-3)}));
  ASSERT_TRUE(dot);
  EXPECT_NEAR(dot->min, 2 / std::pow(1 + 4 * 4e-6, 1.5), kHalfDigits);
}

}  // namespace batten::internal::trimmed_box_test
