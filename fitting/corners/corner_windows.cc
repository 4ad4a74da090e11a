// SPDX-License-Identifier: MIT
#include "fitting/corners/corner_windows.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "batten/fitting/statistics.h"
#include "fitting/corners/corner_data.h"
#include "fitting/corners/kink_window.h"

namespace batten::internal {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kFewestSteps = 6, kScatteredSteps = 38;   // of a side of the narrowest windows
constexpr double kSteadyWindow = 0.05, kScattered = 0.45;  // noise in steps that asks for them
constexpr double kFewestWidths = 34;         // of the noise, of the same side, up to kBroadWidths
constexpr double kBroad = 2;                 // noise in steps up to which the first
constexpr size_t kFewestPoints = 5;          // of a side
constexpr double kLineAngle = 0.07;          // standard deviation of a side's direction there
constexpr double kWider = 1.6;               // from scale to scale
constexpr double kReaches[] = {1, 1.5, 2};   // of a side: windows tried
constexpr double kShortCuts[] = {0.2, 0.4};  // of a step, that are missing in it
constexpr double kNarrower = 1.5;            // from window to window where a corner must hold
constexpr double kWidest = 10;               // of the narrowest side, that measure a corner
constexpr double kBlurred = 0.1;             // of a side: how well a place is known
constexpr double kStride = 0.25;             // of a side, between places looked at
constexpr double kShareOfAngle = 0.7;        // that lines on both sides show of a corner at least
constexpr double kLongestSide = 0.25;        // of the whole length
constexpr double kLeastSide = 0.4;           // of the width, where an end or a corner cuts it

// Sums over the first k points, so that every window's sums are two look-ups.
struct Moments {
  double n = 0, u = 0, uu = 0;
  Vector3d p = Vector3d::Zero(), up = Vector3d::Zero();
};

Moments operator-(const Moments& a, const Moments& b) {
  return {a.n - b.n, a.u - b.u, a.uu - b.uu, a.p - b.p, a.up - b.up};
}

// Slope of the line through a window's points, not scaled.
Vector3d Slope(const Moments& m) { return m.n * m.up - m.u * m.p; }

struct Detour {
  double at, length;
};

// The points with running sums; a closed curve goes on for half its length at either end.
struct UnrolledPoints {
  std::vector<double> u;  // lengths
  std::vector<Moments> sums{Moments()};

  UnrolledPoints(const CornerData& data, bool closed) {
    const Index m = data.points.cols();
    const auto append = [&](Index k, double shift) {
      const double at = data.lengths[k] + shift;
      const Vector3d p = data.points.col(k);
      const Moments& before = sums.back();
      u.push_back(at);
      sums.push_back(
          {before.n + 1, before.u + at, before.uu + at * at, before.p + p, before.up + at * p});
    };
    const double half = 0.5 * data.length;
    for (Index k = 0; closed && k < m; ++k) {
      if (data.lengths[k] >= half) append(k, -data.length);
    }
    for (Index k = 0; k < m; ++k) append(k, 0);
    for (Index k = 0; closed && k < m; ++k) {
      if (data.lengths[k] < half) append(k, data.length);
    }
  }

  double MedianStep() const {
    std::vector<double> steps;
    for (size_t k = 1; k < u.size(); ++k) steps.push_back(u[k] - u[k - 1]);
    return Median(std::move(steps));
  }

  // The points from parameter low to high as means of equally many in a row.
  KinkWindow Means(double low, double high, const Detour& detour) const {
    const auto a = static_cast<size_t>(std::lower_bound(u.begin(), u.end(), low) - u.begin()),
               c = static_cast<size_t>(std::upper_bound(u.begin(), u.end(), high) - u.begin());
    const size_t count = std::min(c - a, kMostMeans);
    KinkWindow window;
    for (size_t i = 0; i < count; ++i) {
      const size_t begin = a + i * (c - a) / count, end = a + (i + 1) * (c - a) / count;
      const Moments m = sums[end] - sums[begin];
      const double at = m.u / m.n;
      window.u.push_back(at < detour.at ? at : at + detour.length);
      window.p.push_back(m.p / m.n);
      window.n.push_back(m.n);
    }
    return window;
  }
};

class WindowSearch {
 public:
  WindowSearch(const CornerData& data, const CornerOptions& options)
      : data_(data),
        options_(options),
        all_(data, options.closed),
        u_(all_.u),
        step_(all_.MedianStep()) {}

