// SPDX-License-Identifier: MIT
// What holds of outlines of clouds in the plane.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "batten/fitting/outline.h"
#include "outlined_clouds.h"

namespace batten::internal::outline_test {

inline OutlineOptions OptionsFor(const OutlinedCloud& cloud) {
  OutlineOptions options;
  options.spacing = 1;
  options.length_u = cloud.length_u;
  options.length_v = cloud.length_v;
  return options;
}

inline std::vector<Places> PolygonsOf(const Outline& outline) {
  std::vector<Places> polygons;
  for (const OutlineCurve& curve : outline.loops) polygons.push_back(PolygonAlong(curve.loop));
  return polygons;
}

// Readers of CAD files refuse edges of no length.
inline void ExpectEverySpanLong(const NurbsCurve<2>& loop) {
  const int degree = loop.basis().degree();
  for (const int span : loop.basis().Spans()) {
    const auto hull = loop.control_points().middleCols(span - degree, degree + 1);
    EXPECT_FALSE((hull.colwise() - hull.col(0)).isZero(0)) << "span " << span;
  }
}

// What holds of every outline.
inline void ExpectSound(const Outline& outline,
                        const OutlineOptions& options,
                        const Eigen::Matrix2Xd& points) {
  const std::vector<Places> polygons = PolygonsOf(outline);
  double last = 0;
  for (size_t k = 0; k < outline.loops.size(); ++k) {
    const NurbsCurve<2>& loop = outline.loops[k].loop;
    EXPECT_TRUE(loop.basis().clamped());
    EXPECT_EQ(loop.At(loop.basis().lower()), loop.At(loop.basis().upper()));
    ExpectEverySpanLong(loop);
    EXPECT_TRUE(std::is_sorted(outline.loops[k].corners.begin(), outline.loops[k].corners.end()));
    for (const double corner : outline.loops[k].corners)
      EXPECT_GE(loop.basis().Multiplicity(corner), loop.basis().degree());
    const double area = AreaOf(polygons[k]);
    if (k == 0) {
      EXPECT_GT(area, 0);
    } else if (area > 0 ||
               last < 0) {  // outer loops, then holes, by falling area, smoothed a little
      EXPECT_LE(std::abs(area), std::abs(last) * 1.01);
      EXPECT_FALSE(area > 0 && last < 0);
    }
    last = area;
    for (const Eigen::Vector2d& p : polygons[k]) {
      EXPECT_TRUE((p.array() >= -1e-9).all()) << p.transpose();
      EXPECT_TRUE(p.x() <= options.length_u + 1e-9 && p.y() <= options.length_v + 1e-9)
          << p.transpose();
    }
  }
  EXPECT_FALSE(Crossing(polygons));
  // A polygon's side may cut a bulge by less than the hundredth that points are held by.
  if (outline.warnings.empty() && !outline.fills) {
    EXPECT_EQ(PointsBeyond(polygons, points), 0);
  }
}

inline std::string Told(const OutlinedShape& shape, int count, Scatter scatter, unsigned seed) {
  return shape.name + " of " + std::to_string(count) + ", scatter " +
         std::to_string(static_cast<int>(scatter)) + ", seed " + std::to_string(seed);
}

}  // namespace batten::internal::outline_test
