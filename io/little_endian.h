// SPDX-License-Identifier: MIT
// Numbers as bytes, the least significant first, as binary mesh formats want them. Internal to io.
#pragma once

#include <algorithm>
#include <bit>
#include <cstring>
#include <string>

namespace batten {

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

}  // namespace batten
