// SPDX-License-Identifier: MIT
#include "fitting/linear/band_kernels.h"

#include <algorithm>
#include <cmath>

#include "geometry/numeric/run_time_dispatch.h"

// Each instruction set has tiles of its own shape, so clones of one function would not do.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define BATTEN_TARGETS
#endif

namespace batten::internal {
namespace {

// L doubles in registers, and the same wherever doubles may stand.
template <int L>
struct Lanes {
  typedef double Vector __attribute__((vector_size(L * sizeof(double))));
  typedef double InMemory __attribute__((vector_size(L * sizeof(double)), aligned(8), may_alias));
};

// A tile of M·L rows and N columns, and what is done with it.
template <int L, int M, int N>
struct Tile {
  using V = typename Lanes<L>::Vector;
  using Memory = typename Lanes<L>::InMemory;
  static constexpr int kRows = M * L;

  V x[N][M];

  static BATTEN_INLINE V Load(const double* from) { return *reinterpret_cast<const Memory*>(from); }
  static BATTEN_INLINE void Store(V value, double* to) { *reinterpret_cast<Memory*>(to) = value; }

  BATTEN_INLINE void Clear() {
    for (int n = 0; n < N; ++n) {
      for (int m = 0; m < M; ++m) x[n][m] = V{};
    }
  }

  // Subtracts Σ_k a_k b_kᵀ, both packed.
  BATTEN_INLINE void Subtract(const double* a, const double* b, int depth) {
    for (int k = 0; k < depth; ++k, a += kRows, b += kRows) {
      V left[M];
      for (int m = 0; m < M; ++m) left[m] = Load(a + m * L);
      for (int n = 0; n < N; ++n) {
        for (int m = 0; m < M; ++m) x[n][m] -= left[m] * b[n];
      }
    }
  }

  // Multiplies from the right by the inverse of a triangle's transpose, whose rows are packed.
  BATTEN_INLINE void Divide(const double* triangle, const double* inverses) {
    for (int n = 0; n < N; ++n) {
      for (int k = 0; k < n; ++k) {
        for (int m = 0; m < M; ++m) x[n][m] -= x[k][m] * triangle[k * kRows + n];
      }
      for (int m = 0; m < M; ++m) x[n][m] *= inverses[n];
    }
  }

  BATTEN_INLINE void ToPacked(double* to) const {
    for (int n = 0; n < N; ++n) {
      for (int m = 0; m < M; ++m) Store(x[n][m], to + n * kRows + m * L);
    }
  }
};

// The part of a tile that is stored: of column c + n the rows [first, last) of the tile.
struct Part {
  int first, last;
};
template <int Rows>
BATTEN_INLINE Part PartOf(const BandColumns& band, int row, int column, int least_row) {
  return {std::clamp(least_row - row, 0, Rows), std::clamp(band.ends[column] - row, 0, Rows)};
}

// The elements of rows [row, row + kRows) and `columns` columns from c on into a buffer; zeros
// where nothing is stored, or above the diagonal.
template <int Rows>
BATTEN_INLINE void ReadEdge(
    const BandColumns& band, int row, int column, int columns, int least_row, double* buffer) {
  for (int n = 0; n < columns; ++n, buffer += Rows) {
    const int c = column + n;
    const Part part = PartOf<Rows>(band, row, c, std::max(least_row, c));
    const double* from = band.Column(c) + row;
    for (int i = 0; i < Rows; ++i) buffer[i] = 0;
    for (int i = part.first; i < part.last; ++i) buffer[i] = from[i];
  }
}

template <int Rows>
BATTEN_INLINE void WriteEdge(const BandColumns& band,
                             int row,
                             int column,
                             int columns,
                             int least_row,
                             const double* buffer) {
  for (int n = 0; n < columns; ++n, buffer += Rows) {
    const int c = column + n;
    const Part part = PartOf<Rows>(band, row, c, std::max(least_row, c));
    double* to = band.Column(c) + row;
    for (int i = part.first; i < part.last; ++i) to[i] = buffer[i];
  }
}

template <int L, int M, int N>
struct Kernels {
  using TileOf = Tile<L, M, N>;
  using V = typename TileOf::V;
  static constexpr int kRows = TileOf::kRows;

