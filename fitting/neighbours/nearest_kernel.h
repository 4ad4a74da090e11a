// SPDX-License-Identifier: MIT
// The hot part of a search for nearest points: plain numbers, compiled for several processors.
#pragma once

namespace batten::internal {

// Points in leaves of 32, and boxes around them in groups of eight: the boxes of level 0 hold
// leaves, those of every other level eight boxes of the level below; the last level is one group.
struct NearestTree {
  static constexpr int kLeaf = 32, kFan = 8, kMostLevels = 12;
  const float* leaves = nullptr;         // per leaf x, y, z of 32 points; infinite where none
  const int* ids = nullptr;              // per leaf of 32 points
  const float* boxes[kMostLevels] = {};  // per group: low x, y, z of eight, high x, y, z
  int levels = 0;
};

// Room for a search for k points: 2 k + 64 numbers each.
struct NearestRoom {
  float* squares;
  int* ids;
  double* keys;
};

// Writes the k points nearest to q to `nearest`, nearest first, of equally far ones those with
// lesser indices first. There are k points at least, and q is so near that squares are finite.
void NearestInTree(
    const NearestTree& tree, const float* q, int k, const NearestRoom& room, int* nearest);

}  // namespace batten::internal
