// SPDX-License-Identifier: MIT
#include "batten/geometry/nurbs_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <limits>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

#include "geometry/numeric/number_text.h"
#include "geometry/nurbs/rational_derivatives.h"

namespace batten {
using namespace internal;

namespace {

// (w·S, w) as plain numbers: Eigen's packets of four would go through memory.
struct HomogeneousSum {
  template <bool kRational>
  void Add(double c, const HomogeneousSum& h) {
    x += c * h.x;
    y += c * h.y;
    z += c * h.z;
    if (kRational) w += c * h.w;
  }
  Eigen::Vector3d lead() const { return {x, y, z}; }

  double x = 0, y = 0, z = 0, w = 0;
};

// The (p+1) × (q+1) control points that act on one cell, less one of them, and the weights.
class ActiveNet {
 public:
  // Parameters that are in the domain already.
  ActiveNet(const NurbsSurface& surface, double u, double v)
      : span_u(surface.basis_u().Span(u)),
        span_v(surface.basis_v().Span(v)),
        p(surface.basis_u().degree()),
        q(surface.basis_v().degree()),
        stride_(surface.size_v()) {
    const Eigen::Index first = Eigen::Index{span_u - p} * stride_ + span_v - q;
    points_ = surface.control_points().data() + 3 * first;
    weights_ = surface.weights().data() + first;
    // The corner nearest to the parameters: a clamped end is met exactly from its own control
    // point.
    const Eigen::Index row = InUpperHalf(surface.basis_u(), span_u, u) ? p : 0;
    const Eigen::Index column = InUpperHalf(surface.basis_v(), span_v, v) ? q : 0;
    origin = Eigen::Map<const Eigen::Vector3d>(points_ + 3 * (row * stride_ + column));
  }

  // Σ_s N_s w_rs (P_rs − origin, 1) of row r, for each of `kOrders` functions N of q+1 values one
  // after another; without weights the last component is not meant.
  template <bool kRational, int kOrders>
  std::array<HomogeneousSum, kOrders> RowSums(int r, const double* N) const {
    const double* P = points_ + 3 * r * stride_;
    const double* weight = weights_ + r * stride_;
    std::array<HomogeneousSum, kOrders> sums;
    for (int s = 0; s <= q; ++s, P += 3) {
      HomogeneousSum h{P[0] - origin[0], P[1] - origin[1], P[2] - origin[2], 1};
      if (kRational) h = {weight[s] * h.x, weight[s] * h.y, weight[s] * h.z, weight[s]};
      for (int k = 0; k < kOrders; ++k) sums[k].template Add<kRational>(N[k * (q + 1) + s], h);
    }
    return sums;
  }

  int span_u, span_v, p, q;
  Eigen::Vector3d origin;

 private:
  static bool InUpperHalf(const SplineBasis& basis, int span, double u) {
    const double* knots = basis.knots().data() + span;
    return u - knots[0] > knots[1] - u;
  }

