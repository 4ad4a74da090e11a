// SPDX-License-Identifier: MIT
#include "geometry/joining/hole_net.h"

#include <utility>

#include "batten/geometry/split.h"

namespace batten::internal {

HoleNet::HoleNet(const std::vector<NurbsCurve<3>>& sides, int spans)
    : sides_(static_cast<int>(sides.size())),
      basis_(SplineBasis::Uniform(
          sides[0].basis().degree(), spans + sides[0].basis().degree(), 0, 1)) {
  const int m = size() - 1;
  unknowns_ = 1 + sides_ * (m - 1) + sides_ * (m - 1) * (m - 1);
  given_.resize(3, Eigen::Index{sides_} * (2 * m + 1));
  for (int k = 0; k < sides_; ++k) {
    const auto [first, second] = Split(sides[k], 0.5);
    given_.middleCols(Eigen::Index{k} * (2 * m + 1), m + 1) = first.control_points();
    given_.middleCols(Eigen::Index{k} * (2 * m + 1) + m, m + 1) = second.control_points();
  }
  origin_ = given_.rowwise().mean();
  given_.colwise() -= origin_;
}

int HoleNet::Index(int patch, int i, int j) const {
  const int m = size() - 1, along = 2 * m + 1;
  const int before = (patch + sides_ - 1) % sides_;
  if (i == m) return -1 - (patch * along + m - j);   // the first half of side i, backwards
  if (j == m) return -1 - (before * along + m + i);  // the second half of side i − 1
  if (i == 0 && j == 0) return 0;
  if (j == 0) return 1 + patch * (m - 1) + i - 1;
  if (i == 0) return 1 + before * (m - 1) + j - 1;
  return 1 + sides_ * (m - 1) + (patch * (m - 1) + i - 1) * (m - 1) + j - 1;
}

std::vector<NurbsSurface> HoleNet::Patches(const Eigen::Matrix3Xd& unknowns) const {
  std::vector<NurbsSurface> patches;
  for (int patch = 0; patch < sides_; ++patch) {
    Eigen::Matrix3Xd points(3, size() * size());
    for (int i = 0; i < size(); ++i) {
      for (int j = 0; j < size(); ++j) {
        const int index = Index(patch, i, j);
        points.col(i * size() + j) =
            index < 0 ? Given(index) : Eigen::Vector3d(unknowns.col(index));
      }
    }
    points.colwise() += origin_;
    patches.emplace_back(basis_, basis_, std::move(points));
  }
  return patches;
}

}  // namespace batten::internal
