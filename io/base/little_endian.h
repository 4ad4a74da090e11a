// SPDX-License-Identifier: MIT
// Numbers as bytes, the least significant first, as binary files want them. Internal to io.
#pragma once

#include <algorithm>
#include <bit>
#include <cstring>
#include <string>
#include <string_view>

namespace batten::internal {

// The number at the offset, which with its size must lie inside the bytes.
template <class T>
T LoadLittleEndian(std::string_view bytes, std::size_t offset) {
  char raw[sizeof(T)];
  std::memcpy(raw, bytes.data() + offset, sizeof raw);
  if constexpr (std::endian::native == std::endian::big) std::reverse(raw, raw + sizeof raw);
  T number;
  std::memcpy(&number, raw, sizeof number);
  return number;
}

template <class T>
void AppendLittleEndian(std::string& buffer, T value) {
  char bytes[sizeof value];
  std::memcpy(bytes, &value, sizeof value);
  if constexpr (std::endian::native == std::endian::big) std::reverse(bytes, bytes + sizeof value);
  buffer.append(bytes, sizeof value);
}

template <class Scalar, class Vector>
void AppendAllLittleEndian(std::string& buffer, const Vector& numbers) {
  for (const auto number : numbers) AppendLittleEndian(buffer, static_cast<Scalar>(number));
}

}  // namespace batten::internal
