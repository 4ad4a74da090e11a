// SPDX-License-Identifier: MIT
// Kernels for the Cholesky factorisation of a symmetric band matrix and its triangular solves, on
// plain pointers, compiled for several instruction sets and chosen when the program runs. Internal.
//
// A step takes some columns at once: it factors their rows on the diagonal, solves the rows below
// for them, and takes what they give from the columns after them. Rows come in panels of a few
// lanes, copied so that a product of two panels reads memory in order and stays in registers.
#pragma once

#include <cstddef>

namespace batten::internal {

// The lower half of a symmetric matrix by columns: a group of `width` columns shares a rectangle
// that starts at the group's first row. Element (i, j) exists for j's group's first row ≤ i <
// ends[j]; ends never fall, and what is not stored is zero and stays so under elimination.
struct BandColumns {
  double* data;
  int size;              // columns
  int width;             // columns in a group
  std::ptrdiff_t group;  // from one group's data to the next
  std::ptrdiff_t stride;
  const int* ends;

  // Pointer to which i is added for element (i, j).
  double* Column(int j) const {
    const int g = j / width;
    return data + g * (group - width) + (j - g * width) * stride;
  }

  // Iterates over the columns in order.
  class Walk {
   public:
    Walk(const BandColumns& band, int j)
        : column_(band.Column(j)),
          left_(band.width - j % band.width),
          width_(band.width),
          stride_(band.stride),
          jump_(band.group - band.width - (band.width - 1) * band.stride) {}
    double* at(int row) const { return column_ + row; }
    void Next() {
      const bool crosses = --left_ == 0;
      column_ += crosses ? jump_ : stride_;
      if (crosses) left_ = width_;
    }

   private:
    double* column_;
    int left_, width_;
    std::ptrdiff_t stride_, jump_;
  };
};

// One step of the factorisation: columns [begin, end), the rows below them up to `reach`.
struct BandStep {
  int begin, end, reach;
  double* packed;    // panel after panel of rows from `begin` on
  double* inverses;  // of the diagonal
};

enum class BandWork {
  kDiagonal,  // the panels of the rows [begin, end): they become L
  kBelow,     // one panel of rows below, from row `row` on
  kTrailing,  // that panel's rows in the columns from `end` on, less the product of the panels
  kNarrow,    // the whole matrix, column by column: for narrow bands
  kForward,   // L y = b in place for kBandLanes right-hand sides, row by row, in `packed`
  kBackward   // Lᵀ x = y in place, the same way
};

// The kernels of one instruction set. `rows` and `columns` make a tile; the columns of a step, but
// of the last one, are a multiple of both. A call says false where a pivot is not positive.
struct BandKernels {
  int rows, columns;
  bool (*run)(BandWork work, const BandColumns& band, const BandStep& step, int row);
};

inline constexpr int kBandLanes = 8;

// The kernels for the processor the program runs on.
const BandKernels& BandKernelsHere();

// The number of panels that hold these rows.
inline int PanelCount(int rows, int panel) { return (rows + panel - 1) / panel; }

}  // namespace batten::internal