  static BATTEN_INLINE double* PanelAt(const BandStep& step, int row) {
    return step.packed + static_cast<std::ptrdiff_t>((row - step.begin) / kRows) * kRows *
                             (step.end - step.begin + N);
  }

  // Columns [column, column + N) of the panel at `row`, less the step's columns before; rows from
  // `least_row` on count. Read from the band.
  static BATTEN_INLINE void Reduced(const BandColumns& band,
                                    const BandStep& step,
                                    int row,
                                    int column,
                                    int least_row,
                                    TileOf& tile) {
    const int columns = std::min(N, step.end - column);
    const bool whole = columns == N && least_row <= row && column + N - 1 <= row &&
                       row + kRows <= band.ends[column];
    if (whole) {
      BandColumns::Walk from(band, column);
      for (int n = 0; n < N; ++n, from.Next()) {
        for (int m = 0; m < M; ++m) tile.x[n][m] = TileOf::Load(from.at(row) + m * L);
      }
    } else {
      double buffer[N * kRows] = {};
      ReadEdge<kRows>(band, row, column, columns, least_row, buffer);
      for (int n = 0; n < N; ++n) {
        for (int m = 0; m < M; ++m) tile.x[n][m] = TileOf::Load(buffer + n * kRows + m * L);
      }
    }
    const int inside = (column - step.begin) % kRows;
    tile.Subtract(PanelAt(step, row), PanelAt(step, column) + inside, column - step.begin);
  }

  // The same, divided by the columns' triangle, into the panel and the band.
  static BATTEN_INLINE void SolveTile(
      const BandColumns& band, const BandStep& step, int row, int column, int least_row) {
    TileOf tile;
    Reduced(band, step, row, column, least_row, tile);
    const int depth = column - step.begin, inside = depth % kRows;
    const double* triangle = PanelAt(step, column) + depth * kRows + inside;
    tile.Divide(triangle, step.inverses + depth);
    const int columns = std::min(N, step.end - column);
    if (columns == N && least_row <= row && column + N - 1 <= row &&
        row + kRows <= band.ends[column]) {
      tile.ToPacked(PanelAt(step, row) + depth * kRows);
      BandColumns::Walk to(band, column);
      for (int n = 0; n < N; ++n, to.Next()) {
        for (int m = 0; m < M; ++m) TileOf::Store(tile.x[n][m], to.at(row) + m * L);
      }
      return;
    }
    double buffer[N * kRows];
    tile.ToPacked(buffer);
    WriteEdge<kRows>(band, row, column, columns, least_row, buffer);
    // Rows before are those of the triangle, which has its place already.
    double* panel = PanelAt(step, row) + depth * kRows;
    for (int n = 0; n < N; ++n) {
      for (int i = std::max(0, least_row - row); i < kRows; ++i)
        panel[n * kRows + i] = buffer[n * kRows + i];
    }
  }

  // The triangle of columns [column, column + N), into the panel and the band.
  static BATTEN_INLINE bool FactorTriangle(const BandColumns& band,
                                           const BandStep& step,
                                           int column) {
    const int depth = column - step.begin, inside = depth % kRows, row = column - inside;
    const int columns = std::min(N, step.end - column);
    TileOf tile;
    Reduced(band, step, row, column, column, tile);
    double buffer[N * kRows];
    tile.ToPacked(buffer);
    double* inverses = step.inverses + depth;
    double* l = buffer + inside;  // element (i, j) at j · kRows + i
    for (int j = columns; j < N; ++j) l[j * kRows + j] = 1;
    for (int j = 0; j < N; ++j) {
      double* column_j = l + j * kRows;
      if (!(column_j[j] > 0)) return false;
      const double pivot = std::sqrt(column_j[j]);
      column_j[j] = pivot;
      inverses[j] = 1 / pivot;
      for (int i = j + 1; i < N; ++i) column_j[i] *= inverses[j];
      for (int k = j + 1; k < N; ++k) {
        for (int i = k; i < N; ++i) l[k * kRows + i] -= column_j[k] * column_j[i];
      }
    }
    double* panel = PanelAt(step, column) + depth * kRows + inside;
    for (int j = 0; j < N; ++j) {
      for (int i = 0; i < j; ++i) panel[j * kRows + i] = 0;
      for (int i = j; i < N; ++i) panel[j * kRows + i] = l[j * kRows + i];
      if (j >= columns) continue;
      double* to = band.Column(column + j) + column;
      const int last = std::min(band.ends[column + j] - column, columns);
      for (int i = j; i < last; ++i) to[i] = l[j * kRows + i];
    }
    return true;
  }

