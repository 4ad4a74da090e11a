// SPDX-License-Identifier: MIT
// Numbers for points, equal ones alike.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/numeric/mixed_bits.h"

namespace batten::internal {

// Numbers points from 0 in the order in which they are first given; −0 is 0. O(1) each.
class PointNumbers {
 public:
  // The number of a point of three coordinates.
  int NumberOf(const double* point) {
    if (2 * (coordinates_.size() / 3 + 1) > slots_.size()) Grow();
    int& slot = SlotOf(point);
    if (slot < 0) {
      slot = size();
      for (int d = 0; d < 3; ++d) coordinates_.push_back(point[d] + 0.0);
    }
    return slot;
  }
  int size() const { return static_cast<int>(coordinates_.size() / 3); }
  // Of one after the other.
  const std::vector<double>& coordinates() const { return coordinates_; }

 private:
  // Where the point's number is, or −1 where it is to be.
  int& SlotOf(const double* point) {
    std::size_t at = MixedBitsOf(point) & (slots_.size() - 1);
    for (;; at = (at + 1) & (slots_.size() - 1)) {
      if (slots_[at] < 0) return slots_[at];
      const double* known = &coordinates_[3 * static_cast<std::size_t>(slots_[at])];
      if (known[0] == point[0] && known[1] == point[1] && known[2] == point[2]) return slots_[at];
    }
  }
  void Grow() {
    constexpr std::size_t kFirst = 64;
    slots_.assign(slots_.empty() ? kFirst : 2 * slots_.size(), -1);
    for (int k = 0; k < size(); ++k) SlotOf(&coordinates_[3 * static_cast<std::size_t>(k)]) = k;
  }

  std::vector<int> slots_;  // a power of two, at most half of them taken
  std::vector<double> coordinates_;
};

}  // namespace batten::internal
