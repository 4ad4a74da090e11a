// SPDX-License-Identifier: MIT
#include "fitting/tiles/tile_axis.h"

#include <algorithm>

namespace batten::internal {

TileAxis::TileAxis(double length, int strips, int cells, int finest_level)
    : length_(length), finest_(finest_level) {
  for (int k = 0; k <= strips; ++k)
    edges_.push_back(static_cast<int>(static_cast<long long>(cells) * k / strips));
}

std::vector<double> TileAxis::Breaks() const {
  std::vector<double> breaks;
  for (const int edge : edges_) breaks.push_back(Knot(edge));
  return breaks;
}

SplineBasis TileAxis::Basis(int degree, std::span<const int> levels) const {
  std::vector<double> knots;
  for (int k = 0; k < strips(); ++k) {
    for (int cell = edges_[k]; cell < edges_[k + 1]; cell += 1 << (finest_ - levels[k]))
      knots.push_back(Knot(cell));
  }
  knots.push_back(length_);
  return SplineBasis::Clamped(degree, knots);
}

SplineBasis TileAxis::Basis(int degree, int level) const {
  return Basis(degree, std::vector<int>(static_cast<std::size_t>(strips()), level));
}

int TileAxis::StripOf(double at) const {
  const auto above = std::upper_bound(
      edges_.begin(), edges_.end(), at, [&](double t, int edge) { return t < Knot(edge); });
  return std::clamp(static_cast<int>(above - edges_.begin()) - 1, 0, strips() - 1);
}

}  // namespace batten::internal
