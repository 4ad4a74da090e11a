// SPDX-License-Identifier: MIT
#include "fitting/wings/oriented_normals.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "fitting/neighbours/signed_sets.h"
#include "geometry/numeric/dense_solvers.h"

namespace batten::internal {
namespace {

constexpr double kMostRoughness = 0.5;  // counted in the cost of an edge of the tree

struct TreeEdge {
  double cost;
  int first, second;
};

}  // namespace

OrientedNormals OrientNormals(const Eigen::Matrix3Xd& points, const Neighbourhoods& around) {
  const Eigen::Index count = points.cols();
  OrientedNormals result{Eigen::Matrix3Xd(3, count), Eigen::VectorXd(count)};
  for (Eigen::Index k = 0; k < count; ++k) {
    Eigen::Matrix3Xd near(3, kOfPlane);
    for (int j = 0; j < kOfPlane; ++j) near.col(j) = points.col(around.At(k, j)) - points.col(k);
    const Eigen::Vector3d mean = near.rowwise().mean();
    near.colwise() -= mean;
    const SymmetricEigen3 axes = EigenOf3(near * near.transpose());
    const Eigen::Vector3d squares = axes.values.cwiseMax(0);
    result.normals.col(k) = axes.vectors.col(0);
    result.roughness[k] = squares[1] > 0 ? std::sqrt(squares[0] / squares[1]) : 1;
  }
  std::vector<TreeEdge> edges;
  edges.reserve(static_cast<size_t>(count * (kOfGraph - 1)));
  for (Eigen::Index k = 0; k < count; ++k) {
    for (int j = 1; j < kOfGraph; ++j) {
      const int other = around.At(k, j);
      if (other == k) continue;
      const double turn = 1 - std::abs(result.normals.col(k).dot(result.normals.col(other)));
      const double rough = std::min(result.roughness[k], kMostRoughness) +
                           std::min(result.roughness[other], kMostRoughness);
      const int own = static_cast<int>(k);
      edges.push_back({turn + rough, std::min(own, other), std::max(own, other)});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const TreeEdge& a, const TreeEdge& b) {
    if (a.cost != b.cost) return a.cost < b.cost;
    return a.first != b.first ? a.first < b.first : a.second < b.second;
  });
  SignedSets trees(count);
  for (const auto& [cost, a, b] : edges)
    trees.Join(a, b, result.normals.col(a).dot(result.normals.col(b)) < 0 ? 1 : 0);
  for (Eigen::Index k = 0; k < count; ++k)
    if (trees.Find(static_cast<int>(k)).second != 0) result.normals.col(k) *= -1;
  return result;
}

}  // namespace batten::internal
