// SPDX-License-Identifier: MIT
#include "batten/fitting/knot_relocation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "batten/fitting/coefficient_order.h"

namespace batten {
namespace {

constexpr int kMeansInSpan = 10;
constexpr int kSweeps = 4;
constexpr double kNarrowest = 0.7;  // of what the span was: narrower ones follow the noise
constexpr double kFirstShare = 0.35, kShrink = 0.6;

// The lower band of a symmetric matrix, row by row.
class Band {
 public:
  Band(int rows, int width) : rows_(rows), width_(width) {
    data_.assign(static_cast<size_t>(rows) * static_cast<size_t>(width + 1), 0.0);
  }
  double& at(int row, int column) {
    return data_[static_cast<size_t>(row) * static_cast<size_t>(width_ + 1) +
                 static_cast<size_t>(row - column)];
  }

  // Σ over the right-hand sides of bᵀA⁻¹b; infinity where the matrix is not positive definite.
  double Explained(std::vector<double>& rhs, int columns) {
    double sum = 0;
    for (int k = 0; k < rows_; ++k) {
      const int first = std::max(0, k - width_);
      for (int j = first; j <= k; ++j) {
        double value = at(k, j);
        for (int i = std::max(first, j - width_); i < j; ++i) value -= at(k, i) * at(j, i);
        if (j < k) {
          at(k, j) = value / at(j, j);
        } else if (value > 0) {
          at(k, k) = std::sqrt(value);
        } else {
          return -std::numeric_limits<double>::infinity();
        }
      }
      for (int c = 0; c < columns; ++c) {
        double* const column = rhs.data() + static_cast<size_t>(c) * static_cast<size_t>(rows_);
        for (int j = first; j < k; ++j) column[k] -= at(k, j) * column[j];
        column[k] /= at(k, k);
        sum += column[k] * column[k];
      }
    }
    return sum;
  }

 private:
  int rows_, width_;
  std::vector<double> data_;
};

}  // namespace

LayoutTrials::LayoutTrials(const FittingProblem& problem, int spans) {
  const auto u = problem.data().parameters.row(0);
  const Eigen::MatrixXd& values = problem.data().values;
  const Eigen::VectorXd& weights = problem.data().weights;
  std::vector<Eigen::Index> order(static_cast<size_t>(u.size()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::stable_sort(
      order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) { return u[a] < u[b]; });
  const auto count = static_cast<size_t>(u.size());
  const size_t means = std::min(count, static_cast<size_t>(kMeansInSpan * spans));
  values_ = Eigen::MatrixXd::Zero(values.rows(), static_cast<Eigen::Index>(means));
  Eigen::Index filled = 0;
  for (size_t b = 0; b < means; ++b) {
    double parameter = 0, weight = 0;
    auto mean = values_.col(filled);
    for (size_t k = b * count / means; k < (b + 1) * count / means; ++k) {
      const double w = weights.size() > 0 ? weights[order[k]] : 1;
      parameter += w * u[order[k]];
      mean += w * values.col(order[k]);
      weight += w;
    }
    if (weight == 0) continue;
    mean /= weight;
    parameters_.push_back(parameter / weight);
    weights_.push_back(weight);
    ++filled;
  }
  values_.conservativeResize(Eigen::NoChange, filled);
  // Sums of squares are differences: about the middle they lose least.
  const Eigen::Map<const Eigen::VectorXd> w(weights_.data(), filled);
  if (w.sum() > 0) values_.colwise() -= (values_ * w / w.sum()).eval();
  total_ = w.dot(values_.colwise().squaredNorm());
}

double LayoutTrials::Squares(const SpanLayout& layout) const {
  const SplineBasis basis = layout.Basis();
  const CoefficientOrder order(basis);
  const std::vector<int> rows = order.Rows(basis);
  const std::vector<int> spans = basis.Spans();
  const int p = basis.degree();
  const auto dimension = static_cast<int>(values_.rows());
  Band matrix(order.count(), order.bandwidth());
  std::vector<double> rhs(static_cast<size_t>(order.count() * dimension), 0.0);
  double values[kMaxDegree + 1];
  size_t at = 0;
  for (size_t k = 0; k < parameters_.size(); ++k) {
    while (at + 1 < spans.size() &&
           parameters_[k] >= basis.knots()[static_cast<size_t>(spans[at]) + 1])
      ++at;
    basis.Values(spans[at], parameters_[k], values);
    const int* const row = rows.data() + (spans[at] - p);
    for (int r = 0; r <= p; ++r) {
      const double scaled = weights_[k] * values[r];
      for (int s = 0; s <= p; ++s) {
        if (row[s] <= row[r]) matrix.at(row[r], row[s]) += scaled * values[s];
      }
      for (int d = 0; d < dimension; ++d) {
        rhs[static_cast<size_t>(d * order.count() + row[r])] +=
            scaled * values_(d, static_cast<Eigen::Index>(k));
      }
    }
  }
  return total_ - matrix.Explained(rhs, dimension);
}

SpanLayout RelocateKnots(const LayoutTrials& trials, SpanLayout layout) {
  const SpanLayout start = layout;
  const auto wide = [&](const std::vector<double>& breaks, size_t span) {
    const std::vector<double>& first = start.breaks();
    return breaks[span + 1] - breaks[span] >= kNarrowest * (first[span + 1] - first[span]);
  };
  double best = trials.Squares(layout);
  double share = kFirstShare;
  for (int sweep = 0; sweep < kSweeps; ++sweep, share *= kShrink) {
    for (int k = 1; k < layout.spans(); ++k) {
      if (layout.IsCorner(k)) continue;
      for (const int side : {1, -1}) {
        std::vector<double> breaks = layout.breaks();
        const auto i = static_cast<size_t>(k);
        breaks[i] += share * (breaks[side > 0 ? i + 1 : i - 1] - breaks[i]);
        if (!wide(breaks, i - 1) || !wide(breaks, i)) continue;
        const SpanLayout moved = layout.WithBreaks(std::move(breaks));
        const double squares = trials.Squares(moved);
        if (!(squares < best)) continue;
        best = squares;
        layout = moved;
        break;
      }
    }
  }
  return layout;
}

}  // namespace batten
