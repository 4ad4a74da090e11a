// SPDX-License-Identifier: MIT
#include "fitting/least_squares/cell_moments.h"

#include <algorithm>
#include <memory>

#include "geometry/evaluation/evaluation_table.h"

namespace batten::internal {
namespace {

// Points sorted into cells together: enough for every cell to get a sizeable batch, few enough to
// stay in a cache.
constexpr std::ptrdiff_t kChunk = 1 << 17;
constexpr std::ptrdiff_t kChunkPerCell = 32;

// Points of a chunk that one thread looks up; each such block counts its cells by itself.
constexpr std::ptrdiff_t kBlock = 1 << 14;
constexpr std::ptrdiff_t kBlockPerCell = 8;

// The largest number of parts in which cells are summed, and the least cells in a part.
constexpr std::ptrdiff_t kParts = 256, kCells = 8;

// A chunk of points, sorted by cell.
class DealtPoints {
 public:
  DealtPoints(const AxisTable& outer,
              const AxisTable* inner,
              const PointRows& points,
              std::ptrdiff_t cell_count)
      : outer_(outer),
        inner_(inner),
        points_(points),
        cell_count_(cell_count),
        chunk_(std::min(points.count, std::max(kChunk, kChunkPerCell * cell_count))),
        block_(std::max(kBlock, kBlockPerCell * cell_count)),
        starts_(static_cast<size_t>(cell_count) + 1),
        cells_(new int[static_cast<size_t>(chunk_)]),
        next_(static_cast<size_t>(Blocks(chunk_) * (cell_count + 1))),
        records_(new double[static_cast<size_t>(chunk_ * RecordSize(points))]) {}

  std::ptrdiff_t chunk() const { return chunk_; }

  // Points [begin, end), a chunk at most.
  void Deal(std::ptrdiff_t begin, std::ptrdiff_t end, ThreadPool& pool) {
    const std::ptrdiff_t blocks = Blocks(end - begin);
    ForBlocks(begin, end, pool, [&](std::ptrdiff_t first, std::ptrdiff_t last, int* next) {
      std::fill_n(next, cell_count_ + 1, 0);
      FindCells(outer_, inner_, points_, first, last, cells_.get() + (first - begin), next);
    });
    int running = 0;
    for (std::ptrdiff_t c = 0; c < cell_count_; ++c) {
      starts_[static_cast<size_t>(c)] = running;
      for (std::ptrdiff_t b = 0; b < blocks; ++b) {
        int& next = next_[static_cast<size_t>(b * (cell_count_ + 1) + c)];
        const int here = next;
        next = running;
        running += here;
      }
    }
    starts_.back() = running;
    ForBlocks(begin, end, pool, [&](std::ptrdiff_t first, std::ptrdiff_t last, int* next) {
      DealPoints(points_,
                 first,
                 last,
                 cells_.get() + (first - begin),
                 static_cast<int>(cell_count_),
                 next,
                 records_.get());
    });
  }

  int size(std::ptrdiff_t cell) const {
    return starts_[static_cast<size_t>(cell) + 1] - starts_[static_cast<size_t>(cell)];
  }
  const double* records(std::ptrdiff_t cell) const {
    return records_.get() +
           std::ptrdiff_t{starts_[static_cast<size_t>(cell)]} * RecordSize(points_);
  }

 private:
  std::ptrdiff_t Blocks(std::ptrdiff_t count) const { return (count + block_ - 1) / block_; }

  template <class Body>
  void ForBlocks(std::ptrdiff_t begin, std::ptrdiff_t end, ThreadPool& pool, const Body& body) {
    pool.For(Blocks(end - begin), 1, [&](std::ptrdiff_t from, std::ptrdiff_t to) {
      for (std::ptrdiff_t b = from; b < to; ++b) {
        const std::ptrdiff_t first = begin + b * block_;
        body(first,
             std::min(end, first + block_),
             next_.data() + static_cast<size_t>(b * (cell_count_ + 1)));
      }
    });
  }

  const AxisTable& outer_;
  const AxisTable* inner_;
  const PointRows& points_;
  std::ptrdiff_t cell_count_, chunk_, block_;
  std::vector<int> starts_;  // of the cells in records_
  std::unique_ptr<int[]> cells_;
  std::vector<int> next_;  // of every block, the place of its next point of a cell
  std::unique_ptr<double[]> records_;
};

}  // namespace

CellMoments::CellMoments(const MomentSizes& sizes, int outer_spans, int inner_spans)
    : sizes_(sizes), outer_spans_(outer_spans), inner_spans_(inner_spans) {
  moments_.assign(Index(outer_spans, 0), 0.0);
}

CellMoments::CellMoments(const AxisTable& outer,
                         const AxisTable* inner,
                         const PointRows& points,
                         ThreadPool& pool)
    : CellMoments({outer.degree, inner != nullptr ? inner->degree : 0, points.dimension},
                  outer.span_count,
                  inner != nullptr ? inner->span_count : 1) {
  Add(outer, inner, points, pool);
}

bool CellMoments::filled(int outer_span, int inner_span) const {
  // Each is a sum of positive products, of which no point has but zeros.
  const double* moments = at(outer_span, inner_span);
  return std::any_of(moments, moments + sizes_.squares(), [](double sum) { return sum != 0; });
}

void CellMoments::Add(const AxisTable& outer,
                      const AxisTable* inner,
                      const PointRows& points,
                      ThreadPool& pool) {
  if (points.count == 0) return;
  const std::ptrdiff_t cells = std::ptrdiff_t{outer_spans_} * inner_spans_;
  const TableSpan whole{0, 1, 1};
  DealtPoints dealt(outer, inner, points, cells);
  for (std::ptrdiff_t begin = 0; begin < points.count; begin += dealt.chunk()) {
    dealt.Deal(begin, std::min(points.count, begin + dealt.chunk()), pool);
    pool.For(
        cells, std::max(kCells, cells / kParts), [&](std::ptrdiff_t first, std::ptrdiff_t last) {
          AlignedDoubles memory(MomentMemory(sizes_));
          for (std::ptrdiff_t c = first; c < last; ++c) {
            if (dealt.size(c) == 0) continue;
            AddMoments(outer.spans[c / inner_spans_],
                       inner != nullptr ? inner->spans[c % inner_spans_] : whole,
                       sizes_,
                       points.weights != nullptr,
                       dealt.records(c),
                       dealt.size(c),
                       memory.data(),
                       moments_.data() + c * sizes_.all());
          }
        });
  }
}

}  // namespace batten::internal
