// SPDX-License-Identifier: MIT
#include "io/cloud/binary_column.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "batten/io/read_error.h"

namespace batten::internal {
namespace {

template <std::size_t kBytes>
struct Bits;
template <>
struct Bits<1> {
  using Type = std::uint8_t;
  static Type Swap(Type bits) { return bits; }
};
template <>
struct Bits<2> {
  using Type = std::uint16_t;
  static Type Swap(Type bits) { return __builtin_bswap16(bits); }
};
template <>
struct Bits<4> {
  using Type = std::uint32_t;
  static Type Swap(Type bits) { return __builtin_bswap32(bits); }
};
template <>
struct Bits<8> {
  using Type = std::uint64_t;
  static Type Swap(Type bits) { return __builtin_bswap64(bits); }
};

template <class T, bool kSwapped>
void Decode(const char* first, std::size_t stride, int rows, double* target) {
  using Unsigned = Bits<sizeof(T)>;
  for (int r = 0; r < rows; ++r) {
    typename Unsigned::Type bits;
    std::memcpy(&bits, first + static_cast<std::size_t>(r) * stride, sizeof bits);
    if constexpr (kSwapped) bits = Unsigned::Swap(bits);
    target[r] = static_cast<double>(std::bit_cast<T>(bits));
  }
}

template <class T>
void Decode(const char* first, std::size_t stride, int rows, bool swapped, double* target) {
  swapped ? Decode<T, true>(first, stride, rows, target)
          : Decode<T, false>(first, stride, rows, target);
}

// From what is stored to the number that is meant.
void Unpack(const BinaryColumn& column, int rows, double* values) {
  if (column.mask != 0) {
    for (int r = 0; r < rows; ++r) {
      values[r] = (static_cast<unsigned>(values[r]) >> column.shift) & column.mask;
    }
  }
  if (column.scale != 1 || column.add != 0) {
    for (int r = 0; r < rows; ++r) values[r] = values[r] * column.scale + column.add;
  }
}

}  // namespace

std::size_t SizeOf(ScalarType type) {
  switch (type) {
    case ScalarType::kInt8:
    case ScalarType::kUint8:
      return 1;
    case ScalarType::kInt16:
    case ScalarType::kUint16:
      return 2;
    case ScalarType::kInt32:
    case ScalarType::kUint32:
    case ScalarType::kFloat32:
      return 4;
    case ScalarType::kInt64:
    case ScalarType::kUint64:
    case ScalarType::kFloat64:
      return 8;
  }
  return 0;
}

double ColourScale(ScalarType type) {
  switch (type) {
    case ScalarType::kFloat32:
    case ScalarType::kFloat64:
      return 255;
    case ScalarType::kUint16:
      return 255.0 / 65535.0;
    default:
      return 1;
  }
}

void DecodeColumn(const char* first,
                  std::size_t stride,
                  int rows,
                  ScalarType type,
                  bool swapped,
                  double* target) {
  switch (type) {
    case ScalarType::kInt8:
      return Decode<std::int8_t>(first, stride, rows, swapped, target);
    case ScalarType::kUint8:
      return Decode<std::uint8_t>(first, stride, rows, swapped, target);
    case ScalarType::kInt16:
      return Decode<std::int16_t>(first, stride, rows, swapped, target);
    case ScalarType::kUint16:
      return Decode<std::uint16_t>(first, stride, rows, swapped, target);
    case ScalarType::kInt32:
      return Decode<std::int32_t>(first, stride, rows, swapped, target);
    case ScalarType::kUint32:
      return Decode<std::uint32_t>(first, stride, rows, swapped, target);
    case ScalarType::kInt64:
      return Decode<std::int64_t>(first, stride, rows, swapped, target);
    case ScalarType::kUint64:
      return Decode<std::uint64_t>(first, stride, rows, swapped, target);
    case ScalarType::kFloat32:
      return Decode<float>(first, stride, rows, swapped, target);
    case ScalarType::kFloat64:
      return Decode<double>(first, stride, rows, swapped, target);
  }
}

void ReadRecords(ByteSource& source,
                 std::int64_t count,
                 std::size_t stride,
                 const std::vector<BinaryColumn>& columns,
                 bool swapped,
                 CloudFilter& filter) {
  if (stride > ByteSource::kBlockBytes) {
    throw ReadError::AtByte(
        source.name(), source.position(), fmt::format("a point of {} bytes is too large", stride));
  }
  RowBatch batch(columns.size());
  for (std::int64_t left = count; left > 0;) {
    const std::string_view bytes = source.Peek(stride);
    const auto whole = static_cast<std::int64_t>(bytes.size() / stride);
    if (whole == 0) {
      throw ReadError::AtByte(
          source.name(),
          source.position() + static_cast<std::int64_t>(bytes.size()),
          fmt::format("the file ends after {} of {} points", count - left, count));
    }
    batch.rows = static_cast<int>(std::min({left, whole, std::int64_t{RowBatch::kRows}}));
    for (std::size_t c = 0; c < columns.size(); ++c) {
      DecodeColumn(bytes.data() + columns[c].offset,
                   stride,
                   batch.rows,
                   columns[c].type,
                   swapped,
                   batch.column(c));
      Unpack(columns[c], batch.rows, batch.column(c));
    }
    for (int r = 0; r < batch.rows; ++r) {
      batch.places[r] = source.position() + static_cast<std::int64_t>(stride) * r;
    }
    left -= batch.rows;
    source.Skip(static_cast<std::int64_t>(stride) * batch.rows);
    filter.Take(batch);
  }
}

}  // namespace batten::internal
