// SPDX-License-Identifier: MIT
#include "batten/geometry/modify_shape.h"

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "geometry/nurbs/checked_parameter.h"
#include "geometry/numeric/number_text.h"

namespace batten {
using namespace internal;
namespace {

// How many control points are free: over a periodic basis number i stands for i + k·FreeCount too.
int FreeCount(const SplineBasis& basis) {
  return basis.periodic() ? basis.size() - basis.degree() : basis.size();
}

void CheckWeight(double weight) {
  if (std::isfinite(weight) && weight > 0) return;
  throw std::invalid_argument("WithWeight: weight = " + NumberText(weight) +
                              " is not positive and finite");
}

void CheckIndex(const char* name, int index, int count) {
  if (index >= 0 && index < count) return;
  throw std::invalid_argument("WithWeight: " + std::string(name) + " = " + std::to_string(index) +
                              " is not in [0, " + std::to_string(count - 1) + "]");
}

// The functions that act at t, added up over the copies of a control point: result[i] for i <
// FreeCount.
Eigen::VectorXd FreeFunctions(const SplineBasis& basis, double t) {
  const int p = basis.degree(), span = basis.Span(t);
  Eigen::VectorXd N(p + 1), result = Eigen::VectorXd::Zero(FreeCount(basis));
  basis.Values(span, t, N.data());
  for (int r = 0; r <= p; ++r) result[(span - p + r) % result.size()] += N[r];
  return result;
}

}  // namespace

template <int Dim>
NurbsCurve<Dim> WithWeight(const NurbsCurve<Dim>& curve, int i, double weight) {
  const SplineBasis& basis = curve.basis();
  CheckIndex("index i", i, basis.size());
  CheckWeight(weight);
  Eigen::VectorXd weights = curve.weights();
  const int round = FreeCount(basis);
  for (int k = i % round; k < basis.size(); k += round) weights[k] = weight;
  return NurbsCurve<Dim>(basis, curve.control_points(), std::move(weights));
}

NurbsSurface WithWeight(const NurbsSurface& surface, int i, int j, double weight) {
  CheckIndex("index i", i, surface.size_u());
  CheckIndex("index j", j, surface.size_v());
  CheckWeight(weight);
  Eigen::VectorXd weights = surface.weights();
  const int round_u = FreeCount(surface.basis_u()), round_v = FreeCount(surface.basis_v());
  for (int k = i % round_u; k < surface.size_u(); k += round_u) {
    for (int l = j % round_v; l < surface.size_v(); l += round_v) {
      weights[Eigen::Index{k} * surface.size_v() + l] = weight;
    }
  }
  return NurbsSurface(
             surface.basis_u(), surface.basis_v(), surface.control_points(), std::move(weights))
      .WithTrims(surface.trims());
}

template <int Dim>
NurbsCurve<Dim> MovedPoint(const NurbsCurve<Dim>& curve,
                           double u,
                           const typename NurbsCurve<Dim>::Point& to) {
  const SplineBasis& basis = curve.basis();
  u = CheckedParameter(basis, u, "MovedPoint", "u");
  if (!to.allFinite()) throw std::invalid_argument("MovedPoint: the point is not finite");
  Eigen::VectorXd R = FreeFunctions(basis, u);
  R.array() *= curve.weights().head(R.size()).array();
  R /= R.sum();
  const typename NurbsCurve<Dim>::Point step = (to - curve.At(u)) / R.squaredNorm();
  typename NurbsCurve<Dim>::Points points = curve.control_points();
  for (int i = 0; i < basis.size(); ++i) points.col(i) += R[i % R.size()] * step;
  return NurbsCurve<Dim>(basis, std::move(points), curve.weights());
}

NurbsSurface MovedPoint(const NurbsSurface& surface,
                        double u,
                        double v,
                        const Eigen::Vector3d& to) {
  u = CheckedParameter(surface.basis_u(), u, "MovedPoint", "u");
  v = CheckedParameter(surface.basis_v(), v, "MovedPoint", "v");
  if (!to.allFinite()) throw std::invalid_argument("MovedPoint: the point is not finite");
  const Eigen::VectorXd Nu = FreeFunctions(surface.basis_u(), u);
  const Eigen::VectorXd Nv = FreeFunctions(surface.basis_v(), v);
  Eigen::MatrixXd R = Nu * Nv.transpose();
  for (Eigen::Index i = 0; i < R.rows(); ++i) {
    for (Eigen::Index j = 0; j < R.cols(); ++j)
      R(i, j) *= surface.weights()[i * surface.size_v() + j];
  }
  R /= R.sum();
  const Eigen::Vector3d step = (to - surface.At(u, v)) / R.squaredNorm();
  Eigen::Matrix3Xd points = surface.control_points();
  for (Eigen::Index i = 0; i < surface.size_u(); ++i) {
    for (Eigen::Index j = 0; j < surface.size_v(); ++j) {
      points.col(i * surface.size_v() + j) += R(i % R.rows(), j % R.cols()) * step;
    }
  }
  return NurbsSurface(surface.basis_u(), surface.basis_v(), std::move(points), surface.weights())
      .WithTrims(surface.trims());
}

template NurbsCurve<2> WithWeight(const NurbsCurve<2>&, int, double);
template NurbsCurve<3> WithWeight(const NurbsCurve<3>&, int, double);
template NurbsCurve<2> MovedPoint(const NurbsCurve<2>&, double, const Eigen::Vector2d&);
template NurbsCurve<3> MovedPoint(const NurbsCurve<3>&, double, const Eigen::Vector3d&);

}  // namespace batten
