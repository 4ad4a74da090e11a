// SPDX-License-Identifier: MIT
#include "batten/fitting/neighbours.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#include <flann/algorithms/kdtree_single_index.h>
#include <flann/flann.hpp>
#pragma GCC diagnostic pop

namespace batten {

struct NeighbourIndex::Tree {
  using Distance = flann::L2_3D<float>;
  Eigen::Vector3d centre;
  double scale;  // a power of two that brings coordinates near one: floats reach from 1e-38 to 1e38
                 // only

  Eigen::Matrix3Xf Local(const Eigen::Matrix3Xd& world) const {
    return ((world.colwise() - centre) * scale).cast<float>();
  }

  Eigen::Matrix3Xf points;
  std::unique_ptr<flann::KDTreeSingleIndex<Distance>> index;
};

NeighbourIndex::NeighbourIndex(const Eigen::Matrix3Xd& points) : tree_(std::make_unique<Tree>()) {
  if (points.cols() == 0) throw std::invalid_argument("NeighbourIndex: no points");
  tree_->centre = points.rowwise().minCoeff() / 2 + points.rowwise().maxCoeff() / 2;
  const double reach = (points.rowwise().maxCoeff() - tree_->centre).maxCoeff();
  tree_->scale = reach > 0 ? std::exp2(std::clamp(-std::ilogb(reach), -1000, 1000)) : 1;
  tree_->points = tree_->Local(points);
  const flann::Matrix<float> rows(tree_->points.data(), static_cast<size_t>(points.cols()), 3);
  constexpr int kLeafSize = 15;
  constexpr bool kReorder = false;  // a second copy of the points gains little
  tree_->index = std::make_unique<flann::KDTreeSingleIndex<Tree::Distance>>(
      rows, flann::KDTreeSingleIndexParams(kLeafSize, kReorder));
  tree_->index->buildIndex();
}

NeighbourIndex::~NeighbourIndex() = default;
NeighbourIndex::NeighbourIndex(NeighbourIndex&&) noexcept = default;

Eigen::Index NeighbourIndex::size() const { return tree_->points.cols(); }

std::vector<int> NeighbourIndex::Nearest(const Eigen::Matrix3Xd& queries, int k) const {
  k = static_cast<int>(std::min<Eigen::Index>(k, size()));
  Eigen::Matrix3Xf local = tree_->Local(queries);
  const auto rows = static_cast<size_t>(queries.cols());
  std::vector<int> indices(rows * k);
  std::vector<float> distances(rows * k);
  flann::Matrix<int> index_rows(indices.data(), rows, k);
  flann::Matrix<float> distance_rows(distances.data(), rows, k);
  flann::SearchParams parameters(flann::FLANN_CHECKS_UNLIMITED);
  parameters.cores = 1;
  parameters.sorted = true;
  tree_->index->knnSearch(flann::Matrix<float>(local.data(), rows, 3),
                          index_rows,
                          distance_rows,
                          static_cast<size_t>(k),
                          parameters);
  return indices;
}

}  // namespace batten
