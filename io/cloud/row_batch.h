// SPDX-License-Identifier: MIT
// Some rows of a file of points, decoded to double and laid out by column.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace batten::internal {

// What readers hand to the filter: the needed columns of up to kRows rows, and where each row
// stands in its file (line of a text, byte of a binary body).
struct RowBatch {
  static constexpr int kRows = 1024;

  explicit RowBatch(std::size_t columns) : values(columns * kRows), places(kRows) {}

  double* column(std::size_t c) { return values.data() + c * kRows; }
  const double* column(std::size_t c) const { return values.data() + c * kRows; }

  int rows = 0;
  std::vector<double> values;
  std::vector<std::int64_t> places;
};

}  // namespace batten::internal
