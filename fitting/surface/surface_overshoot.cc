// SPDX-License-Identifier: MIT
#include "fitting/surface/surface_overshoot.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "batten/fitting/neighbours.h"
#include "batten/geometry/knot_vectors.h"
#include "batten/geometry/surface_evaluator.h"
#include "batten/geometry/trim_region.h"
#include "fitting/neighbours/local_spacing.h"

namespace batten::internal {
namespace {

constexpr double kMostMeasured = 1e5;
constexpr double kMostByCells = 4e5;   // places that the cells ask for, but one in each
constexpr int kMostPerSpan = 4;        // of them along a span: an overshoot bends within one
constexpr double kStepInSpacings = 2;  // spacings between places
constexpr double kWithPoints = 3;      // spacings: a place so near to a point is with the points
constexpr size_t kMostAsked = 10000;   // places without points whose heights are compared
constexpr double kSeam = 0.1;          // share of a period repeated beyond a seam
constexpr int kFirstNeighbours = 32;   // of a place without points …
constexpr int kMostNeighbours = 512;   // … whose heights are compared
constexpr Eigen::Index kStretches = 2000;  // feet that give the length of S_u and S_v

// Midpoints of equal parts of every span, and the part of the domain each stands for.
struct Midpoints {
  std::vector<double> places, widths;
};

Midpoints MidpointsOf(const SplineBasis& basis, double length, double step, int least) {
  Midpoints axis;
  const std::vector<double>& knots = basis.knots();
  const double domain = basis.upper() - basis.lower();
  for (size_t k = 0; k + 1 < knots.size(); ++k) {
    const double low = std::max(knots[k], basis.lower()),
                 high = std::min(knots[k + 1], basis.upper());
    if (!(high > low)) continue;
    const int parts =
        std::max(least, static_cast<int>(std::ceil((high - low) / domain * length / step)));
    for (int i = 0; i < parts; ++i) {
      axis.places.push_back(low + (high - low) * (i + 0.5) / parts);
      axis.widths.push_back((high - low) / parts);
    }
  }
  return axis;
}

// Lengths of S_u and S_v at feet: medians, which no spike moves.
Eigen::Vector2d StretchOf(const SurfaceEvaluator& surface, const Eigen::Matrix2Xd& feet) {
  const Eigen::Index step = std::max<Eigen::Index>(1, feet.cols() / kStretches);
  std::vector<double> along[2];
  for (Eigen::Index k = 0; k < feet.cols(); k += step) {
    const SurfaceJet jet = surface.JetAt(feet(0, k), feet(1, k));
    along[0].push_back(jet.du.norm());
    along[1].push_back(jet.dv.norm());
  }
  Eigen::Vector2d stretch;
  for (int d = 0; d < 2; ++d) {
    auto middle = along[d].begin() + std::ssize(along[d]) / 2;
    std::nth_element(along[d].begin(), middle, along[d].end());
    stretch[d] = *middle;
  }
  return stretch;
}

// The points' spacing at places of the domain, at least that of all.
class SpacingAlong {
 public:
  SpacingAlong(const OvershootInput& input,
               const SurfaceEvaluator& surface,
               const Eigen::Vector2d& stretch)
      : spacing_(input.spacing), scale_(stretch / input.spacing) {
    const PlaceInSpace in_space = [&](const Eigen::Vector2d& at) -> Eigen::Vector3d {
      const Eigen::Vector2d uv = at.cwiseQuotient(scale_);
      return surface.At(uv[0], uv[1]) / spacing_;
    };
    local_.emplace(scale_.asDiagonal() * input.feet, std::vector<EmptyCircle>(), in_space);
  }

  double At(const Eigen::Vector2d& uv) const {
    return spacing_ * local_->At(scale_.cwiseProduct(uv));
  }

 private:
  double spacing_;
  Eigen::Vector2d scale_;
  std::optional<LocalSpacing> local_;
};

// Feet in lengths along the surface, with those near a seam repeated beyond it.
class FootMap {
 public:
  FootMap(const OvershootInput& input, const Eigen::Vector2d& stretch) : stretch_(stretch) {
    const SplineBasis* bases[2] = {&input.surface.basis_u(), &input.surface.basis_v()};
    std::vector<Eigen::Vector2d> at;
    for (Eigen::Index k = 0; k < input.feet.cols(); ++k) {
      at.emplace_back(input.feet.col(k));
      owner_.push_back(k);
    }
    for (int d = 0; d < 2; ++d) {
      if (!bases[d]->periodic()) continue;
      const double period = bases[d]->upper() - bases[d]->lower();
      for (size_t k = 0, count = at.size(); k < count; ++k) {
        const double share = (at[k][d] - bases[d]->lower()) / period;
        if (share >= kSeam && share <= 1 - kSeam) continue;
        Eigen::Vector2d beyond = at[k];
        beyond[d] += share < kSeam ? period : -period;
        at.push_back(beyond);
        owner_.push_back(owner_[k]);
      }
    }
    origin_ = at.front();
    places_.resize(3, std::ssize(at));
    for (size_t k = 0; k < at.size(); ++k) places_.col(static_cast<Eigen::Index>(k)) = Place(at[k]);
    index_.emplace(places_);
  }

