// SPDX-License-Identifier: MIT
#include "batten/geometry/points_into.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <stdexcept>

#include "geometry/evaluation/evaluation_kernels.h"

namespace batten {

void PointsInto(const SurfaceEvaluator& surface,
                std::span<const double> us,
                std::span<const double> vs,
                std::span<double> points,
                ThreadPool& pool) {
  if (us.size() != vs.size() || points.size() != 3 * us.size())
    throw std::invalid_argument("PointsInto: sizes differ");
  constexpr std::ptrdiff_t kTaken = 4096;  // by a thread at once
  constexpr std::size_t kAtOnce = 512;     // pairs that stay in the first cache
  pool.For(std::ssize(us), kTaken, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    std::array<double, 2 * kAtOnce> pairs;
    const auto last = static_cast<std::size_t>(end);
    for (auto first = static_cast<std::size_t>(begin); first < last; first += kAtOnce) {
      const std::size_t count = std::min(kAtOnce, last - first);
      for (std::size_t k = 0; k < count; ++k) {
        pairs[2 * k] = us[first + k];
        pairs[2 * k + 1] = vs[first + k];
      }
      internal::EvaluatePoints(surface.table(), pairs.data(), count, points.data() + 3 * first);
    }
  });
}

}  // namespace batten
