// SPDX-License-Identifier: MIT
#include "fitting/interpolation/smooth_tangents.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>

namespace batten::internal {
namespace {

template <int Dim>
using Vector = Eigen::Matrix<double, Dim, 1>;

constexpr Eigen::Index kWidest = 4096;    // points on either side
constexpr Eigen::Index kMostPoints = 64;  // of them that are used

// The parabola over the points first … last (going round), or some of many, by least squares, chord
// lengths from point `at` on as parameters.
template <int Dim>
struct Parabola {
  Vector<Dim> direction;
  double most = 0;     // largest distance
  double scatter = 0;  // standard deviation
};

template <int Dim>
Parabola<Dim> FitParabola(const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points,
                          Eigen::Index first,
                          Eigen::Index last,
                          Eigen::Index at) {
  const Eigen::Index m = points.cols();
  const Eigen::Index stride = 1 + (last - first) / (2 * kMostPoints + 1);
  const Eigen::Index before = (at - first) / stride, count = before + (last - at) / stride + 1;
  const auto point = [&](Eigen::Index k) {
    return points.col(((at + (k - before) * stride) % m + m) % m);
  };
  Eigen::VectorXd t(count);
  t[0] = 0;
  for (Eigen::Index k = 1; k < count; ++k) t[k] = t[k - 1] + (point(k) - point(k - 1)).norm();
  const double length = t[count - 1];
  t = (t.array() - t[before]) / length;
  Eigen::Matrix3d sums = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, Dim> right = Eigen::Matrix<double, 3, Dim>::Zero();
  const Vector<Dim> origin = point(before);
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::Vector3d powers(1, t[k], t[k] * t[k]);
    sums += powers * powers.transpose();
    right += powers * (point(k) - origin).transpose();
  }
  const Eigen::Matrix<double, 3, Dim> c = sums.fullPivLu().solve(right);
  Parabola<Dim> result;
  result.direction = c.row(1).transpose();
  double squares = 0;
  for (Eigen::Index k = 0; k < count; ++k) {
    const Vector<Dim> miss =
        point(k) - origin - c.transpose() * Eigen::Vector3d(1, t[k], t[k] * t[k]);
    result.most = std::max(result.most, miss.norm());
    squares += miss.squaredNorm();
  }
  if (count > 3) result.scatter = std::sqrt(squares / static_cast<double>(count - 3));
  return result;
}

// Polygon turns of an open or closed sequence of points at a given resolution.
template <int Dim>
class Legs {
 public:
  Legs(const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points, bool closed, double resolution)
      : points_(points), closed_(closed), resolution_(resolution) {
    const Eigen::Index m = points.cols(), steps = closed ? m : m - 1;
    for (Eigen::Index k = 0; k < steps; ++k) {
      longest_ = std::max(longest_, (points.col((k + 1) % m) - points.col(k)).norm());
    }
  }

  Eigen::Index Index(Eigen::Index k) const {
    const Eigen::Index m = points_.cols();
    return (k % m + m) % m;
  }

  // The nearest point at least one step and the resolution away, forward or backward (±1); none
  // past an end, or once around. Skips what is too near by the triangle inequality.
  std::optional<Eigen::Index> Next(Eigen::Index k, int direction) const {
    const Eigen::Index m = points_.cols();
    for (Eigen::Index away = 1; away < m;) {
      const Eigen::Index j = k + direction * away;
      if (!closed_ && (j < 0 || j >= m)) return std::nullopt;
      const double lack = resolution_ - (points_.col(Index(j)) - points_.col(Index(k))).norm();
      if (!(lack > 0)) return j;
      const double steps = std::ceil(lack / longest_);
      if (!(steps < static_cast<double>(m))) return std::nullopt;
      away += std::max<Eigen::Index>(1, static_cast<Eigen::Index>(steps));
    }
    return std::nullopt;
  }

