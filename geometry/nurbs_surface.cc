// SPDX-License-Identifier: MIT
#include "batten/geometry/nurbs_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

#include "batten/geometry/rational_derivatives.h"

namespace batten {

NurbsSurface::NurbsSurface(SplineBasis basis_u,
                           SplineBasis basis_v,
                           Eigen::Matrix3Xd control_points,
                           Eigen::VectorXd weights)
    : basis_u_(std::move(basis_u)),
      basis_v_(std::move(basis_v)),
      control_points_(std::move(control_points)),
      weights_(std::move(weights)) {
  const Eigen::Index count = Eigen::Index{basis_u_.size()} * basis_v_.size();
  if (weights_.size() == 0) weights_ = Eigen::VectorXd::Ones(count);
  if (control_points_.cols() != count) {
    throw std::invalid_argument("NurbsSurface: " + std::to_string(control_points_.cols()) +
                                " control points do not fill a net of " +
                                std::to_string(basis_u_.size()) + " x " +
                                std::to_string(basis_v_.size()));
  }
  if (weights_.size() != count) {
    throw std::invalid_argument("NurbsSurface: " + std::to_string(weights_.size()) +
                                " weights do not fit " + std::to_string(count) + " control points");
  }
  if (!control_points_.allFinite()) {
    throw std::invalid_argument("NurbsSurface: a control point is not finite");
  }
  if (!weights_.allFinite() || !(weights_.minCoeff() > 0)) {
    throw std::invalid_argument("NurbsSurface: a weight is not positive and finite");
  }
  rational_ = (weights_.array() != weights_[0]).any();
  CheckPeriods();
}

void NurbsSurface::CheckPeriods() const {
  const int n = size_u(), m = size_v(), p = basis_u_.degree(), q = basis_v_.degree();
  const auto same = [&](Eigen::Index a, Eigen::Index b) {
    return control_points_.col(a) == control_points_.col(b) && weights_[a] == weights_[b];
  };
  for (Eigen::Index i = 0; basis_u_.periodic() && i < p; ++i) {
    for (int j = 0; j < m; ++j) {
      if (same(i * m + j, (n - p + i) * m + j)) continue;
      throw std::invalid_argument("NurbsSurface: the last " + std::to_string(p) +
                                  " rows of a net periodic in u do not repeat the first");
    }
  }
  for (Eigen::Index j = 0; basis_v_.periodic() && j < q; ++j) {
    for (int i = 0; i < n; ++i) {
      if (same(Eigen::Index{i} * m + j, Eigen::Index{i} * m + m - q + j)) continue;
      throw std::invalid_argument("NurbsSurface: the last " + std::to_string(q) +
                                  " columns of a net periodic in v do not repeat the first");
    }
  }
}

Eigen::Vector3d NurbsSurface::At(double u, double v) const {
  u = basis_u_.Clamp(u);
  v = basis_v_.Clamp(v);
  const int p = basis_u_.degree(), q = basis_v_.degree();
  const int su = basis_u_.Span(u), sv = basis_v_.Span(v);
  double Nu[kMaxDegree + 1], Nv[kMaxDegree + 1];
  basis_u_.Values(su, u, Nu);
  basis_v_.Values(sv, v, Nv);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double weight = 0;
  for (int r = 0; r <= p; ++r) {
    const Eigen::Index row = Eigen::Index{su - p + r} * size_v() + sv - q;
    Eigen::Vector3d inner = Eigen::Vector3d::Zero();
    double inner_weight = 0;
    for (int s = 0; s <= q; ++s) {
      const double c = Nv[s] * weights_[row + s];
      inner += c * control_points_.col(row + s);
      inner_weight += c;
    }
    sum += Nu[r] * inner;
    weight += Nu[r] * inner_weight;
  }
  return sum / weight;
}

// Sums over v first, for the three v-orders at once, then over u. [A3.6 and A4.4 for order 2]
SurfaceJet NurbsSurface::JetAt(double u, double v) const {
  u = basis_u_.Clamp(u);
  v = basis_v_.Clamp(v);
  const int p = basis_u_.degree(), q = basis_v_.degree();
  const int su = basis_u_.Span(u), sv = basis_v_.Span(v);
  double Nu[3 * (kMaxDegree + 1)], Nv[3 * (kMaxDegree + 1)];
  basis_u_.Derivatives(su, u, 2, Nu);
  basis_v_.Derivatives(sv, v, 2, Nv);
  Eigen::Vector4d a00, a10, a01, a20, a11, a02;
  a00 = a10 = a01 = a20 = a11 = a02 = Eigen::Vector4d::Zero();
  for (int r = 0; r <= p; ++r) {
    const Eigen::Index row = Eigen::Index{su - p + r} * size_v() + sv - q;
    Eigen::Vector4d b0 = Eigen::Vector4d::Zero(), b1 = b0, b2 = b0;
    for (int s = 0; s <= q; ++s) {
      const double w = weights_[row + s];
      Eigen::Vector4d h;
      h << w * control_points_.col(row + s), w;
      b0 += Nv[s] * h;
      b1 += Nv[q + 1 + s] * h;
      b2 += Nv[2 * (q + 1) + s] * h;
    }
    a00 += Nu[r] * b0;
    a01 += Nu[r] * b1;
    a02 += Nu[r] * b2;
    a10 += Nu[p + 1 + r] * b0;
    a11 += Nu[p + 1 + r] * b1;
    a20 += Nu[2 * (p + 1) + r] * b0;
  }
  SurfaceJet jet;
  const double w = a00[3];
  jet.point = a00.head<3>() / w;
  jet.du = (a10.head<3>() - a10[3] * jet.point) / w;
  jet.dv = (a01.head<3>() - a01[3] * jet.point) / w;
  jet.duu = (a20.head<3>() - 2 * a10[3] * jet.du - a20[3] * jet.point) / w;
  jet.dvv = (a02.head<3>() - 2 * a01[3] * jet.dv - a02[3] * jet.point) / w;
  jet.duv = (a11.head<3>() - a10[3] * jet.dv - a01[3] * jet.du - a11[3] * jet.point) / w;
  return jet;
}

SurfaceDerivatives NurbsSurface::Derivatives(double u, double v, int order) const {
  if (order < 0) throw std::invalid_argument("NurbsSurface::Derivatives: order is negative");
  u = basis_u_.Clamp(u);
  v = basis_v_.Clamp(v);
  const int p = basis_u_.degree(), q = basis_v_.degree();
  const int su = basis_u_.Span(u), sv = basis_v_.Span(v);
  std::vector<double> Nu((order + 1) * (p + 1)), Nv((order + 1) * (q + 1));
  basis_u_.Derivatives(su, u, order, Nu.data());
  basis_v_.Derivatives(sv, v, order, Nv.data());
  const int stride = order + 1;
  Eigen::Matrix4Xd A = Eigen::Matrix4Xd::Zero(4, stride * stride);
  for (int r = 0; r <= p; ++r) {
    const Eigen::Index row = Eigen::Index{su - p + r} * size_v() + sv - q;
    for (int l = 0; l <= order; ++l) {
      Eigen::Vector4d inner = Eigen::Vector4d::Zero();
      for (int s = 0; s <= q; ++s) {
        const double c = Nv[l * (q + 1) + s] * weights_[row + s];
        inner.head<3>() += c * control_points_.col(row + s);
        inner[3] += c;
      }
      for (int k = 0; k + l <= order; ++k) A.col(k * stride + l) += Nu[k * (p + 1) + r] * inner;
    }
  }
  RationalSurfaceDerivatives(order, A);
  return SurfaceDerivatives(order, std::move(A));
}

// At a collapsed edge one tangent is the rounding of |point| times the derivatives of the basis, of
// which the mixed derivative, divided by the other tangent, has the size.
std::optional<Eigen::Vector3d> UnitNormal(const SurfaceJet& jet) {
  const Eigen::Vector3d n = jet.du.cross(jet.dv);
  const double length = n.norm();
  const double scale = std::max(jet.du.norm() * jet.dv.norm(), jet.point.norm() * jet.duv.norm());
  if (!(length > 64 * std::numeric_limits<double>::epsilon() * scale) || !(length > 0)) {
    return std::nullopt;
  }
  return Eigen::Vector3d(n / length);
}

std::optional<Eigen::Vector3d> NurbsSurface::NormalAt(double u, double v) const {
  return UnitNormal(JetAt(u, v));
}

NurbsSurface NurbsSurface::Translated(const Eigen::Vector3d& shift) const {
  return NurbsSurface(basis_u_, basis_v_, control_points_.colwise() + shift, weights_);
}

}  // namespace batten
