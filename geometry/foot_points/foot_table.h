// SPDX-License-Identifier: MIT
// A surface or curve cut into rational Bézier pieces, tabulated for the search of closest points.
// Internal. A curve is a surface of degree 0 in v with one cell.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

// One parameter direction cut into cells, a cell being a knot span or a part of it.
class FootAxis {
 public:
  FootAxis() = default;
  explicit FootAxis(const SplineBasis& basis, int cuts);
  static FootAxis Single();                    // the missing direction of a curve
  static FootAxis Row(int cells, int degree);  // cell k is [k, k + 1]

  int cells() const { return static_cast<int>(spans_.size()); }
  int span(int cell) const { return spans_[cell]; }
  double low(int cell) const { return breaks_[cell]; }
  double high(int cell) const { return breaks_[cell + 1]; }
  double lower() const { return breaks_.front(); }
  double upper() const { return breaks_.back(); }
  int degree() const { return degree_; }
  bool periodic() const { return periodic_; }
  int cuts() const { return cuts_; }

  // Whether a cell and the next, past the last one the first, are joined by continuous first
  // derivatives.
  bool SmoothAfter(int cell) const { return smooth_after_[cell] != 0; }

  // The cell of a parameter of the domain.
  int Find(double u) const;

  // The parameter at local x in [−1, 1] of a cell, and back.
  double At(int cell, double x) const {
    const double u = low(cell) + half_[cell] * (x + 1);
    return u < low(cell) ? low(cell) : u > high(cell) ? high(cell) : u;
  }
  double Local(int cell, double u) const {
    return u == high(cell) ? 1 : (u - low(cell)) / half_[cell] - 1;
  }

 private:
  void Finish();

  int degree_ = 0, cuts_ = 1;
  bool periodic_ = false;
  std::vector<double> breaks_, half_;
  std::vector<int> spans_, lookup_;
  std::vector<char> smooth_after_;
  double lookup_scale_ = 0;
};

// All pieces, row by row: piece = cell_u · cells_v + cell_v. Positions are relative to the piece's
// centre, so that large coordinates cost no digits; weights are scaled so that the greatest control
// weight of a piece is one.
class FootTable {
 public:
  explicit FootTable(const NurbsSurface& surface);
  template <int Dim>
  explicit FootTable(const NurbsCurve<Dim>& curve);
  // Polynomial curves of one degree, each by its Bézier points less `origin`: one a cell. They need
  // not meet.
  FootTable(const std::vector<Eigen::Matrix3Xd>& curves, const Eigen::Vector3d& origin);

  FootAxis u, v;
  bool rational = false;
  double size = 0;         // half the diagonal of the box of the control points
  Eigen::Vector3d middle;  // its centre
  std::vector<Eigen::Vector3d> centres;
  std::vector<double> radii;  // greatest distance of a Bézier point from the centre
  std::vector<Eigen::AlignedBox3d> boxes;

  int degree_u() const { return u.degree(); }
  int degree_v() const { return v.degree(); }
  int pieces() const { return u.cells() * v.cells(); }

  // Homogeneous Bézier points (w·x, w·y, w·z, w), index (r·(q+1) + s)·4.
  const double* bezier(int piece) const { return bezier_.data() + piece * bezier_stride_; }
  // The same polynomial as coefficients of x^r y^s on [−1, 1]², index (r·(q+1) + s)·4; where the
  // degrees are too high for that, the Bézier points.
  const double* local(int piece) const {
    return monomial() ? local_.data() + piece * bezier_stride_ : bezier(piece);
  }
  bool monomial() const { return degree_u() <= kHighestMonomial && degree_v() <= kHighestMonomial; }
  static constexpr int kHighestMonomial = 9;

  // The squared distance to q, times w², is A + q·B + |q|² W, of bidegree (2p, 2q): five rows A,
  // Bx, By, Bz, W of `padded` coefficients each (four where not rational, W being one), those past
  // `coefficients` being very large.
  const double* squares(int piece) const { return squares_.data() + piece * squares_stride_; }
  int coefficients() const { return (2 * degree_u() + 1) * (2 * degree_v() + 1); }
  int padded() const { return padded_; }

 private:
  // `net` is homogeneous Bézier points about `centre`.
  void SetPiece(int piece, const Eigen::Vector3d& centre, Eigen::Matrix4Xd net);
  void Allocate();

  size_t bezier_stride_ = 0, squares_stride_ = 0;
  int padded_ = 0;
  std::vector<double> bezier_, local_, squares_;
  Eigen::MatrixXd to_local_u_, to_local_v_;
};

}  // namespace batten::internal
