// SPDX-License-Identifier: MIT
#include "batten/fitting/local_approximation.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

#include "batten/fitting/point_tangents.h"
#include "fitting/interpolation/piece_fit.h"
#include "fitting/interpolation/smooth_tangents.h"
#include "geometry/numeric/number_text.h"
#include "geometry/nurbs/placed_curve.h"

namespace batten {
using namespace internal;
namespace {

[[noreturn]] void RefuseApproximation(const std::string& reason) {
  throw std::invalid_argument(reason);
}

template <int Dim>
using Points = Eigen::Matrix<double, Dim, Eigen::Dynamic>;

template <int Dim>
void CheckInput(const Points<Dim>& points,
                double tolerance,
                const LocalApproximationOptions& options) {
  if (!(tolerance > 0) || !std::isfinite(tolerance)) {
    RefuseApproximation("the tolerance " + NumberText(tolerance) + " is not positive");
  }
  if (options.corner_angle &&
      !(*options.corner_angle > 0 && *options.corner_angle < std::numbers::pi)) {
    RefuseApproximation("the corner angle " + NumberText(*options.corner_angle) +
                        " is not between 0 and pi");
  }
  TangentOptions checked;  // the same rules for points and corners
  checked.closed = options.closed;
  checked.corners = options.corners;
  TangentsAt<Dim>(points, checked);
}

template <int Dim>
std::vector<Eigen::Index> CornersOf(const Points<Dim>& points,
                                    double tolerance,
                                    const LocalApproximationOptions& options) {
  constexpr double kVisible = 5;  // tolerances: what moves points by one turns no such leg by 0.5
  std::vector<Eigen::Index> corners = options.corners;
  if (options.corner_angle) {
    const auto found =
        SharpTurns<Dim>(points, options.closed, *options.corner_angle, kVisible * tolerance);
    corners.insert(corners.end(), found.begin(), found.end());
  }
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  if (!options.closed) {
    std::erase_if(corners, [&](Eigen::Index k) { return k == 0 || k == points.cols() - 1; });
  }
  return corners;
}

// The points in the order of the curve, beginning at a corner where a closed curve has one, and
// their pieces.
template <int Dim>
class Run {
 public:
  Run(const Points<Dim>& points,
      std::vector<Eigen::Index> corners,
      double tolerance,
      const LocalApproximationOptions& options)
      : points_(points),
        corners_(std::move(corners)),
        tolerance_(tolerance),
        kind_(options.pieces),
        closed_(options.closed) {
    const Eigen::Index m = points.cols(), last = closed_ ? m : m - 1;
    if (closed_ && !corners_.empty()) start_ = corners_.front();
    std::vector<Eigen::Index> ends;  // of stretches without corners
    for (const Eigen::Index k : corners_) {
      if (k > start_) ends.push_back(k - start_);
    }
    ends.push_back(last);
    Eigen::Index from = 0;
    for (const Eigen::Index end : ends) {
      first_ = from;
      last_ = end;
      while (from < end) from = AddLongest(from);
      pieces_.back().smooth = end == last && closed_ && corners_.empty();
    }
  }

  LocalApproximation<Dim> Result() const {
    auto [curve, breaks] = Chained<Dim>(pieces_, closed_);
    LocalApproximation<Dim> result{std::move(curve),
                                   Eigen::VectorXd(points_.cols()),
                                   largest_,
                                   corners_,
                                   static_cast<Eigen::Index>(pieces_.size())};
    for (size_t k = 0; k < places_.size(); ++k) {
      const auto& [piece, u] = places_[k];
      result.parameters[Index(static_cast<Eigen::Index>(k))] =
          breaks[piece] + u * (breaks[piece + 1] - breaks[piece]);
    }
    if (!closed_) result.parameters[points_.cols() - 1] = 1;
    return result;
  }

 private:
  Eigen::Index Index(Eigen::Index k) const { return (start_ + k) % points_.cols(); }

  // The point and its tangent, estimated from the points of its own stretch.
  DirectedPoint<Dim> At(Eigen::Index k) const {
    Eigen::Index first = first_, last = last_;
    if (closed_ && corners_.empty()) {  // half way round, where windows would meet themselves
      const Eigen::Index half = std::max<Eigen::Index>(1, (points_.cols() - 1) / 2);
      first = k - half;
      last = k + half;
    }
    return {points_.col(Index(k)),
            SmoothDirection<Dim>(points_, start_ + first, start_ + last, start_ + k, tolerance_)};
  }

