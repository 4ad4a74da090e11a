// SPDX-License-Identifier: MIT
// What sanitizers change that tests measure.
#pragma once

namespace batten::internal {

// The address sanitizer keeps freed memory.
#ifdef __SANITIZE_ADDRESS__
inline constexpr bool kMemoryIsTheProgramsOwn = false;
#else
inline constexpr bool kMemoryIsTheProgramsOwn = true;
#endif

}  // namespace batten::internal
