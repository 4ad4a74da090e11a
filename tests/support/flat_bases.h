// SPDX-License-Identifier: MIT
// Bases of sheets whose lengths are known.
#pragma once

#include <Eigen/Core>
#include <numeric>
#include <vector>

#include "bent_sheets.h"
#include "fitting/parameterization/parameterization.h"

namespace batten::internal {

inline std::vector<Eigen::Index> AllOf(const Eigen::Matrix3Xd& points) {
  std::vector<Eigen::Index> all(static_cast<size_t>(points.cols()));
  std::iota(all.begin(), all.end(), 0);
  return all;
}

// Parameters brought into a base's domain.
inline Eigen::Matrix2Xd Inside(const Parameterization& base, const Eigen::Matrix2Xd& parameters) {
  Eigen::Matrix2Xd inside = parameters.cwiseMax(0.0);
  inside.row(0) = inside.row(0).cwiseMin(base.length_u);
  inside.row(1) = inside.row(1).cwiseMin(base.length_v);
  return inside;
}

// A developable sheet laid out by its own lengths; the sheet's square is a rectangle of them.
inline Parameterization FlatBase(const BentSheet& sheet, const SheetPoints& cloud) {
  Parameterization base;
  base.length_u = sheet.flat(1, 0)[0];
  base.length_v = sheet.flat(0, 1)[1];
  base.parameters.resize(2, cloud.parameters.cols());
  for (Eigen::Index k = 0; k < cloud.parameters.cols(); ++k)
    base.parameters.col(k) = sheet.flat(cloud.parameters(0, k), cloud.parameters(1, k));
  return base;
}

inline Parameterization InUnit(double unit, Parameterization base) {
  base.length_u *= unit;
  base.length_v *= unit;
  base.parameters *= unit;
  return base;
}

}  // namespace batten::internal