  static BATTEN_INLINE bool Diagonal(const BandColumns& band, const BandStep& step) {
    for (int column = step.begin; column < step.end; column += N) {
      if (!FactorTriangle(band, step, column)) return false;
      const int next = column + N;
      for (int row = column - (column - step.begin) % kRows; row < step.end; row += kRows) {
        if (row + kRows > next) SolveTile(band, step, row, column, next);
      }
    }
    return true;
  }

  static BATTEN_INLINE void Below(const BandColumns& band, const BandStep& step, int row) {
    for (int column = step.begin; column < step.end; column += N)
      SolveTile(band, step, row, column, row);
  }

  static BATTEN_INLINE void Trailing(const BandColumns& band, const BandStep& step, int row) {
    const int depth = step.end - step.begin;
    const double* a = PanelAt(step, row);
    const int last = std::min(row + kRows, step.reach);
    for (int column = step.end; column < last; column += N) {
      const double* b = PanelAt(step, column) + (column - step.begin) % kRows;
      TileOf tile;
      tile.Clear();
      tile.Subtract(a, b, depth);
      if (column + N - 1 <= row && row + kRows <= step.reach) {
        BandColumns::Walk walk(band, column);
        for (int n = 0; n < N; ++n, walk.Next()) {
          double* to = walk.at(row);
          for (int m = 0; m < M; ++m)
            TileOf::Store(TileOf::Load(to + m * L) + tile.x[n][m], to + m * L);
        }
        continue;
      }
      double buffer[N * kRows];
      tile.ToPacked(buffer);
      for (int n = 0; n < std::min(N, last - column); ++n) {
        double* to = band.Column(column + n);
        const int end = std::min(row + kRows, step.reach);
        for (int i = std::max(row, column + n); i < end; ++i) to[i] += buffer[n * kRows + i - row];
      }
    }
  }

  static BATTEN_INLINE bool Narrow(const BandColumns& band) {
    for (int j = 0; j < band.size; ++j) {
      double* l = band.Column(j);
      if (!(l[j] > 0)) return false;
      const double pivot = std::sqrt(l[j]), inverse = 1 / pivot;
      l[j] = pivot;
      const int end = band.ends[j];
      for (int i = j + 1; i < end; ++i) l[i] *= inverse;
      for (int k = j + 1; k < end; ++k) {
        double* to = band.Column(k);
        const double factor = l[k];
        for (int i = k; i < end; ++i) to[i] -= factor * l[i];
      }
    }
    return true;
  }

  // A row of right-hand sides.
  struct Row {
    static constexpr int kVectors = kBandLanes / L;
    V x[kVectors];

    static BATTEN_INLINE Row From(const double* from) {
      Row row;
      for (int v = 0; v < kVectors; ++v) row.x[v] = TileOf::Load(from + v * L);
      return row;
    }
    BATTEN_INLINE void To(double* to) const {
      for (int v = 0; v < kVectors; ++v) TileOf::Store(x[v], to + v * L);
    }
    BATTEN_INLINE void Subtract(double factor, const Row& other) {
      for (int v = 0; v < kVectors; ++v) x[v] -= factor * other.x[v];
    }
    BATTEN_INLINE void Divide(double by) {
      const double inverse = 1 / by;
      for (int v = 0; v < kVectors; ++v) x[v] *= inverse;
    }
  };

  static constexpr int kTogether = 4;  // columns

