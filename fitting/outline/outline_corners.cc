// SPDX-License-Identifier: MIT
#include "fitting/outline/outline_corners.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "fitting/core/rounding.h"
#include "geometry/numeric/dense_solvers.h"

namespace batten::internal {
namespace {

using Index = Eigen::Index;

constexpr double kMostCornerTurn = 165 * kOneDegree;  // above: a hairpin, no corner
constexpr double kBetter = 1.5;          // sum of squares of a circle over that of two lines
constexpr double kMostMoved = 2;         // by which longer windows may move a corner
constexpr double kFarthestCorner = 3.2;  // distance of a corner from the border; farther: a bend
constexpr double kSharp = 140 * kOneDegree;
constexpr double kLongest = 20;  // longest window that locates a corner

// Thresholds of a corner: length and rms of both windows, turn in degrees, and gain over one circle
// (squared distances, integrated along the border). Borders of random points meet lower ones by
// chance.
struct Window {
  double length, most_rms, least_turn, gain;
};

struct Fitted {
  OutlineLine line;
  double squares;  // sum of squared distances
  Index count;

  double rms() const { return std::sqrt(squares / static_cast<double>(count)); }
};

std::optional<Eigen::Vector2d> Meeting(const OutlineLine& a, const OutlineLine& b) {
  const double sine = a.direction.x() * b.direction.y() - a.direction.y() * b.direction.x();
  if (std::abs(sine) < 1e-3) return {};
  const Eigen::Vector2d way = b.point - a.point;
  return a.point + (way.x() * b.direction.y() - way.y() * b.direction.x()) / sine * a.direction;
}

double Turn(const OutlineLine& a, const OutlineLine& b) {
  return std::atan2(a.direction.x() * b.direction.y() - a.direction.y() * b.direction.x(),
                    a.direction.dot(b.direction));
}

class CornerSearch {
 public:
  CornerSearch(const Eigen::Matrix2Xd& border, double step) : border_(border), step_(step) {}

  std::vector<OutlineCorner> Find() {
    Scan({20, 0.8, 40, 6});
    Scan({10, 1.0, 70, 3});
    Scan({5, 0.6, 70, 2});
    for (size_t i = 0; i < corners_.size(); ++i) Place(i);
    MergeNear();
    // Lines that meet far from the border indicate a narrow bend, unless they form a sharp tip.
    std::erase_if(corners_, [&](const OutlineCorner& corner) {
      return std::abs(corner.turn) < kSharp && FromBorder(corner) > kFarthestCorner;
    });
    return std::move(corners_);
  }

 private:
  Index Count(double length) const { return static_cast<Index>(std::lround(length / step_)); }
  Index Wrapped(Index i) const { return ((i % border_.cols()) + border_.cols()) % border_.cols(); }
  Eigen::Vector2d At(Index i) const { return border_.col(Wrapped(i)); }

  // How far a corner lies from the border around it.
  double FromBorder(const OutlineCorner& corner) const {
    double least = (corner.place - At(corner.index)).norm();
    for (Index i = -Count(10); i <= Count(10); ++i)
      least = std::min(least, (corner.place - At(corner.index + i)).norm());
    return least;
  }

  // From the points first … last.
  Fitted Line(Index first, Index last) const {
    const Index count = last - first + 1;
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (Index i = first; i <= last; ++i) mean += At(i);
    mean /= static_cast<double>(count);
    Eigen::Matrix2d moments = Eigen::Matrix2d::Zero();
    for (Index i = first; i <= last; ++i) {
      const Eigen::Vector2d from = At(i) - mean;
      moments += from * from.transpose();
    }
    const double angle = 0.5 * std::atan2(2 * moments(0, 1), moments(0, 0) - moments(1, 1));
    Eigen::Vector2d way(std::cos(angle), std::sin(angle));
    if (way.dot(At(last) - At(first)) < 0) way = -way;
    const Eigen::Vector2d across(-way.y(), way.x());
    return {{mean, way}, std::max(0.0, across.dot(moments * across)), count};
  }

  // Sum of squared distances from the circle of both windows: the algebraic one, turned into
  // distances.
  double CircleSquares(Index i, Index gap, Index window) const {
    const Eigen::Vector2d origin = At(i);
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    const auto each = [&](const auto& visit) {
      for (Index k = gap; k <= window; ++k) {
        visit(Eigen::Vector2d(At(i - k) - origin));
        visit(Eigen::Vector2d(At(i + k) - origin));
      }
    };
    each([&](const Eigen::Vector2d& p) {
      const Eigen::Vector3d row(p.x(), p.y(), 1);
      normal += row * row.transpose();
      right += row * p.squaredNorm();
    });
    const Eigen::Vector3d solved = SymmetricSolution3(normal, right);
    const Eigen::Vector2d centre = solved.head<2>() / 2;
    const double square = solved[2] + centre.squaredNorm();
    if (!(square > 0)) return std::numeric_limits<double>::infinity();
    const double radius = std::sqrt(square);
    double sum = 0;
    each([&](const Eigen::Vector2d& p) { sum += std::pow((p - centre).norm() - radius, 2); });
    return sum;
  }