  std::vector<CurveCorner> Run() {
    for (double side = NarrowestSide(); side <= kLongestSide * Length(); side *= kWider) Scan(side);
    std::vector<CurveCorner> corners;
    for (const Kink& kink : kinks_) {
      const double u = kink.parameter;
      if (options_.closed && (u < 0 || u >= Length())) continue;
      const Kink sharpened = Sharpened(kink);
      corners.push_back(
          {data_.ParameterAt(Wrapped(sharpened.parameter)), sharpened.angle, sharpened.place});
    }
    return corners;
  }

 private:
  struct Place {
    double at, cosine;
  };

  double First() const { return u_.front(); }
  double Last() const { return u_.back(); }
  double Length() const { return data_.length; }

  double Wrapped(double u) const {
    if (!options_.closed) return u;
    return u < 0 ? u + data_.length : u >= data_.length ? u - data_.length : u;
  }

  // A line through n = w/h points over w has a slope of standard deviation √12 σ / (w √n). Noise
  // hides how sharp a turn of few points is, so that smooth curves with few points to a bend have
  // corners unless sides are long.
  double NarrowestSide() const {
    const double by_noise =
        std::pow(std::sqrt(12.0) * options_.noise * std::sqrt(step_) / kLineAngle, 2.0 / 3.0);
    const double steps = Between(kSteadyWindow, kScattered, kFewestSteps, kScatteredSteps),
                 widths = Between(kBroad, 3 * kBroad, kFewestWidths, kBroadWidths);
    return std::max({steps * step_, by_noise, widths * options_.noise});
  }

  // From a to b as the noise grows from low to high, in steps.
  double Between(double low, double high, double a, double b) const {
    return std::lerp(a, b, std::clamp((options_.noise / step_ - low) / (high - low), 0.0, 1.0));
  }

  // Places where lines on both sides turn enough, the sharpest of their surroundings.
  std::vector<Place> Places(double side) const {
    std::vector<Place> turns;
    const double least = std::cos(kShareOfAngle * options_.least_angle);
    size_t a = 0, b = 0, c = 0;
    for (double s = First() + kLeastSide * side; s <= Last() - kLeastSide * side;
         s += kStride * side) {
      while (a < u_.size() && u_[a] < s - side) ++a;
      while (b < u_.size() && u_[b] < s) ++b;
      while (c < u_.size() && u_[c] <= s + side) ++c;
      if (b - a < kFewestPoints || c - b < kFewestPoints) continue;
      const Vector3d left = Slope(all_.sums[b] - all_.sums[a]),
                     right = Slope(all_.sums[c] - all_.sums[b]);
      const double cosine = left.dot(right) / std::sqrt(left.squaredNorm() * right.squaredNorm());
      if (cosine <= least) turns.push_back({s, cosine});
    }
    std::vector<Place> places;
    for (size_t i = 0; i < turns.size(); ++i) {
      const auto sharper = [&](size_t j) {
        return std::abs(turns[j].at - turns[i].at) < 1.5 * kStride * side &&
               turns[j].cosine < turns[i].cosine;
      };
      if ((i > 0 && sharper(i - 1)) || (i + 1 < turns.size() && sharper(i + 1))) continue;
      places.push_back(turns[i]);
    }
    std::sort(places.begin(), places.end(), [](const Place& x, const Place& y) {
      return x.cosine < y.cosine;
    });
    return places;
  }

  void Scan(double side) {
    const std::vector<Place> places = Places(side);
    std::vector<double> ordered;
    for (const Place& place : places) ordered.push_back(place.at);
    std::sort(ordered.begin(), ordered.end());
    for (const Place& place : places) {
      for (const double reach : kReaches) {
        const std::optional<Kink> kink = JudgePlace(place.at, side, reach * side, ordered);
        if (!kink) continue;
        Keep(*kink);
        break;
      }
    }
  }

  void Keep(Kink kink) {
    kinks_.push_back(kink);
    if (!options_.closed) return;
    for (const double turn : {-data_.length, data_.length}) {
      kinks_.push_back(kink);
      kinks_.back().parameter += turn;
    }
  }

