// SPDX-License-Identifier: MIT
#include "batten/fitting/outline.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include "batten/fitting/refused_data.h"
#include "batten/fitting/statistics.h"
#include "batten/geometry/trim_loops.h"
#include "fitting/core/rounding.h"
#include "fitting/neighbours/local_spacing.h"
#include "fitting/outline/alpha_shape.h"
#include "fitting/outline/outline_containment.h"
#include "fitting/outline/outline_edges.h"
#include "fitting/outline/outline_loop.h"
#include "fitting/outline/outline_polygon.h"
#include "fitting/outline/outline_spline.h"
#include "fitting/outline/periodic_copies.h"
#include "geometry/editing/loop_nesting.h"
#include "geometry/editing/trim_faults.h"
#include "geometry/numeric/number_text.h"

namespace batten {
using namespace internal;
namespace {

using Index = Eigen::Index;

// Lengths are in spacings, areas in squared spacings.
constexpr double kRadius = 2.5;     // of the alpha shape
constexpr double kLeastArea = 36;   // smaller holes and parts are ignored; of local spacings
constexpr double kSparser = 1.5;    // local spacing that is clearly more than one
constexpr double kOutwards = 0.43;  // how far random points' ragged border lies inside, measured
constexpr double kExact = 1e-5;     // sagitta of the polygons that decide which points lie outside
constexpr double kFarthest = 1.5;   // points farther outside are not contained
constexpr double kPinned = 4;       // radius about a crossing that is first put back on the border
constexpr double kHidden = 3;       // points farther outside get a part of their own …
constexpr double kDisc = 1;         // … of this radius about each
constexpr double kBeyond = 6;       // no corner of points lies farther beyond their border
constexpr double kWiden = 4;        // factor of the radius where that does not undo the crossing
constexpr int kMostPinRounds = 16;  // radii of one place, and places that come up on the way

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

bool HoldsOneOf(const Eigen::Matrix2Xd& points, const Eigen::Matrix2Xd& polygon) {
  if (points.cols() == 0) return false;
  const Eigen::AlignedBox2d box(polygon.rowwise().minCoeff(), polygon.rowwise().maxCoeff());
  for (const auto& p : points.colwise())
    if (box.contains(Eigen::Vector2d(p)) && InsidePolygon(polygon, p)) return true;
  return false;
}

// Outer loops, then holes, by falling area.
std::vector<OutlineSpline> ByArea(std::vector<OutlineSpline> splines) {
  std::vector<std::pair<double, size_t>> order;
  for (const OutlineSpline& spline : splines)
    order.emplace_back(SignedArea(spline.Curve(1)), order.size());
  std::stable_sort(order.begin(), order.end(), [](const auto& a, const auto& b) {
    return (a.first > 0) != (b.first > 0) ? a.first > 0 : std::abs(a.first) > std::abs(b.first);
  });
  std::vector<OutlineSpline> sorted;
  for (const auto& [area, k] : order) sorted.push_back(std::move(splines[k]));
  return sorted;
}

// The least area of a part or hole with this border, which is as sparse as most of it: a point far
// from the others must not take the whole part with it.
double LeastArea(const Eigen::Matrix2Xd& polygon, const LocalSpacing& spacing) {
  std::vector<double> around;
  for (const auto& place : polygon.colwise()) around.push_back(spacing.At(place));
  const double local = Median(std::move(around));
  return local > kSparser ? kLeastArea * local * local : kLeastArea;
}

// The loops that bound parts of some size or hold a lone point, and holes of some size.
std::vector<OutlineLoop> SizedParts(std::vector<OutlineLoop> loops,
                                    const Eigen::Matrix2Xd& lone,
                                    const LocalSpacing& spacing,
                                    const OutlineOptions& options,
                                    Outline& outline) {
  struct Sized {
    double area;
    OutlineLoop loop;
  };
  std::vector<Sized> sized;
  for (OutlineLoop& loop : loops) {
    const Eigen::Matrix2Xd polygon = PolygonOf(loop);
    const double area = AreaInSpace(polygon, options);
    const bool holds = area > 0 && HoldsOneOf(lone, polygon);
    if (holds || std::abs(area) >= LeastArea(polygon, spacing) / 2)
      sized.push_back({area, std::move(loop)});
  }
  std::stable_sort(sized.begin(), sized.end(), [](const auto& a, const auto& b) {
    return (a.area > 0) != (b.area > 0) ? a.area > 0 : std::abs(a.area) > std::abs(b.area);
  });
  outline.parts = static_cast<int>(
      std::count_if(sized.begin(), sized.end(), [](const Sized& s) { return s.area > 0; }));
  std::vector<OutlineLoop> parts;
  if (outline.parts == 0) return parts;
  for (Sized& one : sized) parts.push_back(std::move(one.loop));
  return parts;
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

// The place in space of a place in spacings; beyond a seam, of the same one inside.
PlaceInSpace PlaceOf(const OutlineOptions& options) {
  if (!options.place) return nullptr;
  return [&](const Eigen::Vector2d& at) -> Eigen::Vector3d {
    Eigen::Vector2d lengths = at * options.spacing;
    const auto wrap = [](double& length, double period) {
      length -= period * std::floor(length / period);
    };
    if (options.periodic_u) wrap(lengths[0], options.length_u);
    if (options.periodic_v) wrap(lengths[1], options.length_v);
    return options.place(lengths.cwiseMax(0.0).cwiseMin(
               Eigen::Vector2d(options.length_u, options.length_v))) /
           options.spacing;
  };
}

// The circumradius of a triangle as its map lengthens the longest side, or the distance in space of
// its middle from the corners if that is more.
double SizeInSpace(const Eigen::Matrix2Xd& corners, double radius, const PlaceInSpace& place) {
  const Eigen::Vector3d middle = place(corners.rowwise().mean());
  double length = 0, in_space = 0, away = std::numeric_limits<double>::infinity();
  for (Index k = 0; k < corners.cols(); ++k) {
    const Eigen::Vector2d from = corners.col(k), to = corners.col((k + 1) % corners.cols());
    const Eigen::Vector3d corner = place(from);
    length = std::max(length, (to - from).norm());
    in_space = std::max(in_space, (place(to) - corner).norm());
    away = std::min(away, (middle - corner).norm());
  }
  return std::max(radius * in_space / length, away);
}

// Whether the border has no length, so that no curve follows it: where points reach about as far
// across as one from the next, putting it on the edges may leave nothing of it.
bool IsPlace(const OutlineLoop& loop) {
  return std::all_of(loop.begin(), loop.end(), [&](const OutlineSample& sample) {
    return sample.place == loop.front().place;
  });
}

class OutlineSearch {
 public:
  OutlineSearch(const Eigen::Matrix2Xd& parameters, const OutlineOptions& options, ThreadPool& pool)
      : options_(options),
        pool_(pool),
        points_(parameters / options.spacing),
        place_(PlaceOf(options)),
        spacing_(points_, EmptyCircles(points_, kRadius, pool), place_),
        sides_(options.length_u / options.spacing, options.length_v / options.spacing) {}

  // Whether the points have one border, along the edges of the rectangle.
  bool Fills() {
    Outline outline;
    const std::vector<OutlineLoop> parts = SizedParts(Borders({}), {}, spacing_, options_, outline);
    return parts.empty() || (parts.size() == 1 && FillsRectangle(parts.front(), spacing_, sides_));
  }

  Outline Find() {
    Outline outline;
    std::vector<OutlineLoop> parts = SizedParts(Borders({}), {}, spacing_, options_, outline);
    if (parts.empty()) {
      outline.warnings.push_back("the points cover no area larger than " + NumberText(kLeastArea) +
                                 " spacings squared: no outline");
      outline.fills = true;
      return outline;
    }
    if (const Eigen::Matrix2Xd lone = points_(Eigen::all, Outside(Ragged(parts), false, kHidden));
        lone.cols() > 0)
      parts = SizedParts(Borders(lone), lone, spacing_, options_, outline);
    if (outline.parts > 1)
      outline.warnings.push_back("the points fall into " + std::to_string(outline.parts) +
                                 " parts, each with an outline of its own");
    const bool whole = FillsRectangle(parts.front(), spacing_, sides_);
    outline.fills = whole && parts.size() == 1;
    if (outline.fills) return outline;
    if (whole) parts.erase(parts.begin());
    Smooth(parts, whole, outline);
    return outline;
  }

 private:
  using LoopPins = std::vector<std::vector<OutlinePin>>;  // of each loop

  // The covered region, cut at the seams; with discs about lone points, however small.
  std::vector<OutlineLoop> Borders(const Eigen::Matrix2Xd& lone) const {
    Eigen::Matrix2Xd covered(2, points_.cols() + kOnDisc * lone.cols());
    covered.leftCols(points_.cols()) = points_;
    for (Index k = 0; k < kOnDisc * lone.cols(); ++k) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(k % kOnDisc) / kOnDisc;
      covered.col(points_.cols() + k) =
          (lone.col(k / kOnDisc) + kDisc * Eigen::Vector2d(std::cos(angle), std::sin(angle)))
              .cwiseMax(0.0)
              .cwiseMin(sides_);
    }
    const Eigen::Matrix2Xd ghosts = WithPeriodicCopies(covered, sides_, options_);
    const auto is_gap = [&](const Eigen::Matrix2Xd& corners, double radius) {
      const double size = place_ ? SizeInSpace(corners, radius, place_) : radius;
      return size > kRadius * spacing_.At(corners.rowwise().mean());
    };
    std::vector<OutlineLoop> loops;
    for (const Eigen::Matrix2Xd& polygon : AlphaShape(ghosts, kRadius, is_gap, pool_)) {
      const bool large = std::abs(AreaInSpace(polygon, options_)) >= LeastArea(polygon, spacing_);
      if (!large && !(PolygonArea(polygon) > 0 && HoldsOneOf(lone, polygon))) continue;
      loops.push_back(SampledOutline(
          polygon, [&](const Eigen::Vector2d& at) { return kOutwards * spacing_.At(at); }));
      // A small part is too short to be sampled.
      if (!large)
        PinToBorder(loops.back(),
                    {Eigen::Vector2d::Zero(), std::numeric_limits<double>::infinity()});
    }
    for (int axis = 0; axis < 2; ++axis) {
      if (!(axis == 0 ? options_.periodic_u : options_.periodic_v)) continue;
      loops = CutOutlines(loops, axis, 1, 0);
      loops = CutOutlines(loops, axis, -1, sides_[axis]);
      MatchSeam(loops, axis, sides_[axis]);
    }
    return loops;
  }

  // The borders themselves, vertex by vertex.
  std::vector<OutlineSpline> Ragged(const std::vector<OutlineLoop>& parts) const {
    std::vector<OutlineSpline> ragged;
    for (OutlineLoop loop : parts) {
      PinToBorder(loop, {Eigen::Vector2d::Zero(), std::numeric_limits<double>::infinity()});
      ragged.push_back(SmoothedOutline(loop, 0));
    }
    return ragged;
  }

  // Smooths the borders; where smoothed ones cross themselves or each other, leave points far
  // outside or reach far beyond them, they are put back on the points' own border, about each place
  // farther and farther.
  void Smooth(const std::vector<OutlineLoop>& parts, bool whole, Outline& outline) const {
    LoopPins pins(parts.size());
    std::vector<OutlineSpline> splines(parts.size(), RectangleSpline(sides_));  // all smoothed anew
    std::vector<char> anew(parts.size(), 1);
    SmoothAnew(parts, pins, anew, splines);
    const std::vector<OutlineSpline> ragged = Ragged(parts);
    std::optional<std::vector<Index>> lone;  // that no border holds
    for (int round = 0; round < kMostPinRounds; ++round) {
      const std::vector<TrimFault> faults = TrimFaults(Trimmed(splines, whole));
      std::vector<Index> hidden = Outside(splines, whole, kHidden);
      if (!hidden.empty() && !lone) lone = Outside(ragged, whole, kHidden);
      std::erase_if(hidden, [&](Index point) { return std::ranges::binary_search(*lone, point); });
      std::vector<Eigen::Vector2d> places = FarBeyond(splines, ragged, whole);
      for (const Index point : hidden) places.emplace_back(points_.col(point));
      const LoopPins more = MorePins(parts, pins, faults, places, whole);
      anew.assign(parts.size(), 0);
      for (size_t loop = 0; loop < parts.size(); ++loop) {
        anew[loop] = more[loop].empty() ? 0 : 1;
        pins[loop].insert(pins[loop].end(), more[loop].begin(), more[loop].end());
      }
      if (std::ranges::count(anew, 1) == 0) break;
      if (options_.periodic_u || options_.periodic_v) anew.assign(parts.size(), 1);  // seams match
      SmoothAnew(parts, pins, anew, splines);
    }
    splines = ByArea(std::move(splines));
    outline.outside = Outside(splines, whole, kRelativeRounding * sides_.maxCoeff());
    if (const auto outside = static_cast<Index>(outline.outside.size()); outside > 0)
      outline.warnings.push_back(Counted(outside, "outside the outline"));
    if (whole) outline.loops.push_back(Rectangle(options_.length_u, options_.length_v));
    for (const OutlineSpline& spline : splines) {
      std::vector<double> corners = spline.corners;
      for (double& corner : corners) corner *= options_.spacing;
      outline.loops.push_back({spline.Curve(options_.spacing), std::move(corners)});
    }
  }

  // Places of outlines that lie farther from the ragged borders, in space, than a corner may.
  std::vector<Eigen::Vector2d> FarBeyond(const std::vector<OutlineSpline>& splines,
                                         std::vector<OutlineSpline> ragged,
                                         bool whole) const {
    constexpr double kSagitta = 0.1;
    std::vector<Eigen::Vector2d> vertices;
    const OutlinePolygon outline(splines, kBeyond, kSagitta);
    for (const auto& loop : outline.vertices())
      for (const auto& vertex : loop) vertices.push_back(vertex.place);
    const Eigen::Map<const Eigen::Matrix2Xd> places(
        vertices.front().data(), 2, std::ssize(vertices));
    if (whole) ragged.push_back(RectangleSpline(sides_));
    std::vector<Eigen::Vector2d> far;
    for (const OutlineFootPoint& foot :
         OutlinePolygon(ragged, kBeyond).FootPointSet(places, pool_)) {
      const Eigen::Vector2d& at = vertices[static_cast<size_t>(foot.point)];
      if (!(foot.outside > 1)) continue;
      double away = foot.outside;
      if (place_ && foot.loop >= 0)
        away = std::max(away, (place_(at) - place_(ragged[foot.loop].At(foot.t))).norm());
      if (away > kBeyond * std::max(1.0, spacing_.At(at))) far.push_back(at);
    }
    return far;
  }

  // Pins about faults and other places, each wider than those of its loop that hold the place
  // already, until they hold the whole rectangle.
  LoopPins MorePins(const std::vector<OutlineLoop>& parts,
                    const LoopPins& pins,
                    const std::vector<TrimFault>& faults,
                    const std::vector<Eigen::Vector2d>& places,
                    bool whole) const {
    LoopPins more(parts.size());
    const auto radius = [&](size_t loop, const Eigen::Vector2d& at) {
      double radius = kPinned;
      for (const OutlinePin& pin : pins[loop])
        if ((pin.place - at).norm() < pin.radius) radius = std::max(radius, kWiden * pin.radius);
      return radius;
    };
    const double widest = kWiden * sides_.norm();
    const int before = whole ? 1 : 0;  // the rectangle
    for (const TrimFault& fault : faults) {
      for (const int loop : std::set{fault.loop - before, fault.other - before}) {
        if (loop < 0) continue;
        const OutlinePin pin{fault.at, radius(loop, fault.at)};
        if (pin.radius < widest) more[loop].push_back(pin);
      }
    }
    for (const Eigen::Vector2d& place : places) {
      for (size_t loop = 0; loop < parts.size(); ++loop) {
        const OutlinePin pin{place, radius(loop, place)};
        const auto held = [&](const OutlineSample& sample) { return pin.Holds(sample); };
        if (pin.radius < widest && std::ranges::any_of(parts[loop], held))
          more[loop].push_back(pin);
      }
    }
    return more;
  }

  // The splines of the loops marked, under their pins; the others stay.
  void SmoothAnew(const std::vector<OutlineLoop>& parts,
                  const LoopPins& pins,
                  const std::vector<char>& anew,
                  std::vector<OutlineSpline>& splines) const {
    for (size_t k = 0; k < parts.size(); ++k) {
      if (anew[k] == 0) continue;
      OutlineLoop loop = parts[k];
      PutOnEdges(loop, pins[k], spacing_, sides_);
      for (const OutlinePin& pin : pins[k]) PinToBorder(loop, pin);
      if (IsPlace(loop)) {
        throw RefusedData("the points lie along a line, " + RoundedText(sides_.maxCoeff()) +
                          " spacings long and no more than " + RoundedText(sides_.minCoeff()) +
                          " across: a surface needs points in two directions; are all coordinates "
                          "in one unit?");
      }
      splines[k] = SmoothedOutline(loop, options_.noise / options_.spacing);
      FixOnEdges(splines[k]);
    }
    EnforceContainment(points_, sides_, kFarthest, anew, splines, pool_);
    if (MatchSeams(splines, options_, sides_))
      EnforceContainment(points_, sides_, kFarthest, anew, splines, pool_);
    for (size_t k = 0; k < parts.size(); ++k)
      if (anew[k] != 0) KeepInRectangle(splines[k], sides_);
  }

  // The rectangle as a plane, trimmed by the loops.
  NurbsSurface Trimmed(const std::vector<OutlineSpline>& splines, bool whole) const {
    Eigen::Matrix3Xd corners(3, 4);
    corners << 0, 0, sides_[0], sides_[0], 0, sides_[1], 0, sides_[1], 0, 0, 0, 0;
    std::vector<NurbsCurve<2>> loops;
    if (whole) loops.push_back(Rectangle(sides_[0], sides_[1]).loop);
    for (const OutlineSpline& spline : splines) loops.push_back(spline.Curve(1));
    return NurbsSurface(SplineBasis(1, {0, 0, sides_[0], sides_[0]}),
                        SplineBasis(1, {0, 0, sides_[1], sides_[1]}),
                        corners)
        .WithTrims(std::move(loops));
  }

  // The points farther outside than that; what is beyond no hole's border only is inside a whole
  // rectangle.
  std::vector<Index> Outside(const std::vector<OutlineSpline>& splines,
                             bool whole,
                             double distance) const {
    std::vector<OutlineSpline> all = splines;
    if (whole) all.push_back(RectangleSpline(sides_));
    std::vector<Index> outside;
    for (const OutlineFootPoint& foot :
         OutlinePolygon(all, std::max(kFarthest, distance), kExact).FootPointSet(points_, pool_))
      if (foot.outside > distance) outside.push_back(foot.point);
    return outside;
  }

  static constexpr Index kOnDisc = 8;

  const OutlineOptions& options_;
  ThreadPool& pool_;
  Eigen::Matrix2Xd points_;
  PlaceInSpace place_;
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

bool FillTheirRectangle(const Eigen::Matrix2Xd& parameters,
                        const OutlineOptions& options,
                        ThreadPool& pool) {
  Check(parameters, options);
  return OutlineSearch(parameters, options, pool).Fills();
}

}  // namespace batten
