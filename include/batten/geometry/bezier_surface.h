// SPDX-License-Identifier: MIT
// Bézier surfaces in space, polynomial or rational.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "batten/geometry/bezier_curve.h"
#include "batten/geometry/direction.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

// The order in which de Casteljau's algorithm blends a control net: rows along u first, rows along
// v first, or both at once by bilinear means of four neighbours (then the rest along the direction
// of higher degree). All give the same point to rounding.
enum class DeCasteljauOrder { kUFirst, kVFirst, kBilinear };

// S(u,v) = Σ B_{i,p}(u) B_{j,q}(v) w_ij P_ij / Σ B_{i,p}(u) B_{j,q}(v) w_ij on [0, 1]². A value:
// editing returns a new one. Parameters outside are taken at the nearest edge.
// [Piegl & Tiller 1997, §1.5]
class BezierSurface {
 public:
  // Control point (i,j) is column i·(q+1) + j (v runs fastest), Euclidean; no weights means all
  // ones. Throws std::invalid_argument unless degrees are in [0, kMaxBezierDegree], sizes agree,
  // everything is finite and weights are positive.
  BezierSurface(int degree_u,
                int degree_v,
                Eigen::Matrix3Xd control_points,
                Eigen::VectorXd weights = {});

  int degree_u() const { return degree_u_; }
  int degree_v() const { return degree_v_; }
  const Eigen::Matrix3Xd& control_points() const { return control_points_; }
  const Eigen::VectorXd& weights() const { return weights_; }
  bool rational() const { return rational_; }  // weights differ
  int Column(int i, int j) const { return i * (degree_v_ + 1) + j; }
  Eigen::Vector3d control_point(int i, int j) const { return control_points_.col(Column(i, j)); }
  double weight(int i, int j) const { return weights_[Column(i, j)]; }

  // De Casteljau with positive weights throughout (see BezierCurve::At): the point lies in the hull
  // of the control points. O(p·q·min(p,q)). [A1.7]
  Eigen::Vector3d At(double u, double v, DeCasteljauOrder order = DeCasteljauOrder::kUFirst) const;

  // Every partial derivative ∂^(k+l)S/∂u^k∂v^l up to the total order.
  SurfaceDerivatives Derivatives(double u, double v, int order) const;

  bool operator==(const BezierSurface&) const = default;

 private:
  int degree_u_, degree_v_;
  Eigen::Matrix3Xd control_points_;
  Eigen::VectorXd weights_;
  bool rational_;
};

// The surface of first partial derivatives in one direction; applied twice, of second and mixed
// ones. Of one degree less in that direction for a polynomial surface; of twice both degrees for a
// rational one. Throws std::invalid_argument when that is above kMaxBezierDegree.
BezierSurface PartialDerivative(const BezierSurface& surface, Direction direction);

// ∂²S/∂u∂v at the corner (u,v), u and v 0 or 1, from the four control points there:
// p·q·(w11/w00·(P11−P00) − w10·w01/w00²·((P10−P00) + (P01−P00))) at (0, 0). [Farin 2002, §15.7]
Eigen::Vector3d TwistVector(const BezierSurface& surface, int u, int v);

// p·q·(P_{i+1,j+1} − P_{i+1,j} − P_{i,j+1} + P_{ij}), column i·q + j: how far each quadrilateral of
// the net is from a parallelogram. Those are the control points of ∂²S/∂u∂v of a polynomial
// surface; they all vanish for a translational one. [Farin 2002, §15.5]
Eigen::Matrix3Xd ControlTwists(const BezierSurface& surface);

// Below, new control points are means of given ones, and those that coincide give points that
// coincide with them, bit by bit: a collapsed edge stays one.

// The parts on [0, u] × [0, v], [0, u] × [v, 1], [u, 1] × [0, v] and [u, 1] × [v, 1], each on [0,
// 1]² again. Throws std::invalid_argument unless 0 < u, v < 1.
std::array<BezierSurface, 4> Subdivided(const BezierSurface& surface, double u, double v);

// The same surface with degrees p + by_u and q + by_v; see Elevated(BezierCurve).
BezierSurface Elevated(const BezierSurface& surface, int by_u, int by_v);

// The curves u = 0, u = 1 (with parameter v), v = 0, v = 1 (with parameter u).
std::array<BezierCurve<3>, 4> BoundaryCurves(const BezierSurface& surface);

// The unit normal S_u × S_v / |…|; where that vanishes (collapsed edges and corners, edges that are
// tangent to one another) its limit from inside, which follows from the next control rows; none
// where there is none: see LimitNormal(NurbsSurface). Throws std::invalid_argument when a degree is
// above kMaxDegree.
std::optional<Eigen::Vector3d> NormalAt(const BezierSurface& surface, double u, double v);

// As a NURBS surface of one span in each direction over [0, 1]², and back (domains brought to
// [0, 1]). Throw std::invalid_argument when a degree is not in [1, kMaxDegree], or the NURBS
// surface has more spans or is trimmed.
NurbsSurface ToNurbs(const BezierSurface& surface);
BezierSurface ToBezier(const NurbsSurface& surface);

// Columns (w·P, w), with w = 1 where the surface is not rational.
Eigen::Matrix4Xd Homogeneous(const BezierSurface& surface);

}  // namespace batten
