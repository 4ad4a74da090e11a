// SPDX-License-Identifier: MIT
#include "batten/fitting/curve_arrangement.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <utility>

#include "batten/fitting/curve_closure.h"
#include "batten/fitting/curve_sequence.h"
#include "batten/fitting/curve_strays.h"

namespace batten {
namespace {

constexpr double kMostStrays = 0.5;  // of the points: more are no strays

std::string Length(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

// The gap that was closed because the user said so.
void TellGap(double gap, double spacing, CurveArrangement& result) {
  constexpr double kWideInSpacings = 3;
  if (gap <= kWideInSpacings * spacing) return;
  result.warnings.push_back("the ends of the points are " + Length(gap) +
                            " apart: the curve bridges that gap");
}

CurveArrangement InOrder(const PointCloud& cloud, const ArrangeOptions& options) {
  const bool given = options.parameterization == CurveParameterization::kGiven;
  if (given && options.closed == ClosedChoice::kYes) {
    throw std::invalid_argument(
        "given parameters do not say how long the way from the last point to the first is: a "
        "closed curve needs parameters from the points");
  }
  CurveArrangement result;
  result.strays = PointMask::Constant(cloud.size(), false);
  OrderOptions order;
  order.parameterization = options.parameterization;
  order.degree = options.degree;
  order.keep_order = options.order == PointOrder::kGiven;
  if (!given) {
    if (options.find_strays) {
      const PointMask strays = FindStrays(cloud.points(), options.closed == ClosedChoice::kYes);
      if (static_cast<double>(strays.count()) <= kMostStrays * static_cast<double>(cloud.size()))
        result.strays = strays;
    }
    order.left_out = result.strays;
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
    if (!meets) TellGap(open.gap, open.spacing, result);
  }
  result.curves.push_back(OrderPoints(cloud, order));
  return result;
}

CurveArrangement ByNeighbourhood(const PointCloud& cloud,
                                 const ArrangeOptions& options,
                                 ThreadPool& pool,
                                 const Progress& progress) {
  if (options.parameterization == CurveParameterization::kGiven) {
    throw std::invalid_argument("given parameters are an order of the points already");
  }
  const CurveOrder found = OrderAlongCurves(cloud, {options.closed}, pool, progress);
  CurveArrangement result;
  result.unordered = true;
  result.strays = PointMask::Constant(cloud.size(), false);
  for (const Eigen::Index k : found.outliers) result.strays[k] = true;
  for (const CurvePath& path : found.paths) {
    result.curves.push_back(FollowPath(cloud, path));
    result.lengths.push_back(path.length);
    if (path.closed && options.closed == ClosedChoice::kYes)
      TellGap(path.gap, path.spacing, result);
  }
  return result;
}

}  // namespace

CurveArrangement ArrangeCurves(const PointCloud& cloud,
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
