// SPDX-License-Identifier: MIT
#include "fitting/corners/corner_turns.h"

#include <array>
#include <cmath>
#include <optional>

#include "fitting/corners/corner_data.h"
#include "geometry/numeric/polygon.h"

namespace batten::internal {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

// A side announces a turn by bending towards it: so many times its own bend must a turn have.
constexpr double kOverBendAt = 3;       // at a point
constexpr double kOverBendBetween = 5;  // between two, where nothing was measured
constexpr double kOverNoise = 5;        // standard deviations of the turn
constexpr double kLongestMeeting = 3;   // of the gap: both sides prolonged until they meet
constexpr double kSpike = 2.5;          // radians that leaving out an outlier saves
constexpr double kLeastStep = 30;       // standard deviations of the noise
constexpr double kSnap = 0.05;          // of the gap: so near to a point the corner is the point
constexpr double kSlack = 0.01;         // of bend: a point is preferred to a gap

// Estimate from three points of the direction in which the curve leaves a place at or before the
// first.
struct Side {
  Vector3d direction;  // unit
  double bend;         // between the direction of the first two and that of the parabola
  double noise;        // standard deviation of its angle for unit noise
};

// The parabola through q_0, q_1, q_2 with chords as parameters, at `before` ahead of q_0.
Side SideOf(const std::array<Vector3d, 3>& q, double before) {
  const double h1 = (q[1] - q[0]).norm(), h2 = (q[2] - q[1]).norm();
  const Vector3d first = (q[1] - q[0]) / h1, second = (q[2] - q[1]) / h2;
  const double beyond = (before + before + h1) / (h1 + h2);
  const Vector3d direction = first + beyond * (first - second);
  const double noise = std::sqrt(2.0) * ((1 + beyond) / h1 + beyond / h2);
  return {direction.normalized(), AngleBetween(first, direction), noise};
}

struct Turn {
  double angle, bend, noise;
};

struct Candidate {
  Index point;   // the corner's, or the one before it
  bool between;  // between that point and the next
  Turn turn;
  double share;  // of the gap, from the point before
  Vector3d place;
};

class TurnSearch {
 public:
  TurnSearch(const Eigen::Matrix3Xd& points,
             const Eigen::VectorXd& parameters,
             const CornerOptions& options)
      : points_(points), parameters_(parameters), options_(options) {}

  std::vector<CurveCorner> Run() {
    LeaveOutShortSteps();
    LeaveOutSpikes();
    const Index count = Count();
    if (count < 5) return {};
    std::vector<std::optional<Candidate>> at(kept_.size()), between(kept_.size());
    for (Index k = 0; k < count; ++k) {
      at[Slot(k)] = At(k);
      between[Slot(k)] = Between(k);
    }
    for (Index k = 0; k < count; ++k) KeepBest(at, between, k);
    std::vector<CurveCorner> corners;
    for (Index k = 0; k < count; ++k) {
      if (at[Slot(k)]) corners.push_back(Corner(*at[Slot(k)]));
      if (between[Slot(k)]) corners.push_back(Corner(*between[Slot(k)]));
    }
    return corners;
  }

 private:
  Index Count() const { return static_cast<Index>(kept_.size()); }

  size_t Slot(Index k) const { return static_cast<size_t>((k % Count() + Count()) % Count()); }

  Vector3d Point(Index k) const { return points_.col(kept_[Slot(k)]); }

  bool Inside(Index first, Index last) const {
    return options_.closed || (first >= 0 && last < Count());
  }

  double TurnAt(const Vector3d& a, const Vector3d& b, const Vector3d& c) const {
    return AngleBetween(b - a, c - b);
  }

  // A point without which the curve turns much less: to it and back.
  bool IsSpike(Index k) const {
    if (!Inside(k - 2, k + 2)) return false;
    const Vector3d a = Point(k - 2), b = Point(k - 1), p = Point(k), c = Point(k + 1),
                   d = Point(k + 2);
    return TurnAt(a, b, p) + TurnAt(b, p, c) + TurnAt(p, c, d) >
           TurnAt(a, b, c) + TurnAt(b, c, d) + kSpike;
  }

  // Steps so short that noise turns them say nothing.
  void LeaveOutShortSteps() {
    const double least = kLeastStep * options_.noise;
    for (const Index k : WithoutOutliers(points_, options_)) {
      if (kept_.empty() || (points_.col(k) - points_.col(kept_.back())).norm() > least)
        kept_.push_back(k);
    }
    while (options_.closed && kept_.size() > 1 &&
           !((points_.col(kept_.back()) - points_.col(kept_.front())).norm() > least)) {
      kept_.pop_back();
    }
  }

