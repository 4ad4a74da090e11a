// SPDX-License-Identifier: MIT
#include "fitting/cloud/quadric_fit_kernels.h"

#include <bit>
#include <cstdint>
#include <cstring>

#include "geometry/numeric/run_time_dispatch.h"

namespace batten::internal {
namespace {

constexpr int kLanes = 16;

struct Lanes {
  float at[kLanes];
};

BATTEN_INLINE double SumOf(const Lanes& lanes) {
  double sum = 0;
  for (int i = 0; i < kLanes; ++i) sum += static_cast<double>(lanes.at[i]);
  return sum;
}

// Dot product Σ a b, summed in lanes.
BATTEN_INLINE double Dot(const float* a, const float* b) {
  Lanes sum{};
  for (int k = 0; k < kPatchPoints; k += kLanes)
    for (int i = 0; i < kLanes; ++i) sum.at[i] += a[k + i] * b[k + i];
  return SumOf(sum);
}

}  // namespace

BATTEN_CLONES void SecondMoments(const PlacePoints& points, double* moments) {
  const float* rows[] = {points.x, points.y, points.z};
  int at = 0;
  for (int a = 0; a < 3; ++a)
    for (int b = a; b < 3; ++b) moments[at++] = Dot(rows[a], rows[b]);
}

BATTEN_CLONES void TurnInto(const float* axes, PlacePoints& points) {
  for (int k = 0; k < kPatchPoints; ++k) {
    const float x = points.x[k], y = points.y[k], z = points.z[k];
    points.x[k] = axes[0] * x + axes[1] * y + axes[2] * z;
    points.y[k] = axes[3] * x + axes[4] * y + axes[5] * z;
    points.z[k] = axes[6] * x + axes[7] * y + axes[8] * z;
  }
}

BATTEN_CLONES void AddUpQuadric(const PlacePoints& points, const float* weights, double* sums) {
  alignas(64) float rows[6][kPatchPoints], weighted[6][kPatchPoints];
  for (int k = 0; k < kPatchPoints; ++k) {
    const float x = points.x[k], y = points.y[k];
    const float monomials[6] = {1, x, y, x * x, x * y, y * y};
    for (int a = 0; a < 6; ++a) {
      rows[a][k] = monomials[a];
      weighted[a][k] = weights[k] * monomials[a];
    }
  }
  int at = 0;
  for (int a = 0; a < 6; ++a)
    for (int b = 0; b <= a; ++b) sums[at++] = Dot(weighted[a], rows[b]);
  for (int a = 0; a < 6; ++a) sums[at++] = Dot(weighted[a], points.z);
}

BATTEN_CLONES void LeaveQuadric(const PlacePoints& points,
                                const float* coefficients,
                                const float* inverse,
                                PlaceFit& fit) {
  for (int k = 0; k < kPatchPoints; ++k) {
    const float x = points.x[k], y = points.y[k];
    const float monomials[6] = {1, x, y, x * x, x * y, y * y};
    float height = points.z[k], leverage = 0;
    for (int a = 0; a < 6; ++a) {
      height -= coefficients[a] * monomials[a];
      float row = 0;
      for (int b = 0; b < 6; ++b) row += inverse[a * 6 + b] * monomials[b];
      leverage += row * monomials[a];
    }
    fit.heights[k] = height;
    fit.leverages[k] = fit.weights[k] * leverage;
  }
}

BATTEN_CLONES void LinkWithin(
    const PlacePoints& points, float within, float link, int* counts, int* groups) {
  static_assert(kPatchPoints == 64);
  for (int k = 0; k < kPatchPoints; ++k) counts[k] = 0;
  std::uint64_t done = 0, reached = 0;
  int group = -1;
  while (~done != 0) {
    if ((reached & ~done) == 0) {
      reached |= ~done & -~done;
      ++group;
    }
    const int j = std::countr_zero(reached & ~done);
    done |= std::uint64_t{1} << j;
    groups[j] = group;
    const float x = points.x[j], y = points.y[j], z = points.z[j];
    std::uint8_t near[kPatchPoints];
    for (int k = 0; k < kPatchPoints; ++k) {
      const float dx = points.x[k] - x, dy = points.y[k] - y, dz = points.z[k] - z;
      const float square = dx * dx + dy * dy + dz * dz;
      counts[k] += square <= within * within ? 1 : 0;
      near[k] = square <= link * link ? 1 : 0;
    }
    for (int k = 0; k < kPatchPoints; k += 8) {  // eight bytes of 0 or 1 to eight bits
      std::uint64_t bytes;
      std::memcpy(&bytes, near + k, sizeof bytes);
      reached |= (bytes * 0x0102040810204080U >> 56) << k;
    }
  }
}

}  // namespace batten::internal
