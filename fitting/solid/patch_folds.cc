// SPDX-License-Identifier: MIT
#include "fitting/solid/patch_folds.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <iterator>

namespace batten::internal {

std::vector<int> FoldedPatches(const LimitStencils& stencils,
                               const Eigen::Matrix3Xd& control_points,
                               ThreadPool& pool) {
  constexpr std::array kPlaces = {0.02, 0.3, 0.65, 0.98};
  constexpr auto kCount = int(kPlaces.size());
  constexpr double kLeast = 0.1;  // cosine: sound patches turn by less from sample to sample
  const LimitSurface surface(stencils, control_points);
  std::vector<char> folded(std::size_t(stencils.patches()), 0);
  pool.For(stencils.patches(), 64, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t patch = begin; patch < end; ++patch) {
      std::array<Eigen::Vector3d, kCount * kCount> normals;
      for (int i = 0; i < kCount; ++i) {
        for (int j = 0; j < kCount; ++j) {
          const SurfaceJet jet = surface.JetAt({static_cast<int>(patch), kPlaces[i], kPlaces[j]});
          normals[i * kCount + j] = jet.du.cross(jet.dv).stableNormalized();
          const bool bad =
              (i > 0 && normals[i * kCount + j].dot(normals[(i - 1) * kCount + j]) < kLeast) ||
              (j > 0 && normals[i * kCount + j].dot(normals[i * kCount + j - 1]) < kLeast);
          if (bad) folded[std::size_t(patch)] = 1;
        }
      }
    }
  });
  std::vector<int> found;
  for (int patch = 0; patch < stencils.patches(); ++patch) {
    if (folded[std::size_t(patch)]) found.push_back(patch);
  }
  return found;
}

std::optional<std::vector<int>> Unfold(const LimitStencils& stencils,
                                       const Eigen::Matrix3Xd& control_points,
                                       const std::vector<int>& before,
                                       Eigen::Matrix3Xd& step,
                                       ThreadPool& pool) {
  constexpr int kTries = 5;
  constexpr double kShorter = 0.4;
  for (int round = 0; round < kTries; ++round) {
    std::vector<int> after = FoldedPatches(stencils, control_points + step, pool);
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
