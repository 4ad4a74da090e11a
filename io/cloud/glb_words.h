// SPDX-License-Identifier: MIT
// Numbers of the specification of glTF 2.0. [Khronos 2021, §§3.6, 3.7, 4.4] Not installed.
#pragma once

#include <cstddef>
#include <cstdint>

namespace batten::internal {

inline constexpr std::uint32_t kGlbMagic = 0x46546C67, kGlbVersion = 2, kJsonChunk = 0x4E4F534A,
                               kBinaryChunk = 0x004E4942;
// Types of components.
inline constexpr std::size_t kByte = 5120, kUnsignedByte = 5121, kShort = 5122,
                             kUnsignedShort = 5123, kUnsignedInt = 5125, kFloat = 5126;
// Modes of primitives.
inline constexpr std::size_t kPoints = 0, kTriangles = 4, kStrip = 5, kFan = 6;

}  // namespace batten::internal
