// SPDX-License-Identifier: MIT
// How far apart two sets of trim loops are.
#pragma once

#include <gtest/gtest.h>
#include <Eigen/Core>

#include <algorithm>
#include <vector>

#include "batten/geometry/foot_point.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

// The farthest that a place of `a` is from `b`; u and v are scaled to the domain.
inline double OneSidedDistance(const NurbsCurve<2>& a,
                               const NurbsCurve<2>& b,
                               const Eigen::Array2d& sides) {
  constexpr int kPlaces = 24;
  const auto scaled = [&](const NurbsCurve<2>& curve) {
    return NurbsCurve<2>(
        curve.basis(), curve.control_points().array().colwise() / sides, curve.weights());
  };
  const NurbsCurve<2> from = scaled(a);
  const CurveFootPoints<2> onto(scaled(b));
  double worst = 0;
  for (const int span : from.basis().Spans()) {
    const double low = from.basis().knots()[span], high = from.basis().knots()[span + 1];
    for (int i = 0; i <= kPlaces; ++i) {
      Eigen::Vector3d at = Eigen::Vector3d::Zero();
      at.head<2>() = from.At(low + (high - low) * i / kPlaces);
      worst = std::max(worst, onto.Nearest(at).distance);
    }
  }
  return worst;
}

inline double LoopDistance(const NurbsCurve<2>& a,
                           const NurbsCurve<2>& b,
                           const Eigen::Array2d& sides) {
  return std::max(OneSidedDistance(a, b, sides), OneSidedDistance(b, a, sides));
}

// The same number of loops in the same order, each within `tolerance` of the domain.
inline void ExpectSameLoops(const NurbsSurface& read,
                            const NurbsSurface& written,
                            double tolerance) {
  ASSERT_EQ(read.trims().size(), written.trims().size());
  const Eigen::Array2d sides(written.basis_u().upper() - written.basis_u().lower(),
                             written.basis_v().upper() - written.basis_v().lower());
  for (size_t i = 0; i < written.trims().size(); ++i) {
    SCOPED_TRACE(testing::Message() << "loop " << i);
    EXPECT_LE(LoopDistance(read.trims()[i], written.trims()[i], sides), tolerance);
  }
}

}  // namespace batten::internal
