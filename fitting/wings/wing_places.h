// SPDX-License-Identifier: MIT
// Points of a thin section in its frame.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/thread_pool.h"
#include "fitting/wings/sheet_sides.h"
#include "fitting/wings/wing_frame.h"

namespace batten::internal {

inline constexpr double kClearThickness = 8;  // noises: where sections are thicker, sides are clear

struct WingPlaces {
  std::vector<WingPlace> places;
  std::vector<int> side;  // 1 upper, −1 lower, 0 not told

  const WingPlace& At(Eigen::Index k) const { return places[static_cast<size_t>(k)]; }
  int SideOf(Eigen::Index k) const { return side[static_cast<size_t>(k)]; }
};

// O(m).
WingPlaces PlacesIn(const WingFrame& frame,
                    const Eigen::Matrix3Xd& points,
                    const SheetSides& sides,
                    ThreadPool& pool);

}  // namespace batten::internal
