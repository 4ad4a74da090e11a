// SPDX-License-Identifier: MIT
// Knots along one direction of a net that is cut into tiles.
#pragma once

#include <span>
#include <vector>

#include "batten/geometry/spline_basis.h"

namespace batten::internal {

// A domain [0, length] of equal finest cells, cut into strips of tiles. Level L is the finest; a
// strip of level L − k has every 2^k-th knot. Knots of coarser levels are among those of finer
// ones, bit by bit.
class TileAxis {
 public:
  // So many cells of the finest level, in strips as equal as they can be; on a finest level above
  // 0, strips are equal and have a multiple of 2^level cells.
  TileAxis(double length, int strips, int cells, int finest_level = 0);

  int strips() const { return static_cast<int>(edges_.size()) - 1; }
  int finest_level() const { return finest_; }
  int cells() const { return edges_.back(); }  // of the finest level

  // Where strips begin and end.
  std::vector<double> Breaks() const;

  // The clamped basis with strip k on level levels[k].
  SplineBasis Basis(int degree, std::span<const int> levels) const;
  SplineBasis Basis(int degree, int level) const;

  // The strip of a parameter; those outside belong to the nearest.
  int StripOf(double at) const;

 private:
  double Knot(int cell) const { return cell == cells() ? length_ : length_ * cell / cells(); }

  double length_;
  std::vector<int> edges_;  // of strips, in finest cells
  int finest_;
};

}  // namespace batten::internal
