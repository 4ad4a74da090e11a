// SPDX-License-Identifier: MIT
// The search of IntersectCurves and IntersectCurveSurface over what a curve is to meet. Internal to
// geometry.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "geometry/intersection/arc_tree.h"
#include "geometry/intersection/patch_tree.h"
#include "geometry/numeric/constants.h"
#include "geometry/numeric/number_text.h"
#include "geometry/numeric/reject.h"

namespace batten::internal {

// A place of the target, by parameters (the second is zero on a curve).
struct TargetFoot {
  Eigen::Vector2d at;
  double distance;
};

struct ArcMeeting {
  double u;
  Eigen::Vector2d at;
  double distance;
  bool tangential;
};

struct ArcStretch {
  double from, to;
};

struct ArcMeets {
  std::vector<ArcMeeting> points;
  std::vector<ArcStretch> overlaps;
};

// Target: roots(), Halve(k), Size(k), Flatness(k), Separated(arc, k, gap), Transversal(arc, k),
// Angle(arc, k), Solve(arcs, arc, k, tolerance) → the nearest places in the whole domains if the
// iteration ends in both `arc` and k, Foot(point) → the nearest place of all, AngleAt(direction,
// place) → of a direction and the target; zero where there is none.
template <typename Target>
class ArcMeetSearch {
 public:
  ArcMeetSearch(const char* function, ArcTree& arcs, Target& target, double size, double tolerance)
      : function_(function), arcs_(arcs), target_(target), size_(size), tolerance_(tolerance) {}

  ArcMeets Run() {
    for (int i = 0; i < arcs_.roots(); ++i) {
      for (int j = 0; j < target_.roots(); ++j) {
        pairs_.emplace_back(i, j);
        while (!pairs_.empty()) {
          const std::pair<int, int> pair = pairs_.back();
          pairs_.pop_back();
          Compare(pair);
        }
      }
    }
    MeasureContacts();
    std::sort(found_.points.begin(), found_.points.end(), [](const auto& x, const auto& y) {
      return x.u < y.u;
    });
    DropDoubles();
    return std::move(found_);
  }

 private:
  static constexpr std::int64_t kMostArcPairs = 1'000'000;

  void Compare(const std::pair<int, int>& pair) {
    const NetArc& arc = arcs_[pair.first];
    if (target_.Separated(arc, pair.second, tolerance_)) return;
    if (++seen_ > kMostArcPairs) {
      Reject(function_,
             "the two are too alike to be told apart within the tolerance, near " +
                 RoundedText(arc.Middle()) + " of the first; ask for a larger tolerance");
    }
    const double flatness = target_.Flatness(pair.second), size = target_.Size(pair.second);
    const bool transversal = target_.Transversal(arc, pair.second);
    if (transversal) {
      const std::optional<ArcMeeting> met = target_.Solve(arcs_, arc, pair.second, tolerance_);
      if (met) {
        if (met->distance <= tolerance_) found_.points.push_back(*met);
        return;
      }
    }
    // Alike over all their length: what they are to one another is measured.
    const bool flat = std::max(arc.flatness, flatness) <= tolerance_ / 8;
    const bool alike =
        !transversal || target_.Angle(arc, pair.second) * std::max(arc.size, size) <= tolerance_;
    // An arc that goes on far past what it meets is halved down to it, a pole even.
    const bool beside = arc.size <= std::max(2 * size, tolerance_ / 4);
    if ((flat && alike && beside) || std::max(arc.size, size) <= tolerance_ / 4) {
      contacts_.push_back({arc.u0, arc.u1});
      return;
    }
    const bool by_bend = !transversal && !flat;
    if (by_bend ? arc.flatness >= flatness : arc.size >= size) {
      const int half = arcs_.Halve(pair.first);
      pairs_.emplace_back(half, pair.second);
      pairs_.emplace_back(half + 1, pair.second);
    } else {
      const int half = target_.Halve(pair.second);
      pairs_.emplace_back(pair.first, half);
      pairs_.emplace_back(pair.first, half + 1);
    }
  }

  Eigen::Vector3d At(double u) const { return arcs_.JetAt(u).col(0); }
  double DistanceAt(double u) { return target_.Foot(At(u)).distance; }

  // Where the two run alike: stretches of neighbouring contacts, and what of them is near.
  void MeasureContacts() {
    std::sort(contacts_.begin(), contacts_.end(), [](const auto& x, const auto& y) {
      return x.from < y.from;
    });
    for (std::size_t k = 0; k < contacts_.size();) {
      std::vector<double> places;
      double end = contacts_[k].from;
      for (; k < contacts_.size() && contacts_[k].from <= end; ++k) {
        constexpr int kPlaces = 4;
        const double from = contacts_[k].from, to = contacts_[k].to;
        for (int i = 0; i <= kPlaces; ++i) places.push_back(from + (to - from) * i / kPlaces);
        end = std::max(end, to);
      }
      std::sort(places.begin(), places.end());
      places.erase(std::unique(places.begin(), places.end()), places.end());
      MeasureStretch(places);
    }
  }

