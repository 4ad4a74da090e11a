// SPDX-License-Identifier: MIT
// Adaptive quadrature: the cell of greatest error is split until the errors no longer matter.
// Internal to geometry.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace batten::internal {

// The integral over one cell and an estimate, in practice a generous one, of its error.
struct CellIntegral {
  double value = 0, error = 0;
};

// Sums with the roundings of a sum carried along. [Neumaier 1974]
class CarriedSum {
 public:
  void Add(double term) {
    const double sum = sum_ + term;
    carry_ += std::abs(sum_) >= std::abs(term) ? (sum_ - sum) + term : (term - sum) + sum_;
    sum_ = sum;
  }
  double value() const { return sum_ + carry_; }

 private:
  double sum_ = 0, carry_ = 0;
};

// Splits cells, worst first, until their errors sum to at most `tolerance` times the sum of their
// values, or to `floor`. A Cell has a member `integral` (CellIntegral); split(cell) returns its
// parts, none when it is too small to be cut. Where cutting a cell that is right to ten digits
// leaves its error as it was, the error is that of rounding and is dropped. Gives up after `most`
// splits. The cells come in no order. O(log n) a split beside the work of split().
template <typename Cell, typename Split>
void RefineUntilExact(
    std::vector<Cell>& cells, double tolerance, double floor, std::size_t most, Split split) {
  const auto better = [](const Cell& a, const Cell& b) {
    return a.integral.error < b.integral.error;
  };
  const auto sum = [&] {
    CellIntegral total;
    for (const Cell& cell : cells) {
      total.value += std::abs(cell.integral.value);
      total.error += cell.integral.error;
    }
    return total;
  };
  const auto enough = [&](const CellIntegral& total) {
    return !(total.error > std::max(tolerance * total.value, floor));
  };
  constexpr double kTenDigits = 1e-10;
  constexpr std::size_t kRecount = 64;
  std::make_heap(cells.begin(), cells.end(), better);
  CellIntegral total = sum();
  for (std::size_t count = 0; count < most; ++count) {
    if (count % kRecount == 0) total = sum();
    if (enough(total)) {
      total = sum();
      if (enough(total)) return;
    }
    std::pop_heap(cells.begin(), cells.end(), better);
    Cell worst = cells.back();
    cells.pop_back();
    total.error -= worst.integral.error;
    total.value -= std::abs(worst.integral.value);
    std::vector<Cell> parts = split(worst);
    double left = 0;
    for (const Cell& part : parts) left += part.integral.error;
    const bool rounding = left > worst.integral.error / 2 &&
                          worst.integral.error <= kTenDigits * std::abs(worst.integral.value);
    if (parts.empty()) parts.push_back(worst);
    for (Cell& part : parts) {
      if (rounding || parts.size() == 1) part.integral.error = 0;
      total.error += part.integral.error;
      total.value += std::abs(part.integral.value);
      cells.push_back(std::move(part));
      std::push_heap(cells.begin(), cells.end(), better);
    }
  }
}

}  // namespace batten::internal
