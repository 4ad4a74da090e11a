// SPDX-License-Identifier: MIT
#include "batten/fitting/curve_components.h"

#include <algorithm>
#include <cstdio>
#include <stdexcept>
#include <utility>

#include "batten/fitting/statistics.h"
#include "fitting/core/mask_indices.h"
#include "fitting/ordering/curve_closure.h"
#include "fitting/ordering/curve_sequence.h"
#include "fitting/ordering/sequence_outliers.h"

namespace batten {
using namespace internal;
namespace {

constexpr size_t kFewestForLoneEnds = 50, kMostLone = 3;
constexpr double kLoneInSteps = 20;
constexpr double kMostOutliers = 0.5;  // share of the points: above it they are not outliers

std::string Length(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

// Of a gap that is closed: what is to be said where it is wide.
std::string ToldGap(double gap, double spacing) {
  constexpr double kWideInSpacings = 5;
  if (gap <= kWideInSpacings * spacing) return "";
  return "the ends of the points are " + Length(gap) + " apart: the curve bridges that gap";
}

// Where there are outliers, marks also points at the ends that a step far longer than the others
// separates.
PointMask WithLoneEnds(const Eigen::Matrix3Xd& points, PointMask sequence_outliers) {
  if (!sequence_outliers.any()) return sequence_outliers;
  const std::vector<Eigen::Index> kept = IndicesOf(!sequence_outliers);
  if (kept.size() < kFewestForLoneEnds) return sequence_outliers;
  const auto step = [&](size_t k) {
    return (points.col(kept[k + 1]) - points.col(kept[k])).norm();
  };
  std::vector<double> steps;
  for (size_t k = 0; k + 1 < kept.size(); ++k) steps.push_back(step(k));
  const double most = kLoneInSteps * Median(std::move(steps));
  const auto leave = [&](size_t k) { sequence_outliers[kept[k]] = true; };
  for (size_t k = kMostLone; k-- > 0;) {
    if (step(k) <= most) continue;
    for (size_t i = 0; i <= k; ++i) leave(i);
    break;
  }
  for (size_t k = kMostLone; k-- > 0;) {
    const size_t last = kept.size() - 1;
    if (step(last - 1 - k) <= most) continue;
    for (size_t i = 0; i <= k; ++i) leave(last - i);
    break;
  }
  return sequence_outliers;
}

CurveComponents InOrder(const PointCloud& cloud, const ArrangeOptions& options) {
  const bool given = options.parameterization == CurveParameterization::kGiven;
  if (given && options.closed == ClosedChoice::kYes) {
    throw std::invalid_argument(
        "given parameters do not say how long the way from the last point to the first is: a "
        "closed curve needs parameters from the points");
  }
  CurveComponents result;
  result.sequence_outliers = PointMask::Constant(cloud.size(), false);
  OrderOptions order;
  order.parameterization = options.parameterization;
  order.degree = options.degree;
  order.keep_order = options.order == PointOrder::kGiven;
  if (!given) {
    if (options.find_outliers) {
      const PointMask sequence_outliers =
          FindSequenceOutliers(cloud.points(), options.closed == ClosedChoice::kYes);
      if (static_cast<double>(sequence_outliers.count()) <=
          kMostOutliers * static_cast<double>(cloud.size()))
        result.sequence_outliers = WithLoneEnds(cloud.points(), sequence_outliers);
    }
    order.left_out = result.sequence_outliers;
    OrderedPoints open = OrderPoints(cloud, order);
    if (options.closed == ClosedChoice::kNo) {
      result.curves.push_back(std::move(open));
      return result;
    }
    const bool meets = JudgeEnds(open.cloud.points(), open.noise).closed;
    order.closed = meets || options.closed == ClosedChoice::kYes;
    if (!order.closed) {
      result.curves.push_back(std::move(open));
      return result;
    }
    if (!meets) result.of_ends = {ToldGap(open.gap, open.spacing)};
  }
  result.curves.push_back(OrderPoints(cloud, order));
  return result;
}

CurveComponents ByNeighbourhood(const PointCloud& cloud,
                                const ArrangeOptions& options,
                                ThreadPool& pool,
                                const Progress& progress) {
  if (options.parameterization == CurveParameterization::kGiven) {
    throw std::invalid_argument("given parameters are an order of the points already");
  }
  const CurveOrder found = OrderAlongCurves(cloud, {options.closed}, pool, progress);
  CurveComponents result;
  result.unordered = true;
  result.sequence_outliers = PointMask::Constant(cloud.size(), false);
  for (const Eigen::Index k : found.outliers) result.sequence_outliers[k] = true;
  constexpr double kMostLeftOut = 0.75;
  if (static_cast<double>(found.outliers.size()) >
      kMostLeftOut * static_cast<double>(cloud.size())) {
    throw std::invalid_argument(
        "no curve is found in the points: " + std::to_string(found.outliers.size()) + " of " +
        std::to_string(cloud.size()) +
        " lie far from every line of neighbours, as points of a surface do: fit a surface to them");
  }
  if (!found.outliers.empty()) {
    result.warnings.push_back(std::to_string(found.outliers.size()) +
                              " points lie far from every curve and are left out");
  }
  for (const CurvePath& path : found.paths) {
    result.curves.push_back(FollowPath(cloud, path));
    result.lengths.push_back(path.length);
    result.of_ends.push_back(path.closed ? ToldGap(path.gap, std::max(path.spacing, 2 * path.noise))
                                         : "");
  }
  return result;
}

}  // namespace

CurveComponents ArrangeCurves(const PointCloud& cloud,
                              const ArrangeOptions& options,
                              ThreadPool& pool,
                              const Progress& progress) {
  if (cloud.size() == 0) throw std::invalid_argument("the cloud holds no points");
  const bool follow = options.order == PointOrder::kGiven ||
                      options.parameterization == CurveParameterization::kGiven ||
                      (options.order == PointOrder::kAuto && FollowsCurve(cloud.points()));
  return follow && options.order != PointOrder::kUnordered
             ? InOrder(cloud, options)
             : ByNeighbourhood(cloud, options, pool, progress);
}

}  // namespace batten
