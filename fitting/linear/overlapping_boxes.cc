// SPDX-License-Identifier: MIT
#include "fitting/linear/overlapping_boxes.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "fitting/core/shared_constants.h"

namespace batten::internal {
namespace {

constexpr double kEnough = 1e-13;  // of the right-hand side

// A box overlaps its neighbours by the reach of a function and one more; its core is so many times
// as wide: twice, and steps go up by a quarter; four times, and a box takes four times the memory.
constexpr int kCoreInOverlaps = 6;

// The cores along one direction, and with overlaps.
std::vector<std::pair<int, int>> Intervals(int size, int reach) {
  const int overlap = reach + 1, count = std::max(1, size / (kCoreInOverlaps * overlap));
  std::vector<std::pair<int, int>> intervals;
  for (int k = 0; k < count; ++k) {
    const auto at = [&](int edge) { return static_cast<int>(Eigen::Index{size} * edge / count); };
    intervals.emplace_back(std::max(0, at(k) - overlap), std::min(size, at(k + 1) + overlap));
  }
  return intervals;
}

class Preconditioner {
 public:
  Preconditioner(const TensorBand& matrix, std::optional<CoarseSystem> coarse, ThreadPool& pool)
      : inner_size_(matrix.inner_size()), coarse_(std::move(coarse)), pool_(pool) {
    if (matrix.size() <= kOneBox) {
      boxes_.push_back({0, matrix.outer_size(), 0, matrix.inner_size()});
      coarse_.reset();
    } else {
      for (const auto& [i, i_end] : Intervals(matrix.outer_size(), matrix.outer_reach())) {
        for (const auto& [j, j_end] : Intervals(matrix.inner_size(), matrix.inner_reach()))
          boxes_.push_back({i, i_end, j, j_end});
      }
    }
    factors_.resize(boxes_.size(), BlockBandedMatrix(1, 1, 0));
    std::atomic<bool> good = !coarse_ || coarse_->matrix.Factor(&pool);
    const bool alone = boxes_.size() == 1;
    pool.For(std::ssize(boxes_), 1, [&](std::ptrdiff_t first, std::ptrdiff_t last) {
      for (std::ptrdiff_t k = first; k < last && !alone; ++k) {
        factors_[k] = matrix.Of(boxes_[k]);
        if (!factors_[k].Factor()) good = false;
      }
    });
    if (alone) {
      factors_[0] = matrix.Of(boxes_[0]);
      good = good && factors_[0].Factor(&pool);
    }
    good_ = good;
  }

  bool good() const { return good_; }

  Eigen::MatrixXd Applied(const Eigen::MatrixXd& r) const {
    std::vector<Eigen::MatrixXd> parts(boxes_.size());
    pool_.For(std::ssize(boxes_), 1, [&](std::ptrdiff_t first, std::ptrdiff_t last) {
      for (std::ptrdiff_t k = first; k < last; ++k) {
        const NetBox& box = boxes_[k];
        Eigen::MatrixXd& part = parts[k];
        part.resize(box.size(), r.cols());
        for (int i = 0; i < box.outer_size(); ++i)
          part.middleRows(RowIn(box, i), box.inner_size()) =
              r.middleRows(RowOf(box, i), box.inner_size());
        factors_[k].Solve(part);
      }
    });
    Eigen::MatrixXd z = Coarse(r);
    for (std::size_t k = 0; k < boxes_.size(); ++k) {
      const NetBox& box = boxes_[k];
      for (int i = 0; i < box.outer_size(); ++i)
        z.middleRows(RowOf(box, i), box.inner_size()) +=
            parts[k].middleRows(RowIn(box, i), box.inner_size());
    }
    return z;
  }

 private:
  Eigen::Index RowOf(const NetBox& box, int i) const {
    return Eigen::Index{box.outer + i} * inner_size_ + box.inner;
  }
  static Eigen::Index RowIn(const NetBox& box, int i) { return Eigen::Index{i} * box.inner_size(); }

  Eigen::MatrixXd Coarse(const Eigen::MatrixXd& r) const {
    if (!coarse_) return Eigen::MatrixXd::Zero(r.rows(), r.cols());
    const auto &outer = coarse_->outer, &inner = coarse_->inner;
    Eigen::MatrixXd small(outer.cols() * inner.cols(), r.cols()), z(r.rows(), r.cols());
    for (Eigen::Index d = 0; d < r.cols(); ++d) {
      const Eigen::Map<const Eigen::MatrixXd> net(r.col(d).data(), inner.rows(), outer.rows());
      const Eigen::MatrixXd half = inner.transpose() * net;
      small.col(d) = (half * outer).reshaped();
    }
    coarse_->matrix.Solve(small);
    for (Eigen::Index d = 0; d < r.cols(); ++d) {
      const Eigen::Map<const Eigen::MatrixXd> net(small.col(d).data(), inner.cols(), outer.cols());
      const Eigen::MatrixXd half = inner * net;
      z.col(d) = (half * outer.transpose()).reshaped();
    }
    return z;
  }

  int inner_size_;
  std::optional<CoarseSystem> coarse_;
  ThreadPool& pool_;
  std::vector<NetBox> boxes_;
  std::vector<BlockBandedMatrix> factors_;
  bool good_ = false;
};

// Of every column a number.
using Numbers = Eigen::RowVectorXd;

Numbers Products(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.cwiseProduct(b).colwise().sum();
}

// a / b, zero where there is nothing to divide: a column that is solved stays.
Numbers Shares(const Numbers& a, const Numbers& b) {
  return (b.array() > 0).select(a.array() / b.array(), 0.0);
}

}  // namespace

BoxSolution SolveByBoxes(const TensorBand& matrix,
                         std::optional<CoarseSystem> coarse,
                         const Eigen::MatrixXd& rhs,
                         const Eigen::MatrixXd& start,
                         ThreadPool& pool,
                         const std::function<void()>& each) {
  BoxSolution solution{start};
  const Preconditioner preconditioner(matrix, std::move(coarse), pool);
  if (!preconditioner.good()) {
    solution.singular = true;
    return solution;
  }
  const Numbers size = rhs.colwise().norm();
  Eigen::MatrixXd r = rhs - matrix.Times(start, pool), direction;
  Numbers before;
  for (;; ++solution.iterations) {
    solution.residual = Shares(r.colwise().norm(), size).maxCoeff();
    if (solution.residual <= kEnough || solution.iterations == kMostIterations) return solution;
    if (each) each();
    const Eigen::MatrixXd z = preconditioner.Applied(r);
    const Numbers now = Products(r, z);
    direction = solution.iterations == 0
                    ? z
                    : Eigen::MatrixXd(z + direction * Shares(now, before).asDiagonal());
    const Eigen::MatrixXd image = matrix.Times(direction, pool);
    const Numbers step = Shares(now, Products(direction, image));
    solution.rows += direction * step.asDiagonal();
    r -= image * step.asDiagonal();
    before = now;
  }
}

}  // namespace batten::internal