  void MeasureStretch(const std::vector<double>& places) {
    std::vector<double> distances;
    for (const double u : places) distances.push_back(DistanceAt(u));
    const auto near = [&](std::size_t k) { return distances[k] <= tolerance_; };
    bool any = false;
    for (std::size_t k = 0; k < places.size();) {
      if (!near(k)) {
        ++k;
        continue;
      }
      std::size_t last = k;
      while (last + 1 < places.size() && near(last + 1)) ++last;
      const double from = k > 0 ? EdgeBetween(places[k], places[k - 1]) : places[k];
      const double to =
          last + 1 < places.size() ? EdgeBetween(places[last], places[last + 1]) : places[last];
      AddStretch(from, to);
      any = true;
      k = last + 1;
    }
    if (any) return;
    const std::size_t best =
        std::min_element(distances.begin(), distances.end()) - distances.begin();
    AddTouch(places[best > 0 ? best - 1 : 0], places[std::min(best + 1, places.size() - 1)]);
  }

  // Where the distance passes the tolerance.
  double EdgeBetween(double inside, double outside) {
    constexpr int kHalvings = 40;
    for (int k = 0; k < kHalvings; ++k) {
      const double middle = inside / 2 + outside / 2;
      (DistanceAt(middle) <= tolerance_ ? inside : outside) = middle;
    }
    return inside;
  }

  void AddStretch(double from, double to) {
    const Eigen::Vector3d start = At(from);
    const double extent = std::max((At(to) - start).norm(), (At(from / 2 + to / 2) - start).norm());
    if (extent > 8 * std::sqrt(tolerance_ * size_)) {
      found_.overlaps.push_back({from, to});
    } else {
      AddTouch(from, to);
    }
  }

  // The nearest place of a stretch. [Kiefer 1953]
  void AddTouch(double low, double high) {
    constexpr double kRatio = 0.6180339887498949;
    constexpr int kSteps = 60;
    double best = low / 2 + high / 2, least = DistanceAt(best);
    const auto see = [&](double u) {
      const double distance = DistanceAt(u);
      if (distance < least) {
        least = distance;
        best = u;
      }
      return distance;
    };
    see(low);
    see(high);
    double a = high - kRatio * (high - low), b = low + kRatio * (high - low);
    double fa = see(a), fb = see(b);
    for (int k = 0; k < kSteps && high > low; ++k) {
      if (fa < fb) {
        high = b;
        b = a;
        fb = fa;
        fa = see(a = high - kRatio * (high - low));
      } else {
        low = a;
        a = b;
        fa = fb;
        fb = see(b = low + kRatio * (high - low));
      }
    }
    const TargetFoot foot = target_.Foot(At(best));
    if (foot.distance > tolerance_) return;
    // Touches lie within such an angle of their place; a crossing, at a pole even, does not.
    const bool touching =
        target_.AngleAt(arcs_.JetAt(best).col(1), foot.at) <= 8 * std::sqrt(tolerance_ / size_);
    found_.points.push_back({best, foot.at, foot.distance, touching});
  }

  bool Same(const ArcMeeting& x, const ArcMeeting& y) const {
    // Touches are flat: their places are known to the root of the tolerance.
    const double reach =
        x.tangential && y.tangential ? 8 * std::sqrt(tolerance_ * size_) : 4 * tolerance_;
    if ((At(x.u) - At(y.u)).norm() > reach) return false;
    // Next to each other on the curve, over its seam too; or another passage.
    const double length = arcs_.upper() - arcs_.lower();
    const double apart = std::abs(x.u - y.u);
    constexpr double kNext = 1e-3;
    return std::min(apart, length - apart) <= kNext * length && target_.Next(x.at, y.at);
  }

  void DropDoubles() {
    std::vector<ArcMeeting> kept;
    for (const ArcMeeting& one : found_.points) {
      const bool covered =
          std::any_of(found_.overlaps.begin(), found_.overlaps.end(), [&](const ArcStretch& s) {
            return (one.u >= s.from && one.u <= s.to) ||
                   (At(one.u) - At(s.from)).norm() <= 4 * tolerance_ ||
                   (At(one.u) - At(s.to)).norm() <= 4 * tolerance_;
          });
      if (covered) continue;
      const auto same = std::find_if(
          kept.begin(), kept.end(), [&](const ArcMeeting& other) { return Same(one, other); });
      if (same == kept.end()) {
        kept.push_back(one);
      } else if (one.distance < same->distance) {
        *same = one;
      }
    }
    found_.points = std::move(kept);
  }

  const char* function_;
  ArcTree& arcs_;
  Target& target_;
  double size_, tolerance_;
  std::int64_t seen_ = 0;
  std::vector<std::pair<int, int>> pairs_;
  std::vector<ArcStretch> contacts_;
  ArcMeets found_;
};

}  // namespace batten::internal
