// SPDX-License-Identifier: MIT
#include "fitting/grid/fill_cells.h"

#include <Eigen/SparseCholesky>
#include <array>
#include <stdexcept>
#include <vector>

namespace batten::internal {
namespace {

// A second difference: cells and factors.
struct Difference {
  int count = 0;
  std::array<Eigen::Index, 4> cells{};
  std::array<double, 4> factors{};

  void Add(Eigen::Index cell, double factor) {
    cells[static_cast<size_t>(count)] = cell;
    factors[static_cast<size_t>(count++)] = factor;
  }
};

class Filling {
 public:
  Filling(const PointNet& net, const GridParameters& t)
      : net_(net), t_(t), unknown_(static_cast<size_t>(net.points.cols()), -1) {
    for (Eigen::Index k = 0; k < net.points.cols(); ++k) {
      if (net.missing[k]) unknown_[static_cast<size_t>(k)] = count_++;
    }
  }

  PointNet Fill() {
    right_ = Eigen::MatrixX3d::Zero(count_, 3);
    middle_ = MiddleOf(net_);
    for (int i = 0; i < net_.rows; ++i) {
      for (int j = 0; j < net_.columns; ++j) AddDifferencesAt(i, j);
    }
    Eigen::SparseMatrix<double> matrix(count_, count_);
    matrix.setFromTriplets(entries_.begin(), entries_.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(matrix);
    constexpr double kSingular = 1e-13;
    if (factor.info() != Eigen::Success ||
        !(factor.vectorD().minCoeff() > kSingular * factor.vectorD().maxCoeff())) {
      throw std::invalid_argument(
          "the grid has too few points beside its missing cells to carry a surface over them");
    }
    const Eigen::MatrixX3d filled = factor.solve(right_);
    PointNet result{net_.rows, net_.columns, net_.points, {}};
    for (Eigen::Index k = 0; k < result.points.cols(); ++k) {
      const Eigen::Index row = unknown_[static_cast<size_t>(k)];
      if (row >= 0) result.points.col(k) = middle_ + filled.row(row).transpose();
    }
    return result;
  }

 private:
  Eigen::Index Cell(int i, int j) const { return Eigen::Index{i} * net_.columns + j; }

  // Half the way to the neighbours on both sides.
  static double Width(const Eigen::VectorXd& t, int k, int lines) {
    const double low = k > 0 ? (t[k - 1] + t[k]) / 2 : t[0];
    const double high = k + 1 < lines ? (t[k] + t[k + 1]) / 2 : t[lines - 1];
    return high - low;
  }

  void AddDifferencesAt(int i, int j) {
    const double wide_u = Width(t_.u, i, net_.rows), wide_v = Width(t_.v, j, net_.columns);
    if (i > 0 && i + 1 < net_.rows) {
      AddSecond(
          t_.u, i, [&](int k) { return Cell(k, j); }, wide_u * wide_v);
    }
    if (j > 0 && j + 1 < net_.columns) {
      AddSecond(
          t_.v, j, [&](int k) { return Cell(i, k); }, wide_u * wide_v);
    }
    if (i + 1 == net_.rows || j + 1 == net_.columns) return;
    const double du = t_.u[i + 1] - t_.u[i], dv = t_.v[j + 1] - t_.v[j], factor = 1 / (du * dv);
    Difference twist;
    twist.Add(Cell(i, j), factor);
    twist.Add(Cell(i + 1, j + 1), factor);
    twist.Add(Cell(i + 1, j), -factor);
    twist.Add(Cell(i, j + 1), -factor);
    Gather(twist, 2 * du * dv);
  }

  template <typename CellAt>
  void AddSecond(const Eigen::VectorXd& t, int k, const CellAt& cell, double area) {
    const double a = t[k] - t[k - 1], b = t[k + 1] - t[k];
    Difference second;
    second.Add(cell(k - 1), 2 / (a * (a + b)));
    second.Add(cell(k), -2 / (a * b));
    second.Add(cell(k + 1), 2 / (b * (a + b)));
    Gather(second, area);
  }

  void Gather(const Difference& difference, double weight) {
    Eigen::Vector3d known = Eigen::Vector3d::Zero();
    const auto count = static_cast<size_t>(difference.count);
    const auto row_of = [&](size_t a) {
      return unknown_[static_cast<size_t>(difference.cells[a])];
    };
    for (size_t a = 0; a < count; ++a) {
      if (row_of(a) < 0) {
        known += difference.factors[a] * (net_.points.col(difference.cells[a]) - middle_);
      }
    }
    for (size_t a = 0; a < count; ++a) {
      if (row_of(a) < 0) continue;
      right_.row(row_of(a)) -= weight * difference.factors[a] * known.transpose();
      for (size_t b = 0; b < count; ++b) {
        if (row_of(b) < 0) continue;
        entries_.emplace_back(
            row_of(a), row_of(b), weight * difference.factors[a] * difference.factors[b]);
      }
    }
  }

  const PointNet& net_;
  const GridParameters& t_;
  std::vector<Eigen::Index> unknown_;  // row of the system, or −1
  Eigen::Index count_ = 0;
  Eigen::Vector3d middle_ = Eigen::Vector3d::Zero();
  Eigen::MatrixX3d right_;
  std::vector<Eigen::Triplet<double>> entries_;
};

}  // namespace

PointNet WithFilledCells(const PointNet& net, const GridParameters& parameters) {
  Check(net, "WithFilledCells");
  if (net.complete()) return net;
  return Filling(net, parameters).Fill();
}

}  // namespace batten::internal
