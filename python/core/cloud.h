// SPDX-License-Identifier: MIT
// A point cloud as Python holds it, with what is known of the files it came from.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "batten/fitting/fit_report.h"
#include "batten/fitting/point_cloud.h"

namespace batten::python {

struct Points {
  PointCloud cloud;
  std::vector<std::string> files = {};  // none: from memory
  Eigen::Index points_in_file = 0, non_finite = 0, filtered = 0;
  std::optional<InputMesh> mesh = {};
  std::vector<Eigen::Index> missing = {};
  std::vector<std::string> fields = {}, remarks = {};
  double read_seconds = 0;
};

using PointsPtr = std::shared_ptr<Points>;

}  // namespace batten::python
