// SPDX-License-Identifier: MIT
// Large tensor-product systems solved box by box.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <functional>
#include <optional>
#include <vector>

#include "batten/geometry/thread_pool.h"
#include "fitting/linear/tensor_band.h"

namespace batten::internal {

// The system over a coarser net whose functions are among the sums of the fine net's: `matrix` is
// EᵀAE, E = outer ⊗ inner.
struct CoarseSystem {
  Eigen::SparseMatrix<double, Eigen::RowMajor> outer, inner;  // fine × coarse
  BlockBandedMatrix matrix;
};

struct BoxSolution {
  Eigen::MatrixXd rows;
  int iterations = 0;
  double residual = 0;    // |b − Ax| / |b|, the largest of the columns
  bool singular = false;  // a box is not positive definite; rows are as at the start
};

// Solves A·x = b, b of d columns, A symmetric positive definite, from `start`. Conjugate gradients
// whose preconditioner solves A over boxes of the net that overlap by the reach of its functions,
// and over the coarse system, and adds: with boxes and coarse cells of bounded size the number of
// steps does not grow with the net. Ends at a residual of 1e-13, or after 500 steps. A small
// net is one box, and is solved at once. The result does not depend on threads. Memory: some 250
// numbers a coefficient for cubics; time: as much for each step. What `each`, called before every
// step, throws passes through. [Toselli & Widlund 2005, §3: two-level overlapping Schwarz methods]
BoxSolution SolveByBoxes(const TensorBand& matrix,
                         std::optional<CoarseSystem> coarse,
                         const Eigen::MatrixXd& rhs,
                         const Eigen::MatrixXd& start,
                         ThreadPool& pool,
                         const std::function<void()>& each = {});

// Nets of at most so many coefficients are one box.
inline constexpr int kOneBox = 20000;

}  // namespace batten::internal
