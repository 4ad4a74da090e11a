// SPDX-License-Identifier: MIT
// Rows of numbers kept until the end of a file says what they mean. Not installed.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "io/cloud/cloud_filter.h"

namespace batten::internal {

// Rows of `width` numbers each, in pieces, so that growing copies nothing.
class VertexRows {
 public:
  explicit VertexRows(std::size_t width) : width_(width) {}

  std::size_t width() const { return width_; }
  std::int64_t size() const { return size_; }

  // A row more, for the caller to fill.
  double* Add() {
    const auto at = static_cast<std::size_t>(size_) % kPieceRows;
    if (at == 0) pieces_.push_back(std::make_unique_for_overwrite<double[]>(kPieceRows * width_));
    ++size_;
    return pieces_.back().get() + at * width_;
  }

  const double* Row(std::int64_t k) const {
    const auto at = static_cast<std::size_t>(k);
    return pieces_[at / kPieceRows].get() + at % kPieceRows * width_;
  }

  // Frees the piece of rows 0 … k − 1 that ends at k, if one does.
  void FreeBefore(std::int64_t k) {
    const auto at = static_cast<std::size_t>(k);
    if (at > 0 && at % kPieceRows == 0) pieces_[at / kPieceRows - 1].reset();
  }

 private:
  static constexpr std::size_t kPieceRows = 16 * RowBatch::kRows;

  std::size_t width_;
  std::int64_t size_ = 0;
  std::vector<std::unique_ptr<double[]>> pieces_;
};

// Hands equally many rows of all groups, one beside the other as the columns of one file, to the
// filter, and frees them on the way. Places are the numbers of the rows, from 1.
void FeedRows(std::vector<VertexRows> groups, CloudFilter& filter);

}  // namespace batten::internal
