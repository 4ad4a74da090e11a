// SPDX-License-Identifier: MIT
#include "fitting/neighbours/nearest_kernel.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <utility>

#include "geometry/numeric/run_time_dispatch.h"

namespace batten::internal {
namespace {

constexpr int kLeaf = NearestTree::kLeaf, kFan = NearestTree::kFan;
constexpr int kCounted = 64;  // points; more are sorted faster than ranked by counting
constexpr float kInfinite = std::numeric_limits<float>::infinity();

// A box or a leaf still to be visited: its distance, its level (-1 for a leaf) and number.
struct Visit {
  float distance;
  int level, number;
};

// Squared distances of a point from eight boxes; no box is infinitely far.
BATTEN_INLINE void BoxDistances(const float* boxes, const float* q, float* squares) {
  for (int i = 0; i < kFan; ++i) squares[i] = 0;
  for (int d = 0; d < 3; ++d) {
    const float* low = boxes + d * kFan;
    const float* high = boxes + (3 + d) * kFan;
    for (int i = 0; i < kFan; ++i) {
      const float below = low[i] - q[d], above = q[d] - high[i];
      float outside = below > above ? below : above;
      outside = outside > 0 ? outside : 0;
      squares[i] += outside * outside;
    }
  }
}

BATTEN_INLINE void PointDistances(const float* leaf, const float* q, float* squares) {
  for (int i = 0; i < kLeaf; ++i) {
    const float x = q[0] - leaf[i], y = q[1] - leaf[kLeaf + i], z = q[2] - leaf[2 * kLeaf + i];
    squares[i] = x * x + y * y + z * z;
  }
}

// Puts the boxes of a group nearer than the limit on the stack, the nearest on top.
BATTEN_INLINE int PushNear(
    const float* squares, float limit, int level, int group, Visit* stack, int top) {
  int nearest = top;
  float least = limit;
  for (int i = 0; i < kFan; ++i) {
    stack[top] = {squares[i], level - 1, group * kFan + i};
    const bool nearer = squares[i] < least;
    nearest = nearer ? top : nearest;
    least = nearer ? squares[i] : least;
    top += squares[i] < limit ? 1 : 0;
  }
  if (least < limit) std::swap(stack[nearest], stack[top - 1]);
  return top;
}

// Points found so far: all of those visited that are nearer than the limit, and k at least once
// the limit is finite.
struct Found {
  float* squares;
  int* ids;
  int count;
  float limit;
};

BATTEN_INLINE void Append(Found& found, const float* squares, const int* ids) {
  int count = found.count;
  for (int i = 0; i < kLeaf; ++i) {
    found.squares[count] = squares[i];
    found.ids[count] = ids[i];
    count += squares[i] < found.limit ? 1 : 0;
  }
  found.count = count;
}

BATTEN_INLINE int CountBelow(const float* squares, int count, float limit) {
  int below = 0;
  for (int i = 0; i < count; ++i) below += squares[i] < limit ? 1 : 0;
  return below;
}

// Lowers the limit until few more than k are below it, and forgets the others. About as many points
// of a surface are within a radius as the square of that; where many are equally far, halving ends
// without having parted them.
BATTEN_INLINE void Narrow(Found& found, int k) {
  constexpr int kRounds = 8;
  const int enough = k + k / 8;
  float low = 0, high = found.limit;
  int below_low = 0, below_high = found.count;
  if (!(high < kInfinite)) {
    high = 0;
    for (int i = 0; i < found.count; ++i) high = found.squares[i] > high ? found.squares[i] : high;
    high *= 1.000001F;
    high += std::numeric_limits<float>::min();
  }
  for (int round = 0; round < kRounds && below_high > enough; ++round) {
    const float share = round < kRounds / 2 ? (static_cast<float>(k - below_low) + 0.5F) /
                                                  static_cast<float>(below_high - below_low)
                                            : 0.5F;
    const float at = low + share * (high - low);
    const int below = CountBelow(found.squares, found.count, at);
    const bool suffice = below >= k;
    high = suffice ? at : high;
    below_high = suffice ? below : below_high;
    low = suffice ? low : at;
    below_low = suffice ? below_low : below;
  }
  int kept = 0;
  for (int i = 0; i < found.count; ++i) {
    const float square = found.squares[i];
    found.squares[kept] = square;
    found.ids[kept] = found.ids[i];
    kept += square < high ? 1 : 0;
  }
  found.count = kept;
  found.limit = high;
}

// A number that sorts by distance, then by index: the bits of two positive numbers sort as they do.
BATTEN_INLINE double KeyOf(float square, int id) {
  return std::bit_cast<double>(std::uint64_t{std::bit_cast<std::uint32_t>(square)} << 32 |
                               static_cast<std::uint32_t>(id));
}

BATTEN_INLINE int IdOf(double key) {
  return static_cast<int>(static_cast<std::uint32_t>(std::bit_cast<std::uint64_t>(key)));
}

// Breaks ties of distance by index: from here on points must be nearer than the k-th.
void NarrowTies(Found& found, int k, double* keys) {
  for (int i = 0; i < found.count; ++i) keys[i] = KeyOf(found.squares[i], found.ids[i]);
  std::nth_element(keys, keys + k - 1, keys + found.count);
  for (int i = 0; i < k; ++i) {
    found.squares[i] = std::bit_cast<float>(
        static_cast<std::uint32_t>(std::bit_cast<std::uint64_t>(keys[i]) >> 32));
    found.ids[i] = IdOf(keys[i]);
  }
  found.count = k;
  found.limit = found.squares[k - 1];
}

// The k nearest of those found, in order, each put where it belongs by counting those nearer.
BATTEN_INLINE void Order(const Found& found, int k, double* keys, int* nearest) {
  for (int i = 0; i < found.count; ++i) keys[i] = KeyOf(found.squares[i], found.ids[i]);
  if (found.count > kCounted) {
    std::partial_sort(keys, keys + k, keys + found.count);
    for (int i = 0; i < k; ++i) nearest[i] = IdOf(keys[i]);
    return;
  }
  for (int i = 0; i < found.count; ++i) {
    const double key = keys[i];
    std::int64_t rank = 0;
    for (int j = 0; j < found.count; ++j) rank += keys[j] < key ? 1 : 0;
    if (rank < k) nearest[rank] = IdOf(key);
  }
}

}  // namespace

BATTEN_CLONES void NearestInTree(
    const NearestTree& tree, const float* q, int k, const NearestRoom& room, int* nearest) {
  Visit stack[NearestTree::kMostLevels * kFan];
  float squares[kLeaf];
  Found found{room.squares, room.ids, 0, kInfinite};
  const int full = 2 * k + kLeaf;  // to narrow seldom is cheap
  int top = 0;
  stack[top++] = {0, tree.levels - 1, 0};
  while (top > 0) {
    const Visit visit = stack[--top];
    if (!(visit.distance < found.limit)) continue;
    if (visit.level >= 0) {
      BoxDistances(tree.boxes[visit.level] + visit.number * 6L * kFan, q, squares);
      top = PushNear(squares, found.limit, visit.level, visit.number, stack, top);
      continue;
    }
    PointDistances(tree.leaves + visit.number * 3L * kLeaf, q, squares);
    Append(found, squares, tree.ids + visit.number * long{kLeaf});
    if (found.count < k || (found.limit < kInfinite && found.count < full)) continue;
    Narrow(found, k);
    if (found.count >= full) NarrowTies(found, k, room.keys);
  }
  if (found.count > k + k / 4) Narrow(found, k);
  Order(found, k, room.keys, nearest);
}

}  // namespace batten::internal
