// SPDX-License-Identifier: MIT
// Point clouds in double precision, relative to a local origin.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

namespace batten {

// m points with optional normals, weights, colours and parameters. Coordinates are kept relative to
// `origin`, so that georeferenced points keep their last digits in every later subtraction; point k
// is origin() + points().col(k). All values are finite and sizes agree.
class PointCloud {
 public:
  using Colours = Eigen::Matrix<std::uint8_t, 3, Eigen::Dynamic>;

  PointCloud() = default;

  // Points relative to `origin` (3 × m, the data's units; plane clouds have z = 0 and dimension 2).
  // Throws std::invalid_argument when something is not finite.
  explicit PointCloud(Eigen::Matrix3Xd points,
                      Eigen::Vector3d origin = Eigen::Vector3d::Zero(),
                      int dimension = 3);

  // Makes a cloud from world coordinates by subtracting an origin: a round number near the middle
  // where the cloud is far from zero relative to its size, else zero; the subtraction loses no
  // input digits. Works in place.
  static PointCloud FromWorld(Eigen::Matrix3Xd points, int dimension = 3);

  Eigen::Index size() const { return points_->cols(); }
  int dimension() const { return dimension_; }
  const Eigen::Matrix3Xd& points() const { return *points_; }
  const Eigen::Vector3d& origin() const { return origin_; }
  Eigen::Vector3d World(Eigen::Index k) const { return origin_ + points_->col(k); }

  // Attributes: each empty, or one per point.
  const Eigen::Matrix3Xd& normals() const { return normals_; }        // zero: none here
  const Eigen::VectorXd& weights() const { return weights_; }         // positive
  const Colours& colours() const { return colours_; }                 // 0 … 255
  const Eigen::Matrix2Xd& parameters() const { return parameters_; }  // given (u,v)

  // Each throws std::invalid_argument unless it is empty or fits the points and is finite.
  void set_normals(Eigen::Matrix3Xd normals);
  void set_weights(Eigen::VectorXd weights);
  void set_colours(Colours colours);
  void set_parameters(Eigen::Matrix2Xd parameters);

  // The points whose mask is set, with their attributes.
  PointCloud Subset(const Eigen::Array<bool, Eigen::Dynamic, 1>& keep) const;

  // The points of these indices, in this order, with their attributes.
  PointCloud Picked(const std::vector<Eigen::Index>& indices) const;

 private:
  // Copies of a cloud share its points; one that was moved from has none and may only be assigned.
  std::shared_ptr<const Eigen::Matrix3Xd> points_ = std::make_shared<Eigen::Matrix3Xd>(3, 0);
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
  int dimension_ = 3;
  Eigen::Matrix3Xd normals_ = Eigen::Matrix3Xd(3, 0);
  Eigen::VectorXd weights_;
  Colours colours_ = Colours(3, 0);
  Eigen::Matrix2Xd parameters_ = Eigen::Matrix2Xd(2, 0);
};

// A cloud with exact duplicates merged: one point for each place, weights added, the first point's
// normal, colour and parameters kept, order kept. O(m log m).
struct MergedCloud {
  PointCloud cloud;
  Eigen::Index duplicates = 0;      // points merged into another one
  std::vector<Eigen::Index> place;  // for every point given, the merged point that stands for it
};
MergedCloud MergeDuplicates(const PointCloud& cloud);

}  // namespace batten
