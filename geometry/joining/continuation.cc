// SPDX-License-Identifier: MIT
#include "batten/geometry/continuation.h"

#include <cmath>
#include <utility>

#include "batten/geometry/closure.h"
#include "geometry/joining/end_jet.h"
#include "geometry/numeric/box_diagonal.h"
#include "geometry/numeric/construction_checks.h"
#include "geometry/nurbs/homogeneous.h"

namespace batten {
using namespace internal;
namespace {

constexpr const char* kContinuation = "Continued";
constexpr const char* kRemedy = "take another eta, eta2 or a smaller beta";

void CheckFreedom(int order, const JoinFreedom& f) {
  RequireThat(order == 1 || order == 2,
              kContinuation,
              "order = " + std::to_string(order) + " is not 1 or 2");
  RequirePositive(kContinuation, "alpha", f.alpha);
  RequirePositive(kContinuation, "beta", f.beta);
  for (const auto& [name, value] :
       {std::pair{"eta", f.eta}, {"beta2", f.beta2}, {"eta2", f.eta2}}) {
    RequireThat(std::isfinite(value), kContinuation, std::string(name) + " is not finite");
  }
}

SplineBasis OneSpan(int degree) {
  const double ends[] = {0, 1};
  return SplineBasis::Clamped(degree, ends);
}

// Homogeneous Bézier points of degree order + 1, all but the last.
std::vector<Eigen::MatrixXd> FirstPoints(const EndJet& jet, int order, const JoinFreedom& freedom) {
  const EndJet r = Reparameterized(jet, freedom);
  const double n = order + 1;
  std::vector<Eigen::MatrixXd> points{r[0], r[0] + r[1] / n};
  if (order == 2) points.push_back(r[0] + 2 * r[1] / n + r[2] / (n * (n - 1)));
  return points;
}

bool AllEqual(const Eigen::VectorXd& weights) { return (weights.array() == weights[0]).all(); }

}  // namespace

template <int Dim>
NurbsCurve<Dim> Continued(const NurbsCurve<Dim>& curve,
                          bool upper,
                          int order,
                          const Eigen::Matrix<double, Dim, 1>& to,
                          const JoinFreedom& freedom,
                          double to_weight) {
  CheckFreedom(order, freedom);
  RequirePositive(kContinuation, "to_weight", to_weight);
  RequireThat(to.allFinite(), kContinuation, "to is not finite");
  RequireThat(!curve.basis().periodic(), kContinuation, "a periodic curve has no end");
  const auto first = FirstPoints(EndJetOf(curve, upper), order, freedom);
  Eigen::MatrixXd columns(Dim + 1, order + 2);
  for (size_t k = 0; k < first.size(); ++k) columns.col(k) = first[k].col(0);
  columns.rightCols<1>() << to_weight * to, to_weight;
  const Eigen::MatrixXd places = Places(columns, kContinuation, kRemedy);
  RequireThat(
      (places.col(1) - places.col(0)).norm() > 0, kContinuation, "the curve rests at its end");
  Eigen::VectorXd weights = columns.row(Dim).transpose();
  if (AllEqual(weights)) weights.resize(0);
  return NurbsCurve<Dim>(OneSpan(order + 1), places, std::move(weights));
}

NurbsSurface Continued(const NurbsSurface& surface,
                       const SurfaceEdge& edge,
                       int order,
                       const Eigen::Vector3d& shift,
                       const JoinFreedom& freedom) {
  CheckFreedom(order, freedom);
  RefuseTrims(surface.trimmed(), kContinuation, "its edge may not count");
  RequireThat(shift.allFinite() && shift.norm() > 0, kContinuation, "shift is not a finite vector");
  RequireThat(!BasisOf(surface, edge.direction).periodic(),
              kContinuation,
              "a periodic direction has no edge");
  const EndJet jet = EndJetOf(surface, edge);
  auto rows = FirstPoints(jet, order, freedom);
  Eigen::MatrixXd last = freedom.alpha * jet[0];
  last.topRows<3>() += shift * last.row(3);
  rows.push_back(std::move(last));
  const Eigen::Index along = jet[0].cols();
  Eigen::MatrixXd columns(4, along * std::ssize(rows));
  for (Eigen::Index k = 0; k < std::ssize(rows); ++k)
    columns.middleCols(k * along, along) = rows[k];
  const Eigen::MatrixXd places = Places(columns, kContinuation, kRemedy);
  const double size = BoxDiagonal(places.leftCols(along));
  RequireThat(size > kCloses * BoxDiagonal(surface.control_points()),
              kContinuation,
              "the edge is a single point: there is no strip beyond it");
  Eigen::VectorXd weights = columns.row(3).transpose();
  if (AllEqual(weights)) weights.resize(0);
  const SplineBasis& other =
      edge.direction == Direction::kU ? surface.basis_v() : surface.basis_u();
  return NurbsSurface(OneSpan(order + 1), other, places, std::move(weights));
}

template NurbsCurve<2> Continued(
    const NurbsCurve<2>&, bool, int, const Eigen::Vector2d&, const JoinFreedom&, double);
template NurbsCurve<3> Continued(
    const NurbsCurve<3>&, bool, int, const Eigen::Vector3d&, const JoinFreedom&, double);

}  // namespace batten
