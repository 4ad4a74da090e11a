// SPDX-License-Identifier: MIT
#include "batten/geometry/meet_targets.h"

#include <algorithm>
#include <string>
#include <vector>

#include "geometry/editing/control_forms.h"
#include "geometry/editing/tied_points.h"
#include "geometry/numeric/dense_solvers.h"
#include "geometry/numeric/number_text.h"
#include "geometry/numeric/reject.h"
#include "geometry/nurbs/checked_parameter.h"

namespace batten {
using namespace internal;
namespace {

constexpr size_t kMostTargets = 500;
constexpr double kMet = 1e-9;  // of the greatest change: what is missed by more can't be met

[[noreturn]] void RefuseTarget(const std::string& rule) { Reject("WithTargets", rule); }

// A target as an equation for the moves of control points.
struct Condition {
  ControlForm form;
  Eigen::VectorXd change;  // what the form of the moves is to be
  std::string name;        // "the point at u = 0.5"
};

std::string NameOf(const std::string& order, const std::string& at) {
  return (order.empty() ? "the point" : "the derivative of order " + order) + " at " + at;
}

void CheckOrder(int order) {
  if (order >= 0 && order <= kMaxDegree) return;
  RefuseTarget("the order " + std::to_string(order) + " is not between 0 and " +
               std::to_string(kMaxDegree));
}

void CheckIndex(const char* name, int index, int count) {
  if (index >= 0 && index < count) return;
  RefuseTarget("the fixed " + std::string(name) + " = " + std::to_string(index) +
               " is not in [0, " + std::to_string(count - 1) + "]");
}

// Where the free control points that act somewhere stand in the equations; −1: nowhere.
std::vector<Eigen::Index> Columns(const std::vector<Condition>& conditions,
                                  const std::vector<bool>& fixed,
                                  Eigen::Index& count) {
  std::vector<Eigen::Index> columns(fixed.size(), -1);
  count = 0;
  for (const Condition& condition : conditions) {
    for (const Eigen::Index k : condition.form.index) {
      const auto at = static_cast<size_t>(k);
      if (!fixed[at] && columns[at] < 0) columns[at] = count++;
    }
  }
  return columns;
}

// The moves (d × distinct control points) of least squares that meet the conditions.
Eigen::MatrixXd LeastMoves(const std::vector<Condition>& conditions,
                           const std::vector<bool>& fixed,
                           Eigen::Index dimension) {
  Eigen::Index free = 0;
  const std::vector<Eigen::Index> columns = Columns(conditions, fixed, free);
  const auto rows = static_cast<Eigen::Index>(conditions.size());
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(rows, free), change(rows, dimension);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const Condition& condition = conditions[static_cast<size_t>(i)];
    for (size_t k = 0; k < condition.form.index.size(); ++k) {
      const Eigen::Index column = columns[static_cast<size_t>(condition.form.index[k])];
      if (column >= 0) matrix(i, column) = condition.form.values[static_cast<Eigen::Index>(k)];
    }
    const double scale = condition.form.values.stableNorm();
    if (!(scale > 0)) RefuseTarget(condition.name + " is zero whatever the control points are");
    matrix.row(i) /= scale;
    change.row(i) = condition.change.transpose() / scale;
  }
  Eigen::MatrixXd moves = Eigen::MatrixXd::Zero(free, dimension), missing = change;
  if (free > 0) {
    constexpr double kDependent = 1e-12;       // rows have length one
    for (int round = 0; round < 2; ++round) {  // the second restores lost digits
      moves += LeastNormSolution(matrix, missing, kDependent);
      missing = change - matrix * moves;
    }
  }
  Eigen::Index worst = 0;
  const double gap = missing.rowwise().norm().maxCoeff(&worst);
  if (!(gap <= kMet * change.rowwise().norm().maxCoeff())) {
    const Condition& condition = conditions[static_cast<size_t>(worst)];
    RefuseTarget(
        condition.name +
        " can't be met with the others: " + RoundedText(gap * condition.form.values.stableNorm()) +
        " are missing at best; take back what contradicts it, fix fewer control points, or insert "
        "knots there");
  }
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(dimension, columns.size());
  for (size_t k = 0; k < columns.size(); ++k) {
    if (columns[k] >= 0) result.col(static_cast<Eigen::Index>(k)) = moves.row(columns[k]);
  }
  return result;
}

template <typename Target>
void CheckTargets(std::span<const Target> targets) {
  if (targets.size() > kMostTargets) {
    RefuseTarget(std::to_string(targets.size()) + " targets are more than " +
                 std::to_string(kMostTargets));
  }
  for (const Target& target : targets) {
    if (!target.value.allFinite()) RefuseTarget("a value is not finite");
  }
}

}  // namespace

