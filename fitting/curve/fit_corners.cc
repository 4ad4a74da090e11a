// SPDX-License-Identifier: MIT
#include "fitting/curve/fit_corners.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "fitting/core/rounding.h"
#include "fitting/core/rules.h"
#include "fitting/corners/curve_corners.h"
#include "fitting/ordering/row_means.h"

namespace batten::internal {
namespace {

constexpr Eigen::Index kFewPoints = 100;

class Corners {
 public:
  explicit Corners(CurveTask& task)
      : task_(task),
        ordered_(task.ordered),
        degree_(task.options.degree),
        most_(task.options.control_points.value_or(task.options.max_control_points)),
        period_(ordered_.upper - ordered_.lower),
        increasing_(ordered_.parameters.begin(), ordered_.parameters.end()) {
    std::sort(increasing_.begin(), increasing_.end());
  }

  void Find() {
    const RowMeans row = IncreasingRow(ordered_.cloud.points(), ordered_.lengths);
    if (row.parameters.size() < 3) return;
    CornerOptions options;
    task_.sought_as_exact = row.parameters.size() < kFewPoints;
    options.noise = task_.sought_as_exact ? 0 : ordered_.noise;
    options.closed = ordered_.closed;
    options.period = ordered_.length;
    std::vector<CurveCorner> corners = FindCorners(row.points, row.parameters, options);
    std::stable_sort(corners.begin(),
                     corners.end(),
                     [](const CurveCorner& a, const CurveCorner& b) { return a.angle > b.angle; });
    for (const CurveCorner& corner : corners) Keep(ParameterAt(corner.parameter));
    if (task_.near_exact) Anchor();
    if (ordered_.closed && !task_.corners.empty()) MoveSeam();
  }

 private:
  // The parameter at an arc length, linear between points.
  double ParameterAt(double length) const {
    const Eigen::VectorXd &lengths = ordered_.lengths, &u = ordered_.parameters;
    if (ordered_.closed) length -= ordered_.length * std::floor(length / ordered_.length);
    if (ordered_.closed && length < lengths[0]) {  // between the last point and the first
      const Eigen::Index n = lengths.size() - 1;
      const double before = lengths[n] - ordered_.length,
                   share = (length - before) / (lengths[0] - before);
      const double at = u[n] - period_ + share * (u[0] - u[n] + period_);
      return Inside(at < ordered_.lower ? at + period_ : at);
    }
    const auto above = std::upper_bound(lengths.begin(), lengths.end(), length);
    const Eigen::Index k = std::max<Eigen::Index>(1, above - lengths.begin());
    const bool last = k == lengths.size();
    if (last && !ordered_.closed) return ordered_.upper;
    const double l0 = lengths[k - 1], l1 = last ? ordered_.length : lengths[k];
    const double u0 = u[k - 1], u1 = last ? ordered_.upper : u[k];
    return Inside(l1 > l0 ? u0 + (u1 - u0) * ((length - l0) / (l1 - l0)) : u0);
  }

  double Inside(double parameter) const {
    const bool inside = parameter >= ordered_.lower && parameter < ordered_.upper;
    return ordered_.closed && !inside ? ordered_.lower : parameter;
  }

  void Keep(double corner) {
    const double slack = kRelativelyEqual * period_;
    if (!ordered_.closed && (corner - ordered_.lower <= slack || ordered_.upper - corner <= slack))
      return;
    std::vector<double>& kept = task_.corners;
    for (const double other : kept) {
      const double low = std::min(corner, other), high = std::max(corner, other);
      if (high - low <= slack || (ordered_.closed && low + period_ - high <= slack)) return;
      if (PointsBetween(low, high) <= degree_) return;
      if (ordered_.closed && PointsBetween(high, low + period_) <= degree_) return;
    }
    std::vector<double> sorted = kept;
    sorted.push_back(corner);
    std::sort(sorted.begin(), sorted.end());
    const SpanLayout layout =
        SpanLayout::Equal(degree_, 1, ordered_.lower, ordered_.upper, sorted, ordered_.closed);
    if (layout.control_points() <= most_) kept.push_back(corner);
  }

  // Points from one parameter to another, a piece's own: more than the degree fix it. Around a
  // closed curve the upper one may be a period on.
  Eigen::Index PointsBetween(double low, double high) const {
    const double slack = kRelativelyEqual * period_;
    const auto count = [&](double from, double to) {
      const auto first = std::lower_bound(increasing_.begin(), increasing_.end(), from),
                 behind = std::upper_bound(first, increasing_.end(), to);
      return behind - first;
    };
    return count(low - slack, high + slack) +
           (ordered_.closed ? count(low - slack - period_, high + slack - period_) : 0);
  }

  void Anchor() {
    for (Eigen::Index k = 0; k < ordered_.parameters.size(); ++k) {
      for (const double corner : task_.corners) {
        if (std::abs(ordered_.parameters[k] - corner) <= kRelativelyEqual * period_)
          task_.anchored.push_back(k);
      }
    }
  }

  // The seam, at a corner, needs no break of its own.
  void MoveSeam() {
    const double seam = task_.corners.front();
    const auto moved = [&](double parameter) {
      const double from_seam = parameter - seam;
      return Inside(ordered_.lower + (from_seam < 0 ? from_seam + period_ : from_seam));
    };
    for (double& corner : task_.corners) corner = moved(corner);
    for (double& parameter : task_.given) parameter = moved(parameter);
    Eigen::Matrix2Xd parameters = task_.problem.data().parameters;
    parameters.row(0) = task_.given;
    task_.problem = task_.problem.WithParameters(std::move(parameters));
  }

  CurveTask& task_;
  const OrderedPoints& ordered_;
  int degree_, most_;
  double period_;
  std::vector<double> increasing_;  // the points' parameters
};

}  // namespace

void FindCorners(CurveTask& task) {
  const CurveFitOptions& options = task.options;
  if (!Acts(Rule::kCorners) || !options.corners || options.degree < 2 || !task.by_feet()) return;
  Corners(task).Find();
}

}  // namespace batten::internal
