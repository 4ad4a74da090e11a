// SPDX-License-Identifier: MIT
#include "fitting/linear/block_banded_matrix.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

#include "fitting/linear/band_kernels.h"

namespace batten::internal {
namespace {

constexpr int kNarrow = 24;        // half bandwidth up to which columns go one by one
constexpr int kMostColumns = 128;  // in a step
constexpr int kShare = 4;          // a step takes at most one part in so many of the band
constexpr int kForThreads = 256;   // half bandwidth from which on threads are used
constexpr int kPanelsAtOnce = 2;

// Columns of a step: a share of the band, so that its own rows cost little.
int StepColumns(int band, const BandKernels& kernels) {
  const int unit = std::max(kernels.rows, kernels.columns);
  return std::max(1, std::min(kMostColumns, band / kShare) / unit) * unit;
}

// For each column, one past the last nonzero row in this or an earlier column.
std::vector<int> EndsOf(const BandColumns& band, int bandwidth) {
  std::vector<int> ends(static_cast<size_t>(band.size));
  int end = 0;
  for (int j = 0; j < band.size; ++j) {
    const double* column = band.Column(j);
    const int first = j - j % band.width;
    const int last = static_cast<int>(
        std::min<std::ptrdiff_t>(band.size, first + (std::ptrdiff_t{bandwidth} + 1) * band.width));
    int row = last;
    while (row > std::max(end, j + 1) && column[row - 1] == 0) --row;
    end = std::max(end, row);
    ends[static_cast<size_t>(j)] = end;
  }
  return ends;
}

// Right-hand sides row by row.
using LaneRows = Eigen::Map<Eigen::Matrix<double, kBandLanes, Eigen::Dynamic>>;

int WidthOf(const std::vector<int>& ends) {
  int width = 0;
  for (size_t j = 0; j < ends.size(); ++j)
    width = std::max(width, ends[j] - 1 - static_cast<int>(j));
  return width;
}

}  // namespace

BlockBandedMatrix::BlockBandedMatrix(int blocks, int block_size, int bandwidth)
    : blocks_(blocks), block_size_(block_size), bandwidth_(bandwidth) {
  if (blocks < 1 || block_size < 1 || bandwidth < 0) {
    throw std::invalid_argument("BlockBandedMatrix: sizes must be positive");
  }
  data_.assign(static_cast<size_t>(blocks) * (bandwidth + 1) * block_size * block_size, 0.0);
}

void BlockBandedMatrix::RejectBlock(int row, int below) const {
  throw std::invalid_argument("BlockBandedMatrix: block (" + std::to_string(row) + ", " +
                              std::to_string(row - below) + ") of " + std::to_string(blocks_) +
                              " rows is not at most " + std::to_string(bandwidth_) +
                              " below the diagonal");
}

double BlockBandedMatrix::Trace() const {
  double trace = 0;
  for (int k = 0; k < blocks_; ++k) trace += at(k, 0).trace();
  return trace;
}

void BlockBandedMatrix::AddToDiagonal(double value) {
  for (int k = 0; k < blocks_; ++k) at(k, 0).diagonal().array() += value;
}

void BlockBandedMatrix::Pin(const std::vector<Eigen::Index>& rows, double pivot) {
  for (const Eigen::Index row : rows) {
    const int block = static_cast<int>(row) / block_size_,
              inside = static_cast<int>(row) % block_size_;
    for (int below = 0; below <= std::min(block, bandwidth_); ++below) {
      at(block, below).row(inside).setZero();
    }
    for (int below = 0; below <= bandwidth_ && block + below < blocks_; ++below) {
      at(block + below, below).col(inside).setZero();
    }
    at(block, 0)(inside, inside) = pivot;
  }
}

Eigen::MatrixXd BlockBandedMatrix::Times(const Eigen::MatrixXd& x) const {
  const int b = block_size_;
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(x.rows(), x.cols());
  for (int row = 0; row < blocks_; ++row) {
    for (int below = 0; below <= std::min(bandwidth_, row); ++below) {
      const auto block = at(row, below);
      const int column = row - below;
      result.middleRows(row * b, b).noalias() += block * x.middleRows(column * b, b);
      if (below > 0)
        result.middleRows(column * b, b).noalias() += block.transpose() * x.middleRows(row * b, b);
    }
  }
  return result;
}

BandColumns BlockBandedMatrix::Columns() const {
  return {const_cast<double*>(data_.data()),
          size(),
          block_size_,
          stride() * block_size_,
          stride(),
          ends_.data()};
}

bool BlockBandedMatrix::Factor(ThreadPool* pool) {
  ends_ = EndsOf(Columns(), bandwidth_);
  const BandColumns band = Columns();
  const BandKernels& kernels = BandKernelsHere();
  const int width = WidthOf(ends_);
  if (width <= kNarrow) return kernels.run(BandWork::kNarrow, band, {}, 0);
  const int columns = StepColumns(width, kernels);
  const std::ptrdiff_t panel = std::ptrdiff_t{columns + kernels.columns} * kernels.rows;
  std::vector<double> packed(
      static_cast<size_t>(PanelCount(columns + width, kernels.rows) * panel)),
      inverses(static_cast<size_t>(columns + kernels.columns));
  const auto for_panels = [&](BandWork work, const BandStep& step) {
    const auto body = [&](std::ptrdiff_t first, std::ptrdiff_t last) {
      for (std::ptrdiff_t k = first; k < last; ++k)
        kernels.run(work, band, step, step.end + static_cast<int>(k) * kernels.rows);
    };
    const int panels = PanelCount(step.reach - step.end, kernels.rows);
    if (pool && width >= kForThreads) {
      pool->For(panels, kPanelsAtOnce, body);
    } else {
      body(0, panels);
    }
  };
  for (int begin = 0; begin < band.size; begin += columns) {
    const int end = std::min(band.size, begin + columns);
    const BandStep step{begin, end, band.ends[end - 1], packed.data(), inverses.data()};
    if (!kernels.run(BandWork::kDiagonal, band, step, 0)) return false;
    for_panels(BandWork::kBelow, step);
    for_panels(BandWork::kTrailing, step);
  }
  return true;
}

double BlockBandedMatrix::SmallestPivot() const {
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < blocks_; ++k)
    least = std::min(least, at(k, 0).diagonal().cwiseAbs2().minCoeff());
  return least;
}

