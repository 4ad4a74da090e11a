// SPDX-License-Identifier: MIT
#include "fitting/streaming/distance_counts.h"

#include <algorithm>
#include <cmath>

namespace batten::internal {
namespace {

constexpr int kOctaves = 80, kLowest = -40;  // of the unit: 2^-40 is 1e-12
constexpr int kSteps = 512;                  // in an octave
constexpr int kSizes = kOctaves * kSteps;
enum DistanceNumber { kAll, kSquares, kAbsolute, kOut, kBySize };

// Negative distances go down from the middle, the others up from it.
int PlaceOf(double relative) {
  int exponent = 0;
  const double mantissa = std::frexp(std::abs(relative), &exponent);  // 0.5 … 1
  int size = 0;
  if (relative != 0) {
    const int octave = exponent - 1 - kLowest;
    size = octave * kSteps + static_cast<int>((2 * mantissa - 1) * kSteps);
    if (octave < 0) size = 0;
  }
  size = std::clamp(size, 0, kSizes - 1);
  return relative < 0 ? kSizes - 1 - size : kSizes + size;
}

// The middle of what PlaceOf puts there.
double SizeAt(int place) {
  const bool negative = place < kSizes;
  const int size = negative ? kSizes - 1 - place : place - kSizes;
  const double value = std::ldexp(1 + (size % kSteps + 0.5) / kSteps, size / kSteps + kLowest);
  return negative ? -value : value;
}

}  // namespace

DistanceCounts::DistanceCounts(double unit, std::optional<double> tolerance)
    : unit_(unit), tolerance_(tolerance), numbers_(kBySize + 2 * kSizes, 0.0) {}

void DistanceCounts::Add(double distance) {
  const double size = std::abs(distance);
  numbers_[kAll] += 1;
  numbers_[kSquares] += size * size;
  numbers_[kAbsolute] += size;
  if (tolerance_ && size > *tolerance_) numbers_[kOut] += 1;
  greatest_ = std::max(greatest_, size);
  numbers_[static_cast<std::size_t>(kBySize + PlaceOf(distance / unit_))] += 1;
}

double DistanceCounts::Quantile(double share, bool with_sign) const {
  const double* by_size = numbers_.data() + kBySize;
  const double wanted = share * std::max(0.0, numbers_[kAll] - 1);
  double below = 0;
  if (with_sign) {
    for (int place = 0; place < 2 * kSizes; ++place)
      if ((below += by_size[place]) > wanted) return unit_ * SizeAt(place);
  } else {
    for (int size = 0; size < kSizes; ++size)
      if ((below += by_size[kSizes + size] + by_size[kSizes - 1 - size]) > wanted)
        return std::min(greatest_, unit_ * SizeAt(kSizes + size));
  }
  return 0;
}

ErrorSummary DistanceCounts::Summary() const {
  ErrorSummary error;
  error.tolerance = tolerance_;
  const double count = numbers_[kAll];
  error.points = static_cast<Eigen::Index>(count);
  if (count == 0) return error;
  error.rms = std::sqrt(numbers_[kSquares] / count);
  error.mean = numbers_[kAbsolute] / count;
  error.max = greatest_;
  error.p50 = Quantile(0.50, false);
  error.p95 = Quantile(0.95, false);
  error.p99 = Quantile(0.99, false);
  error.signed_p5 = Quantile(0.05, true);
  error.signed_p95 = Quantile(0.95, true);
  error.out_of_tolerance = static_cast<Eigen::Index>(numbers_[kOut]);
  error.within_tolerance = 1 - numbers_[kOut] / count;
  return error;
}

}  // namespace batten::internal
