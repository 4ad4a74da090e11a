// SPDX-License-Identifier: MIT
#include "fitting/least_squares/moment_kernels.h"

#include <algorithm>

#include "geometry/evaluation/evaluation_lanes.h"
#include "geometry/numeric/run_time_dispatch.h"
#include "batten/geometry/spline_basis.h"

namespace batten::internal {
namespace {

constexpr int kLanes = 8;
constexpr int kBatch = 128;  // points whose forms are in memory at once: they fit the fastest cache

typedef double V8 __attribute__((vector_size(64)));
typedef double V4 __attribute__((vector_size(32)));
typedef double V2 __attribute__((vector_size(16)));

BATTEN_INLINE V8 At(const double* from) { return *reinterpret_cast<const V8*>(from); }
BATTEN_INLINE void Put(V8 value, double* to) { *reinterpret_cast<V8*>(to) = value; }
BATTEN_INLINE double Sum(V8 x) {
  const V4 four =
      __builtin_shufflevector(x, x, 0, 1, 2, 3) + __builtin_shufflevector(x, x, 4, 5, 6, 7);
  const V2 two =
      __builtin_shufflevector(four, four, 0, 1) + __builtin_shufflevector(four, four, 2, 3);
  return two[0] + two[1];
}

// The working memory: every row holds one number of each of the points of a batch.
struct Rows {
  double *t, *o, *s, *r, *w, *z;
  double *outer_squares, *inner_squares;  // t^k o^(2p−k) w, s^l r^(2q−l)
  double *outer_values, *inner_values;    // z_d t^i o^(p−i) w, s^j r^(q−j)
};

BATTEN_INLINE Rows RowsIn(double* memory, const MomentSizes& sizes) {
  Rows rows;
  const auto take = [&](int count) {
    double* first = memory;
    memory += static_cast<std::ptrdiff_t>(count) * kBatch;
    return first;
  };
  rows.t = take(1);
  rows.o = take(1);
  rows.s = take(1);
  rows.r = take(1);
  rows.w = take(1);
  rows.z = take(sizes.dimension);
  rows.outer_squares = take(2 * sizes.p + 1);
  rows.inner_squares = take(2 * sizes.q + 1);
  rows.outer_values = take(sizes.dimension * (sizes.p + 1));
  rows.inner_values = take(sizes.q + 1);
  return rows;
}

// Fixed > 0: the length of a record. Behind the last point the lanes are filled with points of
// weight zero.
template <int Fixed>
BATTEN_INLINE void Unpack(const TableSpan& outer,
                          const TableSpan& inner,
                          int dimension,
                          bool weighted,
                          const double* records,
                          int count,
                          const Rows& rows) {
  const int size = Fixed > 0 ? Fixed : 2 + dimension + (weighted ? 1 : 0);
  for (int k = 0; k < count; ++k) {
    const double *from = records + static_cast<std::ptrdiff_t>(k) * size, u = from[0], v = from[1];
    rows.t[k] = (u - outer.start) * outer.scale;
    rows.o[k] = (outer.end - u) * outer.scale;
    rows.s[k] = (v - inner.start) * inner.scale;
    rows.r[k] = (inner.end - v) * inner.scale;
    rows.w[k] = weighted ? from[size - 1] : 1.0;
    for (int d = 0; d < dimension; ++d) rows.z[d * kBatch + k] = from[2 + d];
  }
  for (int k = count; k % kLanes != 0; ++k) {
    rows.t[k] = rows.o[k] = rows.s[k] = rows.r[k] = rows.w[k] = 0;
    for (int d = 0; d < dimension; ++d) rows.z[d * kBatch + k] = 0;
  }
}

// Row j of `forms`: factor · t^j o^(degree−j), j = 0 … degree; no factors (null): ones.
template <int Fixed>
BATTEN_INLINE void FormLoop(
    int degree, const double* t, const double* o, const double* factor, int count, double* forms) {
  const int n = Fixed >= 0 ? Fixed : degree;
  for (int k = 0; k < count; k += kLanes) {
    const V8 T = At(t + k), O = At(o + k);
    V8 products[Fixed >= 0 ? Fixed + 1 : 2 * kMaxDegree + 1];
    V8 power = factor != nullptr ? At(factor + k) : V8{} + 1;
#pragma GCC unroll 8
    for (int j = 0; j <= n; ++j) {
      products[j] = power;
      power *= T;
    }
    power = V8{} + 1;
#pragma GCC unroll 8
    for (int j = n; j >= 0; --j) {
      Put(products[j] * power, forms + j * kBatch + k);
      power *= O;
    }
  }
}

BATTEN_INLINE void Forms(
    int degree, const double* t, const double* o, const double* factor, int count, double* forms) {
  switch (degree) {
    case 0:
      return FormLoop<0>(degree, t, o, factor, count, forms);
    case 2:
      return FormLoop<2>(degree, t, o, factor, count, forms);
    case 3:
      return FormLoop<3>(degree, t, o, factor, count, forms);
    case 6:
      return FormLoop<6>(degree, t, o, factor, count, forms);
    default:
      return FormLoop<-1>(degree, t, o, factor, count, forms);
  }
}

// out[i·out_row + j] += Σ over the points of row i of a times row j of b.
template <int I, int J>
BATTEN_INLINE void Block(const double* a, const double* b, int count, double* out, int out_row) {
  V8 sums[I][J] = {};
  for (int k = 0; k < count; k += kLanes) {
    V8 left[I];
#pragma GCC unroll 4
    for (int i = 0; i < I; ++i) left[i] = At(a + i * kBatch + k);
#pragma GCC unroll 4
    for (int j = 0; j < J; ++j) {
      const V8 right = At(b + j * kBatch + k);
#pragma GCC unroll 4
      for (int i = 0; i < I; ++i) sums[i][j] += left[i] * right;
    }
  }
#pragma GCC unroll 4
  for (int i = 0; i < I; ++i) {
#pragma GCC unroll 4
    for (int j = 0; j < J; ++j) out[i * out_row + j] += Sum(sums[i][j]);
  }
}

template <int J>
BATTEN_INLINE void Columns(
    const double* a, int rows, const double* b, int count, double* out, int out_row) {
  int i = 0;
  for (; i + 2 <= rows; i += 2) Block<2, J>(a + i * kBatch, b, count, out + i * out_row, out_row);
  if (i < rows) Block<1, J>(a + i * kBatch, b, count, out + i * out_row, out_row);
}

BATTEN_INLINE void Products(
    const double* a, int rows, const double* b, int columns, int count, double* out) {
  int j = 0;
  for (; j + 4 <= columns; j += 4) Columns<4>(a, rows, b + j * kBatch, count, out + j, columns);
  const double* rest = b + j * kBatch;
  switch (columns - j) {
    case 1:
      return Columns<1>(a, rows, rest, count, out + j, columns);
    case 2:
      return Columns<2>(a, rows, rest, count, out + j, columns);
    case 3:
      return Columns<3>(a, rows, rest, count, out + j, columns);
    default:
      return;
  }
}

// Multiplies the values by the weights; returns Σ w |z|².
BATTEN_INLINE double WeighValues(const Rows& rows, int dimension, int count) {
  V8 sum{};
  for (int d = 0; d < dimension; ++d) {
    for (int k = 0; k < count; k += kLanes) {
      double* z = rows.z + d * kBatch + k;
      const V8 weighed = At(rows.w + k) * At(z);
      sum += weighed * At(z);
      Put(weighed, z);
    }
  }
  return Sum(sum);
}

// Short record lengths are compile-time constants.
BATTEN_INLINE void UnpackAny(const TableSpan& outer,
                             const TableSpan& inner,
                             int dimension,
                             bool weighted,
                             const double* records,
                             int count,
                             const Rows& rows) {
  if (dimension == 1 && !weighted) return Unpack<3>(outer, inner, 1, false, records, count, rows);
  if (dimension == 1) return Unpack<4>(outer, inner, 1, true, records, count, rows);
  if (dimension == 3 && !weighted) return Unpack<5>(outer, inner, 3, false, records, count, rows);
  if (dimension == 3) return Unpack<6>(outer, inner, 3, true, records, count, rows);
  return Unpack<0>(outer, inner, dimension, weighted, records, count, rows);
}

BATTEN_INLINE void Deal(const double* from_outer,
                        const double* from_inner,
                        const double* values,
                        int dimension,
                        double* record) {
  record[0] = *from_outer;
  record[1] = from_inner != nullptr ? *from_inner : 0.0;
  for (int d = 0; d < dimension; ++d) record[2 + d] = values[d];
}

}  // namespace

BATTEN_CLONES void FindCells(const AxisTable& outer,
                             const AxisTable* inner,
                             const PointRows& points,
                             std::ptrdiff_t begin,
                             std::ptrdiff_t end,
                             int* cells,
                             int* counts) {
  const int columns = inner != nullptr ? inner->span_count : 1;
  const int none = outer.span_count * columns;
  for (std::ptrdiff_t k = begin; k < end; ++k) {
    int cell = lanes::Locate(outer, points.outer[k * points.stride]).span * columns;
    if (inner != nullptr) cell += lanes::Locate(*inner, points.inner[k * points.stride]).span;
    if (points.weights != nullptr && points.weights[k] == 0) cell = none;
    cells[k - begin] = cell;
    ++counts[cell];
  }
}

void DealPoints(const PointRows& points,
                std::ptrdiff_t begin,
                std::ptrdiff_t end,
                const int* cells,
                int none,
                int* next,
                double* records) {
  const int dimension = points.dimension, size = RecordSize(points);
  for (std::ptrdiff_t k = begin; k < end; ++k) {
    const int cell = cells[k - begin];
    if (cell == none) continue;
    double* record = records + static_cast<std::ptrdiff_t>(next[cell]++) * size;
    const double* outer = points.outer + k * points.stride;
    const double* inner = points.inner != nullptr ? points.inner + k * points.stride : nullptr;
    const double* values = points.values + k * dimension;
    if (dimension == 1) {
      Deal(outer, inner, values, 1, record);
    } else if (dimension == 3) {
      Deal(outer, inner, values, 3, record);
    } else {
      Deal(outer, inner, values, dimension, record);
    }
    if (points.weights != nullptr) record[size - 1] = points.weights[k];
  }
}

std::size_t MomentMemory(const MomentSizes& sizes) {
  return static_cast<std::size_t>(kBatch) *
         (5 + sizes.dimension + (2 * sizes.p + 1) + (2 * sizes.q + 1) +
          sizes.dimension * (sizes.p + 1) + (sizes.q + 1));
}

BATTEN_CLONES void AddMoments(const TableSpan& outer,
                              const TableSpan& inner,
                              const MomentSizes& sizes,
                              bool weighted,
                              const double* records,
                              std::ptrdiff_t count,
                              double* memory,
                              double* moments) {
  const Rows rows = RowsIn(memory, sizes);
  const int p = sizes.p, q = sizes.q, dimension = sizes.dimension;
  const int size = 2 + dimension + (weighted ? 1 : 0);
  for (std::ptrdiff_t first = 0; first < count; first += kBatch) {
    const int batch = static_cast<int>(std::min<std::ptrdiff_t>(kBatch, count - first));
    UnpackAny(outer, inner, dimension, weighted, records + first * size, batch, rows);
    moments[sizes.all() - 1] += WeighValues(rows, dimension, batch);
    Forms(2 * p, rows.t, rows.o, rows.w, batch, rows.outer_squares);
    Forms(2 * q, rows.s, rows.r, nullptr, batch, rows.inner_squares);
    Products(rows.outer_squares, 2 * p + 1, rows.inner_squares, 2 * q + 1, batch, moments);
    for (int d = 0; d < dimension; ++d) {
      Forms(p,
            rows.t,
            rows.o,
            rows.z + d * kBatch,
            batch,
            rows.outer_values + static_cast<std::ptrdiff_t>(d) * (p + 1) * kBatch);
    }
    Forms(q, rows.s, rows.r, nullptr, batch, rows.inner_values);
    Products(rows.outer_values,
             dimension * (p + 1),
             rows.inner_values,
             q + 1,
             batch,
             moments + sizes.squares());
  }
}

BATTEN_CLONES void AddProduct(int rows,
                              int terms,
                              int width,
                              const double* a,
                              std::ptrdiff_t a_row,
                              std::ptrdiff_t a_term,
                              const double* b,
                              std::ptrdiff_t b_row,
                              double* out,
                              std::ptrdiff_t out_row) {
  for (int r = 0; r < rows; ++r) {
    double* __restrict row = out + r * out_row;
    for (int k = 0; k < terms; ++k) {
      const double factor = a[r * a_row + k * a_term];
      const double* __restrict from = b + k * b_row;
      for (int c = 0; c < width; ++c) row[c] += factor * from[c];
    }
  }
}

}  // namespace batten::internal
