// SPDX-License-Identifier: MIT
#include "geometry/editing/polar_form.h"

#include <algorithm>
#include <utility>

namespace batten::internal {

// One row of the Oslo algorithm: the discrete B-splines of degree k = 0 … p. A function that the
// arguments rule out gets the coefficient zero exactly, because knots are equal bit by bit; so
// knots beyond the ends of the vector, whatever they are taken for, never count.
ControlMean PolarMean(const SplineBasis& basis, double before, std::span<const double> arguments) {
  const std::vector<double>& U = basis.knots();
  const int p = basis.degree(), last = static_cast<int>(U.size()) - 1;
  const int span = static_cast<int>(std::upper_bound(U.begin(), U.end(), before) - U.begin()) - 1;
  const auto knot = [&](int i) { return U[std::clamp(i, 0, last)]; };
  ControlMean result{span - p, Eigen::VectorXd::Zero(p + 1)};
  Eigen::VectorXd& b = result.coefficients;
  b[p] = 1;
  for (int k = 1; k <= p; ++k) {
    for (int r = p - k + 1; r <= p; ++r) {
      if (b[r] == 0) continue;
      const int j = span - p + r;
      const double low = knot(j), high = knot(j + k), v = arguments[k - 1], old = b[r];
      if (v <= low) {
        b[r - 1] += old;
        b[r] = 0;
      } else if (v < high) {
        b[r - 1] += old * ((high - v) / (high - low));
        b[r] = old * ((v - low) / (high - low));
      }
    }
  }
  return result;
}

std::vector<ControlMean> RefinementMeans(const SplineBasis& basis, const SplineBasis& refined) {
  const double* T = refined.knots().data();
  std::vector<ControlMean> means;
  for (int i = 0; i < refined.size(); ++i) {
    means.push_back(PolarMean(basis, T[i], {T + i + 1, size_t(basis.degree())}));
  }
  return means;
}

std::vector<ControlMean> ElevationMeans(const SplineBasis& basis, const SplineBasis& elevated) {
  const int p = basis.degree(), q = p + 1;
  const double* T = elevated.knots().data();
  std::vector<ControlMean> means;
  std::vector<double> rest(p);
  for (int i = 0; i < elevated.size(); ++i) {
    const double* window = T + i + 1;
    ControlMean mean{0, Eigen::VectorXd::Zero(p + 1)};
    for (int k = 0; k < q;) {
      const int next =
          static_cast<int>(std::upper_bound(window + k, window + q, window[k]) - window);
      std::copy(window, window + k, rest.begin());
      std::copy(window + k + 1, window + q, rest.begin() + k);
      const ControlMean one = PolarMean(basis, T[i], rest);
      mean.first = one.first;  // the same for all: it depends on T[i] only
      mean.coefficients += one.coefficients * (double(next - k) / q);
      k = next;
    }
    means.push_back(std::move(mean));
  }
  return means;
}

namespace {

// Means of one row as P + Σ λ_i (P_i − P), λ_i = c_i w_i / Σ c_i w_i, with P the control point of
// the largest coefficient.
void Combine(const ControlMean& mean, const ControlRows& rows, ControlRows& result, int to) {
  const int low = std::max(0, -mean.first);
  const int high =
      std::min<int>(static_cast<int>(mean.coefficients.size()), rows.basis.size() - mean.first);
  int largest = low;
  for (int r = low; r < high; ++r) {
    if (mean.coefficients[r] > mean.coefficients[largest]) largest = r;
  }
  for (Eigen::Index row = 0; row < rows.rows(); ++row) {
    ControlRows::Point reference = rows.At(row, mean.first + largest), sum{{0, 0, 0}, 0};
    for (int r = low; r < high; ++r) {
      if (mean.coefficients[r] == 0) continue;
      const ControlRows::Point point = rows.At(row, mean.first + r);
      const double c = mean.coefficients[r] * point.weight;
      sum.place += c * (point.place - reference.place);
      sum.weight += c;
    }
    result.Set(row, to, {reference.place + sum.place / sum.weight, sum.weight});
  }
}

}  // namespace

ControlRows Combined(const std::vector<ControlMean>& means,
                     const ControlRows& rows,
                     SplineBasis basis) {
  ControlRows result = EmptyRows(rows, std::move(basis));
  for (size_t i = 0; i < means.size(); ++i) Combine(means[i], rows, result, static_cast<int>(i));
  return result;
}

}  // namespace batten::internal
