// SPDX-License-Identifier: MIT
// What `batten evaluate` says of a curve or surface at a place, as JSON and as lines.
#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "batten/geometry/trim_region.h"
#include "batten/io/geometry_file.h"

namespace batten::internal {

// What is asked at every place.
struct EvaluationQuestion {
  int order = 0;                              // of derivatives
  std::optional<Eigen::Vector3d> along = {};  // a vector, whose parameter velocities are wanted
};

// Point, derivatives and, where asked for, normal, curvature and velocities at a curve's u or a
// surface's u, v, which are in the domain. `region`: what is inside the surface's trims, or null.
nlohmann::ordered_json Evaluation(const Geometry& geometry,
                                  const TrimRegion* region,
                                  const std::vector<double>& at,
                                  const EvaluationQuestion& question);

// The same for a reader: a name and its numbers in columns, a line each.
std::string EvaluationText(const nlohmann::ordered_json& evaluation);

}  // namespace batten::internal