  struct Neighbourhood {
    double gap = 0;                    // distance to the nearest foot
    std::vector<Eigen::Index> points;  // within 2 · gap + reach
  };
  Neighbourhood Around(const Eigen::Vector2d& uv, double reach) const {
    const Eigen::Matrix3Xd query = Place(uv);
    const auto all = static_cast<int>(places_.cols());
    for (int count = std::min(kFirstNeighbours, all);; count = std::min(2 * count, all)) {
      const std::vector<int> near = index_->Nearest(query, count);
      const auto distance = [&](int k) { return (places_.col(k) - query).norm(); };
      Neighbourhood found{distance(near.front()), {}};
      const double radius = 2 * found.gap + reach;
      if (count < std::min(all, kMostNeighbours) && distance(near.back()) < radius) continue;
      for (const int k : near)
        if (distance(k) <= radius) found.points.push_back(owner_[static_cast<size_t>(k)]);
      return found;
    }
  }

 private:
  Eigen::Vector3d Place(const Eigen::Vector2d& uv) const {
    const Eigen::Vector2d moved = stretch_.cwiseProduct(uv - origin_);
    return {moved[0], moved[1], 0};
  }

  Eigen::Vector2d stretch_, origin_ = Eigen::Vector2d::Zero();
  std::vector<Eigen::Index> owner_;
  Eigen::Matrix3Xd places_;
  std::optional<NeighbourIndex> index_;
};

// The direction of heights near some points.
Eigen::Vector3d UpNear(const OvershootInput& input,
                       const SurfaceEvaluator& surface,
                       const std::vector<Eigen::Index>& points) {
  if (input.up) return *input.up;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Index k : points)
    if (const auto normal = surface.NormalAt(input.feet(0, k), input.feet(1, k))) sum += *normal;
  return sum.isZero(0) ? sum : sum.normalized();
}

// How high a place must move to be among the heights of points.
double RiseInto(const Eigen::Vector3d& place,
                const Eigen::Vector3d& up,
                const Eigen::Matrix3Xd& points,
                const std::vector<Eigen::Index>& which) {
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (const Eigen::Index k : which) {
    const double height = up.dot(points.col(k) - place);
    low = std::min(low, height);
    high = std::max(high, height);
  }
  return low > 0 ? low : std::min(high, 0.0);
}

// Places inside the trims, with the area in the domain that each stands for.
struct Places {
  Eigen::Matrix2Xd uv;
  Eigen::VectorXd widths;
  Eigen::Matrix3Xd points;
  std::vector<Eigen::Index> alone;  // indices of those far from all points …
  std::vector<double> spacings;     // … and how far apart these are there
};

Places MeasuredPlaces(const OvershootInput& input,
                      const SurfaceEvaluator& surface,
                      const Eigen::Vector2d& stretch,
                      ThreadPool& pool) {
  const SplineBasis &bu = input.surface.basis_u(), &bv = input.surface.basis_v();
  const double length_u = stretch[0] * (bu.upper() - bu.lower()),
               length_v = stretch[1] * (bv.upper() - bv.lower());
  const double step =
      std::max(kStepInSpacings * input.spacing, std::sqrt(length_u * length_v / kMostMeasured));
  const double cells =
      static_cast<double>(bu.Spans().size()) * static_cast<double>(bv.Spans().size());
  const int least = std::clamp(static_cast<int>(std::sqrt(kMostByCells / cells)), 1, kMostPerSpan);
  const Midpoints us = MidpointsOf(bu, length_u, step, least),
                  vs = MidpointsOf(bv, length_v, step, least);
  const TrimRegion region(input.surface);
  Places places{Eigen::Matrix2Xd(2, std::ssize(us.places) * std::ssize(vs.places)), {}, {}, {}, {}};
  places.widths.resize(places.uv.cols());
  Eigen::Index count = 0;
  for (size_t i = 0; i < us.places.size(); ++i) {
    for (size_t j = 0; j < vs.places.size(); ++j) {
      if (!region.Contains(us.places[i], vs.places[j])) continue;
      places.uv.col(count) << us.places[i], vs.places[j];
      places.widths[count++] = us.widths[i] * vs.widths[j];
    }
  }
  places.uv.conservativeResize(2, count);
  places.widths.conservativeResize(count);
  if (count == 0) return places;
  surface.Points(places.uv, places.points, pool);
  const std::vector<int> nearest = NeighbourIndex(input.points, pool).Nearest(places.points, 1);
  std::optional<SpacingAlong> spacing;  // takes time, and is seldom asked
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto own = input.points.col(nearest[static_cast<size_t>(k)]);
    const double away = (places.points.col(k) - own).norm();
    if (!(away > kWithPoints * input.spacing)) continue;
    if (!spacing && input.spacing > 0) spacing.emplace(input, surface, stretch);
    const double there = spacing ? spacing->At(places.uv.col(k)) : 0;
    if (!(away > kWithPoints * there)) continue;
    places.alone.push_back(k);
    places.spacings.push_back(there);
  }
  return places;
}

