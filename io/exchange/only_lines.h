// SPDX-License-Identifier: MIT
// Whether a file holds lines alone. Not installed.
#pragma once

#include <algorithm>
#include <variant>
#include <vector>

#include "batten/io/geometry_types.h"

namespace batten::internal {

// Whether all are curves of two control points.
inline bool OnlyLines(const std::vector<Geometry>& geometry) {
  return std::all_of(geometry.begin(), geometry.end(), [](const Geometry& one) {
    const auto* curve = std::get_if<NurbsCurve<3>>(&one);
    return curve && curve->basis().degree() == 1 && curve->basis().size() == 2;
  });
}

}  // namespace batten::internal
