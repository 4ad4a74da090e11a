// SPDX-License-Identifier: MIT
#include "fitting/solid/patch_folds.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <iterator>

namespace batten::internal {

std::vector<int> FoldedPatches(const LimitStencils& stencils,
                               const std::vector<int>& patches,
                               const Eigen::Matrix3Xd& control_points,
                               ThreadPool& pool) {
  constexpr std::array kPlaces = {0.02, 0.3, 0.65, 0.98};
  const auto count = int(kPlaces.size());
  constexpr double kLeast = 0.1;  // cosine: sound patches turn by less from sample to sample
  const LimitSurface surface(stencils, control_points);
  std::vector<char> folded(patches.size(), 0);
  pool.For(std::ptrdiff_t(patches.size()), 64, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t k = begin; k < end; ++k) {
      const Eigen::Matrix3Xd normals = surface.NormalsOn(patches[std::size_t(k)], kPlaces);
      const auto apart = [&](int one, int other) {
        return normals.col(one).dot(normals.col(other)) < kLeast;
      };
      for (int i = 0; i < count; ++i) {
        for (int j = 0; j < count; ++j) {
          const int at = i * count + j;
          if ((i > 0 && apart(at, at - count)) || (j > 0 && apart(at, at - 1)))
            folded[std::size_t(k)] = 1;
        }
      }
    }
  });
  std::vector<int> found;
  for (std::size_t k = 0; k < patches.size(); ++k) {
    if (folded[k]) found.push_back(patches[k]);
  }
  return found;
}

std::optional<std::vector<int>> Unfold(const LimitStencils& stencils,
                                       const std::vector<int>& patches,
                                       const Eigen::Matrix3Xd& control_points,
                                       const std::vector<int>& before,
                                       Eigen::Matrix3Xd& step,
                                       ThreadPool& pool) {
  constexpr int kTries = 5;
  constexpr double kShorter = 0.4;
  for (int round = 0; round < kTries; ++round) {
    std::vector<int> after = FoldedPatches(stencils, patches, control_points + step, pool);
    std::vector<int> fresh;
    std::set_difference(
        after.begin(), after.end(), before.begin(), before.end(), std::back_inserter(fresh));
    if (fresh.empty()) return after;
    std::vector<bool> shortened(std::size_t(step.cols()), false);
    for (const int patch : fresh) {
      for (const int vertex : stencils.Support(patch)) shortened[std::size_t(vertex)] = true;
    }
    for (Eigen::Index v = 0; v < step.cols(); ++v) {
      if (shortened[std::size_t(v)]) step.col(v) *= kShorter;
    }
  }
  return std::nullopt;
}

}  // namespace batten::internal