  void LeaveOutSpikes() {
    if (Count() < 5) return;
    std::vector<Index> rest;
    for (Index k = 0; k < Count(); ++k) {
      if (!IsSpike(k)) rest.push_back(kept_[Slot(k)]);
    }
    kept_ = std::move(rest);
  }

  Side Left(Index k, double before) const {
    return SideOf({Point(k), Point(k - 1), Point(k - 2)}, before);
  }
  Side Right(Index k, double before) const {
    return SideOf({Point(k), Point(k + 1), Point(k + 2)}, before);
  }

  static Turn TurnOf(const Side& left, const Side& right) {
    return {AngleBetween(-left.direction, right.direction),
            left.bend + right.bend,
            std::hypot(left.noise, right.noise)};
  }

  bool Passes(const Turn& turn, double over_bend) const {
    return turn.angle >= options_.least_angle && turn.angle >= over_bend * turn.bend &&
           turn.angle >= kOverNoise * turn.noise * options_.noise;
  }

  std::optional<Candidate> At(Index k) const {
    if (!Inside(k - 2, k + 2)) return std::nullopt;
    const Turn turn = TurnOf(Left(k, 0), Right(k, 0));
    if (!Passes(turn, kOverBendAt)) return std::nullopt;
    return Candidate{k, false, turn, 0, Point(k)};
  }

  std::optional<Candidate> Between(Index k) const {
    if (!Inside(k - 2, k + 3)) return std::nullopt;
    const Vector3d gap = Point(k + 1) - Point(k);
    const double length = gap.norm();
    const Side left = Left(k, length / 2), right = Right(k + 1, length / 2);
    const Turn turn = TurnOf(left, right);
    if (!Passes(turn, kOverBendBetween)) return std::nullopt;
    // The nearest places of the two lines, a and b from their points towards each other.
    const Vector3d u = -left.direction, v = -right.direction;
    const double c = u.dot(v), rest = 1 - c * c;
    if (!(rest > 0)) return std::nullopt;
    const double a = (gap.dot(u) - c * gap.dot(v)) / rest, b = (c * gap.dot(u) - gap.dot(v)) / rest;
    if (!(a >= -kSnap * length && b >= -kSnap * length && a + b <= kLongestMeeting * length)) {
      return std::nullopt;
    }
    if (a < kSnap * length) return Candidate{k, true, turn, 0, Point(k)};
    if (b < kSnap * length) return Candidate{k, true, turn, 1, Point(k + 1)};
    return Candidate{k, true, turn, a / (a + b), 0.5 * (Point(k) + a * u + Point(k + 1) + b * v)};
  }

  // Of a gap and what it touches, the one whose sides bend least against the turn stays.
  void KeepBest(std::vector<std::optional<Candidate>>& at,
                std::vector<std::optional<Candidate>>& between,
                Index k) const {
    std::optional<Candidate>& gap = between[Slot(k)];
    if (!gap) return;
    const double bend = gap->turn.bend / gap->turn.angle;
    for (const Index end : {k, k + 1}) {
      const std::optional<Candidate>& point = at[Slot(end)];
      if (point && point->turn.bend / point->turn.angle <= bend + kSlack) gap.reset();
      if (!gap) return;
    }
    std::optional<Candidate>& next = between[Slot(k + 1)];
    if (next && next->turn.bend / next->turn.angle < bend) {
      gap.reset();
      return;
    }
    next.reset();
    at[Slot(k)].reset();
    at[Slot(k + 1)].reset();
  }

  CurveCorner Corner(const Candidate& candidate) const {
    const size_t k = Slot(candidate.point), next = Slot(candidate.point + 1);
    double parameter = parameters_[kept_[k]];
    if (candidate.between) {
      double behind = parameters_[kept_[next]];
      if (next < k) behind += options_.period;
      parameter += candidate.share * (behind - parameter);
      if (options_.closed && parameter >= parameters_[0] + options_.period)
        parameter -= options_.period;
    }
    return {parameter, candidate.turn.angle, candidate.place};
  }

  const Eigen::Matrix3Xd& points_;
  const Eigen::VectorXd& parameters_;
  const CornerOptions& options_;
  std::vector<Index> kept_;
};

}  // namespace

std::vector<CurveCorner> CornersOfExact(const Eigen::Matrix3Xd& points,
                                        const Eigen::VectorXd& parameters,
                                        const CornerOptions& options) {
  return TurnSearch(points, parameters, options).Run();
}

}  // namespace batten::internal
