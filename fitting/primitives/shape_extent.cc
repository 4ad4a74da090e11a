// SPDX-License-Identifier: MIT
#include "fitting/primitives/shape_extent.h"

#include <algorithm>
#include <cmath>

#include "batten/fitting/statistics.h"
#include "batten/geometry/make_curve.h"
#include "fitting/primitives/angle_extent.h"
#include "geometry/numeric/constants.h"

namespace batten::internal {
namespace {

// The places for which some window of successive neighbours is not much wider than usual; `period`
// is infinite along a line.
std::vector<double> WithNeighbours(const std::vector<double>& places, double period) {
  constexpr int kFewest = 16, kNeighbours = 5;
  constexpr double kLonely = 6;  // median window widths: wider windows hold isolated places
  const int count = static_cast<int>(places.size());
  if (count < kFewest) return places;
  std::vector<double> sorted = places;
  std::sort(sorted.begin(), sorted.end());
  const bool round = std::isfinite(period);
  const int windows = round ? count : count - kNeighbours + 1;
  std::vector<double> width(static_cast<size_t>(windows));
  for (int i = 0; i < windows; ++i) {
    const int last = i + kNeighbours - 1;
    width[i] = (last < count ? sorted[last] : sorted[last - count] + period) - sorted[i];
  }
  const double usual = Median(width);
  if (!(usual > 0)) return places;
  std::vector<double> kept;
  for (const double place : places) {
    const int at =
        static_cast<int>(std::lower_bound(sorted.begin(), sorted.end(), place) - sorted.begin());
    for (int i = at - kNeighbours + 1; i <= at; ++i) {
      if (!round && (i < 0 || i >= windows)) continue;
      if (width[(i + count) % count] > kLonely * usual) continue;
      kept.push_back(place);
      break;
    }
  }
  return kept.empty() ? places : kept;
}

}  // namespace

Extent ExtentOnLine(const std::vector<double>& places) {
  const auto [low, high] = std::minmax_element(places.begin(), places.end());
  return {*low, *high - *low, false};
}

Extent ExtentOnCircle(const std::vector<double>& angles) {
  std::vector<double> sorted = angles;
  std::sort(sorted.begin(), sorted.end());
  const size_t count = sorted.size();
  double widest = sorted.front() + kTurn - sorted.back(), start = sorted.front();
  for (size_t k = 1; k < count; ++k) {
    const double gap = sorted[k] - sorted[k - 1];
    if (gap > widest) {
      widest = gap;
      start = sorted[k];
    }
  }
  if (AllRound(widest, std::ssize(angles))) return {angles.front(), kTurn, true};
  return {start, kTurn - widest, false};
}

std::vector<double> Supported(const std::vector<double>& places) {
  return WithNeighbours(places, HUGE_VAL);
}

std::vector<double> SupportedAngles(const std::vector<double>& angles) {
  return WithNeighbours(angles, kTurn);
}

template <int Dim>
NurbsCurve<Dim> SegmentOf(const FittedLine& line, const Extent& extent) {
  using Point = typename NurbsCurve<Dim>::Point;
  const double end = extent.start + extent.length;
  return MakeLine<Dim>(Point((line.point + extent.start * line.direction).template head<Dim>()),
                       Point((line.point + end * line.direction).template head<Dim>()));
}

template <int Dim>
NurbsCurve<Dim> ArcOf(const FittedCircle& circle, const Extent& extent) {
  return MakeFlatArc<Dim>(circle.point.template head<Dim>().eval(),
                          circle.outward.template head<Dim>().eval(),
                          circle.tangent.template head<Dim>().eval(),
                          circle.curvature,
                          {extent.start, extent.full ? kTurn : extent.length});
}

template NurbsCurve<2> SegmentOf<2>(const FittedLine& line, const Extent& extent);
template NurbsCurve<3> SegmentOf<3>(const FittedLine& line, const Extent& extent);
template NurbsCurve<2> ArcOf<2>(const FittedCircle& circle, const Extent& extent);
template NurbsCurve<3> ArcOf<3>(const FittedCircle& circle, const Extent& extent);

}  // namespace batten::internal
