// SPDX-License-Identifier: MIT
#include "batten/fitting/grid_data.h"

#include <Eigen/Geometry>
#include <stdexcept>

#include "fitting/core/rounding.h"

namespace batten {

void Check(const PointNet& net, const std::string& what) {
  const auto reject = [&](const std::string& rule) {
    throw std::invalid_argument(what + ": " + rule);
  };
  const std::string size = std::to_string(net.rows) + " x " + std::to_string(net.columns);
  if (net.rows < 2 || net.columns < 2) {
    reject("a grid needs at least 2 rows of 2 points; this one is " + size);
  }
  if (net.points.cols() != Eigen::Index{net.rows} * net.columns) {
    reject("a grid of " + size + " takes " + std::to_string(Eigen::Index{net.rows} * net.columns) +
           " points; there are " + std::to_string(net.points.cols()));
  }
  if (net.missing.size() != 0 && net.missing.size() != net.points.cols()) {
    reject("the mask of missing cells has " + std::to_string(net.missing.size()) +
           " values for a grid of " + size);
  }
  for (Eigen::Index k = 0; k < net.points.cols(); ++k) {
    if (net.points.col(k).allFinite()) continue;
    reject("the point in row " + std::to_string(k / net.columns + 1) + ", column " +
           std::to_string(k % net.columns + 1) + " is not finite");
  }
}

void RequireComplete(const PointNet& net, const std::string& what) {
  Check(net, what);
  if (net.complete()) return;
  throw std::invalid_argument("the grid has " + std::to_string(net.missing.count()) +
                              " missing cells: a tensor product needs a point in each");
}

Eigen::Vector3d MiddleOf(const PointNet& net) {
  Eigen::AlignedBox3d box;
  for (Eigen::Index k = 0; k < net.points.cols(); ++k) {
    if (net.missing.size() == 0 || !net.missing[k]) box.extend(net.points.col(k));
  }
  if (box.isEmpty()) return Eigen::Vector3d::Zero();
  return box.min() / 2 + box.max() / 2;
}

CollapsedLines CollapsedLinesOf(const PointNet& net) {
  const double near =
      internal::kRelativeRounding *
      (net.points.rowwise().maxCoeff() - net.points.rowwise().minCoeff()).maxCoeff();
  const auto one_place = [&](Eigen::Index first, Eigen::Index count, Eigen::Index step) {
    for (Eigen::Index k = 1; k < count; ++k) {
      const Eigen::Vector3d apart = net.points.col(first + k * step) - net.points.col(first);
      if (!(apart.cwiseAbs().maxCoeff() <= near)) return false;
    }
    return true;
  };
  const Eigen::Index rows = net.rows, columns = net.columns;
  return {one_place(0, columns, 1),
          one_place((rows - 1) * columns, columns, 1),
          one_place(0, rows, columns),
          one_place(columns - 1, rows, columns)};
}

void Collapse(const CollapsedLines& poles, int size_u, int size_v, Eigen::Matrix3Xd& control) {
  const auto collapse = [&](bool pole, Eigen::Index first, Eigen::Index count, Eigen::Index step) {
    for (Eigen::Index k = 1; pole && k < count; ++k) {
      control.col(first + k * step) = control.col(first);
    }
  };
  collapse(poles.first_row, 0, size_v, 1);
  collapse(poles.last_row, Eigen::Index{size_u - 1} * size_v, size_v, 1);
  collapse(poles.first_column, 0, size_u, size_v);
  collapse(poles.last_column, size_v - 1, size_u, size_v);
}

PointNet Transposed(const PointNet& net) {
  PointNet turned{net.columns, net.rows, Eigen::Matrix3Xd(3, net.points.cols()), {}};
  if (net.missing.size() > 0) turned.missing.resize(net.missing.size());
  for (int i = 0; i < net.rows; ++i) {
    for (int j = 0; j < net.columns; ++j) {
      const Eigen::Index from = Eigen::Index{i} * net.columns + j,
                         to = Eigen::Index{j} * net.rows + i;
      turned.points.col(to) = net.points.col(from);
      if (net.missing.size() > 0) turned.missing[to] = net.missing[from];
    }
  }
  return turned;
}

}  // namespace batten
