// SPDX-License-Identifier: MIT
#include "fitting/grid/line_least_squares.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "fitting/grid/line_interpolation.h"
#include "fitting/knots/data_knots.h"
#include "fitting/linear/coefficient_order.h"

namespace batten::internal {
namespace {

constexpr double kSingular = 1e-14;

void Subtract(double factor, const double* from, Eigen::Index width, double* x) {
  for (Eigen::Index d = 0; d < width; ++d) x[d] -= factor * from[d];
}

}  // namespace

LineLeastSquares::LineLeastSquares(const SplineBasis& basis,
                                   std::span<const double> parameters,
                                   bool meet_ends,
                                   std::span<const double> weights)
    : size_(basis.size()),
      data_size_(static_cast<Eigen::Index>(parameters.size())),
      distinct_(DistinctCount(basis)),
      degree_(basis.degree()),
      meet_ends_(meet_ends),
      weights_(weights.begin(), weights.end()) {
  if (weights_.empty()) weights_.assign(parameters.size(), 1.0);
  const auto reject = [](const std::string& rule) {
    throw std::invalid_argument("LineLeastSquares: " + rule);
  };
  if (data_size_ < distinct_) {
    reject(std::to_string(data_size_) + " parameters are fewer than " + std::to_string(distinct_) +
           " functions");
  }
  if (meet_ends && (!basis.clamped() || parameters.front() != basis.lower() ||
                    parameters.back() != basis.upper())) {
    reject("ends are met by a basis that is clamped at the first and last parameter");
  }
  if (!basis.periodic()) {
    if (const auto lonely = FirstUnsupported(basis, parameters)) {
      reject("no parameter is left for function " + std::to_string(*lonely));
    }
  }
  const auto p = static_cast<size_t>(degree_);
  values_.resize(parameters.size() * (p + 1));
  for (size_t k = 0; k < parameters.size(); ++k) {
    const int span = basis.Span(parameters[k]);
    first_.push_back(span - degree_);
    basis.Values(span, parameters[k], values_.data() + k * (p + 1));
  }
  Factor();
}

void LineLeastSquares::Factor() {
  const Eigen::Index p = degree_, n = distinct_;
  const bool ring = n < size_;
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(ring ? n : 0, ring ? n : 0);
  band_.assign(static_cast<size_t>(ring ? 0 : n * (p + 1)), 0.0);
  const auto at = [&](Eigen::Index i, Eigen::Index j) -> double& {
    return band_[static_cast<size_t>(i * (p + 1) + j - i + p)];
  };
  for (Eigen::Index k = 0; k < data_size_; ++k) {
    const Eigen::Index first = first_[static_cast<size_t>(k)];
    const double* N = values_.data() + k * (p + 1);
    const double weight = weights_[static_cast<size_t>(k)];
    for (Eigen::Index r = 0; r <= p; ++r) {
      for (Eigen::Index s = 0; s <= p; ++s) {
        if (ring) {
          dense((first + r) % n, (first + s) % n) += weight * N[r] * N[s];
        } else if (s <= r) {
          at(first + r, first + s) += weight * N[r] * N[s];
        }
      }
    }
  }
  if (ring) {
    ring_.compute(dense);
    regular_ = ring_.info() == Eigen::Success &&
               ring_.vectorD().minCoeff() > kSingular * ring_.vectorD().maxCoeff();
    return;
  }
  if (meet_ends_) {
    for (Eigen::Index i = 1; i <= std::min(p, n - 1); ++i) at(i, 0) = at(n - 1, n - 1 - i) = 0;
    at(0, 0) = at(n - 1, n - 1) = 1;
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Index first = std::max<Eigen::Index>(0, i - p);
    for (Eigen::Index j = first; j < i; ++j) {
      // Rows hold L·D until the diagonal is done.
      for (Eigen::Index k = std::max(first, j - p); k < j; ++k) at(i, j) -= at(i, k) * at(j, k);
    }
    for (Eigen::Index j = first; j < i; ++j) {
      const double scaled = at(i, j) * at(j, j);
      at(i, i) -= at(i, j) * scaled;
      at(i, j) = scaled;
    }
    regular_ = regular_ && at(i, i) > 0;
    at(i, i) = 1 / at(i, i);
  }
}

void LineLeastSquares::SolveBanded(double* x, Eigen::Index width) const {
  const Eigen::Index p = degree_, n = size_;
  for (Eigen::Index i = 0; i < n; ++i) {
    const double* row = band_.data() + i * (p + 1) - i + p;
    for (Eigen::Index j = std::max<Eigen::Index>(0, i - p); j < i; ++j) {
      Subtract(row[j], x + j * width, width, x + i * width);
    }
  }
  for (Eigen::Index i = n - 1; i >= 0; --i) {
    const double inverse = band_[static_cast<size_t>(i * (p + 1) + p)];
    for (Eigen::Index d = 0; d < width; ++d) x[i * width + d] *= inverse;
    for (Eigen::Index j = i + 1; j <= std::min(n - 1, i + p); ++j) {
      Subtract(
          band_[static_cast<size_t>(j * (p + 1) + i - j + p)], x + j * width, width, x + i * width);
    }
  }
}

void LineLeastSquares::Solve(const double* data,
                             Eigen::Index stride,
                             Eigen::Index width,
                             double* x) const {
  const Eigen::Index p = degree_, n = distinct_;
  const double *front = data, *back = data + (data_size_ - 1) * stride;
  std::fill_n(x, n * width, 0.0);
  std::vector<double> rest(static_cast<size_t>(width));
  for (Eigen::Index k = 0; k < data_size_; ++k) {
    const Eigen::Index first = first_[static_cast<size_t>(k)];
    const double* N = values_.data() + k * (p + 1);
    std::copy_n(data + k * stride, width, rest.data());
    if (meet_ends_ && first == 0) Subtract(N[0], front, width, rest.data());
    if (meet_ends_ && first + p == n - 1) Subtract(N[p], back, width, rest.data());
    for (Eigen::Index r = 0; r <= p; ++r) {
      Subtract(-weights_[static_cast<size_t>(k)] * N[r],
               rest.data(),
               width,
               x + (first + r) % n * width);
    }
  }
  if (n < size_) {
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Eigen::Map<Rows> rows(x, n, width);
    rows = ring_.solve(Eigen::MatrixXd(rows)).eval();
    std::copy_n(x, (size_ - n) * width, x + n * width);
    return;
  }
  if (meet_ends_) {
    std::copy_n(front, width, x);
    std::copy_n(back, width, x + (n - 1) * width);
  }
  SolveBanded(x, width);
}

void LineLeastSquares::SolveLines(const double* data,
                                  Eigen::Index width,
                                  double* control,
                                  ThreadPool& pool) const {
  pool.For(width, kSolvedTogether, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    const Eigen::Index count = end - begin;
    std::vector<double> x(static_cast<size_t>(size_ * count));
    Solve(data + begin, width, count, x.data());
    for (Eigen::Index i = 0; i < size_; ++i) {
      std::copy_n(x.data() + i * count, count, control + i * width + begin);
    }
  });
}