  // In a window that ends where the curve does, at known corners and, short of them, at other
  // places of the scale.
  std::optional<Kink> JudgePlace(double at,
                                 double side,
                                 double reach,
                                 const std::vector<double>& places) const {
    double low = std::max(at - reach, First()), high = std::min(at + reach, Last());
    const double near = std::max(2 * step_, 3 * options_.noise), far = kBlurred * side;
    const auto next = std::upper_bound(places.begin(), places.end(), at),
               same = std::lower_bound(places.begin(), places.end(), at);
    if (next != places.end()) high = std::min(high, *next - far);
    if (same != places.begin()) low = std::max(low, *(same - 1) + far);
    for (const Kink& kink : kinks_) {
      if (std::abs(kink.parameter - at) < kLeastSide * side) return std::nullopt;
      if (kink.parameter < at) low = std::max(low, kink.parameter + near);
      if (kink.parameter > at) high = std::min(high, kink.parameter - near);
    }
    if (at - low < kLeastSide * side || high - at < kLeastSide * side) return std::nullopt;
    return Judge(at, low, high);
  }

  // Where no point lies at the corner, the step across it is a short cut: lengths miss part of it.
  std::optional<Kink> Judge(double at, double low, double high) const {
    const PointClass plain = JudgeWith({at, 0}, at, low, high);
    if (plain.corner) return plain.kink;
    if (!plain.turns) return std::nullopt;
    const Index gap = std::upper_bound(u_.begin(), u_.end(), plain.kink.parameter) - u_.begin();
    const auto first = static_cast<size_t>(std::max<Index>(gap - 1, 1)),
               last = std::min(static_cast<size_t>(gap) + 1, u_.size() - 1);
    PointClass best;
    for (size_t k = first; k <= last; ++k) {
      for (const double share : kShortCuts) {
        const Detour detour{u_[k], share * (u_[k] - u_[k - 1])};
        const PointClass verdict = JudgeWith(detour, at, low, high);
        if (verdict.corner && (!best.corner || verdict.kink.squares < best.kink.squares))
          best = verdict;
      }
    }
    if (!best.corner) return std::nullopt;
    return best.kink;
  }

  PointClass JudgeWith(const Detour& detour, double at, double low, double high) const {
    const KinkWindow window = all_.Means(low, high, detour);
    if (window.u.size() < 2 * kFewestPoints) return {};
    PointClass verdict = KinkOf(
        window, at, options_.noise, options_.least_angle, std::log(2 * Length() / (high - low)));
    Kink& kink = verdict.kink;
    verdict.corner = verdict.corner && HoldsNearby(kink, low, high, detour);
    if (verdict.corner && kink.parameter > detour.at - detour.length)
      kink.parameter = std::max(detour.at, kink.parameter) - detour.length;
    return verdict;
  }

  // The same corner in the widest window that still shows it, where it is known best.
  Kink Sharpened(Kink kink) const {
    const double near = std::max(2 * step_, 3 * options_.noise);
    double low = First(), high = Last();
    for (const Kink& other : kinks_) {
      if (other.parameter < kink.parameter) low = std::max(low, other.parameter + near);
      if (other.parameter > kink.parameter) high = std::min(high, other.parameter - near);
    }
    const double at = kink.parameter, blur = kink.reach / 2;
    const double widest = kWidest * NarrowestSide();
    for (double reach = kWider * kink.reach; reach <= widest; reach *= kWider) {
      const std::optional<Kink> wider =
          Judge(at, std::max(low, at - reach), std::min(high, at + reach));
      if (wider && std::abs(wider->parameter - at) <= blur) kink = *wider;
    }
    return kink;
  }

  // Narrower windows may not know whether there is a corner, but none may know better.
  bool HoldsNearby(const Kink& kink, double low, double high, const Detour& detour) const {
    for (;;) {
      low = kink.parameter + (low - kink.parameter) / kNarrower;
      high = kink.parameter + (high - kink.parameter) / kNarrower;
      const KinkWindow window = all_.Means(low, high, detour);
      if (window.u.size() < 2 * kFewestPoints) return true;
      if (IsSmoother(window, kink.parameter, options_.noise)) return false;
    }
  }

  const CornerData& data_;
  const CornerOptions& options_;
  const UnrolledPoints all_;
  const std::vector<double>& u_;
  double step_;
  std::vector<Kink> kinks_;
};

}  // namespace

std::vector<CurveCorner> CornersOfNoisy(const Matrix3Xd& points,
                                        const VectorXd& parameters,
                                        const CornerOptions& options) {
  const CornerData data = CornerDataOf(points, parameters, options);
  return WindowSearch(data, options).Run();
}

}  // namespace batten::internal