  std::optional<FittedRun<Dim>> Fit(const DirectedPoint<Dim>& start,
                                    Eigen::Index from,
                                    Eigen::Index to) const {
    const DirectedPoint<Dim> end = At(to);
    if (start.place == end.place) return std::nullopt;
    Points<Dim> inner(Dim, to - from - 1);
    for (Eigen::Index k = from + 1; k < to; ++k) inner.col(k - from - 1) = points_.col(Index(k));
    return kind_ == ApproximationPieces::kCubics ? FitCubicRun<Dim>(start, end, inner, tolerance_)
                                                 : FitConicRun<Dim>(start, end, inner, tolerance_);
  }

  // Adds the longest piece from a point that doubling and halving find; returns where it ends.
  Eigen::Index AddLongest(Eigen::Index from) {
    constexpr int kTries = 3;  // runs that are too long, before it is believed
    const DirectedPoint<Dim> start = At(from);
    std::optional<FittedRun<Dim>> best;
    Eigen::Index good = from + 1, bad = last_ + 1;
    int failed = 0;
    for (Eigen::Index step = 2; step / 2 < last_ - from && failed < kTries; step *= 2) {
      const Eigen::Index to = std::min(last_, from + step);
      auto fitted = Fit(start, from, to);
      if (fitted) {
        best = std::move(fitted);
        good = to;
        failed = 0;
        bad = last_ + 1;
      } else if (failed++ == 0) {
        bad = to;
      }
    }
    while (bad - good > 1 && good < last_) {
      const Eigen::Index to = good + (bad - good) / 2;
      auto fitted = Fit(start, from, to);
      if (fitted) {
        best = std::move(fitted);
        good = to;
      } else {
        bad = to;
      }
    }
    if (!best) best = Exact(start, At(from + 1));
    const auto before = static_cast<Eigen::Index>(pieces_.size());
    places_.push_back({before, 0});
    for (const auto& [piece, u] : best->places) places_.push_back({before + piece, u});
    largest_ = std::max(largest_, best->largest);
    for (ChainPiece<Dim>& piece : best->pieces) pieces_.push_back(std::move(piece));
    return good;
  }

  FittedRun<Dim> Exact(const DirectedPoint<Dim>& start, const DirectedPoint<Dim>& end) const {
    if (kind_ == ApproximationPieces::kCubics) return {{CubicPiece<Dim>(start, end)}, {}, 0};
    return {ConicPieces<Dim>(start, end, true), {}, 0};
  }

  const Points<Dim>& points_;
  std::vector<Eigen::Index> corners_;
  double tolerance_;
  ApproximationPieces kind_;
  bool closed_;
  Eigen::Index start_ = 0;             // the point that comes first
  Eigen::Index first_ = 0, last_ = 0;  // of the stretch in work
  std::vector<ChainPiece<Dim>> pieces_;
  std::vector<typename FittedRun<Dim>::Place> places_;  // of every point
  double largest_ = 0;
};

}  // namespace

template <int Dim>
LocalApproximation<Dim> ApproximateLocally(const Points<Dim>& points,
                                           double tolerance,
                                           const LocalApproximationOptions& options) {
  CheckInput<Dim>(points, tolerance, options);
  // Points are relative to their middle, so that large coordinates cost no digits.
  const Eigen::Matrix<double, Dim, 1> middle =
      points.rowwise().minCoeff() + (points.rowwise().maxCoeff() - points.rowwise().minCoeff()) / 2;
  const Points<Dim> local = points.colwise() - middle;
  LocalApproximation<Dim> result =
      Run<Dim>(local, CornersOf<Dim>(points, tolerance, options), tolerance, options).Result();
  result.curve = Translated(result.curve, middle);
  return result;
}

template LocalApproximation<2> ApproximateLocally<2>(const Eigen::Matrix2Xd&,
                                                     double,
                                                     const LocalApproximationOptions&);
template LocalApproximation<3> ApproximateLocally<3>(const Eigen::Matrix3Xd&,
                                                     double,
                                                     const LocalApproximationOptions&);

}  // namespace batten
