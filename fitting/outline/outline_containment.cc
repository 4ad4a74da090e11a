// SPDX-License-Identifier: MIT
#include "fitting/outline/outline_containment.h"

#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "fitting/outline/outline_polygon.h"

namespace batten::internal {
namespace {

constexpr double kMargin = 0.01;  // beyond a point, inside the rectangle; above a polygon's sagitta
constexpr double kContainmentLookedAt = 0.5;  // points that near inside may come to lie outside
constexpr double kBin = 0.5;                  // length of border that gets one condition
constexpr double kNearCorner = 1;
constexpr int kRounds = 8;
constexpr int kSweeps = 300;
constexpr double kOwnLength = 1;
constexpr double kMostContainmentMoved =
    4;                          // of a control point; else conditions contradict each other
constexpr double kSoft = 1e-5;  // softness of conditions
constexpr double kMet = 1e-3;

// A spline's place at t must go along n by at least `least`.
struct Condition {
  double t;
  Eigen::Vector2d n;
  double least;
};

// A cubic's values at a parameter and the columns of its control points.
struct SparseRow {
  std::array<int, 4> column;
  std::array<double, 4> value;

  Eigen::Vector2d operator*(const Eigen::Matrix2Xd& points) const {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (int r = 0; r < 4; ++r) sum += value[r] * points.col(column[r]);
    return sum;
  }
};

// The least move, in the mean square along the border, that meets conditions: dual ascent, one
// condition after the other [Hildreth 1957]. The inverse of the splines' Gram matrix decays by more
// than a half per control point, so that a condition moves only those in a window about it.
class LeastMove {
 public:
  explicit LeastMove(const OutlineSpline& spline) : spline_(spline), mass_(Mass(spline)) {}

  // 2 × n moves that meet the conditions, or nearly where they would ask for much.
  Eigen::Matrix2Xd Move(const std::vector<Condition>& conditions) const {
    std::vector<Active> actives;
    for (const Condition& condition : conditions) actives.push_back(ActiveOf(condition));
    for (double soft = kSoft;; soft *= 10) {
      Eigen::Matrix2Xd move = Move(conditions, actives, soft);
      if (!(move.colwise().norm().maxCoeff() > kMostContainmentMoved) || soft > 1e3) return move;
    }
  }

 private:
  static constexpr int kWindow = 24;  // control points on either side: 0.43^24 is 2e-9

  struct Active {
    SparseRow row;
    std::vector<int> columns;
    Eigen::Matrix2Xd step;  // what a multiplier of one moves, of these columns
    double size = 0;
  };

  static SparseRow RowAt(const OutlineSpline& spline, double t) {
    SparseRow row;
    const int span = spline.basis.Span(t);
    spline.basis.Values(span, t, row.value.data());
    for (int r = 0; r < 4; ++r) row.column[r] = spline.unknown[span - 3 + r];
    return row;
  }

  static Eigen::SparseMatrix<double> Mass(const OutlineSpline& spline) {
    const auto n = static_cast<int>(spline.points.cols());
    std::vector<Eigen::Triplet<double>> entries;
    const auto& knots = spline.basis.knots();
    constexpr int kSamples = 6;
    for (const int span : spline.basis.Spans()) {
      const double length = knots[span + 1] - knots[span];
      for (int k = 0; k < kSamples; ++k) {
        const SparseRow row = RowAt(spline, knots[span] + length * (k + 0.5) / kSamples);
        for (int r = 0; r < 4; ++r)
          for (int s = 0; s < 4; ++s)
            entries.emplace_back(
                row.column[r], row.column[s], length / kSamples * row.value[r] * row.value[s]);
      }
    }
    for (int i = 0; i < n; ++i)
      entries.emplace_back(i, i, kOwnLength);  // short pieces do not slide
    Eigen::SparseMatrix<double> mass(n, n);
    mass.setFromTriplets(entries.begin(), entries.end());
    return mass;
  }

  Active ActiveOf(const Condition& condition) const {
    Active active;
    active.row = RowAt(spline_, condition.t);
    const auto n = static_cast<int>(spline_.points.cols());
    const int size = std::min(n, 2 * kWindow + 4);
    const int first = size == n ? 0 : active.row.column[0] - kWindow + n;
    for (int k = 0; k < size; ++k) active.columns.push_back((first + k) % n);
    const auto place = [&](Eigen::Index column) {
      return ((static_cast<int>(column) - first) % n + n) % n;
    };
    Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(size, size);
    for (int k = 0; k < size; ++k)
      for (Eigen::SparseMatrix<double>::InnerIterator it(mass_, active.columns[k]); it; ++it)
        if (place(it.row()) < size) mass(place(it.row()), k) = it.value();
    Eigen::VectorXd values = Eigen::VectorXd::Zero(size);
    for (int r = 0; r < 4; ++r) values[place(active.row.column[r])] += active.row.value[r];
    active.step.resize(2, size);
    for (int axis = 0; axis < 2; ++axis) {
      Eigen::MatrixXd held = mass;
      Eigen::VectorXd right = condition.n[axis] * values;
      for (int k = 0; k < size; ++k) {
        if (!spline_.fixed[active.columns[k]][axis]) continue;
        held.row(k).setZero();
        held.col(k).setZero();
        held(k, k) = 1;
        right[k] = 0;
      }
      active.step.row(axis) = held.llt().solve(right).transpose();
    }
    active.size = condition.n.dot(active.step * values);
    return active;
  }

