// SPDX-License-Identifier: MIT
#include "geometry/construction/cubic_approximation.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "geometry/construction/spline_interpolation.h"
#include "geometry/numeric/construction_checks.h"

namespace batten::internal {
namespace {

constexpr int kDegree = 3;
constexpr int kInside = 11;            // places looked at in an interval
constexpr std::size_t kMost = 20'000;  // intervals: beyond that no CAD system reads the result
constexpr double kAim = 0.9;           // of the tolerance: what places between may be worse by

// From a break to the next, with the function at its ends and inside.
struct Interval {
  FunctionBreak begin;
  double end;
  ValueAndSlope at_begin, at_end;
  Eigen::MatrixXd inside;  // a column for each place
};

double PlaceInside(double begin, double end, int k) {
  return begin + (end - begin) * (k + 1) / (kInside + 1);
}

Interval IntervalOf(const VectorFunction& function, const FunctionBreak& begin, double end) {
  Interval interval{begin, end, function(begin.at, Side::kAbove), function(end, Side::kBelow), {}};
  interval.inside.resize(interval.at_begin.value.size(), kInside);
  for (int k = 0; k < kInside; ++k) {
    interval.inside.col(k) = function(PlaceInside(begin.at, end, k), Side::kAbove).value;
  }
  return interval;
}

SplineBasis BasisOver(const std::vector<Interval>& intervals) {
  std::vector<double> knots(kDegree + 1, intervals.front().begin.at);
  for (std::size_t k = 1; k < intervals.size(); ++k) {
    knots.insert(knots.end(), kDegree - intervals[k].begin.continuity, intervals[k].begin.at);
  }
  knots.insert(knots.end(), kDegree + 1, intervals.back().end);
  return SplineBasis(kDegree, std::move(knots));
}

Eigen::MatrixXd CompleteSpline(const SplineBasis& basis, const std::vector<Interval>& intervals) {
  std::vector<SplineDatum> data;
  Eigen::MatrixXd values(intervals.front().inside.rows(), basis.size());
  const auto add = [&](const SplineDatum& datum, const Eigen::VectorXd& value) {
    values.col(static_cast<Eigen::Index>(data.size())) = value;
    data.push_back(datum);
  };
  for (std::size_t k = 0; k < intervals.size(); ++k) {
    const Interval& interval = intervals[k];
    const double at = interval.begin.at;
    if (k > 0 && interval.begin.continuity == 0) add({at, 1, true}, intervals[k - 1].at_end.slope);
    add({at}, interval.at_begin.value);
    if (k == 0 || interval.begin.continuity < 2) add({at, 1}, interval.at_begin.slope);
  }
  const Interval& last = intervals.back();
  add({last.end, 1}, last.at_end.slope);
  add({last.end}, last.at_end.value);
  return Interpolated(basis, data, values);
}

double ErrorOn(const Interval& interval,
               const SplineBasis& basis,
               const Eigen::MatrixXd& coefficients,
               const std::function<double(const Eigen::VectorXd&)>& measure) {
  double values[kDegree + 1], error = 0;
  for (int k = 0; k < kInside; ++k) {
    const double at = PlaceInside(interval.begin.at, interval.end, k);
    const int span = basis.Span(at);
    basis.Values(span, at, values);
    const Eigen::VectorXd spline = coefficients.middleCols(span - kDegree, kDegree + 1) *
                                   Eigen::Map<const Eigen::Vector4d>(values);
    error = std::max(error, measure(spline - interval.inside.col(k)));
  }
  return error;
}

// Into how many parts: the error falls with the fourth power of the length.
int PartsFor(double error, double tolerance) {
  return static_cast<int>(std::clamp(std::ceil(std::pow(error / tolerance, 0.25)), 2.0, 8.0));
}

}  // namespace

CubicApproximation ApproximateByCubic(const VectorFunction& function,
                                      const std::vector<FunctionBreak>& breaks,
                                      const std::function<double(const Eigen::VectorXd&)>& measure,
                                      double tolerance,
                                      const char* what) {
  std::vector<Interval> intervals;
  for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
    intervals.push_back(IntervalOf(function, breaks[k], breaks[k + 1].at));
  }
  for (;;) {
    SplineBasis basis = BasisOver(intervals);
    Eigen::MatrixXd coefficients = CompleteSpline(basis, intervals);
    double error = 0;
    std::vector<Interval> parted;
    for (Interval& interval : intervals) {
      const double here = ErrorOn(interval, basis, coefficients, measure);
      error = std::max(error, here);
      if (!(here > kAim * tolerance)) {
        parted.push_back(std::move(interval));
        continue;
      }
      const int parts = PartsFor(here, kAim * tolerance);
      const double begin = interval.begin.at, end = interval.end;
      const auto place = [&](int k) {
        return k == parts ? end : begin + (end - begin) * k / parts;
      };
      for (int k = 0; k < parts; ++k) {
        const FunctionBreak from{place(k), k == 0 ? interval.begin.continuity : 2};
        parted.push_back(IntervalOf(function, from, place(k + 1)));
      }
    }
    if (!(error > kAim * tolerance)) {
      return {std::move(basis), std::move(coefficients), error};
    }
    RequireThat(parted.size() <= kMost,
                what,
                "the tolerance " + NumberText(tolerance) + " is not reached with " +
                    std::to_string(kMost) + " spans; reached is " + RoundedText(error));
    intervals = std::move(parted);
  }
}

}  // namespace batten::internal
