// SPDX-License-Identifier: MIT
// Kernel of the nearest-neighbour search, compiled for several instruction sets.
#pragma once

namespace batten::internal {

// A box tree: points in leaves of 32 and boxes around them in groups of eight. Boxes of level 0
// hold leaves, those of every other level eight boxes of the level below; the last level is one
// group.
struct NearestTree {
  static constexpr int kLeaf = 32, kFan = 8, kMostLevels = 12;
  const float* leaves = nullptr;         // per leaf x, y, z of 32 points; infinite where none
  const int* ids = nullptr;              // per leaf of 32 points
  const float* boxes[kMostLevels] = {};  // per group: low x, y, z of eight, high x, y, z
  int levels = 0;
};

// Working memory of a search for k points: 2 k + 64 numbers each.
struct NearestRoom {
  float* squares;
  int* ids;
  double* keys;
};

// Writes the k points nearest to q to `nearest`, nearest first, equally far ones by increasing
// index. There are at least k points, and q is so near that squared distances are finite.
void NearestInTree(
    const NearestTree& tree, const float* q, int k, const NearestRoom& room, int* nearest);

}  // namespace batten::internal
