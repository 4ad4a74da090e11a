// SPDX-License-Identifier: MIT
// The polynomial pieces of curves and surfaces, each in homogeneous Bézier form about an origin of
// its own, so that small pieces far from the data's origin keep their digits. Internal to geometry.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

// C(u0 + t (u1 − u0)) = origin + Σ B_i(t) points_i / Σ B_i(t) w_i for t in [0, 1]; z = 0 in the
// plane.
struct CurvePiece {
  double u0, u1;
  Eigen::Vector3d origin;
  Eigen::Matrix4Xd points;  // (w_i (P_i − origin), w_i)
  // Bounds of what rounding, that of the control points' own coordinates included, may have done
  // to each coordinate of a point; nothing where control points coincide with the origin.
  Eigen::VectorXd errors;

  int degree() const { return static_cast<int>(points.cols()) - 1; }
  Eigen::Vector3d Euclidean(int i) const { return origin + points.col(i).head<3>() / points(3, i); }
};

// The same over [u0, u1] × [v0, v1]; point (i,j) is column i·(q+1) + j.
struct SurfacePiece {
  double u0, u1, v0, v1;
  Eigen::Vector3d origin;
  int p, q;
  Eigen::Matrix4Xd points;
  Eigen::VectorXd errors;

  int Column(int i, int j) const { return i * (q + 1) + j; }
  Eigen::Vector3d Euclidean(int i, int j) const {
    return origin + points.col(Column(i, j)).head<3>() / points(3, Column(i, j));
  }
};

// The piece of a non-empty span. The origin is a control point of the span unless given. O(p³).
template <int Dim>
CurvePiece PieceOf(const NurbsCurve<Dim>& curve,
                   int span,
                   const std::optional<Eigen::Vector3d>& origin = {});
SurfacePiece PieceOf(const NurbsSurface& surface,
                     int span_u,
                     int span_v,
                     const std::optional<Eigen::Vector3d>& origin = {});

// The pieces of all non-empty spans in order.
template <int Dim>
std::vector<CurvePiece> PiecesOf(const NurbsCurve<Dim>& curve);

// All pieces of a surface, made when asked for. Keeps the conversion matrices: 8·(p+1)² bytes a
// span.
class SurfacePieces {
 public:
  explicit SurfacePieces(const NurbsSurface& surface);  // must outlive this
  int count_u() const { return static_cast<int>(spans_u_.size()); }
  int count_v() const { return static_cast<int>(spans_v_.size()); }
  SurfacePiece Piece(int i, int j, const std::optional<Eigen::Vector3d>& origin = {}) const;

 private:
  const NurbsSurface& surface_;
  std::vector<int> spans_u_, spans_v_;
  std::vector<Eigen::MatrixXd> matrices_u_, matrices_v_;
};

// The same piece about its end t = 0 or 1, or its corner: about the control point there if there is
// one, so that control points that coincide with it are exactly zero.
template <int Dim>
CurvePiece AboutEnd(const NurbsCurve<Dim>& curve, int span, int end);
SurfacePiece AboutCorner(const NurbsSurface& surface, int span_u, int span_v, int end_u, int end_v);

// The Bernstein polynomials of a degree ≤ kMaxDegree: values[i] = B_i(t). [Piegl & Tiller 1997,
// A1.3]
void BernsteinBasis(int degree, double t, double* values);

// Derivatives of order 0 … 3 with respect to t; those of order 0 relative to the origin.
struct CurvePieceJet {
  Eigen::Vector3d point, first, second, third;
};
CurvePieceJet JetOf(const CurvePiece& piece, double t);

// With respect to the piece's own parameters s and t in [0, 1]; the point relative to the origin.
SurfaceJet JetOf(const SurfacePiece& piece, double s, double t);

}  // namespace batten::internal
