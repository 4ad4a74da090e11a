// SPDX-License-Identifier: MIT
// Numbers of any type inside binary records.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "io/base/byte_source.h"
#include "io/cloud/cloud_filter.h"

namespace batten::internal {

enum class ScalarType {
  kInt8,
  kUint8,
  kInt16,
  kUint16,
  kInt32,
  kUint32,
  kInt64,
  kUint64,
  kFloat32,
  kFloat64
};

std::size_t SizeOf(ScalarType type);

// What colours of the type are multiplied with to be 0 … 255: floating ones go to 1, wide integers
// to the end of their range.
double ColourScale(ScalarType type);

// Where a number stands in a record, and how it is stored there.
struct BinaryColumn {
  std::size_t offset;
  ScalarType type;
  // Of an unsigned integer some bits: (stored >> shift) & mask; mask 0 takes all.
  unsigned shift = 0, mask = 0;
  // The number is stored · scale + add.
  double scale = 1, add = 0;
};

// target[r] = the number at first + r·stride, for r = 0 … rows − 1. `swapped`: in the other byte
// order than the machine's.
void DecodeColumn(
    const char* first, std::size_t stride, int rows, ScalarType type, bool swapped, double* target);

// Hands `count` records of `stride` bytes to the filter; `columns` are in the order of the
// filter's. Throws ReadError where the file ends before.
void ReadRecords(ByteSource& source,
                 std::int64_t count,
                 std::size_t stride,
                 const std::vector<BinaryColumn>& columns,
                 bool swapped,
                 CloudFilter& filter);

}  // namespace batten::internal