template <int Dim>
NurbsCurve<Dim> WithTargets(const NurbsCurve<Dim>& curve,
                            std::span<const CurveTarget<Dim>> targets,
                            std::span<const int> fixed) {
  CheckTargets(targets);
  if (targets.empty()) return curve;
  const TiedPoints ties(curve);
  std::vector<Condition> conditions;
  for (const CurveTarget<Dim>& target : targets) {
    CheckOrder(target.order);
    const double u = CheckedParameter(curve.basis(), target.u, "WithTargets", "u");
    conditions.push_back({ties.Together(DerivativeForm(curve, u, target.order)),
                          target.value - curve.Derivatives(u, target.order).col(target.order),
                          NameOf(target.order == 0 ? "" : std::to_string(target.order),
                                 "u = " + NumberText(target.u))});
  }
  const int count = DistinctPoints(curve.basis());
  std::vector<bool> held(static_cast<size_t>(count), false);
  for (const int i : fixed) {
    CheckIndex("index i", i, curve.basis().size());
    held[static_cast<size_t>(ties.First(i % count))] = true;
  }
  return WithMoves(curve, ties.Spread(LeastMoves(conditions, held, Dim)));
}

NurbsSurface WithTargets(const NurbsSurface& surface,
                         std::span<const SurfaceTarget> targets,
                         std::span<const NetPlace> fixed) {
  CheckTargets(targets);
  if (targets.empty()) return surface;
  const TiedPoints ties(surface);
  std::vector<Condition> conditions;
  for (const SurfaceTarget& target : targets) {
    const int k = target.order_u, l = target.order_v;
    CheckOrder(k);
    CheckOrder(l);
    const double u = CheckedParameter(surface.basis_u(), target.u, "WithTargets", "u");
    const double v = CheckedParameter(surface.basis_v(), target.v, "WithTargets", "v");
    conditions.push_back(
        {ties.Together(DerivativeForm(surface, u, v, k, l)),
         target.value - surface.Derivatives(u, v, k + l)(k, l),
         NameOf(k + l == 0 ? "" : std::to_string(k) + "," + std::to_string(l),
                "(u, v) = (" + NumberText(target.u) + ", " + NumberText(target.v) + ")")});
  }
  const int round_u = DistinctPoints(surface.basis_u()),
            round_v = DistinctPoints(surface.basis_v());
  std::vector<bool> held(static_cast<size_t>(DistinctPoints(surface)), false);
  for (const auto& [i, j] : fixed) {
    CheckIndex("index i", i, surface.size_u());
    CheckIndex("index j", j, surface.size_v());
    held[static_cast<size_t>(ties.First(i % round_u * round_v + j % round_v))] = true;
  }
  return WithMoves(surface, ties.Spread(LeastMoves(conditions, held, 3)));
}

template NurbsCurve<2> WithTargets(const NurbsCurve<2>&,
                                   std::span<const CurveTarget<2>>,
                                   std::span<const int>);
template NurbsCurve<3> WithTargets(const NurbsCurve<3>&,
                                   std::span<const CurveTarget<3>>,
                                   std::span<const int>);

}  // namespace batten
