// SPDX-License-Identifier: MIT
#include "geometry/intersection/branch_tracer.h"

#include <algorithm>
#include <cmath>

#include "geometry/bezier/bernstein.h"

namespace batten::internal {
namespace {

constexpr double kTightSine = 0.01;  // below, deviations count as at this sine
constexpr double kLeastTurnCosine = 0.8;
constexpr int kPlacesInArc = 7;
constexpr std::size_t kMostStations = 200'000;

template <int Rows>
Eigen::Matrix<double, Rows, 1> CubicAt(const Eigen::Matrix<double, Rows, 4>& b, double t) {
  double B[4];
  BernsteinValues(3, t, B);
  return B[0] * b.col(0) + B[1] * b.col(1) + B[2] * b.col(2) + B[3] * b.col(3);
}

class Marcher {
 public:
  explicit Marcher(const PairContact& contact)
      : contact_(contact), tolerance_(contact.tolerance()) {}

  // Stations from `first` on, which is the first of them; closed when they come back to `home`.
  struct March {
    std::vector<MeetPoint> stations;
    bool closed = false;
  };
  March From(const MeetPoint& first, double step) {
    March march{{first}, false};
    double h = step;
    const double least = kLeastStep * tolerance_;
    while (h > least && march.stations.size() < kMostStations) {
      const MeetPoint& here = march.stations.back();
      if (!here.regular) break;
      std::optional<Step> next = StepFrom(here, h);
      if (!next) {
        h /= 2;
        continue;
      }
      const double deviation = DeviationOf(ArcBetween(here, next->to), next->to.sine);
      if (deviation > kAim * tolerance_) {
        h = std::min(h, next->length) *
            std::clamp(0.9 * std::pow(kAim * tolerance_ / deviation, 0.25), 0.1, 0.8);
        continue;
      }
      if (march.stations.size() > 2 && ComesHome(here, next->to, first)) {
        greatest_ = std::max(greatest_, DeviationOf(ArcBetween(here, first), first.sine));
        march.stations.push_back(first);
        march.closed = true;
        break;
      }
      greatest_ = std::max(greatest_, deviation);
      const bool moved = next->length > least;
      if (moved) march.stations.push_back(next->to);
      if (next->ends || !moved) break;
      const double factor = std::pow(kAim * tolerance_ / std::max(deviation, 1e-300), 0.25);
      h *= std::clamp(0.9 * factor, 0.5, 2.0);
    }
    if (!march.closed && march.stations.size() > 1) SettleOnTouch(march.stations);
    return march;
  }

  double greatest() const { return greatest_; }

 private:
  static constexpr double kAim = 0.5;         // of the tolerance
  static constexpr double kLeastStep = 1e-2;  // of the tolerance

  struct Step {
    MeetPoint to;
    double length;
    bool ends;
  };

  std::optional<Step> StepFrom(const MeetPoint& here, double h) const {
    const Eigen::Vector4d guess = here.at + h * here.velocity;
    const Eigen::Vector3d through = here.point + h * here.tangent;
    std::optional<Eigen::Vector4d> at = contact_.InPlane(guess, here.tangent, through);
    if (!at) return BorderFrom(here, contact_.AlongBorders(here, guess), h);
    *at = contact_.AlongBorders(here, contact_.OntoBorders(*at));
    if (!contact_.Inside(*at)) return BorderFrom(here, *at, h);
    return Ahead(here, *at, h, false);
  }

  // The place as a station, turned forward; none where it lies behind or the branch turns too much.
  std::optional<Step> Ahead(const MeetPoint& here,
                            const Eigen::Vector4d& at,
                            double h,
                            bool ends) const {
    MeetPoint to = contact_.PointAt(at);
    const Eigen::Vector3d chord = to.point - here.point;
    const double length = chord.norm();
    if (ends && length <= kLeastStep * tolerance_) return Step{to, length, true};
    if (length > 2 * h || chord.dot(here.tangent) < kLeastTurnCosine * length) return std::nullopt;
    if (to.regular) {
      if (to.tangent.dot(here.tangent) < 0) to = to.Reversed();
      if (to.tangent.dot(here.tangent) < kLeastTurnCosine) return std::nullopt;
    } else if (!ends) {
      // A place where the surfaces touch is stepped over.
      return std::nullopt;
    }
    return Step{to, length, ends};
  }

