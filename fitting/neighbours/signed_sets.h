// SPDX-License-Identifier: MIT
// Disjoint sets of points whose members carry a sign against their set.
#pragma once

#include <Eigen/Core>
#include <numeric>
#include <utility>
#include <vector>

namespace batten::internal {

// Sets of 0 … size − 1, each at first alone. Paths are compressed. [Tarjan 1975]
class SignedSets {
 public:
  explicit SignedSets(Eigen::Index size)
      : parent_(static_cast<size_t>(size)), flipped_(static_cast<size_t>(size), 0) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }

  // The set's number and whether the member is flipped in it.
  std::pair<int, int> Find(int member) {
    int root = member, flip = 0;
    for (; parent_[root] != root; root = parent_[root]) flip ^= flipped_[root];
    for (int rest = flip; parent_[member] != root && member != root;) {
      const int next = parent_[member], own = flipped_[member];
      parent_[member] = root;
      flipped_[member] = rest;
      rest ^= own;
      member = next;
    }
    return {root, flip};
  }

  // Joins the members' sets so that their signs differ by `flip`. False where they were one.
  bool Join(int a, int b, int flip = 0) {
    const auto [root_a, flip_a] = Find(a);
    const auto [root_b, flip_b] = Find(b);
    if (root_a == root_b) return false;
    parent_[root_b] = root_a;
    flipped_[root_b] = flip_a ^ flip_b ^ flip;
    return true;
  }

 private:
  std::vector<int> parent_, flipped_;
};

}  // namespace batten::internal