  // 0 where there are no neighbours.
  double Turn(Eigen::Index k) const {
    const auto before = Next(k, -1), behind = Next(k, 1);
    if (!before || !behind) return 0;
    const Vector<Dim> here = points_.col(Index(k)),
                      a = (here - points_.col(Index(*before))).normalized(),
                      b = (points_.col(Index(*behind)) - here).normalized();
    return 2 * std::atan2((a - b).norm(), (a + b).norm());
  }

 private:
  const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points_;
  bool closed_;
  double resolution_, longest_ = 0;
};

}  // namespace

template <int Dim>
std::vector<Eigen::Index> SharpTurns(const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points,
                                     bool closed,
                                     double angle,
                                     double resolution) {
  constexpr double kOutstanding = 4;
  const Eigen::Index m = points.cols();
  const Legs<Dim> legs(points, closed, resolution);
  Eigen::VectorXd turns(m);
  for (Eigen::Index k = 0; k < m; ++k) turns[k] = legs.Turn(k);
  // Sharper than all points up to the neighbour, and much sharper than two neighbours.
  const auto outstanding = [&](Eigen::Index k, int direction) {
    const auto next = legs.Next(k, direction);
    if (!next) return false;
    for (Eigen::Index j = k + direction; j != *next; j += direction) {
      const double other = turns[legs.Index(j)];
      if (other > turns[k] || (other == turns[k] && direction < 0)) return false;
    }
    double beside = turns[legs.Index(*next)];
    if (const auto second = legs.Next(*next, direction)) {
      beside = std::max(beside, turns[legs.Index(*second)]);
    }
    return turns[k] > kOutstanding * beside;
  };
  std::vector<Eigen::Index> result;
  for (Eigen::Index k = 0; k < m; ++k) {
    if (turns[k] > angle && outstanding(k, -1) && outstanding(k, 1)) result.push_back(k);
  }
  return result;
}

template <int Dim>
Vector<Dim> SmoothDirection(const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points,
                            Eigen::Index first,
                            Eigen::Index last,
                            Eigen::Index at,
                            double tolerance) {
  const auto from = [&](Eigen::Index r) { return std::max(first, at - r); };
  const auto to = [&](Eigen::Index r) { return std::min(last, at + r); };
  const Eigen::Index m = points.cols();
  const Vector<Dim> chord = points.col((to(1) % m + m) % m) - points.col((from(1) % m + m) % m);
  const auto unit = [&](const Vector<Dim>& v) {
    return Vector<Dim>(v.norm() > 0 ? v.normalized() : chord.normalized());
  };
  if (last - first < 2) return unit(chord);
  const bool end = at == first || at == last;
  Eigen::Index reach = end ? 2 : 1;
  Parabola<Dim> best = FitParabola<Dim>(points, from(reach), to(reach), at);
  double scatter = -1;  // of the narrowest parabola that misses points
  while (2 * reach <= kWidest && (from(2 * reach) < from(reach) || to(2 * reach) > to(reach))) {
    reach *= 2;
    const Parabola<Dim> wider = FitParabola<Dim>(points, from(reach), to(reach), at);
    if (scatter < 0) {
      if (!(wider.most <= tolerance / 2)) break;
      scatter = wider.scatter;
    } else if (!(wider.most <= tolerance && wider.scatter <= 1.5 * scatter + tolerance / 50)) {
      break;
    }
    best = wider;
  }
  return unit(best.direction);
}

template std::vector<Eigen::Index> SharpTurns<2>(const Eigen::Matrix2Xd&, bool, double, double);
template std::vector<Eigen::Index> SharpTurns<3>(const Eigen::Matrix3Xd&, bool, double, double);
template Eigen::Vector2d SmoothDirection<2>(
    const Eigen::Matrix2Xd&, Eigen::Index, Eigen::Index, Eigen::Index, double);
template Eigen::Vector3d SmoothDirection<3>(
    const Eigen::Matrix3Xd&, Eigen::Index, Eigen::Index, Eigen::Index, double);

}  // namespace batten::internal
