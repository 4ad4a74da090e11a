// SPDX-License-Identifier: MIT
#include "batten/geometry/modify_shape.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "geometry/editing/control_forms.h"
#include "geometry/editing/tied_points.h"
#include "geometry/numeric/number_text.h"
#include "geometry/nurbs/checked_parameter.h"

namespace batten {
using namespace internal;
namespace {

void CheckWeight(double weight) {
  if (std::isfinite(weight) && weight > 0) return;
  throw std::invalid_argument("WithWeight: weight = " + NumberText(weight) +
                              " is not positive and finite");
}

// The weight that stands to `weight` as `this_one` to `old`.
double InRatio(double this_one, double old, double weight) {
  return this_one == old ? weight : this_one / old * weight;
}

void CheckIndex(const std::string& function, const char* name, int index, int count) {
  if (index >= 0 && index < count) return;
  throw std::invalid_argument(function + ": " + name + " = " + std::to_string(index) +
                              " is not in [0, " + std::to_string(count - 1) + "]");
}

[[noreturn]] void RefusePull(const std::string& rule) {
  throw std::invalid_argument("Pulled: " + rule);
}

// The factor of the weights of the control points (d × as many) with these shares of the point,
// beside the share `rest` of the others, that moves it by `by` along its line. With R the point at
// weights of zero, Q that at infinite ones and ρ the sum of the shares, P = R + ρ(Q − R), and ρ/(1
// − ρ) is in proportion to the factor.
double PullFactor(const Eigen::MatrixXd& points,
                  const Eigen::VectorXd& shares,
                  double rest,
                  const Eigen::VectorXd& at,
                  double by) {
  constexpr double kRounding = 1e-14;
  const double share = shares.sum();
  if (!(share > kRounding)) RefusePull("the control point does not act at the parameter");
  if (!(rest > kRounding))
    RefusePull("nothing else acts at the parameter: weights don't move the point there");
  const Eigen::VectorXd towards = points * (shares / share);
  const double reach = (towards - at).stableNorm(), line = reach / rest;
  if (!(reach > kRounding * points.cwiseAbs().maxCoeff()))
    RefusePull("the point lies where the pull leads to: there is no direction to move it in");
  if (!(by < reach)) {
    RefusePull("by = " + NumberText(by) + " is not less than " + RoundedText(reach) +
               ", how far the point is from where the pull leads to: the weight would be infinite");
  }
  const double target = share + by / line;  // of Q, and what is left of R
  if (!(target > 0)) {
    RefusePull("by = " + NumberText(by) + " is not above " + RoundedText(-share * line) +
               ", where the weight becomes zero");
  }
  return target / (rest - by / line) * rest / share;
}

// The share of all other control points.
double RestOf(const ControlForm& form, const std::vector<Eigen::Index>& own) {
  double rest = 0;
  for (size_t k = 0; k < form.index.size(); ++k) {
    if (std::find(own.begin(), own.end(), form.index[k]) == own.end())
      rest += form.values[static_cast<Eigen::Index>(k)];
  }
  return rest;
}

// R_i / Σ R_j² · step for every control point i that acts.
template <int Dim>
Eigen::MatrixXd LeastMoves(const ControlForm& form,
                           Eigen::Index count,
                           const Eigen::Matrix<double, Dim, 1>& step) {
  Eigen::MatrixXd moves = Eigen::MatrixXd::Zero(Dim, count);
  const Eigen::Matrix<double, Dim, 1> unit = step / form.values.squaredNorm();
  for (size_t k = 0; k < form.index.size(); ++k)
    moves.col(form.index[k]) = form.values[static_cast<Eigen::Index>(k)] * unit;
  return moves;
}

}  // namespace

template <int Dim>
NurbsCurve<Dim> WithWeight(const NurbsCurve<Dim>& curve, int i, double weight) {
  const SplineBasis& basis = curve.basis();
  CheckIndex("WithWeight", "index i", i, basis.size());
  CheckWeight(weight);
  const TiedPoints ties(curve);
  const int round = DistinctPoints(basis);
  const Eigen::Index own = ties.First(i % round);
  Eigen::VectorXd weights = curve.weights();
  for (int k = 0; k < basis.size(); ++k) {
    if (ties.First(k % round) == own) weights[k] = InRatio(weights[k], curve.weights()[i], weight);
  }
  return NurbsCurve<Dim>(basis, curve.control_points(), std::move(weights));
}

NurbsSurface WithWeight(const NurbsSurface& surface, int i, int j, double weight) {
  CheckIndex("WithWeight", "index i", i, surface.size_u());
  CheckIndex("WithWeight", "index j", j, surface.size_v());
  CheckWeight(weight);
  const TiedPoints ties(surface, TiedPoints::Of::kSeams);
  const Eigen::Index round_u = DistinctPoints(surface.basis_u()),
                     round_v = DistinctPoints(surface.basis_v()), columns = surface.size_v();
  const Eigen::Index own = ties.First(i % round_u * round_v + j % round_v);
  Eigen::VectorXd weights = surface.weights();
  const double old = weights[i * columns + j];
  for (Eigen::Index k = 0; k < weights.size(); ++k) {
    const Eigen::Index number = k / columns % round_u * round_v + k % columns % round_v;
    if (ties.First(number) == own) weights[k] = InRatio(weights[k], old, weight);
  }
  return NurbsSurface(
             surface.basis_u(), surface.basis_v(), surface.control_points(), std::move(weights))
      .WithTrims(surface.trims());
}

template <int Dim>
NurbsCurve<Dim> Pulled(const NurbsCurve<Dim>& curve,
                       double u,
                       std::span<const int> control_points,
                       double by) {
  const size_t count = control_points.size();
  if (count < 1 || count > 2 || (count == 2 && control_points[1] != control_points[0] + 1))
    RefusePull("one control point, or two neighbours i and i + 1, are needed");
  for (const int i : control_points) CheckIndex("Pulled", "index i", i, curve.basis().size());
  u = CheckedParameter(curve.basis(), u, "Pulled", "u");
  const TiedPoints ties(curve);
  const ControlForm form = ties.Together(DerivativeForm(curve, u));
  typename NurbsCurve<Dim>::Points points(Dim, count);
  Eigen::VectorXd shares(count);
  std::vector<Eigen::Index> own;
  for (size_t k = 0; k < count; ++k) {
    own.push_back(ties.First(control_points[k] % DistinctPoints(curve)));
    const auto at = static_cast<Eigen::Index>(k);
    points.col(at) = curve.control_points().col(control_points[k]);
    shares[at] = form.At(own.back());
  }
  const double factor = PullFactor(points, shares, RestOf(form, own), curve.At(u), by);
  NurbsCurve<Dim> pulled = curve;
  for (const int i : control_points) pulled = WithWeight(pulled, i, factor * curve.weights()[i]);
  return pulled;
}

NurbsSurface Pulled(const NurbsSurface& surface, double u, double v, int i, int j, double by) {
  CheckIndex("Pulled", "index i", i, surface.size_u());
  CheckIndex("Pulled", "index j", j, surface.size_v());
  u = CheckedParameter(surface.basis_u(), u, "Pulled", "u");
  v = CheckedParameter(surface.basis_v(), v, "Pulled", "v");
  const int round_u = DistinctPoints(surface.basis_u()),
            round_v = DistinctPoints(surface.basis_v());
  const TiedPoints ties(surface, TiedPoints::Of::kSeams);
  const ControlForm form = ties.Together(DerivativeForm(surface, u, v));
  const Eigen::Index own = ties.First(i % round_u * round_v + j % round_v);
  const double factor = PullFactor(surface.control_point(i, j),
                                   Eigen::VectorXd::Constant(1, form.At(own)),
                                   RestOf(form, {own}),
                                   surface.At(u, v),
                                   by);
  return WithWeight(surface, i, j, factor * surface.weights()[i * surface.size_v() + j]);
}

template <int Dim>
NurbsCurve<Dim> MovedPoint(const NurbsCurve<Dim>& curve,
                           double u,
                           const typename NurbsCurve<Dim>::Point& to) {
  u = CheckedParameter(curve.basis(), u, "MovedPoint", "u");
  if (!to.allFinite()) throw std::invalid_argument("MovedPoint: the point is not finite");
  const TiedPoints ties(curve);
  return WithMoves(
      curve,
      ties.Spread(LeastMoves<Dim>(
          ties.Together(DerivativeForm(curve, u)), DistinctPoints(curve), to - curve.At(u))));
}

NurbsSurface MovedPoint(const NurbsSurface& surface,
                        double u,
                        double v,
                        const Eigen::Vector3d& to) {
  u = CheckedParameter(surface.basis_u(), u, "MovedPoint", "u");
  v = CheckedParameter(surface.basis_v(), v, "MovedPoint", "v");
  if (!to.allFinite()) throw std::invalid_argument("MovedPoint: the point is not finite");
  const TiedPoints ties(surface);
  return WithMoves(surface,
                   ties.Spread(LeastMoves<3>(ties.Together(DerivativeForm(surface, u, v)),
                                             DistinctPoints(surface),
                                             to - surface.At(u, v))));
}

template NurbsCurve<2> Pulled(const NurbsCurve<2>&, double, std::span<const int>, double);
template NurbsCurve<3> Pulled(const NurbsCurve<3>&, double, std::span<const int>, double);
template NurbsCurve<2> WithWeight(const NurbsCurve<2>&, int, double);
template NurbsCurve<3> WithWeight(const NurbsCurve<3>&, int, double);
template NurbsCurve<2> MovedPoint(const NurbsCurve<2>&, double, const Eigen::Vector2d&);
template NurbsCurve<3> MovedPoint(const NurbsCurve<3>&, double, const Eigen::Vector3d&);

}  // namespace batten
