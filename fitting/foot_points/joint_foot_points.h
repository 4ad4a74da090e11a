// SPDX-License-Identifier: MIT
// Foot points of data on a shape that changes, and the part of each residual normal to the shape
// (variable projection of the parameters). Used by joint optimization only.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "batten/geometry/spline_basis.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// A curve (no basis_v; net 2 × n or 3 × n) or surface (3 × n, v fastest) as the optimiser sees it.
struct TensorShape {
  SplineBasis basis_u;
  std::optional<SplineBasis> basis_v;
  Eigen::MatrixXd net;
  Eigen::VectorXd weights;

  int degree_v() const { return basis_v ? basis_v->degree() : 0; }
  int size_v() const { return basis_v ? basis_v->size() : 1; }
  int dimension() const { return static_cast<int>(net.rows()); }
  // Control points that act on one knot cell.
  int functions() const { return (basis_u.degree() + 1) * (degree_v() + 1); }
  // The index of the k-th of them (v fastest) for the cell of these spans.
  int ControlPoint(int span_u, int span_v, int k) const {
    const int q = degree_v();
    return (span_u - basis_u.degree() + k / (q + 1)) * size_v() + span_v - q + k % (q + 1);
  }
  // The rational basis functions R of these control points at (u,v). [Piegl & Tiller 1997, eqs.
  // 4.2, 4.12]
  void Rational(int span_u, int span_v, double u, double v, double* R) const;
};

// Foot points and residuals of the data, one a column.
struct FootPointSet {
  Eigen::Matrix2Xd parameters;           // curves: second row zero
  Eigen::MatrixXd difference;            // shape less datum
  Eigen::MatrixXd first, second;         // unit directions that count, as many as `directions` says
  std::vector<std::uint8_t> directions;  // 0: all coordinates count

  double SquaredDistances() const { return difference.squaredNorm(); }
};

// Projects data onto a shape. With T the tangents at a foot point, eliminating its parameters
// leaves the residual's part normal to T: along the normal of a surface, across the tangent of a
// curve. Where the foot is held by the domain's edge only the tangents along the edge are free; at
// a corner, at an end of a curve, and where there is no normal, all of the residual counts.
class FootProjector {
 public:
  // `points`: dimension × m, kept by reference. With `orthogonal` off, parameters stay what they
  // are and all of a residual counts. `held`: of each point of a surface, 1 where u stays what it
  // is, 2 where v does; empty: none.
  FootProjector(const Eigen::MatrixXd& points,
                bool orthogonal,
                ThreadPool& pool,
                std::vector<std::uint8_t> held = {})
      : points_(points), orthogonal_(orthogonal), pool_(pool), held_(std::move(held)) {}

  // Finds the foot points from nearby starts; `feet` is resized where needed.
  void Project(const TensorShape& shape, const Eigen::Matrix2Xd& starts, FootPointSet& feet) const;

 private:
  void ProjectOnSurface(const TensorShape& shape,
                        const Eigen::Matrix2Xd& starts,
                        FootPointSet& feet) const;

  const Eigen::MatrixXd& points_;
  bool orthogonal_;
  ThreadPool& pool_;
  std::vector<std::uint8_t> held_;
};

// The orientation of the shape: unit normals of a surface, or tangents of a curve, at the middles
// of 4 × 4 (4) parts of every knot cell; zero where there is none. Places whose part holds a foot
// point, and that lie within the rectangle of all, are watched.
struct Facing {
  Eigen::MatrixXd directions;  // dimension × places
  Eigen::Index columns = 1;    // places in the v direction; they run fastest
  std::vector<bool> watched;

  // Whether, compared with `before`, no watched place has flipped, and no two watched neighbours of
  // a cell have come to face away from each other, as they do where the shape folds.
  bool Keeps(const Facing& before) const;

  void Watch(const TensorShape& shape, const Eigen::Matrix2Xd& feet);
};
Facing FacingOf(const TensorShape& shape, ThreadPool& pool);

}  // namespace batten::internal
