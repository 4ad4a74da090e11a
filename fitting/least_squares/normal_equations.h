// SPDX-License-Identifier: MIT
// The normal equations of a scattered least-squares problem, assembled knot cell by knot cell.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/fitting/point_rows.h"
#include "batten/geometry/spline_basis.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/least_squares/cell_moments.h"
#include "fitting/linear/block_banded_matrix.h"
#include "fitting/linear/tensor_band.h"

namespace batten::internal {

// Sorts points by the knot cell their parameters lie in.
class CellOrder {
 public:
  // `outer` and `inner` hold one parameter a point, inside the bases' domains. A curve has no inner
  // basis (null): its only inner span is 0. O(m).
  CellOrder(const SplineBasis& outer_basis,
            const SplineBasis* inner_basis,
            const Eigen::VectorXd& outer,
            const Eigen::VectorXd& inner);

  struct Cell {
    int outer_span, inner_span;
    Eigen::Index begin, end;  // in points()
  };
  const std::vector<Cell>& cells() const { return cells_; }  // those that hold points
  const std::vector<Eigen::Index>& points() const {
    return points_;
  }  // sorted by cell, then by index

 private:
  std::vector<Cell> cells_;
  std::vector<Eigen::Index> points_;
};

// A = Σ w b bᵀ and the right-hand side Σ w b zᵀ over the points, b the tensor-product basis
// functions at a point's parameters and z its values. Gathered as moments of knot cells, each of
// which is turned once into products of basis functions: all factors are positive, so that the
// matrix is as exact as the plain sum. The sums do not depend on the number of threads.
// O(m (2p+1)(2q+1)) and a few points' worth for every cell; memory of the moments besides.
class NormalEquations {
 public:
  // inner basis: null for a curve, whose points have no inner parameters. Parameters must lie in
  // the bases' domains.
  NormalEquations(const SplineBasis& outer_basis,
                  const SplineBasis* inner_basis,
                  const PointRows& points,
                  ThreadPool& pool);

  // The same from moments over the bases' spans.
  NormalEquations(const SplineBasis& outer_basis,
                  const SplineBasis* inner_basis,
                  const CellMoments& moments,
                  ThreadPool& pool);

  // Adds A to a matrix of EmptyMatrix' sizes. O(n (p+1)(2q+1)).
  void AddTo(BlockBandedMatrix& matrix) const;

  // Rows as in the matrix: those of the outer basis in its CoefficientOrder, inside each the
  // different inner coefficients.
  const Eigen::MatrixXd& rhs() const { return rhs_; }  // n × d
  double squares() const { return squares_; }          // Σ w |z|²
  double trace() const { return trace_; }              // of A, repeated coefficients apart

  // A over the bases' coefficients, repeated ones apart.
  const TensorBand& band() const { return band_; }

 private:
  std::vector<int> outer_rows_, inner_rows_;
  TensorBand band_;
  Eigen::MatrixXd rhs_;
  double squares_ = 0, trace_ = 0;
};

// A view of m points: parameters (inner: empty for a curve), values d × m, weights empty for ones.
// Its arguments must outlive it.
PointRows RowsOf(const Eigen::VectorXd& outer,
                 const Eigen::VectorXd& inner,
                 const Eigen::MatrixXd& values,
                 const Eigen::VectorXd& weights);

// A zero matrix for the coefficients of a tensor-product spline that differ; inner basis null for a
// curve.
BlockBandedMatrix EmptyMatrix(const SplineBasis& outer_basis, const SplineBasis* inner_basis);

}  // namespace batten::internal