void LineLeastSquares::SolveWithin(const double* data,
                                   Eigen::Index count,
                                   int dimension,
                                   double* control,
                                   ThreadPool& pool) const {
  pool.For(count, kSolvedTogether / 4, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    const Eigen::Index width = (end - begin) * dimension;
    std::vector<double> turned(static_cast<size_t>(data_size_ * width)),
        x(static_cast<size_t>(size_ * width));
    for (Eigen::Index b = begin; b < end; ++b) {
      for (Eigen::Index k = 0; k < data_size_; ++k) {
        std::copy_n(data + (b * data_size_ + k) * dimension,
                    dimension,
                    turned.data() + k * width + (b - begin) * dimension);
      }
    }
    Solve(turned.data(), width, width, x.data());
    for (Eigen::Index b = begin; b < end; ++b) {
      for (Eigen::Index i = 0; i < size_; ++i) {
        std::copy_n(x.data() + i * width + (b - begin) * dimension,
                    dimension,
                    control + (b * size_ + i) * dimension);
      }
    }
  });
}

void LineLeastSquares::EvaluateLines(const double* control,
                                     Eigen::Index width,
                                     double* values) const {
  const Eigen::Index p = degree_;
  for (Eigen::Index k = 0; k < data_size_; ++k) {
    double* value = values + k * width;
    std::fill_n(value, width, 0.0);
    for (Eigen::Index r = 0; r <= p; ++r) {
      Subtract(-values_[static_cast<size_t>(k * (p + 1) + r)],
               control + (first_[static_cast<size_t>(k)] + r) * width,
               width,
               value);
    }
  }
}

}  // namespace batten::internal
