// SPDX-License-Identifier: MIT
#include "fitting/outline/outline_containment.h"

#include <Eigen/Dense>
#include <algorithm>
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

using Row = Eigen::Matrix<double, 1, Eigen::Dynamic>;

class LeastMove {
 public:
  explicit LeastMove(const OutlineSpline& spline) : spline_(spline) {
    const auto n = spline.points.cols();
    Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(n, n);
    const auto& knots = spline.basis.knots();
    constexpr int kSamples = 6;
    for (const int span : spline.basis.Spans()) {
      const double length = knots[span + 1] - knots[span];
      for (int k = 0; k < kSamples; ++k) {
        Row row = Values(knots[span] + length * (k + 0.5) / kSamples);
        mass += length / kSamples * row.transpose() * row;
      }
    }
    for (int axis = 0; axis < 2; ++axis) {
      Eigen::MatrixXd held = mass;
      held.diagonal().array() += kOwnLength;  // short pieces do not slide
      for (Eigen::Index i = 0; i < n; ++i) {
        if (!spline.fixed[i][axis]) continue;
        held.row(i).setZero();
        held.col(i).setZero();
        held(i, i) = 1;
      }
      inverse_[axis] = held.llt().solve(Eigen::MatrixXd::Identity(n, n));
      for (Eigen::Index i = 0; i < n; ++i)
        if (spline.fixed[i][axis]) inverse_[axis].row(i).setZero();
    }
  }

  Row Values(double t) const {
    double values[4];
    const int span = spline_.basis.Span(t);
    spline_.basis.Values(span, t, values);
    Row row = Row::Zero(spline_.points.cols());
    for (int r = 0; r <= 3; ++r) row[spline_.unknown[span - 3 + r]] += values[r];
    return row;
  }

  // 2 × n moves that meet the conditions, or nearly where they would ask for much.
  Eigen::Matrix2Xd Move(const std::vector<Condition>& conditions) const {
    for (double soft = kSoft;; soft *= 10) {
      Eigen::Matrix2Xd move = Move(conditions, soft);
      if (!(move.colwise().norm().maxCoeff() > kMostContainmentMoved) || soft > 1e3) return move;
    }
  }

 private:
  Eigen::Matrix2Xd Move(const std::vector<Condition>& conditions, double soft) const {
    const auto n = spline_.points.cols();
    Eigen::Matrix2Xd move = Eigen::Matrix2Xd::Zero(2, n);
    struct Active {
      Row row;
      Eigen::Matrix2Xd step;  // what a multiplier of one moves
      double size = 0, multiplier = 0;
    };
    std::vector<Active> actives;
    for (const Condition& condition : conditions) {
      Active active{Values(condition.t), Eigen::Matrix2Xd(2, n)};
      for (int axis = 0; axis < 2; ++axis)
        active.step.row(axis) =
            condition.n[axis] * (inverse_[axis] * active.row.transpose()).transpose();
      active.size = condition.n.dot(active.step * active.row.transpose());
      actives.push_back(std::move(active));
    }
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      double worst = 0;
      for (size_t k = 0; k < actives.size(); ++k) {
        Active& active = actives[k];
        if (active.size < 1e-6) continue;  // fixed there
        const double lacks = conditions[k].least - soft * active.multiplier -
                             conditions[k].n.dot(move * active.row.transpose());
        const double change = std::max(-active.multiplier, lacks / (active.size + soft));
        if (change == 0) continue;
        active.multiplier += change;
        move += change * active.step;
        worst = std::max(worst, std::abs(change) * active.size);
      }
      if (worst < kMet) break;
    }
    return move;
  }

  const OutlineSpline& spline_;
  Eigen::MatrixXd inverse_[2];
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
