// SPDX-License-Identifier: MIT
#include "fitting/curve/knot_relocation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "fitting/linear/coefficient_order.h"

namespace batten::internal {
namespace {

constexpr int kMeansInSpan = 10;
constexpr int kSweeps = 4;
constexpr double kNarrowest = 0.7;  // share of the span before: narrower spans follow the noise
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
  return Squares(basis, Sums(basis));
}

Eigen::MatrixXd LayoutTrials::Sums(const SplineBasis& basis) const {
  const Eigen::Index functions = basis.degree() + 1;
  const std::vector<int> spans = basis.Spans();
  Eigen::MatrixXd sums(functions * (functions + values_.rows()), std::ssize(spans));
  for (Eigen::Index i = 0; i < sums.cols(); ++i)
    SumSpan(basis, spans[static_cast<size_t>(i)], sums.col(i));
  return sums;
}

// The products of functions r ≥ s at (p + 1) r + s, behind them those with each coordinate. What
// lies before the first span or behind the last belongs to it.
void LayoutTrials::SumSpan(const SplineBasis& basis,
                           int span,
                           Eigen::Ref<Eigen::VectorXd> sums) const {
  const int p = basis.degree();
  const auto dimension = static_cast<int>(values_.rows());
  const double low = basis.knots()[static_cast<size_t>(span)],
               high = basis.knots()[static_cast<size_t>(span) + 1];
  const auto place = [&](double u) {
    return static_cast<size_t>(std::lower_bound(parameters_.begin(), parameters_.end(), u) -
                               parameters_.begin());
  };
  const size_t begin = low > basis.lower() ? place(low) : 0,
               end = high < basis.upper() ? place(high) : parameters_.size();
  sums.setZero();
  double* const gram = sums.data();
  double* const right = gram + (p + 1) * (p + 1);
  double values[kMaxDegree + 1];
  for (size_t k = begin; k < end; ++k) {
    basis.Values(span, parameters_[k], values);
    const double* const z = values_.data() + k * static_cast<size_t>(dimension);
    for (int r = 0; r <= p; ++r) {
      const double scaled = weights_[k] * values[r];
      for (int s = 0; s <= r; ++s) gram[r * (p + 1) + s] += scaled * values[s];
      for (int d = 0; d < dimension; ++d) right[r * dimension + d] += scaled * z[d];
    }
  }
}

double LayoutTrials::Squares(const SplineBasis& basis, const Eigen::MatrixXd& sums) const {
  const CoefficientOrder order(basis);
  const std::vector<int> rows = order.Rows(basis), spans = basis.Spans();
  const int p = basis.degree();
  const auto dimension = static_cast<int>(values_.rows());
  Band matrix(order.count(), order.bandwidth());
  std::vector<double> rhs(static_cast<size_t>(order.count() * dimension), 0.0);
  for (size_t i = 0; i < spans.size(); ++i) {
    const double* const gram = sums.col(static_cast<Eigen::Index>(i)).data();
    const double* const right = gram + (p + 1) * (p + 1);
    const int* const row = rows.data() + (spans[i] - p);
    for (int r = 0; r <= p; ++r) {
      for (int s = 0; s <= r; ++s) {
        // Functions of few spans around may be one.
        const double twice = s < r && row[s] == row[r] ? 2 : 1;
        matrix.at(std::max(row[r], row[s]), std::min(row[r], row[s])) +=
            twice * gram[r * (p + 1) + s];
      }
      for (int d = 0; d < dimension; ++d)
        rhs[static_cast<size_t>(d * order.count() + row[r])] += right[r * dimension + d];
    }
  }
  return total_ - matrix.Explained(rhs, dimension);
}

namespace {

// A layout with its sums, to be changed break by break.
class Trial {
 public:
  Trial(const LayoutTrials& trials, const SpanLayout& layout)
      : trials_(trials), sums_(trials.Sums(layout.Basis())) {}

  // Of a layout that differs by that break only; Accept makes it the present one.
  double Squares(const SpanLayout& layout, int moved) {
    const SplineBasis basis = layout.Basis();
    const std::vector<int> spans = basis.Spans();
    const int count = layout.spans(), p = layout.degree();
    changed_.clear();
    for (int i = moved - p; i < moved + p; ++i) {
      if (!layout.closed() && (i < 0 || i >= count)) continue;
      changed_.push_back(((i % count) + count) % count);
    }
    std::sort(changed_.begin(), changed_.end());
    changed_.erase(std::unique(changed_.begin(), changed_.end()), changed_.end());
    before_ = sums_(Eigen::all, changed_);
    for (const int i : changed_)
      trials_.SumSpan(basis, spans[static_cast<size_t>(i)], sums_.col(i));
    return trials_.Squares(basis, sums_);
  }

  void TakeBack() { sums_(Eigen::all, changed_) = before_; }

 private:
  const LayoutTrials& trials_;
  Eigen::MatrixXd sums_, before_;
  std::vector<int> changed_;
};

}  // namespace

SpanLayout RelocateKnots(const LayoutTrials& trials, SpanLayout layout) {
  const SpanLayout start = layout;
  const auto wide = [&](const std::vector<double>& breaks, size_t span) {
    const std::vector<double>& first = start.breaks();
    return breaks[span + 1] - breaks[span] >= kNarrowest * (first[span + 1] - first[span]);
  };
  Trial trial(trials, layout);
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
        const double squares = trial.Squares(moved, k);
        if (!(squares < best)) {
          trial.TakeBack();
          continue;
        }
        best = squares;
        layout = moved;
        break;
      }
    }
  }
  return layout;
}

}  // namespace batten::internal
