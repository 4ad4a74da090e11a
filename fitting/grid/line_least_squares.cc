// SPDX-License-Identifier: MIT
#include "fitting/grid/line_least_squares.h"

#include <algorithm>
#include <stdexcept>
#include <string>

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
                                   bool meet_ends)
    : size_(basis.size()),
      data_size_(static_cast<Eigen::Index>(parameters.size())),
      degree_(basis.degree()),
      meet_ends_(meet_ends),
      rows_(CoefficientOrder(basis).Rows(basis)),
      matrix_(DistinctCount(basis),
              CoefficientOrder(basis).bandwidth(),
              CoefficientOrder(basis).bandwidth()) {
  const auto reject = [](const std::string& rule) {
    throw std::invalid_argument("LineLeastSquares: " + rule);
  };
  const int distinct = DistinctCount(basis);
  if (data_size_ < distinct) {
    reject(std::to_string(data_size_) + " parameters are fewer than " + std::to_string(distinct) +
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
    double* N = values_.data() + k * (p + 1);
    first_.push_back(span - degree_);
    basis.Values(span, parameters[k], N);
    for (size_t r = 0; r <= p; ++r) {
      const int row = Row(k, r);
      if (meet_ends && (row == 0 || row == distinct - 1)) continue;
      for (size_t s = 0; s <= p; ++s) matrix_.at(row, Row(k, s)) += N[r] * N[s];
    }
  }
  if (meet_ends) matrix_.at(0, 0) = matrix_.at(distinct - 1, distinct - 1) = 1;
  double greatest = 0;
  for (int i = 0; i < distinct; ++i) greatest = std::max(greatest, matrix_.at(i, i));
  regular_ = matrix_.Factor(basis.periodic() ? kSingular * greatest : 0) == distinct;
}

// The control points of the matrix' rows.
RightSides LineLeastSquares::Solve(const double* data,
                                   Eigen::Index stride,
                                   Eigen::Index width) const {
  const auto p = static_cast<size_t>(degree_);
  const double* const back = data + (data_size_ - 1) * stride;
  RightSides sums = RightSides::Zero(matrix_.size(), width);
  for (size_t k = 0; k < first_.size(); ++k) {
    const double* const from = data + static_cast<Eigen::Index>(k) * stride;
    for (size_t r = 0; r <= p; ++r) {
      Subtract(-values_[k * (p + 1) + r], from, width, sums.row(Row(k, r)).data());
    }
  }
  if (meet_ends_) {
    std::copy_n(data, width, sums.row(0).data());
    std::copy_n(back, width, sums.row(sums.rows() - 1).data());
  }
  if (regular_) matrix_.Solve(sums);
  return sums;
}

void LineLeastSquares::SolveLines(const double* data,
                                  Eigen::Index width,
                                  double* control,
                                  ThreadPool& pool) const {
  pool.For(width, kSolvedTogether, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    const Eigen::Index count = end - begin;
    const RightSides solved = Solve(data + begin, width, count);
    for (size_t i = 0; i < rows_.size(); ++i) {
      std::copy_n(solved.row(rows_[i]).data(),
                  count,
                  control + static_cast<Eigen::Index>(i) * width + begin);
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
    std::vector<double> turned(static_cast<size_t>(data_size_ * width));
    for (Eigen::Index b = begin; b < end; ++b) {
      for (Eigen::Index k = 0; k < data_size_; ++k) {
        std::copy_n(data + (b * data_size_ + k) * dimension,
                    dimension,
                    turned.data() + k * width + (b - begin) * dimension);
      }
    }
    const RightSides solved = Solve(turned.data(), width, width);
    for (Eigen::Index b = begin; b < end; ++b) {
      for (Eigen::Index i = 0; i < size_; ++i) {
        std::copy_n(solved.row(rows_[static_cast<size_t>(i)]).data() + (b - begin) * dimension,
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
