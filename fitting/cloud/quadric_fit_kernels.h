// SPDX-License-Identifier: MIT
// Kernels of the quadric fit to a patch of 64 points, compiled for several instruction sets.
#pragma once

namespace batten::internal {

inline constexpr int kPatchPoints = 64;

// Points of one patch relative to its mean, scaled to a size near one.
struct PlacePoints {
  alignas(64) float x[kPatchPoints], y[kPatchPoints], z[kPatchPoints];
};

// Weights of the points, their heights over the quadric z(x, y), and their leverages in its fit.
struct PlaceFit {
  alignas(64) float weights[kPatchPoints], heights[kPatchPoints], leverages[kPatchPoints];
};

// Computes the sums Σ xx, xy, xz, yy, yz, zz.
void SecondMoments(const PlacePoints& points, double* moments);

// Rotates points into a frame whose axes are the rows of a 3 × 3 matrix.
void TurnInto(const float* axes, PlacePoints& points);

// Sums up the normal equations of the quadric 1, x, y, xx, xy, yy for z: the lower half of the
// matrix row by row (21 numbers), then the right-hand side (6).
void AddUpQuadric(const PlacePoints& points, const float* weights, double* sums);

// Computes the heights over the quadric of these coefficients, and the leverages by the inverse of
// the matrix (6 × 6) times the weights.
void LeaveQuadric(const PlacePoints& points,
                  const float* coefficients,
                  const float* inverse,
                  PlaceFit& fit);

// Counts the points within a distance of each point, itself included, and numbers the connected
// components, from 0 on, of the graph with edges no longer than `link`.
void LinkWithin(const PlacePoints& points, float within, float link, int* counts, int* groups);

}  // namespace batten::internal