  // The first border between here and a place beyond it.
  std::optional<Step> BorderFrom(const MeetPoint& here,
                                 const Eigen::Vector4d& beyond,
                                 double h) const {
    std::optional<Step> nearest;
    for (int i = 0; i < 4; ++i) {
      for (const double border : {contact_.lower()[i], contact_.upper()[i]}) {
        const double from = here.at[i], to = beyond[i];
        const bool low = border == contact_.lower()[i];
        if (low ? to >= border : to <= border) continue;
        if (from == border) {
          // It leaves here, or comes back to the border it begins on.
          const bool leaves = low ? here.velocity[i] <= 0 : here.velocity[i] >= 0;
          return leaves ? std::optional<Step>({here, 0, true}) : std::nullopt;
        }
        const double share = std::clamp((border - from) / (to - from), 0.0, 1.0);
        Eigen::Vector4d start = here.at + share * (beyond - here.at);
        start[i] = border;
        const auto solved = contact_.Holding(start, i);
        if (!solved) continue;
        const Eigen::Vector4d at = contact_.OntoBorders(*solved);
        if (!contact_.Inside(at)) continue;
        const auto step = Ahead(here, at, h, true);
        if (step && (!nearest || step->length < nearest->length)) nearest = step;
      }
    }
    return nearest;
  }

  // How far a cubic is from both surfaces, and they from each other along it.
  double DeviationOf(const MeetArc& arc, double sine) const {
    double most = 0;
    for (int k = 1; k <= kPlacesInArc; ++k) {
      const double t = static_cast<double>(k) / (kPlacesInArc + 1);
      const Eigen::Vector4d at = CubicAt<4>(arc.places, t);
      const Eigen::Vector3d here = CubicAt<3>(arc.points, t);
      const Eigen::Vector3d a = contact_.First(at), b = contact_.Second(at);
      const double gap = (a - b).norm();
      const bool touching = contact_.kind() == MeetKind::kTouching;
      const double across = touching ? gap : gap / std::max(sine, kTightSine);
      most = std::max({most, (a - here).norm(), (b - here).norm(), across});
      if (!(most <= tolerance_)) return most;
    }
    if (contact_.kind() == MeetKind::kTouching) most = std::max(most, SideStep(arc));
    // Where it leaves the boxes between its ends it would have had to end before.
    for (int k = 1; k <= kPlacesInArc; ++k) {
      const Eigen::Vector4d at =
          CubicAt<4>(arc.places, static_cast<double>(k) / (kPlacesInArc + 1));
      if (contact_.Inside(at)) continue;
      const Eigen::Vector4d kept = at.cwiseMax(contact_.lower()).cwiseMin(contact_.upper());
      const double outside = std::max((contact_.First(at) - contact_.First(kept)).norm(),
                                      (contact_.Second(at) - contact_.Second(kept)).norm());
      if (outside > kAim * tolerance_) return 16 * tolerance_;
    }
    return most;
  }

  // Along a touch gaps do not tell how far the curve is aside.
  double SideStep(const MeetArc& arc) const {
    const Eigen::Vector4d at = CubicAt<4>(arc.places, 0.5);
    const Eigen::Vector3d here = CubicAt<3>(arc.points, 0.5);
    const Eigen::Vector3d along = arc.points.col(3) - arc.points.col(0);
    const auto settled = contact_.InPlane(at, along.normalized(), here);
    return settled ? (contact_.First(*settled) - here).norm() : 16 * tolerance_;
  }

  // Where branches cross each other their places are known to the root of what they are on the
  // surfaces: the touch there is the end of all of them.
  void SettleOnTouch(std::vector<MeetPoint>& stations) {
    constexpr double kNearlyTouching = 1e-3;
    const MeetPoint &end = stations.back(), &before = stations[stations.size() - 2];
    if (contact_.kind() == MeetKind::kTouching || end.sine > kNearlyTouching) return;
    const auto touch = contact_.NearestTouch(end.at);
    if (!touch) return;
    const Eigen::Vector4d at = contact_.OntoBorders(*touch);
    if (!contact_.Inside(at)) return;
    const MeetPoint place = contact_.PointAt(at);
    MeetPoint settled = end;
    settled.at = at;
    settled.point = place.point;
    if ((settled.point - end.point).norm() > (end.point - before.point).norm()) return;
    const double deviation = DeviationOf(ArcBetween(before, settled), kTightSine);
    if (deviation > kAim * tolerance_) return;
    greatest_ = std::max(greatest_, deviation);
    stations.back() = settled;
  }

  bool ComesHome(const MeetPoint& from, const MeetPoint& to, const MeetPoint& home) const {
    const Eigen::Vector3d chord = to.point - from.point;
    const double along = (home.point - from.point).dot(chord) / chord.squaredNorm();
    if (!(along > 0 && along <= 1 + 1e-9)) return false;
    const MeetArc arc = ArcBetween(from, to);
    if (chord.norm() < (home.point - CubicAt<3>(arc.points, along)).norm()) return false;
    if (home.tangent.dot(from.tangent) < 0.5) return false;
    const Eigen::Vector4d apart = (home.at - CubicAt<4>(arc.places, along))
                                      .cwiseQuotient(contact_.upper() - contact_.lower());
    constexpr double kSamePlace = 0.01;
    if (apart.cwiseAbs().maxCoeff() > kSamePlace) return false;
    return DeviationOf(ArcBetween(from, home), home.sine) <= tolerance_;
  }

