// SPDX-License-Identifier: MIT
// The result of a fit or a comparison as Python holds it.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "batten/fitting/fit_report.h"
#include "batten/fitting/point_mask.h"
#include "batten/fitting/primitive_options.h"
#include "python/core/body.h"
#include "python/core/cloud.h"

namespace batten::python {

struct Fit {
  std::vector<BodyPtr> bodies;
  std::variant<Eigen::Matrix2Xd, Eigen::MatrixXd, Eigen::VectorXd>
      parameters;  // one for each point
  Eigen::VectorXd residuals;
  PointMask outliers;
  std::vector<int> owners = {};  // of several geometries, the one of each point; empty: one
  FitReport report;
  PointsPtr points;
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  std::string command, unit = "mm";
  std::vector<std::string> names = {};
  std::optional<PrimitiveShape> shape = std::nullopt;
};

using FitPtr = std::shared_ptr<Fit>;

// What the report of a fit to points from files says of these, and of their far coordinates.
void Complete(Fit& fit, bool keeps_origin);

}  // namespace batten::python
