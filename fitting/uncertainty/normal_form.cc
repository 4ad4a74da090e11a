// SPDX-License-Identifier: MIT
#include "fitting/uncertainty/normal_form.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <vector>

namespace batten::internal {
namespace {

constexpr double kPointsPerBlock = 4;  // fewer: blocks are the points themselves
constexpr double kSignificant = 4;     // standard deviations of a mean square
constexpr double kLeastLeft = 0.2;     // of a block's variance; less: the fit has taken it away
constexpr int kFinest = 4;             // parts of a knot span

// A knot cell, cut into parts × parts (curves: parts).
struct Block {
  int cell_u, cell_v, part_u, part_v;
  auto operator<=>(const Block&) const = default;
};

Block BlockOf(const SplineShape& shape, double u, double v, int parts) {
  Block block{};
  const auto place = [&](const SplineBasis& basis, double parameter, int& cell, int& part) {
    const double at = basis.Clamp(parameter);
    cell = basis.Span(at);
    const double low = basis.knots()[static_cast<size_t>(cell)],
                 high = basis.knots()[static_cast<size_t>(cell) + 1];
    part = std::clamp(static_cast<int>(parts * (at - low) / (high - low)), 0, parts - 1);
  };
  place(shape.u, u, block.cell_u, block.part_u);
  if (shape.v) place(*shape.v, v, block.cell_v, block.part_v);
  return block;
}

// The points by block, those of one block next to each other.
struct Sorted {
  std::vector<Block> blocks;
  std::vector<Eigen::Index> order;

  Sorted(const SplineShape& shape, const Eigen::Matrix2Xd& parameters, int parts)
      : blocks(static_cast<size_t>(parameters.cols())), order(blocks.size()) {
    for (size_t k = 0; k < blocks.size(); ++k) {
      const auto at = parameters.col(static_cast<Eigen::Index>(k));
      blocks[k] = BlockOf(shape, at[0], at[1], parts);
    }
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
      return blocks[static_cast<size_t>(a)] < blocks[static_cast<size_t>(b)];
    });
  }

  // Calls visit(first, last) for every block's range in `order`.
  template <typename Visit>
  void ForEach(const Visit& visit) const {
    for (size_t first = 0; first < order.size();) {
      size_t last = first + 1;
      while (last < order.size() &&
             blocks[static_cast<size_t>(order[last])] == blocks[static_cast<size_t>(order[first])])
        ++last;
      visit(first, last);
      first = last;
    }
  }
};

// A dense form over the unknowns that rows of one cell share.
class CellForm {
 public:
  void Add(const SparseRow& row, double weight) {
    for (const auto& [index, value] : row) {
      const auto found = std::lower_bound(indices_.begin(), indices_.end(), index);
      if (found == indices_.end() || *found != index) Insert(index);
    }
    places_.clear();
    for (const auto& [index, value] : row) {
      const auto found = std::lower_bound(indices_.begin(), indices_.end(), index);
      places_.push_back(found - indices_.begin());
    }
    for (size_t a = 0; a < row.size(); ++a) {
      for (size_t b = 0; b < row.size(); ++b)
        form_(places_[a], places_[b]) += weight * row[a].second * row[b].second;
    }
  }

  void MoveTo(std::vector<Eigen::Triplet<double>>& entries) {
    for (size_t a = 0; a < indices_.size(); ++a) {
      for (size_t b = 0; b < indices_.size(); ++b)
        entries.emplace_back(indices_[a],
                             indices_[b],
                             form_(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)));
    }
    indices_.clear();
    form_.resize(0, 0);
  }

 private:
  void Insert(int index) {
    const auto at = std::lower_bound(indices_.begin(), indices_.end(), index) - indices_.begin();
    const Eigen::Index old = form_.rows();
    Eigen::MatrixXd wider = Eigen::MatrixXd::Zero(old + 1, old + 1);
    std::vector<Eigen::Index> kept;
    for (Eigen::Index k = 0; k <= old; ++k)
      if (k != at) kept.push_back(k);
    wider(kept, kept) = form_;
    form_ = std::move(wider);
    indices_.insert(indices_.begin() + at, index);
  }

  std::vector<int> indices_;
  std::vector<Eigen::Index> places_;
  Eigen::MatrixXd form_;
};

// Sums over the blocks of one width: squares found and expected, and how many.
struct Growth {
  double found = 0, expected = 0, blocks = 0;
};

Growth GrowthAt(int parts,
                const DisplacementRows& rows,
                const WeighedPoints& points,
                const RowOfPoint& row_of,
                const std::function<double(const SparseRow&)>& unfitted,
                double variance) {
  Growth growth;
  const Sorted sorted(rows.shape(), points.parameters, parts);
  sorted.ForEach([&](size_t first, size_t last) {
    if (last - first < static_cast<size_t>(kPointsPerBlock)) return;
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(points.pulls.rows());
    std::map<int, double> row;
    double weight = 0;
    for (size_t k = first; k < last; ++k) {
      const Eigen::Index point = sorted.order[k];
      const double w = points.weights[point];
      sum += w * points.pulls.col(point) / points.slope;
      weight += w;
      for (const auto& [index, value] : row_of(point)) row[index] += w * value;
    }
    const double left = weight - unfitted(SparseRow(row.begin(), row.end()));
    if (left < kLeastLeft * weight) return;
    growth.found += sum.squaredNorm();
    growth.expected += points.components * variance * left;
    growth.blocks += points.components;
  });
  return growth;
}

}  // namespace

Eigen::SparseMatrix<double> NormalForm(const DisplacementRows& rows,
                                       const WeighedPoints& points,
                                       const RowOfPoint& row_of) {
  std::vector<Eigen::Triplet<double>> entries;
  CellForm cell;
  const Sorted sorted(rows.shape(), points.parameters, 1);
  sorted.ForEach([&](size_t first, size_t last) {
    for (size_t k = first; k < last; ++k)
      cell.Add(row_of(sorted.order[k]), points.weights[sorted.order[k]]);
    cell.MoveTo(entries);
  });
  Eigen::SparseMatrix<double> form(rows.unknowns(), rows.unknowns());
  form.setFromTriplets(entries.begin(), entries.end());
  return form;
}

double SharedNoise(const DisplacementRows& rows,
                   const WeighedPoints& points,
                   const RowOfPoint& row_of,
                   const std::function<double(const SparseRow&)>& unfitted,
                   double variance) {
  double shared = 1;
  for (int parts = 1; parts <= kFinest && variance > 0; parts *= 2) {
    const Growth growth = GrowthAt(parts, rows, points, row_of, unfitted, variance);
    if (growth.blocks < 1 || !(growth.expected > 0)) break;
    const double ratio = growth.found / growth.expected;
    if (ratio > 1 + kSignificant * std::sqrt(2 / growth.blocks)) shared = std::max(shared, ratio);
  }
  return shared;
}

}  // namespace batten::internal
