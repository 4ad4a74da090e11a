// SPDX-License-Identifier: MIT
#include "fitting/least_squares/net_values.h"

#include <optional>

#include "fitting/core/shared_constants.h"
#include "fitting/least_squares/net_kernel.h"
#include "geometry/evaluation/evaluation_table.h"

namespace batten::internal {
namespace {

constexpr Eigen::Index kReadBehind = 4;  // numbers the kernel reads beyond the last plane

}  // namespace

Eigen::MatrixXd NetValues(const SplineBasis& outer,
                          const SplineBasis* inner,
                          const Eigen::MatrixXd& net,
                          PointRows points,
                          ThreadPool& pool) {
  const AxisStorage outer_axis(outer, 0);
  std::optional<AxisStorage> inner_axis;
  if (inner) inner_axis.emplace(*inner, 0);
  Eigen::VectorXd planes = Eigen::VectorXd::Zero(net.size() + kReadBehind);
  planes.head(net.size()).reshaped(net.cols(), net.rows()) = net.transpose();
  points.dimension = static_cast<int>(net.rows());
  Eigen::MatrixXd values(net.rows(), points.count);
  pool.For(points.count, kPointsPerTask, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    EvaluateNet(outer_axis.table(),
                inner_axis ? &inner_axis->table() : nullptr,
                {planes.data(), net.cols(), inner ? inner->size() : 1},
                points,
                begin,
                end,
                values.data());
  });
  return values;
}

}  // namespace batten::internal
