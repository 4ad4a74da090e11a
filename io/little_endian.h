// SPDX-License-Identifier: MIT
// Numbers in headers of binary files. Not installed.
#pragma once

#include <algorithm>
#include <bit>
#include <cstring>
#include <string_view>

namespace batten {

// The little-endian number at the offset, which with its size must lie inside the bytes.
template <class T>
T LoadLittleEndian(std::string_view bytes, std::size_t offset) {
  char raw[sizeof(T)];
  std::memcpy(raw, bytes.data() + offset, sizeof raw);
  if constexpr (std::endian::native == std::endian::big) std::reverse(raw, raw + sizeof raw);
  T number;
  std::memcpy(&number, raw, sizeof number);
  return number;
}

}  // namespace batten
