// SPDX-License-Identifier: MIT
// The result of a fit or a comparison as Python holds it.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "batten/fitting/fit_estimator.h"
#include "batten/fitting/fit_report.h"
#include "batten/fitting/point_mask.h"
#include "batten/io/report_json.h"
#include "python/core/body.h"
#include "python/core/cloud.h"
#include "python/core/options.h"

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
  FitEstimator estimator = {};
  ReportChecks checks = {};
};

using FitPtr = std::shared_ptr<Fit>;

// Its command and unit, and what the report says of points from files and of far coordinates.
void Complete(Fit& fit, const Keywords& keywords, bool keeps_origin);

// All but the bodies of what the library found for these points.
template <typename Found>
void Take(Found& found, const PointsPtr& points, const Keywords& keywords, Fit& fit) {
  fit.parameters = std::move(found.parameters);
  fit.residuals = std::move(found.residuals);
  fit.outliers = std::move(found.outliers);
  fit.report = std::move(found.report);
  if constexpr (requires { found.estimator; }) fit.estimator = std::move(found.estimator);
  fit.points = points;
  keywords.Take("shift", fit.shift);
  Complete(fit, keywords, !keywords.Has("shift"));
}

}  // namespace batten::python
