// SPDX-License-Identifier: MIT
#include "fitting/neighbours/spatial_sort.h"

#include <algorithm>
#include <bit>
#include <cstdint>

namespace batten::internal {
namespace {

constexpr std::ptrdiff_t kPerTask = 1 << 15;

int WidestSide(const PlacedPoint* begin, const PlacedPoint* end) {
  float low[3], high[3];
  std::copy_n(begin->at, 3, low);
  std::copy_n(begin->at, 3, high);
  for (const PlacedPoint* p = begin; p != end; ++p) {
    for (int d = 0; d < 3; ++d) {
      low[d] = p->at[d] < low[d] ? p->at[d] : low[d];
      high[d] = p->at[d] > high[d] ? p->at[d] : high[d];
    }
  }
  int widest = 0;
  for (int d = 1; d < 3; ++d) {
    if (high[d] - low[d] > high[widest] - low[widest]) widest = d;
  }
  return widest;
}

// Size of a block's first half: the greatest leaf · 2ⁿ below the block's size.
std::ptrdiff_t FirstHalf(std::ptrdiff_t size, int leaf) {
  const auto leaves = static_cast<std::uint64_t>((size + leaf - 1) / leaf);
  return static_cast<std::ptrdiff_t>(std::bit_ceil(leaves) / 2) * leaf;
}

PlacedPoint* Halve(PlacedPoint* begin, PlacedPoint* end, int leaf) {
  PlacedPoint* middle = begin + FirstHalf(end - begin, leaf);
  const int d = WidestSide(begin, end);
  std::nth_element(begin, middle, end, [d](const PlacedPoint& a, const PlacedPoint& b) {
    return a.at[d] < b.at[d];
  });
  return middle;
}

void HalveAll(PlacedPoint* begin, PlacedPoint* end, int leaf) {
  while (end - begin > leaf) {
    PlacedPoint* middle = Halve(begin, end, leaf);
    HalveAll(middle, end, leaf);
    end = middle;
  }
}

}  // namespace

void HalveDownTo(std::vector<PlacedPoint>& points, int leaf, ThreadPool& pool) {
  struct Range {
    PlacedPoint *begin, *end;
  };
  std::vector<Range> ranges = {{points.data(), points.data() + points.size()}};
  while (ranges.front().end - ranges.front().begin > kPerTask) {
    std::vector<Range> halves(2 * ranges.size());
    pool.For(std::ssize(ranges), 1, [&](std::ptrdiff_t i, std::ptrdiff_t) {
      const auto [begin, end] = ranges[static_cast<size_t>(i)];
      PlacedPoint* middle = end - begin > leaf ? Halve(begin, end, leaf) : end;
      halves[static_cast<size_t>(2 * i)] = {begin, middle};
      halves[static_cast<size_t>(2 * i + 1)] = {middle, end};
    });
    ranges = std::move(halves);
  }
  pool.For(std::ssize(ranges), 1, [&](std::ptrdiff_t i, std::ptrdiff_t) {
    HalveAll(ranges[static_cast<size_t>(i)].begin, ranges[static_cast<size_t>(i)].end, leaf);
  });
}

}  // namespace batten::internal
