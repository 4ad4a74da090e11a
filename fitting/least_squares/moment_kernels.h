// SPDX-License-Identifier: MIT
// Kernels that sort points into knot cells and sum the moments of one cell: loops over plain
// memory, compiled for several instruction sets and chosen at run time. No Eigen type crosses this
// header.
//
// On a cell t, o = 1 − t ∈ [0, 1] are the places in its outer span from start and end, and s, r
// those in its inner one. The moments of a cell, one behind the other, are
//   Σ w t^k o^(2p−k) s^l r^(2q−l)   at k·(2q+1) + l,
//   Σ w z_d t^i o^(p−i) s^j r^(q−j)   at (d·(p+1) + i)·(q+1) + j behind them,
//   Σ w |z|²   last.
// Every product of two B-spline functions of the cell, and every function, is a sum of such forms
// with positive factors: no digits are lost, whatever the degree.
#pragma once

#include <cstddef>

#include "batten/fitting/point_rows.h"
#include "geometry/evaluation/kernel_tables.h"

namespace batten::internal {

// A problem's degrees and dimension. A curve has inner degree 0.
struct MomentSizes {
  int p, q, dimension;

  int squares() const {
    return (2 * p + 1) * (2 * q + 1);
  }  // how many moments are of weights alone
  int values() const { return dimension * (p + 1) * (q + 1); }
  int all() const { return squares() + values() + 1; }
};

// Points are copied to records (outer, inner, values, weight), the weight only where there are any.
inline int RecordSize(const PointRows& points) {
  return 2 + points.dimension + (points.weights != nullptr ? 1 : 0);
}

// cells[k − begin] = span of the outer · inner spans + span of the inner axis (null: 0) that point
// k lies in, of spans of positive length; points of weight zero get the number of cells. Adds how
// many each got to `counts`. Throws std::invalid_argument for a parameter that is not a number.
void FindCells(const AxisTable& outer,
               const AxisTable* inner,
               const PointRows& points,
               std::ptrdiff_t begin,
               std::ptrdiff_t end,
               int* cells,
               int* counts);

// Record next[cell]++ of `records` becomes point k, for every point but those of cell `none`.
void DealPoints(const PointRows& points,
                std::ptrdiff_t begin,
                std::ptrdiff_t end,
                const int* cells,
                int none,
                int* next,
                double* records);

// Doubles of working memory that AddMoments needs, at the start of a cache line.
std::size_t MomentMemory(const MomentSizes& sizes);

// Adds the moments of `count` records of one cell.
void AddMoments(const TableSpan& outer,
                const TableSpan& inner,
                const MomentSizes& sizes,
                bool weighted,
                const double* records,
                std::ptrdiff_t count,
                double* memory,
                double* moments);

// A small matrix product: row r < rows of `out` += Σ_{k < terms} a[r·a_row + k·a_term] · row k of
// b; rows of length `width`, row r of out at out + r·out_row, row k of b at b + k·b_row.
void AddProduct(int rows,
                int terms,
                int width,
                const double* a,
                std::ptrdiff_t a_row,
                std::ptrdiff_t a_term,
                const double* b,
                std::ptrdiff_t b_row,
                double* out,
                std::ptrdiff_t out_row);

}  // namespace batten::internal