  static BATTEN_INLINE void Forward(const BandColumns& band, double* x) {
    constexpr int kLanes = kBandLanes;
    for (int j = 0; j < band.size; j += kTogether) {
      const int columns = std::min(kTogether, band.size - j);
      const double* l[kTogether];
      Row y[kTogether];
      for (int c = 0; c < columns; ++c) l[c] = band.Column(j + c);
      for (int c = 0; c < columns; ++c) {
        y[c] = Row::From(x + (j + c) * kLanes);
        for (int k = 0; k < c; ++k) {
          if (j + c < band.ends[j + k]) y[c].Subtract(l[k][j + c], y[k]);
        }
        y[c].Divide(l[c][j + c]);
        y[c].To(x + (j + c) * kLanes);
      }
      int i = j + columns;
      if (columns == kTogether) {
        for (; i < band.ends[j]; ++i) {
          Row sum = Row::From(x + i * kLanes);
          for (int c = 0; c < kTogether; ++c) sum.Subtract(l[c][i], y[c]);
          sum.To(x + i * kLanes);
        }
      }
      for (; i < band.ends[j + columns - 1]; ++i) {
        Row sum = Row::From(x + i * kLanes);
        for (int c = 0; c < columns; ++c) {
          if (i < band.ends[j + c]) sum.Subtract(l[c][i], y[c]);
        }
        sum.To(x + i * kLanes);
      }
    }
  }

  static BATTEN_INLINE void Backward(const BandColumns& band, double* x) {
    constexpr int kLanes = kBandLanes;
    for (int j = (band.size - 1) / kTogether * kTogether; j >= 0; j -= kTogether) {
      const int columns = std::min(kTogether, band.size - j);
      const double* l[kTogether];
      Row y[kTogether];
      for (int c = 0; c < columns; ++c) {
        l[c] = band.Column(j + c);
        y[c] = Row::From(x + (j + c) * kLanes);
      }
      int i = j + columns;
      if (columns == kTogether) {
        for (; i < band.ends[j]; ++i) {
          const Row from = Row::From(x + i * kLanes);
          for (int c = 0; c < kTogether; ++c) y[c].Subtract(l[c][i], from);
        }
      }
      for (; i < band.ends[j + columns - 1]; ++i) {
        const Row from = Row::From(x + i * kLanes);
        for (int c = 0; c < columns; ++c) {
          if (i < band.ends[j + c]) y[c].Subtract(l[c][i], from);
        }
      }
      for (int c = columns - 1; c >= 0; --c) {
        for (int k = c + 1; k < columns; ++k) {
          if (j + k < band.ends[j + c]) y[c].Subtract(l[c][j + k], y[k]);
        }
        y[c].Divide(l[c][j + c]);
        y[c].To(x + (j + c) * kLanes);
      }
    }
  }
};

template <int L, int M, int N>
BATTEN_INLINE bool Run(BandWork work, const BandColumns& band, const BandStep& step, int row) {
  using Set = Kernels<L, M, N>;
  switch (work) {
    case BandWork::kDiagonal:
      return Set::Diagonal(band, step);
    case BandWork::kBelow:
      Set::Below(band, step, row);
      break;
    case BandWork::kTrailing:
      Set::Trailing(band, step, row);
      break;
    case BandWork::kNarrow:
      return Set::Narrow(band);
    case BandWork::kForward:
      Set::Forward(band, step.packed);
      break;
    case BandWork::kBackward:
      Set::Backward(band, step.packed);
      break;
  }
  return true;
}

bool RunBaseline(BandWork work, const BandColumns& band, const BandStep& step, int row) {
  return Run<2, 2, 4>(work, band, step, row);
}

#ifdef BATTEN_TARGETS
__attribute__((target("arch=x86-64-v3"))) bool RunAvx2(BandWork work,
                                                       const BandColumns& band,
                                                       const BandStep& step,
                                                       int row) {
  return Run<4, 2, 4>(work, band, step, row);
}

__attribute__((target("arch=x86-64-v4"))) bool RunAvx512(BandWork work,
                                                         const BandColumns& band,
                                                         const BandStep& step,
                                                         int row) {
  return Run<8, 2, 8>(work, band, step, row);
}

#endif

}  // namespace

const BandKernels& BandKernelsHere() {
  static const BandKernels kernels = [] {
#ifdef BATTEN_TARGETS
    if (__builtin_cpu_supports("x86-64-v4")) return BandKernels{16, 8, RunAvx512};
    if (__builtin_cpu_supports("x86-64-v3")) return BandKernels{8, 4, RunAvx2};
#endif
    return BandKernels{4, 4, RunBaseline};
  }();
  return kernels;
}

}  // namespace batten::internal