  Eigen::Matrix2Xd Move(const std::vector<Condition>& conditions,
                        const std::vector<Active>& actives,
                        double soft) const {
    Eigen::Matrix2Xd move = Eigen::Matrix2Xd::Zero(2, spline_.points.cols());
    std::vector<double> multipliers(actives.size(), 0.0);
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      double worst = 0;
      for (size_t k = 0; k < actives.size(); ++k) {
        const Active& active = actives[k];
        if (active.size < 1e-6) continue;  // fixed there
        const double lacks =
            conditions[k].least - soft * multipliers[k] - conditions[k].n.dot(active.row * move);
        const double change = std::max(-multipliers[k], lacks / (active.size + soft));
        if (change == 0) continue;
        multipliers[k] += change;
        move(Eigen::all, active.columns) += change * active.step;
        worst = std::max(worst, std::abs(change) * active.size);
      }
      if (worst < kMet) break;
    }
    return move;
  }

  const OutlineSpline& spline_;
  Eigen::SparseMatrix<double> mass_;
};

// No margin is kept near corners, which may lie on an edge of the rectangle.
bool NearCorner(const OutlineSpline& loop, double t) {
  const double round = loop.basis.upper() - loop.basis.lower();
  return std::any_of(loop.corners.begin(), loop.corners.end(), [&](double corner) {
    const double away = std::abs(t - corner);
    return std::min(away, round - away) < kNearCorner;
  });
}

using Bins = std::map<std::pair<int, long>, Condition>;

void Keep(Bins& bins, int loop, int kind, const Condition& condition) {
  const long bin = std::lround(condition.t / kBin) * 8 + kind;
  const auto [place, fresh] = bins.emplace(std::pair(loop, bin), condition);
  if (!fresh && place->second.least < condition.least) place->second = condition;
}

// Points that the moves of a border may reach.
Eigen::Matrix2Xd NearOutlines(const Eigen::Matrix2Xd& points,
                              const std::vector<OutlineSpline>& loops,
                              ThreadPool& pool) {
  const std::vector<OutlineFootPoint> feet =
      OutlinePolygon(loops, kMostContainmentMoved).FootPointSet(points, pool);
  Eigen::Matrix2Xd near(2, static_cast<Eigen::Index>(feet.size()));
  for (size_t k = 0; k < feet.size(); ++k)
    near.col(static_cast<Eigen::Index>(k)) = points.col(feet[k].point);
  return near;
}

}  // namespace

void EnforceContainment(const Eigen::Matrix2Xd& points,
                        const Eigen::Vector2d& sides,
                        double farthest,
                        std::vector<OutlineSpline>& loops,
                        ThreadPool& pool) {
  const std::vector<OutlineSpline> begun = loops;
  const Eigen::Matrix2Xd near = NearOutlines(points, loops, pool);
  std::vector<LeastMove> least(begun.begin(), begun.end());
  for (int round = 0; round < kRounds; ++round) {
    const OutlinePolygon polygon(loops, std::max(farthest, kContainmentLookedAt));
    std::vector<Bins> bins(loops.size());
    double worst = 0;
    for (const OutlineFootPoint& foot : polygon.FootPointSet(near, pool)) {
      if (foot.loop < 0 || foot.outside > farthest || foot.outside < -kContainmentLookedAt)
        continue;
      if (loops[foot.loop].IsStraight(foot.t)) continue;
      worst = std::max(worst, foot.outside + kMargin);
      Keep(bins[foot.loop], foot.loop, 0, {foot.t, foot.outward, foot.outside + kMargin});
    }
    for (size_t l = 0; l < loops.size(); ++l) {
      for (const auto& vertex : polygon.vertices()[l]) {
        if (loops[l].IsStraight(vertex.t)) continue;
        for (int axis = 0; axis < 2; ++axis) {
          for (const int sign : {-1, 1}) {
            const double beyond = sign > 0 ? vertex.place[axis] - sides[axis] : -vertex.place[axis];
            if (beyond < -kContainmentLookedAt) continue;
            const double margin = NearCorner(loops[l], vertex.t) ? -kMargin : kMargin;
            worst = std::max(worst, beyond + margin);
            Keep(bins[l],
                 static_cast<int>(l),
                 1 + 2 * axis + (sign > 0),
                 {vertex.t, -sign * Eigen::Vector2d::Unit(axis), beyond + margin});
          }
        }
      }
    }
    if (worst < kMargin / 2) return;
    for (size_t l = 0; l < loops.size(); ++l) {
      std::vector<Condition> conditions;
      for (const auto& [key, condition] : bins[l]) {
        conditions.push_back(condition);
        const Eigen::Vector2d moved = loops[l].At(condition.t) - begun[l].At(condition.t);
        conditions.back().least += condition.n.dot(moved);
      }
      if (!conditions.empty()) loops[l].points = begun[l].points + least[l].Move(conditions);
    }
  }
}

}  // namespace batten::internal
