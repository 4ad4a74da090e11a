// SPDX-License-Identifier: MIT
#include "fitting/interpolation/curved_ends.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "fitting/core/rounding.h"

namespace batten::internal {
namespace {

// C'' that gives a curve with this C' the curvature of an end, and its derivative by C'.
template <int Dim>
struct SecondBySlope {
  Eigen::Matrix<double, Dim, 1> value;
  Eigen::Matrix<double, Dim, Dim> by_slope;
};

template <int Dim>
SecondBySlope<Dim> SecondOf(const EndCurvature<Dim>& asked,
                            double share,
                            const Eigen::Matrix<double, Dim, 1>& slope) {
  using Matrix = Eigen::Matrix<double, Dim, Dim>;
  const Eigen::Matrix<double, Dim, 1> k = share * asked.value;
  SecondBySlope<Dim> second;
  if constexpr (Dim == 2) {
    const double speed = slope.norm();
    const Eigen::Matrix2d turn{{0, -1}, {1, 0}};
    second.value = k[0] * speed * turn * slope;
    second.by_slope =
        k[0] * (speed * turn + turn * slope * slope.transpose() / std::max(speed, 1e-300));
  } else {
    second.value = slope.squaredNorm() * k - slope.dot(k) * slope;
    second.by_slope =
        2 * k * slope.transpose() - slope * k.transpose() - slope.dot(k) * Matrix::Identity();
  }
  if (!asked.of_function) return second;
  const double ratio = second.value[0] / slope[0];
  Eigen::Matrix<double, 1, Dim> by_ratio = second.by_slope.row(0) / slope[0];
  by_ratio[0] -= ratio / slope[0];
  second.by_slope -= ratio * Matrix::Identity() + slope * by_ratio;
  second.value -= ratio * slope;
  second.value[0] = 0;
  second.by_slope.row(0).setZero();
  return second;
}

template <int Dim>
class CurvatureSearch {
 public:
  using Seconds = typename EndSlopes<Dim>::Seconds;

  CurvatureSearch(const EndCurvatures<Dim>& curvatures, const EndSlopes<Dim>& slopes)
      : curvatures_(curvatures), slopes_(slopes) {}

  // Newton's method, steps halved where they do not help.
  std::optional<Seconds> From(Seconds seconds, double share) const {
    constexpr int kSteps = 60, kHalvings = 20;
    Equations now = EquationsAt(seconds, share);
    for (int step = 0; step < kSteps && now.missing > 0; ++step) {
      const Unknowns change = now.by_seconds.fullPivLu().solve(now.values);
      if (!change.allFinite()) break;
      double length = 1;
      int halving = 0;
      for (; halving < kHalvings; ++halving, length /= 2) {
        Seconds next = seconds;
        for (int end : {0, 1}) next[end] -= length * change.template segment<Dim>(end * Dim);
        const Equations there = EquationsAt(next, share);
        if (!(there.missing < now.missing)) continue;
        seconds = next;
        now = there;
        break;
      }
      if (halving == kHalvings) break;
    }
    if (!(now.missing <= kRelativeRounding)) return {};
    return seconds;
  }

  // From no curvature on.
  std::optional<Seconds> Followed() const {
    constexpr double kLeast = 1. / 1024;
    Seconds seconds = {Place::Zero(), Place::Zero()};
    double share = 0, step = 0.25;
    while (share < 1) {
      const double next = std::min(1.0, share + step);
      if (const auto found = From(seconds, next)) {
        seconds = *found;
        share = next;
        step *= 2;
      } else if ((step /= 2) < kLeast) {
        return {};
      }
    }
    return seconds;
  }

  // The second derivatives at ends that run so many times as fast as the spline without them.
  Seconds Guess(double start_speed, double end_speed) const {
    return {Second(0, 1, start_speed * slopes_.own[0]).value,
            Second(1, 1, end_speed * slopes_.own[1]).value};
  }

 private:
  using Place = Eigen::Matrix<double, Dim, 1>;
  using Unknowns = Eigen::Matrix<double, 2 * Dim, 1>;
  struct Equations {
    Unknowns values;
    Eigen::Matrix<double, 2 * Dim, 2 * Dim> by_seconds;
    double missing;  // of the values, in shares of curvature times speed squared
  };

  SecondBySlope<Dim> Second(int end, double share, const Place& slope) const {
    if (!curvatures_[end]) return {Place::Zero(), Eigen::Matrix<double, Dim, Dim>::Zero()};
    return SecondOf<Dim>(*curvatures_[end], share, slope);
  }

  Equations EquationsAt(const Seconds& seconds, double share) const {
    Equations equations;
    equations.by_seconds.setIdentity();
    equations.missing = 0;
    for (int end : {0, 1}) {
      const Place slope = slopes_.At(end, seconds);
      const auto wanted = Second(end, share, slope);
      const Place miss = seconds[end] - wanted.value;
      equations.values.template segment<Dim>(end * Dim) = miss;
      for (int other : {0, 1}) {
        equations.by_seconds.template block<Dim, Dim>(end * Dim, other * Dim) -=
            slopes_.by(end, other) * wanted.by_slope;
      }
      const double asked = curvatures_[end] ? share * curvatures_[end]->value.norm() : 0;
      const double size = std::max(seconds[end].norm(), asked * slope.squaredNorm());
      if (!miss.allFinite()) equations.missing = HUGE_VAL;
      if (size > 0) equations.missing = std::max(equations.missing, miss.norm() / size);
    }
    return equations;
  }

  const EndCurvatures<Dim>& curvatures_;
  const EndSlopes<Dim>& slopes_;
};

}  // namespace

template <int Dim>
std::optional<typename EndSlopes<Dim>::Seconds> SecondsOfCurvatures(
    const EndCurvatures<Dim>& curvatures, const EndSlopes<Dim>& slopes, double wild) {
  const CurvatureSearch<Dim> search(curvatures, slopes);
  const auto tame = [&](const auto& seconds) {
    return slopes.At(0, seconds).norm() <= wild && slopes.At(1, seconds).norm() <= wild;
  };
  if (const auto found = search.Followed(); found && tame(*found)) return found;
  constexpr double kSpeeds[] = {1, 0.5, 2, 0.25, 4, 0.1, 10};
  for (const double start : kSpeeds) {
    for (const double end : kSpeeds) {
      const auto found = search.From(search.Guess(start, end), 1);
      if (found && tame(*found)) return found;
    }
  }
  return {};
}

template std::optional<EndSlopes<2>::Seconds> SecondsOfCurvatures(const EndCurvatures<2>&,
                                                                  const EndSlopes<2>&,
                                                                  double);
template std::optional<EndSlopes<3>::Seconds> SecondsOfCurvatures(const EndCurvatures<3>&,
                                                                  const EndSlopes<3>&,
                                                                  double);

}  // namespace batten::internal
