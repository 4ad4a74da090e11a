// SPDX-License-Identifier: MIT
#include "geometry/foot_points/capture_radius_kernel.h"

#include "geometry/numeric/run_time_dispatch.h"

namespace batten::internal {
namespace {

typedef double Lanes __attribute__((vector_size(8 * kReachLanes), aligned(8)));

BATTEN_INLINE Lanes Load(const double* from) { return *reinterpret_cast<const Lanes*>(from); }

}  // namespace

BATTEN_CLONES
void WidenRanges(const double* sets,
                 int count,
                 std::ptrdiff_t stride,
                 int padded,
                 const double* first,
                 const double* second,
                 TangentRanges& ranges) {
  const Lanes zero{};
  Lanes low0 = zero + ranges.low[0], high0 = zero + ranges.high[0];
  Lanes low1 = zero + ranges.low[1], high1 = zero + ranges.high[1];
  for (int set = 0; set < count; ++set, sets += stride) {
    for (int k = 0; k < padded; k += kReachLanes) {
      const Lanes x = Load(sets + k), y = Load(sets + padded + k), z = Load(sets + 2 * padded + k);
      const Lanes d0 = x * first[0] + y * first[1] + z * first[2];
      const Lanes d1 = x * second[0] + y * second[1] + z * second[2];
      low0 = d0 < low0 ? d0 : low0;
      high0 = d0 > high0 ? d0 : high0;
      low1 = d1 < low1 ? d1 : low1;
      high1 = d1 > high1 ? d1 : high1;
    }
  }
  for (int k = 0; k < kReachLanes; ++k) {
    ranges.low[0] = low0[k] < ranges.low[0] ? low0[k] : ranges.low[0];
    ranges.high[0] = high0[k] > ranges.high[0] ? high0[k] : ranges.high[0];
    ranges.low[1] = low1[k] < ranges.low[1] ? low1[k] : ranges.low[1];
    ranges.high[1] = high1[k] > ranges.high[1] ? high1[k] : ranges.high[1];
  }
}

}  // namespace batten::internal
