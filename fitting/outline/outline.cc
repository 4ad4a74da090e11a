// SPDX-License-Identifier: MIT
#include "batten/fitting/outline.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "fitting/neighbours/local_spacing.h"
#include "fitting/outline/alpha_shape.h"
#include "fitting/outline/outline_containment.h"
#include "fitting/outline/outline_edges.h"
#include "fitting/outline/outline_loop.h"
#include "fitting/outline/outline_polygon.h"
#include "fitting/outline/outline_spline.h"
#include "fitting/outline/periodic_copies.h"
#include "geometry/numeric/number_text.h"

namespace batten {
using namespace internal;
namespace {

using Index = Eigen::Index;

// Lengths are in spacings, areas in squared spacings.
constexpr double kRadius = 2.5;     // of the alpha shape
constexpr double kLeastArea = 36;   // smaller holes and parts are ignored
constexpr double kOutwards = 0.43;  // how far random points' ragged border lies inside, measured
constexpr double kExact = 1e-5;     // sagitta of the polygons that decide which points lie outside
constexpr double kFarthest = 1.5;   // points farther outside are not contained

void Check(const Eigen::Matrix2Xd& parameters, const OutlineOptions& options) {
  const auto positive = [](const char* name, double value) {
    if (!(value > 0) || !std::isfinite(value))
      throw std::invalid_argument(std::string("FindOutline: ") + name + " is " + NumberText(value) +
                                  ", not positive and finite");
  };
  positive("spacing", options.spacing);
  positive("length_u", options.length_u);
  positive("length_v", options.length_v);
  if (!(options.noise >= 0) || !std::isfinite(options.noise))
    throw std::invalid_argument("FindOutline: noise is " + NumberText(options.noise) +
                                ", not zero or positive and finite");
  if (parameters.cols() == 0) throw std::invalid_argument("FindOutline: parameters hold no point");
}

bool Contains(const OutlineLoop& loop, const Eigen::Vector2d& place) {
  bool inside = false;
  for (size_t i = 0, j = loop.size() - 1; i < loop.size(); j = i++) {
    const Eigen::Vector2d &a = loop[i].place, &b = loop[j].place;
    if ((a.y() > place.y()) != (b.y() > place.y()) &&
        place.x() < a.x() + (place.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
      inside = !inside;
  }
  return inside;
}

// The largest part with its holes, by falling area.
std::vector<OutlineLoop> LargestPart(std::vector<OutlineLoop> loops,
                                     const OutlineOptions& options,
                                     Outline& outline) {
  struct Sized {
    double area;
    OutlineLoop loop;
  };
  std::vector<Sized> sized;
  for (OutlineLoop& loop : loops) {
    const double area = AreaInSpace(PolygonOf(loop), options);
    if (std::abs(area) >= kLeastArea / 2) sized.push_back({area, std::move(loop)});
  }
  std::stable_sort(
      sized.begin(), sized.end(), [](const auto& a, const auto& b) { return a.area > b.area; });
  outline.parts = static_cast<int>(
      std::count_if(sized.begin(), sized.end(), [](const Sized& s) { return s.area > 0; }));
  std::vector<OutlineLoop> part;
  if (outline.parts == 0) return part;
  part.push_back(std::move(sized.front().loop));
  for (size_t k = sized.size(); k-- > 1;)
    if (sized[k].area < 0 && Contains(part.front(), sized[k].loop.front().place))
      part.push_back(std::move(sized[k].loop));
  return part;
}

OutlineCurve Rectangle(double u, double v) {
  Eigen::Matrix2Xd corners(2, 5);
  corners << 0, u, u, 0, 0, 0, 0, v, v, 0;
  const double around = 2 * (u + v);
  return {{SplineBasis(1, {0, 0, u, u + v, 2 * u + v, around, around}), corners},
          {0, u, u + v, 2 * u + v}};
}

std::string Counted(Index count, const std::string& what) {
  return std::to_string(count) + (count == 1 ? " point lies " : " points lie ") + what;
}

double AreaWithin(const OutlineSpline& spline) {
  const OutlinePolygon polygon({spline}, kFarthest);
  const auto& vertices = polygon.vertices().front();
  Eigen::Matrix2Xd places(2, static_cast<Index>(vertices.size()) - 1);
  for (Index i = 0; i < places.cols(); ++i) places.col(i) = vertices[i].place;
  return SignedArea(places);
}

class OutlineSearch {
 public:
  OutlineSearch(const Eigen::Matrix2Xd& parameters, const OutlineOptions& options, ThreadPool& pool)
      : options_(options),
        pool_(pool),
        points_(parameters / options.spacing),
        spacing_(points_),
        sides_(options.length_u / options.spacing, options.length_v / options.spacing) {}

  Outline Find() {
    Outline outline;
    std::vector<OutlineLoop> part = LargestPart(Borders(), options_, outline);
    if (part.empty()) {
      outline.warnings.push_back("the points cover no area larger than " + NumberText(kLeastArea) +
                                 " spacings squared: no outline");
      outline.fills = true;
      outline.parts = 0;
      return outline;
    }
    if (outline.parts > 1)
      outline.warnings.push_back("the points fall into " + std::to_string(outline.parts) +
                                 " parts: only the largest has an outline");
    const bool whole = FillsRectangle(part.front(), spacing_, sides_);
    outline.fills = whole && part.size() == 1;
    if (outline.fills) return outline;
    if (whole) {
      outline.loops.push_back(Rectangle(options_.length_u, options_.length_v));
      part.erase(part.begin());
    }
    for (OutlineLoop& loop : part) PutOnEdges(loop, sides_);
    Smooth(part, whole, outline);
    return outline;
  }

 private:
  // The covered region, cut at the seams.
  std::vector<OutlineLoop> Borders() const {
    const Eigen::Matrix2Xd ghosts = WithPeriodicCopies(points_, sides_, options_);
    const auto stretch = [&](const Eigen::Vector2d& place) { return spacing_.At(place); };
    std::vector<OutlineLoop> loops;
    for (const Eigen::Matrix2Xd& polygon : AlphaShape(ghosts, kRadius, stretch, pool_))
      if (std::abs(AreaInSpace(polygon, options_)) >= kLeastArea)
        loops.push_back(SampledOutline(polygon, kOutwards));
    for (int axis = 0; axis < 2; ++axis) {
      if (!(axis == 0 ? options_.periodic_u : options_.periodic_v)) continue;
      loops = CutOutlines(loops, axis, 1, 0);
      loops = CutOutlines(loops, axis, -1, sides_[axis]);
      MatchSeam(loops, axis, sides_[axis]);
    }
    return loops;
  }

  void Smooth(const std::vector<OutlineLoop>& part, bool whole, Outline& outline) const {
    std::vector<OutlineSpline> splines;
    for (const OutlineLoop& loop : part) {
      splines.push_back(SmoothedOutline(loop, options_.noise / options_.spacing));
      FixOnEdges(splines.back());
    }
    EnforceContainment(points_, sides_, kFarthest, splines, pool_);
    if (MatchSeams(splines, options_, sides_))
      EnforceContainment(points_, sides_, kFarthest, splines, pool_);
    for (OutlineSpline& spline : splines) KeepInRectangle(spline, sides_);
    if (const Index outside = Outside(splines, whole); outside > 0)
      outline.warnings.push_back(Counted(outside, "outside the outline"));
    std::stable_sort(splines.begin() + (whole ? 0 : 1),
                     splines.end(),
                     [](const auto& a, const auto& b) { return AreaWithin(a) < AreaWithin(b); });
    for (const OutlineSpline& spline : splines) {
      std::vector<double> corners = spline.corners;
      for (double& corner : corners) corner *= options_.spacing;
      outline.loops.push_back({spline.Curve(options_.spacing), std::move(corners)});
    }
  }

  // Beyond rounding; what is beyond no hole's border only is inside a whole rectangle.
  Index Outside(const std::vector<OutlineSpline>& splines, bool whole) const {
    std::vector<OutlineSpline> all = splines;
    if (whole) all.push_back(RectangleSpline(sides_));
    const double rounding = 1e-12 * sides_.maxCoeff();
    Index count = 0;
    for (const OutlineFootPoint& foot :
         OutlinePolygon(all, kFarthest, kExact).FootPointSet(points_, pool_))
      if (foot.outside > rounding) ++count;
    return count;
  }

  const OutlineOptions& options_;
  ThreadPool& pool_;
  Eigen::Matrix2Xd points_;
  LocalSpacing spacing_;
  Eigen::Vector2d sides_;
};

}  // namespace

Outline FindOutline(const Eigen::Matrix2Xd& parameters,
                    const OutlineOptions& options,
                    ThreadPool& pool) {
  Check(parameters, options);
  return OutlineSearch(parameters, options, pool).Find();
}

}  // namespace batten
