// SPDX-License-Identifier: MIT
#include "batten/fitting/point_cloud.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

namespace batten {
namespace {

void RequireFit(Eigen::Index count, Eigen::Index points, const char* field) {
  if (count != 0 && count != points) {
    throw std::invalid_argument(std::string("PointCloud: ") + field + " has " +
                                std::to_string(count) + " entries for " + std::to_string(points) +
                                " points");
  }
}

void RequireFinite(bool finite, const char* field) {
  if (!finite) throw std::invalid_argument(std::string("PointCloud: ") + field + " is not finite");
}

// A multiple of a power of two not above the extent, near the middle of the range: its few digits
// make the subtraction exact wherever the input's own digits allow. Zero where the range is near
// zero.
double RoundOrigin(double low, double high) {
  const double middle = low / 2 + high / 2, extent = high - low;
  if (std::abs(middle) <= 16 * extent || middle == 0) return 0;
  const double unit = extent > 0 ? std::exp2(std::floor(std::log2(extent)))
                                 : std::exp2(std::floor(std::log2(std::abs(middle))));
  return std::round(middle / unit) * unit;
}

}  // namespace

PointCloud::PointCloud(Eigen::Matrix3Xd points, Eigen::Vector3d origin, int dimension)
    : points_(std::move(points)), origin_(std::move(origin)), dimension_(dimension) {
  if (dimension_ != 2 && dimension_ != 3) {
    throw std::invalid_argument("PointCloud: dimension must be 2 or 3");
  }
  RequireFinite(points_.allFinite(), "a point");
  RequireFinite(origin_.allFinite(), "the origin");
}

PointCloud PointCloud::FromWorld(Eigen::Matrix3Xd points, int dimension) {
  RequireFinite(points.allFinite(), "a point");
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  if (points.cols() > 0) {
    const Eigen::Vector3d low = points.rowwise().minCoeff(), high = points.rowwise().maxCoeff();
    for (int d = 0; d < 3; ++d) origin[d] = RoundOrigin(low[d], high[d]);
    if (!origin.isZero(0)) points.colwise() -= origin;
  }
  return PointCloud(std::move(points), origin, dimension);
}

void PointCloud::set_normals(Eigen::Matrix3Xd normals) {
  RequireFit(normals.cols(), size(), "normals");
  RequireFinite(normals.allFinite(), "a normal");
  normals_ = std::move(normals);
}

void PointCloud::set_weights(Eigen::VectorXd weights) {
  RequireFit(weights.size(), size(), "weights");
  RequireFinite(weights.allFinite(), "a weight");
  if (weights.size() > 0 && !(weights.minCoeff() > 0)) {
    throw std::invalid_argument("PointCloud: a weight is not positive");
  }
  weights_ = std::move(weights);
}

void PointCloud::set_colours(Colours colours) {
  RequireFit(colours.cols(), size(), "colours");
  colours_ = std::move(colours);
}

void PointCloud::set_parameters(Eigen::Matrix2Xd parameters) {
  RequireFit(parameters.cols(), size(), "parameters");
  RequireFinite(parameters.allFinite(), "a parameter");
  parameters_ = std::move(parameters);
}

PointCloud PointCloud::Subset(const Eigen::Array<bool, Eigen::Dynamic, 1>& keep) const {
  if (keep.size() != size()) {
    throw std::invalid_argument("PointCloud::Subset: the mask has " + std::to_string(keep.size()) +
                                " entries for " + std::to_string(size()) + " points");
  }
  std::vector<Eigen::Index> kept;
  for (Eigen::Index k = 0; k < size(); ++k) {
    if (keep[k]) kept.push_back(k);
  }
  return Picked(kept);
}

PointCloud PointCloud::Picked(const std::vector<Eigen::Index>& kept) const {
  PointCloud result(points_(Eigen::all, kept), origin_, dimension_);
  if (normals_.cols() > 0) result.normals_ = normals_(Eigen::all, kept);
  if (weights_.size() > 0) result.weights_ = weights_(kept);
  if (colours_.cols() > 0) result.colours_ = colours_(Eigen::all, kept);
  if (parameters_.cols() > 0) result.parameters_ = parameters_(Eigen::all, kept);
  return result;
}

MergedCloud MergeDuplicates(const PointCloud& cloud) {
  const Eigen::Index m = cloud.size();
  const Eigen::Matrix3Xd& p = cloud.points();
  std::vector<Eigen::Index> order(m);
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
    for (int d = 0; d < 3; ++d) {
      if (p(d, a) != p(d, b)) return p(d, a) < p(d, b);
    }
    return a < b;
  });
  Eigen::VectorXd weights =
      cloud.weights().size() > 0 ? cloud.weights() : Eigen::VectorXd::Ones(m).eval();
  MergedCloud result;
  std::vector<Eigen::Index> first(static_cast<size_t>(m));  // the point that stands for this one
  Eigen::Array<bool, Eigen::Dynamic, 1> keep =
      Eigen::Array<bool, Eigen::Dynamic, 1>::Constant(m, true);
  for (Eigen::Index i = 0; i < m;) {
    Eigen::Index j = i;
    for (; j < m && p.col(order[j]) == p.col(order[i]); ++j) {
      first[order[j]] = order[i];
      if (j == i) continue;
      weights[order[i]] += weights[order[j]];
      keep[order[j]] = false;
      ++result.duplicates;
    }
    i = j;
  }
  std::vector<Eigen::Index> rank(static_cast<size_t>(m));
  Eigen::Index kept = 0;
  for (Eigen::Index k = 0; k < m; ++k) rank[k] = keep[k] ? kept++ : kept;
  result.place.resize(static_cast<size_t>(m));
  for (Eigen::Index k = 0; k < m; ++k) result.place[k] = rank[first[k]];
  result.cloud = cloud;
  if (result.duplicates > 0) {
    result.cloud.set_weights(std::move(weights));
    result.cloud = result.cloud.Subset(keep);
  }
  return result;
}

}  // namespace batten