void BlockBandedMatrix::Solve(Eigen::MatrixXd& rhs) const { Sweep(rhs, true, true); }
void BlockBandedMatrix::Forward(Eigen::MatrixXd& rhs) const { Sweep(rhs, true, false); }
void BlockBandedMatrix::Backward(Eigen::MatrixXd& rhs) const { Sweep(rhs, false, true); }

void BlockBandedMatrix::Sweep(Eigen::MatrixXd& rhs, bool forward, bool backward) const {
  const BandKernels& kernels = BandKernelsHere();
  const BandColumns band = Columns();
  std::vector<double> rows(static_cast<size_t>(band.size) * kBandLanes);
  const BandStep all{0, 0, 0, rows.data(), nullptr};
  LaneRows lanes(rows.data(), kBandLanes, band.size);
  for (Eigen::Index first = 0; first < rhs.cols(); first += kBandLanes) {
    const Eigen::Index count = std::min<Eigen::Index>(kBandLanes, rhs.cols() - first);
    if (count < kBandLanes) lanes.setZero();
    lanes.topRows(count) = rhs.middleCols(first, count).transpose();
    if (forward) kernels.run(BandWork::kForward, band, all, 0);
    if (backward) kernels.run(BandWork::kBackward, band, all, 0);
    rhs.middleCols(first, count) = lanes.topRows(count).transpose();
  }
}

}  // namespace batten::internal
