// SPDX-License-Identifier: MIT
#include "fitting/grid/tensor_grid.h"

#include <algorithm>
#include <limits>

namespace batten::internal {
namespace {

std::vector<double> Different(const Eigen::RowVectorXd& values) {
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  return sorted;
}

Eigen::Index PlaceOf(const std::vector<double>& sorted, double value) {
  return std::lower_bound(sorted.begin(), sorted.end(), value) - sorted.begin();
}

Eigen::VectorXd AsVector(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

}  // namespace

std::optional<GridOrder> FindTensorGrid(const Eigen::Matrix2Xd& parameters, double most_missing) {
  const Eigen::Index count = parameters.cols();
  if (!parameters.allFinite()) return std::nullopt;
  const std::vector<double> us = Different(parameters.row(0)), vs = Different(parameters.row(1));
  const auto rows = static_cast<Eigen::Index>(us.size()),
             columns = static_cast<Eigen::Index>(vs.size());
  constexpr Eigen::Index kMost = std::numeric_limits<int>::max();
  if (rows < 2 || columns < 2 || columns > kMost / rows) return std::nullopt;
  const Eigen::Index cells = rows * columns;
  if (count > cells ||
      static_cast<double>(cells - count) > most_missing * static_cast<double>(cells))
    return std::nullopt;
  std::vector<Eigen::Index> point(static_cast<size_t>(cells), -1);
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::Index cell =
        PlaceOf(us, parameters(0, k)) * columns + PlaceOf(vs, parameters(1, k));
    if (point[static_cast<size_t>(cell)] >= 0) return std::nullopt;
    point[static_cast<size_t>(cell)] = k;
  }
  GridOrder grid{
      static_cast<int>(rows), static_cast<int>(columns), AsVector(us), AsVector(vs), {}, {}};
  if (count < cells) grid.missing = PointMask::Constant(cells, false);
  for (Eigen::Index cell = 0; cell < cells; ++cell) {
    const Eigen::Index k = point[static_cast<size_t>(cell)];
    if (k >= 0) {
      grid.order.push_back(k);
    } else {
      grid.missing[cell] = true;
    }
  }
  return grid;
}

}  // namespace batten::internal