  const PairContact& contact_;
  double tolerance_, greatest_ = 0;
};

}  // namespace

// Hermite's cubic; an end without a tangent takes the chord's direction.
MeetArc ArcBetween(const MeetPoint& a, const MeetPoint& b) {
  const Eigen::Vector3d chord = b.point - a.point;
  const Eigen::Vector4d step = b.at - a.at;
  const double turn = a.regular && b.regular ? (b.tangent - a.tangent).norm() : 0;
  MeetArc arc;
  constexpr double kOfTheTurn = 1.0 / 24;  // an arc of a circle is so much longer than its chord
  arc.length = chord.norm() * (1 + kOfTheTurn * turn * turn);
  const double third = arc.length / 3;
  const Eigen::Vector3d from = a.regular ? Eigen::Vector3d(third * a.tangent) : chord / 3;
  const Eigen::Vector3d to = b.regular ? Eigen::Vector3d(third * b.tangent) : chord / 3;
  const Eigen::Vector4d leaving = a.regular ? Eigen::Vector4d(third * a.velocity) : step / 3;
  const Eigen::Vector4d coming = b.regular ? Eigen::Vector4d(third * b.velocity) : step / 3;
  arc.points << a.point, a.point + from, b.point - to, b.point;
  arc.places << a.at, a.at + leaving, b.at - coming, b.at;
  return arc;
}

bool TracedBranch::Passes(const MeetPoint& place, double reach) const {
  for (std::size_t k = 0; k < boxes.size(); ++k) {
    if (boxes[k].squaredExteriorDistance(place.point) > reach * reach) continue;
    const MeetArc arc = ArcBetween(stations[k], stations[k + 1]);
    // The foot on the cubic: a few steps from the chord's.
    const Eigen::Vector3d chord = arc.points.col(3) - arc.points.col(0);
    double t = (place.point - arc.points.col(0)).dot(chord) / std::max(chord.squaredNorm(), 1e-300);
    constexpr int kSteps = 4;
    for (int i = 0; i < kSteps; ++i) {
      t = std::clamp(t, 0.0, 1.0);
      t += (place.point - CubicAt<3>(arc.points, t)).dot(chord) /
           std::max(chord.squaredNorm(), 1e-300);
    }
    t = std::clamp(t, 0.0, 1.0);
    if ((CubicAt<3>(arc.points, t) - place.point).norm() > reach) continue;
    const Eigen::Vector4d apart = CubicAt<4>(arc.places, t) - place.at;
    const Eigen::Vector4d spread = stations[k + 1].at - stations[k].at;
    // The same place of the domains too, or another one of a surface that crosses itself.
    constexpr double kLike = 1.0;
    const double most = kLike * (spread.norm() + reach * place.velocity.norm());
    if (apart.norm() <= most || !place.regular) return true;
  }
  return false;
}

TracedBranch TraceBranch(const PairContact& contact, const Eigen::Vector4d& start) {
  TracedBranch branch;
  branch.kind = contact.kind();
  MeetPoint first = contact.PointAt(contact.OntoBorders(start));
  if (!first.regular) return branch;
  const Eigen::Vector4d on_border = contact.AlongBorders(first, first.at);
  if (on_border != first.at) first = contact.PointAt(on_border);
  if (!first.regular) return branch;
  // A hundredth of the way across the boxes to begin with.
  constexpr double kFirst = 0.01;
  const double step =
      kFirst /
      (first.velocity.cwiseQuotient(contact.upper() - contact.lower())).cwiseAbs().maxCoeff();
  Marcher marcher(contact);
  Marcher::March forward = marcher.From(first, step);
  branch.closed = forward.closed;
  if (!forward.closed) {
    const Marcher::March backward = marcher.From(first.Reversed(), step);
    for (std::size_t k = backward.stations.size(); k-- > 1;) {
      branch.stations.push_back(backward.stations[k].Reversed());
    }
  }
  branch.stations.insert(branch.stations.end(), forward.stations.begin(), forward.stations.end());
  branch.deviation = marcher.greatest();
  for (std::size_t k = 0; k + 1 < branch.stations.size(); ++k) {
    const MeetArc arc = ArcBetween(branch.stations[k], branch.stations[k + 1]);
    Eigen::AlignedBox3d box;
    for (int i = 0; i < 4; ++i) box.extend(Eigen::Vector3d(arc.points.col(i)));
    branch.boxes.push_back(box);
  }
  return branch;
}

}  // namespace batten::internal
