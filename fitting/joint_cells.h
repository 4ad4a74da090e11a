// SPDX-License-Identifier: MIT
// The joint problem seen cell by cell: what every knot cell says about its control points once all
// foot points are eliminated. Used by the joint stage only.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/fitting/joint_stage.h"
#include "batten/fitting/normal_equations.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

// The control points of a changing surface, the foot points of all data on it, and, per knot cell,
// the least-squares rows that remain of them. With T = [S_u S_v] at a foot point, eliminating its
// parameters leaves the residual's part along the normal; where the foot is held by the domain's
// edge, also the part across the edge, and at a corner all of it.
class JointCells {
 public:
  JointCells(const NurbsSurface& start,
             const Eigen::Matrix3Xd& points,
             const Eigen::VectorXd& weights,
             const Eigen::Matrix2Xd& parameters,
             const JointOptions& options,
             ThreadPool& pool);

  // Control points, three numbers each; the optimiser writes here.
  double* control_point(int k) { return net_.col(k).data(); }
  int control_points() const { return static_cast<int>(net_.cols()); }

  int cells() const { return static_cast<int>(cells_.size()); }
  int functions() const { return functions_; }  // control points of a cell
  int rows() const { return 6 * functions_ + 2; }
  std::vector<int> ControlPointsOf(int cell) const;

  // Projects every point onto the surface of the present control points and sorts them into cells.
  // False when the surface has turned over somewhere.
  bool Project();

  // Makes the present state the one that later steps start from: foot points, damping, distances.
  void Accept();

  // The rows of a cell: residual (rows()) and, when asked for, Jacobian (rows() × 3·functions(),
  // row major) at the accepted state; without it, two rows that have the same sum of squares as the
  // cost.
  void Evaluate(int cell, double* residual, double* jacobian) const;

  double SquaredDistances() const;  // Σ d² of the last projection, without weights
  NurbsSurface Surface() const;
  const Eigen::Matrix2Xd& feet() const { return accepted_feet_; }

  double damping = 1e-2;  // of the proximal rows

 private:
  struct Cell {
    int span_u, span_v;
    Eigen::MatrixXd fairness;  // Lᵀ with K = L·Lᵀ the cell's thin-plate form
    Eigen::MatrixXd proximal;  // Lᵀ of the cell's point-distance matrix, at the accepted state
    Eigen::Index begin = 0, end = 0;  // its points in order_
    Eigen::Matrix3Xd normals;         // of the start, on a grid
  };

  void MakeCells(const NurbsSurface& start, double fairness_weight);
  void Rational(int span_u, int span_v, double u, double v, double* R) const;
  Eigen::Matrix3Xd Corner(const Cell& cell, const Eigen::Matrix3Xd& net) const;
  double PointWeight(Eigen::Index k) const { return weights_.size() > 0 ? weights_[k] : 1.0; }

  SplineBasis basis_u_, basis_v_;
  Eigen::VectorXd net_weights_;
  Eigen::Matrix3Xd net_, accepted_net_;
  const Eigen::Matrix3Xd& points_;
  Eigen::VectorXd weights_;
  const JointOptions& options_;
  ThreadPool& pool_;
  int functions_;
  std::vector<Cell> cells_;
  std::vector<Eigen::Index> order_;  // points sorted by cell
  std::vector<SurfaceJet> jets_;     // at the foot points of the last projection
  Eigen::Matrix2Xd feet_, accepted_feet_;
};

}  // namespace batten
