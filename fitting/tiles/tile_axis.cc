// SPDX-License-Identifier: MIT
#include "fitting/tiles/tile_axis.h"

#include <algorithm>
#include <utility>

namespace batten::internal {

TileAxis::TileAxis(double length, std::vector<int> edges, int finest)
    : length_(length), edges_(std::move(edges)), finest_(finest) {}

TileAxis TileAxis::Of(double length, int strips, int coarsest_cells, int finest_level) {
  std::vector<int> edges(static_cast<std::size_t>(strips) + 1);
  for (int k = 0; k <= strips; ++k) edges[k] = (k * coarsest_cells) << finest_level;
  return {length, std::move(edges), finest_level};
}

TileAxis TileAxis::Uniform(double length, int strips, int cells) {
  std::vector<int> edges(static_cast<std::size_t>(strips) + 1);
  for (int k = 0; k <= strips; ++k)
    edges[k] = static_cast<int>(static_cast<long long>(cells) * k / strips);
  return {length, std::move(edges), 0};
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