// A place far from all points.
struct Alone {
  Eigen::Index place;
  double spacing;        // of the points there
  double gap;            // along the surface to the nearest foot point
  Eigen::Vector3d back;  // the way to the nearest height of the points around
};

std::vector<Alone> HeightsOf(const OvershootInput& input,
                             const SurfaceEvaluator& surface,
                             const Eigen::Vector2d& stretch,
                             const Places& places) {
  const FootMap feet(input, stretch);
  std::vector<Alone> all;
  const size_t step = 1 + places.alone.size() / kMostAsked;
  for (size_t i = 0; i < places.alone.size(); i += step) {
    const Eigen::Index k = places.alone[i];
    const double spacing = places.spacings[i];
    const FootMap::Neighbourhood around = feet.Around(places.uv.col(k), kWithPoints * spacing);
    const Eigen::Vector3d up = UpNear(input, surface, around.points);
    const double rise = RiseInto(places.points.col(k), up, input.points, around.points);
    all.push_back({k, spacing, around.gap, rise * up});
  }
  return all;
}

}  // namespace

std::optional<Eigen::Vector3d> DirectionOfHeights(const FitReport& report) {
  if (report.geometry.base != "plane" || !report.geometry.base_axes) return {};
  return report.geometry.base_axes->col(2);
}

std::vector<Excursion> FindExcursions(const OvershootInput& input, double least, ThreadPool& pool) {
  const SurfaceEvaluator surface(input.surface);
  const Eigen::Vector2d stretch = StretchOf(surface, input.feet);
  const Places places = MeasuredPlaces(input, surface, stretch, pool);
  std::vector<Excursion> found;
  if (places.alone.empty()) return found;
  for (const Alone& one : HeightsOf(input, surface, stretch, places))
    if (one.back.norm() > least * one.spacing)
      found.push_back({places.uv.col(one.place), one.back, one.spacing});
  return found;
}

OvershootSummary MeasureOvershoot(const OvershootInput& input, ThreadPool& pool) {
  const SurfaceEvaluator surface(input.surface);
  const Eigen::Vector2d stretch = StretchOf(surface, input.feet);
  const Places places = MeasuredPlaces(input, surface, stretch, pool);
  OvershootSummary found;
  if (places.alone.empty()) return found;
  std::vector<SurfaceJet> jets;
  surface.Jets(places.uv, jets, pool);
  const auto area = [&](Eigen::Index k) {
    const SurfaceJet& jet = jets[static_cast<size_t>(k)];
    return places.widths[k] * jet.du.cross(jet.dv).norm();
  };
  const NeighbourIndex centres(places.points(Eigen::all, places.alone), pool);
  const std::vector<int> nearest = centres.Nearest(places.points, 1);
  double whole = 0;
  for (Eigen::Index k = 0; k < places.uv.cols(); ++k) {
    const auto own = static_cast<size_t>(nearest[static_cast<size_t>(k)]);
    const Eigen::Index centre = places.alone[own];
    const double distance = (places.points.col(k) - places.points.col(centre)).norm();
    whole += area(k);
    if (distance < kWithPoints * places.spacings[own]) found.area_without_points += area(k);
  }
  for (const Alone& one : HeightsOf(input, surface, stretch, places)) {
    found.largest_gap = std::max(found.largest_gap, one.gap);
    const double beyond = one.back.norm();
    if (one.spacing > 0) found.in_spacings = std::max(found.in_spacings, beyond / one.spacing);
    if (!(beyond > found.max)) continue;
    found.max = beyond;
    found.at = places.points.col(one.place);
  }
  if (whole > 0) found.share_without_points = found.area_without_points / whole;
  return found;
}

}  // namespace batten::internal
