// SPDX-License-Identifier: MIT
#include "fitting/outline/outline_edges.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "batten/geometry/bounding_box.h"
#include "fitting/core/rounding.h"
#include "geometry/editing/loop_nesting.h"
#include "geometry/numeric/constants.h"

namespace batten::internal {
namespace {

constexpr double kDeepest = 4;              // depth; a deeper border does not fill the rectangle
constexpr double kFarthestFromEdges = 3.5;  // largest distance of a stretch put on an edge
constexpr double kMeanDepth = 1.5;
constexpr size_t kEdgeWindow = 12;  // samples over which the depth is averaged
constexpr double kWindowDepth = 2;

double Depth(const Eigen::Vector2d& place, int edge, const Eigen::Vector2d& sides) {
  const int axis = edge / 2;
  return edge % 2 == 0 ? place[axis] : sides[axis] - place[axis];
}

double EdgeAt(int edge, const Eigen::Vector2d& sides) {
  return edge % 2 == 0 ? 0.0 : sides[edge / 2];
}

// The greatest mean of so many depths in a row: a border that bends away is no edge.
double DeepestWindow(const std::vector<double>& depths) {
  double sum = 0, deepest = 0;
  for (size_t k = 0; k < depths.size(); ++k) {
    sum += depths[k];
    if (k >= kEdgeWindow) sum -= depths[k - kEdgeWindow];
    if (k + 1 >= kEdgeWindow) deepest = std::max(deepest, sum / static_cast<double>(kEdgeWindow));
  }
  return deepest;
}

// Whether the border runs along an edge as the rectangle's own does, the covered region on its
// left: the inner side of a thin strip beside the edge runs the other way.
bool RunsAlong(const Eigen::Vector2d& way, int edge) {
  const bool forwards = edge == 1 || edge == 2;  // right, lower
  return (way[1 - edge / 2] > 0) == forwards;
}

// The index of the edge along which samples first … last run, −1 if none.
int EdgeOf(const OutlineLoop& loop,
           size_t first,
           size_t count,
           const LocalSpacing& spacing,
           const Eigen::Vector2d& sides) {
  const Eigen::Vector2d way =
      loop[(first + count - 1) % loop.size()].measured - loop[first % loop.size()].measured;
  for (int edge = 0; edge < 4; ++edge) {
    if (!RunsAlong(way, edge)) continue;
    std::vector<double> depths;  // of local spacings
    for (size_t k = 0; k < count; ++k) {
      const Eigen::Vector2d& at = loop[(first + k) % loop.size()].measured;
      depths.push_back(Depth(at, edge, sides) / spacing.At(at));
    }
    const double sum = std::accumulate(depths.begin(), depths.end(), 0.0);
    if (*std::ranges::max_element(depths) < kFarthestFromEdges &&
        sum < kMeanDepth * static_cast<double>(count) && DeepestWindow(depths) < kWindowDepth) {
      return edge;
    }
  }
  return -1;
}

}  // namespace

bool FillsRectangle(const OutlineLoop& outer,
                    const LocalSpacing& spacing,
                    const Eigen::Vector2d& sides) {
  Eigen::Vector2d low = sides, high = Eigen::Vector2d::Zero();
  for (const OutlineSample& sample : outer) {
    double depth = sides.maxCoeff();
    for (int edge = 0; edge < 4; ++edge)
      depth = std::min(depth, Depth(sample.measured, edge, sides));
    if (depth > kDeepest && depth > kDeepest * spacing.At(sample.measured)) return false;
    low = low.cwiseMin(sample.measured);
    high = high.cwiseMax(sample.measured);
  }
  const Eigen::Array2d inner = (sides.array() - 4 * kDeepest).max(0.0);
  return (low.array() <= 2 * kDeepest).all() &&
         (high.array() >= sides.array() - 2 * kDeepest).all() &&
         PolygonArea(PolygonOf(outer)) >= inner.prod();
}

void PutOnEdges(OutlineLoop& loop,
                const std::vector<OutlinePin>& pins,
                const LocalSpacing& spacing,
                const Eigen::Vector2d& sides) {
  const size_t n = loop.size();
  const auto first = static_cast<size_t>(
      std::find_if(loop.begin(), loop.end(), [](const auto& s) { return s.corner; }) -
      loop.begin());
  if (first == n) return;
  OutlineLoop result;
  std::vector<std::pair<size_t, int>> onto;  // corners of the result and the edges they go on
  for (size_t k = 0; k < n;) {
    const size_t start = first + k;
    size_t end = k + 1;
    while (end < n && !loop[(first + end) % n].corner) ++end;
    OutlineSample corner = loop[start % n];
    const auto pinned = [&] {
      for (size_t i = k; i <= end; ++i)
        for (const OutlinePin& pin : pins)
          if (pin.Holds(loop[(first + i) % n])) return true;
      return false;
    };
    int edge = corner.along_cut ? -1 : EdgeOf(loop, start, end - k + 1, spacing, sides);
    if (edge >= 0 && pinned()) edge = -1;
    if (edge >= 0) {
      corner.along_cut = true;
      onto.emplace_back(result.size(), edge);
    }
    result.push_back(corner);
    if (!corner.along_cut)
      for (size_t i = k + 1; i < end; ++i) result.push_back(loop[(first + i) % n]);
    k = end;
  }
  for (const auto& [corner, edge] : onto) {
    result[corner].place[edge / 2] = EdgeAt(edge, sides);
    size_t next = corner + 1;
    if (next == result.size()) next = 0;
    result[next].place[edge / 2] = EdgeAt(edge, sides);
  }
  for (OutlineSample& sample : result)
    if (sample.corner) sample.place = sample.place.cwiseMax(0.0).cwiseMin(sides);
  // Both ends of a stretch may be the same corner of the rectangle now: it is none any more.
  loop.clear();
  for (size_t k = 0; k < result.size(); ++k) {
    const OutlineSample& next = result[(k + 1) % result.size()];
    if (result[k].along_cut && next.corner && result[k].place == next.place) continue;
    loop.push_back(result[k]);
  }
}

void FixOnEdges(OutlineSpline& spline) {
  for (size_t c = 0; c < spline.corners.size(); ++c) {
    const int span = spline.basis.Span(spline.corners[c]);
    if (spline.pinned[c] != 0)
      for (int i = 0; i <= kOutlineDegree; ++i)
        spline.fixed[spline.unknown[span - kOutlineDegree + i]] = {true, true};
    if (spline.straight[c] == 0) continue;
    const int first = spline.unknown[span - kOutlineDegree], last = spline.unknown[span];
    for (int i = 1; i < kOutlineDegree; ++i)
      spline.fixed[spline.unknown[span - kOutlineDegree + i]] = {true, true};
    const Eigen::Vector2d way = (spline.points.col(last) - spline.points.col(first)).cwiseAbs();
    const int axis = way[0] < way[1] ? 0 : 1;
    spline.fixed[first][axis] = spline.fixed[last][axis] = true;
  }
}

void MatchSeam(std::vector<OutlineLoop>& loops, int axis, double period) {
  std::vector<double*> heights[2];
  for (OutlineLoop& loop : loops)
    for (OutlineSample& sample : loop)
      if (sample.corner && (sample.place[axis] == 0 || sample.place[axis] == period))
        heights[sample.place[axis] != 0].push_back(&sample.place[1 - axis]);
  if (heights[0].size() != heights[1].size()) return;
  for (auto& side : heights)
    std::sort(side.begin(), side.end(), [](const double* a, const double* b) { return *a < *b; });
  for (size_t k = 0; k < heights[0].size(); ++k)
    *heights[0][k] = *heights[1][k] = (*heights[0][k] + *heights[1][k]) / 2;
}

bool MatchSeams(std::vector<OutlineSpline>& splines,
                const OutlineOptions& options,
                const Eigen::Vector2d& sides) {
  bool moved = false;
  for (int axis = 0; axis < 2; ++axis) {
    if (!(axis == 0 ? options.periodic_u : options.periodic_v)) continue;
    struct End {
      double height, outward;
      OutlineSpline* spline;
      int column;
    };
    std::vector<End> ends[2];
    for (OutlineSpline& spline : splines) {
      for (size_t c = 0; c < spline.corners.size(); ++c) {
        if (spline.straight[c] == 0) continue;
        const int span = spline.basis.Span(spline.corners[c]);
        const int first = spline.unknown[span - kOutlineDegree], last = spline.unknown[span];
        const double at = spline.points(axis, first);
        if (at != spline.points(axis, last) || (at != 0 && at != sides[axis])) continue;
        const double a = spline.points(1 - axis, first), b = spline.points(1 - axis, last);
        ends[at != 0].push_back({a, a - b, &spline, first});
        ends[at != 0].push_back({b, b - a, &spline, last});
      }
    }
    if (ends[0].size() != ends[1].size()) continue;
    for (auto& side : ends)
      std::stable_sort(
          side.begin(), side.end(), [](const End& a, const End& b) { return a.height < b.height; });
    for (size_t k = 0; k < ends[0].size(); ++k) {
      const End &a = ends[0][k], &b = ends[1][k];
      const double outer =
          a.outward > 0 ? std::max(a.height, b.height) : std::min(a.height, b.height);
      for (const End& end : {a, b}) {
        end.spline->points(1 - axis, end.column) = outer;
        end.spline->fixed[end.column] = {true, true};
      }
      moved = true;
    }
  }
  return moved;
}

namespace {

// The box of one span, by the control points that make it, less what rounding may have added: an
// end on a side is not beyond it.
Eigen::AlignedBox2d BoxOf(const OutlineSpline& spline, int span) {
  const int p = spline.basis.degree(), first = span - p;
  const auto knots = spline.basis.knots().begin() + first;
  Eigen::Matrix2Xd points(2, p + 1);
  for (int i = 0; i <= p; ++i) points.col(i) = spline.points.col(spline.unknown[first + i]);
  const double rounding = 32 * kEpsilon * points.cwiseAbs().maxCoeff();
  Eigen::AlignedBox2d box =
      BoundingBox(NurbsCurve<2>(SplineBasis(p, {knots, knots + 2 * p + 2}), std::move(points)));
  box.min().array() += rounding;
  box.max().array() -= rounding;
  return box;
}

// The greatest value of `sign` times a coordinate over all spans that may exceed the limit: a span
// lies in its control points' hull.
double GreatestBeyond(const OutlineSpline& spline, int axis, int sign, double limit) {
  double greatest = -std::numeric_limits<double>::infinity();
  for (const int span : spline.basis.Spans()) {
    const auto beyond = [&](int i) {
      return sign * spline.points(axis, spline.unknown[i]) > limit;
    };
    bool inside = true;
    for (int i = span - spline.basis.degree(); i <= span; ++i) inside = inside && !beyond(i);
    if (inside) continue;
    const Eigen::AlignedBox2d box = BoxOf(spline, span);
    greatest = std::max(greatest, sign > 0 ? box.max()[axis] : -box.min()[axis]);
  }
  return greatest;
}

// Control points of the parts far outside.
void ClampSpans(OutlineSpline& spline, int axis, double side, double trifle) {
  for (const int span : spline.basis.Spans()) {
    bool inside = true;  // all of the span's hull
    for (int i = span - spline.basis.degree(); i <= span; ++i) {
      const double x = spline.points(axis, spline.unknown[i]);
      inside = inside && x >= 0 && x <= side;
    }
    if (inside) continue;
    const Eigen::AlignedBox2d box = BoxOf(spline, span);
    if (box.min()[axis] >= -trifle && box.max()[axis] <= side + trifle) continue;
    for (int i = span - spline.basis.degree(); i <= span; ++i) {
      double& x = spline.points(axis, spline.unknown[i]);
      x = std::clamp(x, 0.0, side);
    }
  }
}

}  // namespace

void KeepInRectangle(OutlineSpline& spline, const Eigen::Vector2d& sides) {
  constexpr int kRounds = 6;
  constexpr double kTrifle = 0.5;
  for (int axis = 0; axis < 2; ++axis) {
    ClampSpans(spline, axis, sides[axis], kTrifle);
    for (int round = 0; round < kRounds; ++round) {
      const double low = -GreatestBeyond(spline, axis, -1, 0),
                   high = GreatestBeyond(spline, axis, 1, sides[axis]);
      if (low >= 0 && high <= sides[axis]) break;
      const double from = low < 0 ? low - kRelativelyEqual : 0;
      const double to = high > sides[axis] ? high + kRelativelyEqual : sides[axis];
      for (Eigen::Index i = 0; i < spline.points.cols(); ++i) {
        double& x = spline.points(axis, i);
        if (!spline.fixed[i][axis]) x = sides[axis] * ((x - from) / (to - from));
      }
    }
    if (-GreatestBeyond(spline, axis, -1, 0) < 0 ||
        GreatestBeyond(spline, axis, 1, sides[axis]) > sides[axis])
      ClampSpans(spline, axis, sides[axis], 0);
  }
}

OutlineSpline RectangleSpline(const Eigen::Vector2d& sides) {
  OutlineLoop loop;
  for (const auto& [u, v] :
       {std::pair(0.0, 0.0), {sides[0], 0.0}, {sides[0], sides[1]}, {0.0, sides[1]}}) {
    OutlineSample sample;
    sample.place = sample.measured = sample.border = Eigen::Vector2d(u, v);
    sample.corner = sample.along_cut = true;
    loop.push_back(sample);
  }
  return SmoothedOutline(loop, 0);
}

}  // namespace batten::internal
