// SPDX-License-Identifier: MIT
#include "fitting/outline/outline_containment.h"

#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
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
constexpr double kSofter = 100;
constexpr double kMet = 1e-3;
constexpr double kTrifle = 1e-2 * kMet;

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
    for (double soft = kSoft;; soft *= kSofter) {
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

  // Solves A·x = right in place by Cholesky's factors; entry (d, k) of the band is A's (k + d, k).
  static void SolveBanded(Eigen::MatrixXd& band, Eigen::VectorXd& right) {
    const auto size = band.cols(), width = band.rows() - 1;
    for (Eigen::Index k = 0; k < size; ++k) {
      const Eigen::Index below = std::min(width, size - 1 - k);
      band.col(k).head(below + 1) /= std::sqrt(band(0, k));
      for (Eigen::Index d = 1; d <= below; ++d)
        band.col(k + d).head(below - d + 1) -= band(d, k) * band.col(k).segment(d, below - d + 1);
      right[k] /= band(0, k);
      right.segment(k + 1, below) -= right[k] * band.col(k).segment(1, below);
    }
    for (Eigen::Index k = size; k-- > 0;) {
      const Eigen::Index below = std::min(width, size - 1 - k);
      right[k] -= band.col(k).segment(1, below).dot(right.segment(k + 1, below));
      right[k] /= band(0, k);
    }
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
    const auto held = [&](int k, int axis) { return spline_.fixed[active.columns[k]][axis]; };
    // Of the Gram matrix; that of the whole of a loop is cyclic.
    const int band = size == n ? size - 1 : kOutlineDegree;
    Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(band + 1, size);  // entry (d, k) is of k + d and k
    for (int k = 0; k < size; ++k)
      for (Eigen::SparseMatrix<double>::InnerIterator it(mass_, active.columns[k]); it; ++it)
        if (const int below = place(it.row()) - k; below >= 0 && below <= band && k + below < size)
          mass(below, k) = it.value();
    Eigen::VectorXd values = Eigen::VectorXd::Zero(size);
    for (int r = 0; r < 4; ++r) values[place(active.row.column[r])] += active.row.value[r];
    active.step.resize(2, size);
    for (int axis = 0; axis < 2; ++axis) {
      Eigen::MatrixXd factor = mass;
      Eigen::VectorXd right = condition.n[axis] * values;
      for (int k = 0; k < size; ++k) {
        for (int d = 1; d <= band && k + d < size; ++d)
          if (held(k, axis) || held(k + d, axis)) factor(d, k) = 0;
        if (!held(k, axis)) continue;
        factor(0, k) = 1;
        right[k] = 0;
      }
      SolveBanded(factor, right);
      active.step.row(axis) = right.transpose();
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
        if (std::abs(change) * active.size < kTrifle) continue;
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

using Bins = std::map<long, Condition>;

void Keep(Bins& bins, int kind, const Condition& condition) {
  const long bin = std::lround(condition.t / kBin) * 8 + kind;
  const auto [place, fresh] = bins.emplace(bin, condition);
  if (!fresh && place->second.least < condition.least) place->second = condition;
}

// Points that the moves of a border may bring within `farthest`.
Eigen::Matrix2Xd NearOutlines(const Eigen::Matrix2Xd& points,
                              double farthest,
                              const std::vector<char>& movable,
                              const std::vector<OutlineSpline>& loops,
                              ThreadPool& pool) {
  std::vector<OutlineSpline> moving;
  for (size_t k = 0; k < loops.size(); ++k)
    if (movable[k] != 0) moving.push_back(loops[k]);
  if (moving.empty()) return Eigen::Matrix2Xd(2, 0);
  const double reach = kMostContainmentMoved + farthest;
  std::vector<Eigen::Index> near;
  for (const OutlineFootPoint& foot : OutlinePolygon(moving, reach).FootPointSet(points, pool))
    if (foot.loop >= 0 && std::abs(foot.outside) <= reach) near.push_back(foot.point);
  return points(Eigen::all, near);
}

}  // namespace

void EnforceContainment(const Eigen::Matrix2Xd& points,
                        const Eigen::Vector2d& sides,
                        double farthest,
                        const std::vector<char>& movable,
                        std::vector<OutlineSpline>& loops,
                        ThreadPool& pool) {
  const std::vector<OutlineSpline> begun = loops;
  const Eigen::Matrix2Xd near = NearOutlines(points, farthest, movable, loops, pool);
  std::vector<std::optional<LeastMove>> least(begun.size());
  for (size_t l = 0; l < begun.size(); ++l)
    if (movable[l] != 0) least[l].emplace(begun[l]);
  for (int round = 0; round < kRounds; ++round) {
    const OutlinePolygon polygon(loops, std::max(farthest, kContainmentLookedAt));
    std::vector<Bins> bins(loops.size());
    double worst = 0;
    for (const OutlineFootPoint& foot : polygon.FootPointSet(near, pool)) {
      if (foot.loop < 0 || foot.outside > farthest || foot.outside < -kContainmentLookedAt)
        continue;
      if (movable[foot.loop] == 0 || loops[foot.loop].IsStraight(foot.t)) continue;
      worst = std::max(worst, foot.outside + kMargin);
      Keep(bins[foot.loop], 0, {foot.t, foot.outward, foot.outside + kMargin});
    }
    for (size_t l = 0; l < loops.size(); ++l) {
      if (movable[l] == 0) continue;
      for (const auto& vertex : polygon.vertices()[l]) {
        if (loops[l].IsStraight(vertex.t)) continue;
        for (int axis = 0; axis < 2; ++axis) {
          for (const int sign : {-1, 1}) {
            const double beyond = sign > 0 ? vertex.place[axis] - sides[axis] : -vertex.place[axis];
            if (beyond < -kContainmentLookedAt) continue;
            const double margin = NearCorner(loops[l], vertex.t) ? -kMargin : kMargin;
            worst = std::max(worst, beyond + margin);
            Keep(bins[l],
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
      if (!conditions.empty()) loops[l].points = begun[l].points + least[l]->Move(conditions);
    }
  }
}

}  // namespace batten::internal