  Eigen::Index stride_;
  const double* points_;
  const double* weights_;
};

}  // namespace

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
  const Eigen::Matrix3Xd range = control_points_.colwise() - control_points_.col(0);
  if (!(weights_.maxCoeff() * (2 * range.cwiseAbs().maxCoeff()) <=
        std::numeric_limits<double>::max())) {
    throw std::invalid_argument("NurbsSurface: control points times weights are too far apart");
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
  const ActiveNet net(*this, u, v);
  double Nu[kMaxDegree + 1], Nv[kMaxDegree + 1];
  basis_u_.Values(net.span_u, u, Nu);
  basis_v_.Values(net.span_v, v, Nv);
  const auto sum = [&](auto rational) {
    HomogeneousSum total;
    for (int r = 0; r <= net.p; ++r) {
      total.Add<rational>(Nu[r], net.RowSums<rational, 1>(r, Nv)[0]);
    }
    return total;
  };
  if (!rational_) return net.origin + sum(std::false_type()).lead();
  const HomogeneousSum total = sum(std::true_type());
  return net.origin + total.lead() / total.w;
}

// Sums over v first, for the three v-orders at once, then over u. [A3.6 and A4.4 for order 2]
SurfaceJet NurbsSurface::JetAt(double u, double v) const {
  u = basis_u_.Clamp(u);
  v = basis_v_.Clamp(v);
  const ActiveNet net(*this, u, v);
  const int p = net.p;
  double Nu[3 * (kMaxDegree + 1)], Nv[3 * (kMaxDegree + 1)];
  basis_u_.Derivatives(net.span_u, u, 2, Nu);
  basis_v_.Derivatives(net.span_v, v, 2, Nv);
  HomogeneousSum a00, a10, a01, a20, a11, a02;
  const auto sum_rows = [&](auto rational) {
    for (int r = 0; r <= p; ++r) {
      const auto b = net.RowSums<rational, 3>(r, Nv);
      a00.Add<rational>(Nu[r], b[0]);
      a01.Add<rational>(Nu[r], b[1]);
      a02.Add<rational>(Nu[r], b[2]);
      a10.Add<rational>(Nu[p + 1 + r], b[0]);
      a11.Add<rational>(Nu[p + 1 + r], b[1]);
      a20.Add<rational>(Nu[2 * (p + 1) + r], b[0]);
    }
  };
  if (!rational_) {
    sum_rows(std::false_type());
    return {net.origin + a00.lead(), a10.lead(), a01.lead(), a20.lead(), a11.lead(), a02.lead()};
  }
  sum_rows(std::true_type());
  SurfaceJet jet;
  const double w = a00.w;
  const Eigen::Vector3d c = a00.lead() / w;
  jet.point = net.origin + c;
  jet.du = (a10.lead() - a10.w * c) / w;
  jet.dv = (a01.lead() - a01.w * c) / w;
  jet.duu = (a20.lead() - 2 * a10.w * jet.du - a20.w * c) / w;
  jet.dvv = (a02.lead() - 2 * a01.w * jet.dv - a02.w * c) / w;
  jet.duv = (a11.lead() - a10.w * jet.dv - a01.w * jet.du - a11.w * c) / w;
  return jet;
}

SurfaceDerivatives NurbsSurface::Derivatives(double u, double v, int order) const {
  if (order < 0) throw std::invalid_argument("NurbsSurface::Derivatives: order is negative");
  u = basis_u_.Clamp(u);
  v = basis_v_.Clamp(v);
  const ActiveNet net(*this, u, v);
  const int p = net.p, q = net.q, top_u = std::min(order, p), top_v = std::min(order, q);
  double Nu[(kMaxDegree + 1) * (kMaxDegree + 1)], Nv[(kMaxDegree + 1) * (kMaxDegree + 1)];
  basis_u_.Derivatives(net.span_u, u, top_u, Nu);
  basis_v_.Derivatives(net.span_v, v, top_v, Nv);
  const Eigen::Index stride = Eigen::Index{order} + 1;
  Eigen::Matrix4Xd A = Eigen::Matrix4Xd::Zero(4, stride * stride);
  for (int r = 0; r <= p; ++r) {
    for (int l = 0; l <= top_v; ++l) {
      const double* N = Nv + l * (q + 1);
      const HomogeneousSum sum =
          rational_ ? net.RowSums<true, 1>(r, N)[0] : net.RowSums<false, 1>(r, N)[0];
      for (int k = 0; k <= top_u && k + l <= order; ++k) {
        A.col(k * stride + l) += Nu[k * (p + 1) + r] * Eigen::Vector4d(sum.x, sum.y, sum.z, sum.w);
      }
    }
  }
  if (rational_) RationalSurfaceDerivatives(order, A);
  A.col(0).head<3>() += net.origin;
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

NurbsSurface NurbsSurface::Translated(const Eigen::Vector3d& shift) const {
  return NurbsSurface(basis_u_, basis_v_, control_points_.colwise() + shift, weights_)
      .WithTrims(trims_);
}

NurbsSurface NurbsSurface::WithTrims(std::vector<NurbsCurve<2>> loops) const {
  const Eigen::Array2d sides(basis_u_.upper() - basis_u_.lower(),
                             basis_v_.upper() - basis_v_.lower());
  for (const NurbsCurve<2>& loop : loops) {
    const Eigen::Array2d gap =
        (loop.At(loop.basis().upper()) - loop.At(loop.basis().lower())).array().abs();
    if ((gap <= kLoopClosure * sides).all()) continue;
    throw std::invalid_argument("NurbsSurface: trim loop " + std::to_string(&loop - loops.data()) +
                                " does not close: its ends are " + NumberText(gap[0]) + ", " +
                                NumberText(gap[1]) + " apart");
  }
  NurbsSurface trimmed = *this;
  trimmed.trims_ = std::move(loops);
  return trimmed;
}

}  // namespace batten
