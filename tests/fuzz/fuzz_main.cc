// SPDX-License-Identifier: MIT
// What libFuzzer calls; the build says which target.
#include <cstddef>
#include <cstdint>
#include <ctime>

#include "fuzz_targets.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // CPU time: libFuzzer's own limit is of the wall's clock, which a busy machine breaks too.
  constexpr double kMostSeconds = 5;
  const std::clock_t start = std::clock();
  batten::internal::BATTEN_FUZZ_TARGET({reinterpret_cast<const char*>(data), size});
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  batten::internal::RequireLaw(seconds < kMostSeconds, "a small file takes less than 5 seconds");
  return 0;
}
