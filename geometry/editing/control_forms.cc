// SPDX-License-Identifier: MIT
#include "geometry/editing/control_forms.h"

#include <algorithm>
#include <utility>

namespace batten::internal {
namespace {

// Row k: the k-th derivatives of the functions first … first + p that act at a parameter.
struct ActingFunctions {
  int first;
  Eigen::MatrixXd derivatives;  // (order + 1) × (p + 1)
};

ActingFunctions FunctionsAt(const SplineBasis& basis, double u, int order) {
  const int p = basis.degree(), span = basis.Span(u);
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> values(order + 1, p + 1);
  basis.Derivatives(span, u, order, values.data());
  return {span - p, values};
}

double Binomial(int n, int k) {
  double value = 1;
  for (int i = 1; i <= k; ++i) value = value * (n - k + i) / i;
  return value;
}

// The derivatives of the highest orders of R_rs = w_rs N_r N_s / Σ w N N, whose rows in u and v are
// given, by Leibniz' rule for the product of R and the sum. [eqs. 4.8, 4.20]
Eigen::MatrixXd RationalFunctions(const Eigen::MatrixXd& u,
                                  const Eigen::MatrixXd& v,
                                  const Eigen::MatrixXd& weights) {
  const auto K = static_cast<int>(u.rows()), L = static_cast<int>(v.rows());
  std::vector<Eigen::MatrixXd> R(static_cast<size_t>(K * L));
  Eigen::MatrixXd sums(K, L);
  for (int k = 0; k < K; ++k) {
    for (int l = 0; l < L; ++l) {
      Eigen::MatrixXd& result = R[static_cast<size_t>(k * L + l)];
      result = weights.cwiseProduct(u.row(k).transpose() * v.row(l));
      sums(k, l) = result.sum();
      for (int i = 0; i <= k; ++i) {
        for (int j = i == 0 ? 1 : 0; j <= l; ++j) {
          result -= Binomial(k, i) * Binomial(l, j) * sums(i, j) *
                    R[static_cast<size_t>((k - i) * L + l - j)];
        }
      }
      result /= sums(0, 0);
    }
  }
  return R.back();
}

}  // namespace

void AddTerm(ControlForm& form, Eigen::Index control_point, double value) {
  const auto found = std::find(form.index.begin(), form.index.end(), control_point);
  if (found != form.index.end()) {
    form.values[found - form.index.begin()] += value;
    return;
  }
  form.values[std::ssize(form.index)] = value;
  form.index.push_back(control_point);
}

double ControlForm::At(Eigen::Index control_point) const {
  const auto found = std::find(index.begin(), index.end(), control_point);
  return found == index.end() ? 0 : values[found - index.begin()];
}

template <int Dim>
ControlForm DerivativeForm(const NurbsCurve<Dim>& curve, double u, int order) {
  const auto [first, N] = FunctionsAt(curve.basis(), u, order);
  Eigen::VectorXd R = N.row(order).transpose();
  if (curve.rational()) {
    R = RationalFunctions(N, Eigen::MatrixXd::Ones(1, 1), curve.weights().segment(first, N.cols()));
  }
  ControlForm form{{}, Eigen::VectorXd(N.cols())};
  for (Eigen::Index r = 0; r < R.size(); ++r)
    AddTerm(form, (first + r) % DistinctPoints(curve), R[r]);
  form.values.conservativeResize(std::ssize(form.index));
  return form;
}

ControlForm DerivativeForm(
    const NurbsSurface& surface, double u, double v, int order_u, int order_v) {
  const auto [first_u, Nu] = FunctionsAt(surface.basis_u(), u, order_u);
  const auto [first_v, Nv] = FunctionsAt(surface.basis_v(), v, order_v);
  Eigen::MatrixXd weights(Nu.cols(), Nv.cols());
  for (Eigen::Index r = 0; r < weights.rows(); ++r) {
    weights.row(r) =
        surface.weights().segment((first_u + r) * surface.size_v() + first_v, Nv.cols());
  }
  Eigen::MatrixXd R = Nu.row(order_u).transpose() * Nv.row(order_v);
  if (surface.rational()) R = RationalFunctions(Nu, Nv, weights);
  const int round_u = DistinctPoints(surface.basis_u()),
            round_v = DistinctPoints(surface.basis_v());
  ControlForm form{{}, Eigen::VectorXd(R.size())};
  for (Eigen::Index r = 0; r < R.rows(); ++r) {
    for (Eigen::Index s = 0; s < R.cols(); ++s) {
      AddTerm(form, (first_u + r) % round_u * round_v + (first_v + s) % round_v, R(r, s));
    }
  }
  form.values.conservativeResize(std::ssize(form.index));
  return form;
}

template <int Dim>
NurbsCurve<Dim> WithMoves(const NurbsCurve<Dim>& curve, const Eigen::MatrixXd& moves) {
  typename NurbsCurve<Dim>::Points points = curve.control_points();
  for (Eigen::Index i = 0; i < points.cols(); ++i) points.col(i) += moves.col(i % moves.cols());
  return NurbsCurve<Dim>(curve.basis(), std::move(points), curve.weights());
}

NurbsSurface WithMoves(const NurbsSurface& surface, const Eigen::MatrixXd& moves) {
  const int round_u = DistinctPoints(surface.basis_u()),
            round_v = DistinctPoints(surface.basis_v());
  Eigen::Matrix3Xd points = surface.control_points();
  for (Eigen::Index i = 0; i < surface.size_u(); ++i) {
    for (Eigen::Index j = 0; j < surface.size_v(); ++j) {
      points.col(i * surface.size_v() + j) += moves.col(i % round_u * round_v + j % round_v);
    }
  }
  return NurbsSurface(surface.basis_u(), surface.basis_v(), std::move(points), surface.weights())
      .WithTrims(surface.trims());
}

template ControlForm DerivativeForm(const NurbsCurve<2>&, double, int);
template ControlForm DerivativeForm(const NurbsCurve<3>&, double, int);
template NurbsCurve<2> WithMoves(const NurbsCurve<2>&, const Eigen::MatrixXd&);
template NurbsCurve<3> WithMoves(const NurbsCurve<3>&, const Eigen::MatrixXd&);

}  // namespace batten::internal
