// SPDX-License-Identifier: MIT
// What libFuzzer calls; the build says which target.
#include <cstddef>
#include <cstdint>

#include "fuzz_targets.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  batten::BATTEN_FUZZ_TARGET({reinterpret_cast<const char*>(data), size});
  return 0;
}
