// SPDX-License-Identifier: MIT
// A tensor-product NURBS surface in space.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/spline_basis.h"

namespace batten {

// A point of a surface with its first and second partial derivatives.
struct SurfaceJet {
  Eigen::Vector3d point, du, dv, duu, duv, dvv;
};

// All partial derivatives up to a total order, at one parameter.
class SurfaceDerivatives {
 public:
  SurfaceDerivatives(int order, Eigen::Matrix4Xd columns)
      : order_(order), columns_(std::move(columns)) {}
  int order() const { return order_; }
  // ∂^(k+l)S / ∂u^k ∂v^l, for k + l ≤ order.
  Eigen::Vector3d operator()(int k, int l) const {
    return columns_.col(k * (order_ + 1) + l).head<3>();
  }

 private:
  int order_;
  Eigen::Matrix4Xd columns_;
};

// S(u,v) = Σ N_i(u) N_j(v) w_ij P_ij / Σ N_i(u) N_j(v) w_ij on the product of the bases' domains.
// A value: editing returns a new one. Parameters outside the domain are taken at its nearest edge
// or, in a periodic direction, whole periods away; NaN, and ±∞ in a periodic direction, throw
// std::invalid_argument (SplineBasis::Clamp). Corners of a clamped net are met exactly, and over a
// collapsed edge the derivatives along it are exactly zero. [Piegl & Tiller 1997, §4.4]
//
// Rounding, per coordinate; ε = 2^-52, p and q the degrees, g × h the size of the cell between
// knots, D the range of the coordinate over the cell's (p+1)(q+1) control points. Sums run over
// control points less one of them, so what counts is D and not the distance from the origin:
//  · a point is right to (7p + 7q + 4)·ε·D + ε·|S|, whatever the weights;
//  · ∂^(k+l)S/∂u^k∂v^l without weights to (4p + 4q + 2)·ε·D·p!/(p−k)!·(2/g)^k·q!/(q−l)!·(2/h)^l;
//  · with weights to (k+l+1)(7p + 7q + k + l + 6)·ε·B_kl, where B_kl is what Leibniz' rule gives
//    with the absolute value of every term added: large where weights differ much.
class NurbsSurface {
 public:
  // Control point (i,j) is column i·size_v + j (v runs fastest), Euclidean, in the data's units; no
  // weights means all ones. Throws std::invalid_argument unless sizes agree, everything is finite,
  // also weights times differences of coordinates, weights are positive and, in a periodic
  // direction of degree p, the last p rows are the first p.
  NurbsSurface(SplineBasis basis_u,
               SplineBasis basis_v,
               Eigen::Matrix3Xd control_points,
               Eigen::VectorXd weights = {});

  const SplineBasis& basis_u() const { return basis_u_; }
  const SplineBasis& basis_v() const { return basis_v_; }
  int size_u() const { return basis_u_.size(); }
  int size_v() const { return basis_v_.size(); }
  const Eigen::Matrix3Xd& control_points() const { return control_points_; }
  const Eigen::VectorXd& weights() const { return weights_; }
  bool rational() const { return rational_; }  // weights differ
  Eigen::Vector3d control_point(int i, int j) const {
    return control_points_.col(i * size_v() + j);
  }

  Eigen::Vector3d At(double u, double v) const;

  // Point, first and second derivatives, without allocating. Right-continuous at knots, left at the
  // upper ends.
  SurfaceJet JetAt(double u, double v) const;

  // Every partial derivative up to the total order. [A3.6, A4.4]
  SurfaceDerivatives Derivatives(double u, double v, int order) const;

  // The unit normal S_u × S_v / |…|. Where the two are parallel or vanish the limit from inside the
  // piece, which normal_limits.h defines (and normal_limits.cc this function): one at a pole, one
  // for each ruling at a cone's tip, none on a fold or where it depends on the direction.
  std::optional<Eigen::Vector3d> NormalAt(double u, double v) const;

  // The loops in the domain that bound the part of the surface that counts: the outer boundaries of
  // its regions, counter-clockwise, one of them first, and holes, clockwise; none: the whole
  // domain. On a periodic direction they lie in one period [lower, upper], and where a region goes
  // round, its outer loop runs along the seam, once on either side. Evaluation does not look at
  // them; trim_region.h tells what is inside.
  const std::vector<NurbsCurve<2>>& trims() const { return trims_; }
  bool trimmed() const { return !trims_.empty(); }

  // The surface with these loops in place of its own. Throws std::invalid_argument unless each
  // ends where it begins, to kLoopClosure of the domain. That they lie in the domain, are turned as
  // said and do not cross is the maker's business: trim_region.h checks and turns.
  NurbsSurface WithTrims(std::vector<NurbsCurve<2>> loops) const;

  // The surface moved by `shift`.
  NurbsSurface Translated(const Eigen::Vector3d& shift) const;

  bool operator==(const NurbsSurface&) const = default;

 private:
  void CheckPeriods() const;

  SplineBasis basis_u_, basis_v_;
  Eigen::Matrix3Xd control_points_;
  Eigen::VectorXd weights_;
  bool rational_;
  std::vector<NurbsCurve<2>> trims_;
};

// How far, as a share of the domain, the ends of a trim loop may be apart.
inline constexpr double kLoopClosure = 1e-9;

// The unit normal of a jet; none where S_u and S_v are parallel to rounding, or vanish.
std::optional<Eigen::Vector3d> UnitNormal(const SurfaceJet& jet);

}  // namespace batten
