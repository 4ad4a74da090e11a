// SPDX-License-Identifier: MIT
#include "geometry/offset/self_crossings.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "geometry/intersection/pair_contact.h"
#include "geometry/intersection/patch_tree.h"

namespace batten::internal {
namespace {

bool Beside(const ParameterBox& a, const ParameterBox& b) {
  return a.u0 <= b.u1 && b.u0 <= a.u1 && a.v0 <= b.v1 && b.v0 <= a.v1;
}

class SelfSearch {
 public:
  SelfSearch(PatchTree& tree, const Eigen::Vector3d& origin, double tolerance)
      : tree_(tree), origin_(origin), tolerance_(tolerance) {}

  std::optional<SelfCrossing> Meeting(int first, int second) {
    std::vector<std::pair<int, int>> pairs{{first, second}};
    constexpr double kFinest = 1e-3;
    constexpr int kMostLooks = 20'000;
    for (int looks = 0; !pairs.empty() && looks < kMostLooks; ++looks) {
      const auto [i, j] = pairs.back();
      pairs.pop_back();
      if (Separated(tree_[i], tree_[j], 0)) continue;
      if (const auto met = Solved(i, j)) return met;
      if (std::max(tree_[i].size(), tree_[j].size()) <= kFinest * tree_.size()) continue;
      const bool cut_first = tree_[i].size() >= tree_[j].size();
      const int half = tree_.Halve(cut_first ? i : j);
      pairs.emplace_back(cut_first ? half : i, cut_first ? j : half);
      pairs.emplace_back(cut_first ? half + 1 : i, cut_first ? j : half + 1);
    }
    return std::nullopt;
  }

 private:
  std::optional<SelfCrossing> Solved(int i, int j) const {
    const NetPatch &a = tree_[i], &b = tree_[j];
    constexpr double kMostSpread = 0.6;
    if (!(a.normal.spread < kMostSpread && b.normal.spread < kMostSpread)) return std::nullopt;
    if (LineAngle(a.normal.axis, b.normal.axis) <= a.normal.spread + b.normal.spread) {
      return std::nullopt;
    }
    const PairContact contact(
        tree_, tree_.SmoothBoxOf(i), tree_, tree_.SmoothBoxOf(j), MeetKind::kCrossing, tolerance_);
    Eigen::Vector4d start;
    start << a.Middle(), b.Middle();
    const auto at = contact.Nearest(start);
    if (!at) return std::nullopt;
    const auto in = [](const ParameterBox& box, double u, double v) {
      return u >= box.u0 && u <= box.u1 && v >= box.v0 && v <= box.v1;
    };
    const Eigen::Vector4d& x = *at;
    if (!in(a.box, x[0], x[1]) || !in(b.box, x[2], x[3])) return std::nullopt;
    return SelfCrossing{x.head<2>(), x.tail<2>(), contact.First(x) + origin_};
  }

  PatchTree& tree_;
  Eigen::Vector3d origin_;
  double tolerance_;
};

}  // namespace

std::vector<SelfCrossing> SelfCrossings(const NurbsSurface& surface,
                                        double tolerance,
                                        std::size_t most) {
  const auto& points = surface.control_points();
  const Eigen::Vector3d origin = (points.rowwise().maxCoeff() + points.rowwise().minCoeff()) / 2;
  PatchTree tree(surface, origin);
  SelfSearch search(tree, origin, tolerance);
  const int roots = tree.roots();
  std::vector<SelfCrossing> found;
  for (int i = 0; i < roots && found.size() < most; ++i) {
    for (int j = i + 1; j < roots && found.size() < most; ++j) {
      if (Beside(tree[i].box, tree[j].box) || Separated(tree[i], tree[j], 0)) continue;
      if (const auto met = search.Meeting(i, j)) found.push_back(*met);
    }
  }
  return found;
}

}  // namespace batten::internal
