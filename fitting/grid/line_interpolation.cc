// SPDX-License-Identifier: MIT
#include "fitting/grid/line_interpolation.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "fitting/knots/data_knots.h"

namespace batten::internal {

LineInterpolation::LineInterpolation(const SplineBasis& basis, std::span<const double> parameters)
    : size_(basis.size()), degree_(basis.degree()) {
  if (static_cast<Eigen::Index>(parameters.size()) != size_ || basis.periodic()) {
    throw std::invalid_argument(
        "LineInterpolation: an open basis and as many parameters as functions are needed");
  }
  if (const auto lonely = FirstUnsupported(basis, parameters)) {
    throw std::invalid_argument("LineInterpolation: no parameter is left for function " +
                                std::to_string(*lonely));
  }
  const Eigen::Index p = degree_, stride = 2 * p + 1;
  band_.assign(static_cast<size_t>(size_ * stride), 0.0);
  std::vector<double> values(static_cast<size_t>(p) + 1);
  for (Eigen::Index i = 0; i < size_; ++i) {
    const double t = parameters[static_cast<size_t>(i)];
    const int span = basis.Span(t);
    basis.Values(span, t, values.data());
    for (Eigen::Index r = 0; r <= p; ++r) {
      const Eigen::Index off = span - p + r - i + p;  // place in the band
      if (off >= 0 && off < stride)
        band_[static_cast<size_t>(i * stride + off)] = values[static_cast<size_t>(r)];
    }
  }
  const auto at = [&](Eigen::Index i, Eigen::Index j) -> double& {
    return band_[static_cast<size_t>(i * stride + j - i + p)];
  };
  for (Eigen::Index k = 0; k < size_; ++k) {
    at(k, k) = 1 / at(k, k);
    const Eigen::Index last = std::min(size_ - 1, k + p);
    for (Eigen::Index i = k + 1; i <= last; ++i) {
      if (at(i, k) == 0) continue;
      const double factor = at(i, k) *= at(k, k);
      for (Eigen::Index j = k + 1; j <= last; ++j) at(i, j) -= factor * at(k, j);
    }
  }
}

void LineInterpolation::Solve(double* data, Eigen::Index stride, Eigen::Index width) const {
  const Eigen::Index p = degree_;
  const auto row = [&](Eigen::Index i) { return data + i * stride; };
  for (Eigen::Index i = 0; i < size_; ++i) {
    const double* factors = band_.data() + i * (2 * p + 1);
    double* x = row(i);
    for (Eigen::Index r = std::max<Eigen::Index>(0, p - i); r < p; ++r) {
      if (factors[r] == 0) continue;
      const double factor = factors[r];
      const double* before = row(i + r - p);
      for (Eigen::Index d = 0; d < width; ++d) x[d] -= factor * before[d];
    }
  }
  for (Eigen::Index i = size_ - 1; i >= 0; --i) {
    const double* entries = band_.data() + i * (2 * p + 1) + p;
    double* x = row(i);
    for (Eigen::Index r = 1; r <= std::min(p, size_ - 1 - i); ++r) {
      if (entries[r] == 0) continue;
      const double entry = entries[r];
      const double* after = row(i + r);
      for (Eigen::Index d = 0; d < width; ++d) x[d] -= entry * after[d];
    }
    for (Eigen::Index d = 0; d < width; ++d) x[d] *= entries[0];
  }
}

void LineInterpolation::SolveLines(double* data, Eigen::Index width, ThreadPool& pool) const {
  pool.For(width, kSolvedTogether, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    Solve(data + begin, width, end - begin);
  });
}

void LineInterpolation::SolveWithin(double* data,
                                    Eigen::Index count,
                                    int dimension,
                                    ThreadPool& pool) const {
  const Eigen::Index line = size_ * dimension;
  pool.For(count, kSolvedTogether / 4, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    const Eigen::Index width = (end - begin) * dimension;
    std::vector<double> turned(static_cast<size_t>(size_ * width));
    const auto move = [&](auto&& copy) {
      for (Eigen::Index b = begin; b < end; ++b) {
        for (Eigen::Index j = 0; j < size_; ++j) {
          copy(data + b * line + j * dimension,
               turned.data() + j * width + (b - begin) * dimension);
        }
      }
    };
    move([&](const double* from, double* to) { std::copy_n(from, dimension, to); });
    Solve(turned.data(), width, width);
    move([&](double* to, const double* from) { std::copy_n(from, dimension, to); });
  });
}

}  // namespace batten::internal
