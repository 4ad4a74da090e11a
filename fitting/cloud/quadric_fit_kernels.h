// SPDX-License-Identifier: MIT
// The hot part of judging a place by one quadric: plain numbers, compiled for several processors.
#pragma once

namespace batten::internal {

// Points of one place relative to its middle, of a size near one.
struct PlacePoints {
  static constexpr int kCount = 64;
  alignas(64) float x[kCount], y[kCount], z[kCount];
};

// Weights of the points, their heights over a quadric of the plane of z and, as if they were not
// in it, those that go with it.
struct PlaceFit {
  alignas(64) float weights[PlacePoints::kCount], heights[PlacePoints::kCount],
      leverages[PlacePoints::kCount];
};

// Σ xx, xy, xz, yy, yz, zz.
void SecondMoments(const PlacePoints& points, double* moments);

// Turns points into a frame: rows are its axes.
void TurnInto(const float* axes, PlacePoints& points);

// Normal equations of the quadric 1, x, y, xx, xy, yy for z: the lower half of the matrix row by
// row (21 numbers), then the right-hand side (6).
void AddUpQuadric(const PlacePoints& points, const float* weights, double* sums);

// Heights over the quadric of these coefficients, and leverages by the inverse of the matrix (6 ×
// 6) times the weights.
void LeaveQuadric(const PlacePoints& points,
                  const float* coefficients,
                  const float* inverse,
                  PlaceFit& fit);

// How many of the points are within a distance of each, itself included, and the numbers of the
// groups, from 0 on, that chains of links no longer than `link` hold together.
void LinkWithin(const PlacePoints& points, float within, float link, int* counts, int* groups);

}  // namespace batten::internal