  std::optional<OutlineCorner> Judged(Index i, const Fitted& before, const Fitted& after) const {
    const double turn = Turn(before.line, after.line);
    if (std::abs(turn) > kMostCornerTurn) return {};
    const auto place = Meeting(before.line, after.line);
    // A sharp tip holds no points; what it loses grows like the root of the cotangent of its half.
    const double most_cut = std::abs(turn) < 110 * kOneDegree ? 3 : 6;
    if (!place || (*place - At(i)).norm() > most_cut) return {};
    return OutlineCorner{i, before.line, after.line, turn, *place};
  }

  bool Taken(Index i, Index window) const {
    return std::any_of(corners_.begin(), corners_.end(), [&](const OutlineCorner& corner) {
      const Index away = std::abs(corner.index - i);
      return std::min(away, border_.cols() - away) < window;
    });
  }

  // Best ones first.
  void Scan(const Window& kind) {
    const Index window = Count(kind.length), gap = Count(kCornerGap);
    if (border_.cols() < 3 * window) return;
    struct Candidate {
      double squares;
      OutlineCorner corner;
    };
    std::vector<Candidate> candidates;
    for (Index i = 0; i < border_.cols(); ++i) {
      if (Taken(i, window)) continue;
      const Fitted before = Line(i - window, i - gap), after = Line(i + gap, i + window);
      if (before.rms() > kind.most_rms || after.rms() > kind.most_rms) continue;
      const auto corner = Judged(i, before, after);
      if (!corner || std::abs(corner->turn) < kind.least_turn * kOneDegree) continue;
      const double floor =
          kLeastBorderNoise * kLeastBorderNoise * static_cast<double>(2 * before.count);
      const double squares = before.squares + after.squares + floor;
      const double circle = CircleSquares(i, gap, window) + floor;
      if (circle < kBetter * squares || (circle - squares) * step_ < kind.gain) continue;
      candidates.push_back({squares, *corner});
    }
    std::stable_sort(candidates.begin(), candidates.end(), [](const auto& a, const auto& b) {
      return a.squares < b.squares;
    });
    for (const Candidate& candidate : candidates)
      if (!Taken(candidate.corner.index, window)) corners_.push_back(candidate.corner);
    SortByIndex();
  }

  void SortByIndex() {
    std::sort(corners_.begin(), corners_.end(), [](const auto& a, const auto& b) {
      return a.index < b.index;
    });
  }

  // A corner that looks cut off is one, where the lines before and after it meet.
  void MergeNear() {
    constexpr double kApart = 5, kJog = 3;
    for (size_t k = 0; k + 1 < corners_.size() || (k < corners_.size() && corners_.size() > 1);) {
      const size_t next = (k + 1) % corners_.size();
      OutlineCorner &a = corners_[k], &b = corners_[next];
      if ((a.place - b.place).norm() > kApart) {
        ++k;
        continue;
      }
      const auto place = Meeting(a.before, b.after);
      const double turn = Turn(a.before, b.after);
      const bool one = a.turn * b.turn > 0 && std::abs(turn) < kMostCornerTurn && place &&
                       (*place - a.place).norm() < kApart && (*place - b.place).norm() < kApart;
      if (one) {
        a = {a.index, a.before, b.after, turn, *place};
      } else if (a.turn * b.turn > 0 || (a.place - b.place).norm() < kJog) {
        if (std::abs(b.turn) > std::abs(a.turn)) a = b;
      } else {
        ++k;
        continue;
      }
      corners_.erase(corners_.begin() + static_cast<std::ptrdiff_t>(next));
      if (next == 0) break;
    }
    SortByIndex();  // the last corner may have taken the place of the first
  }

  // The longest straight window on a side that ends before the next corner.
  OutlineLine Longest(Index i, int side, double room, const OutlineLine& otherwise) const {
    const Index gap = Count(kCornerGap);
    std::optional<Fitted> best;
    for (double length = 5; length <= kLongest; length *= 1.25) {
      if (length > room - kCornerGap && best) break;
      const Index end = Count(std::min(length, room - kCornerGap));
      if (end < gap + 4) return otherwise;
      const Fitted fitted = side < 0 ? Line(i - end, i - gap) : Line(i + gap, i + end);
      if (best && fitted.rms() > 1.15 * best->rms() + 0.05) break;
      best = fitted;
    }
    return best ? best->line : otherwise;
  }

  void Place(size_t k) {
    OutlineCorner& corner = corners_[k];
    const size_t n = corners_.size();
    const auto room = [&](Index from, Index to) {
      const Index way = Wrapped(to - from);
      return step_ * static_cast<double>(way == 0 ? border_.cols() / 2 : way);
    };
    const Index previous = corners_[(k + n - 1) % n].index, next = corners_[(k + 1) % n].index;
    const OutlineLine before =
        Longest(corner.index, -1, room(previous, corner.index), corner.before);
    const OutlineLine after = Longest(corner.index, 1, room(corner.index, next), corner.after);
    const auto place = Meeting(before, after);
    if (!place || (*place - corner.place).norm() > kMostMoved) return;
    corner = {corner.index, before, after, Turn(before, after), *place};
  }

  const Eigen::Matrix2Xd& border_;
  double step_;
  std::vector<OutlineCorner> corners_;
};

}  // namespace

std::vector<OutlineCorner> OutlineCorners(const Eigen::Matrix2Xd& border, double step) {
  return CornerSearch(border, step).Find();
}

}  // namespace batten::internal
