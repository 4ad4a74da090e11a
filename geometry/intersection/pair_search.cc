// SPDX-License-Identifier: MIT
#include "geometry/intersection/pair_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>

#include "geometry/numeric/number_text.h"
#include "geometry/numeric/reject.h"

namespace batten::internal {
namespace {

constexpr double kMostSpread = 0.6;     // radians: a cone wider than this is not nearly flat
constexpr double kShareOfAngle = 0.25;  // of the angle between the axes must lie between the cones
constexpr double kGap = 0.01;           // of the tolerance: nearer than this may meet
constexpr double kFinestAlike = 1.0 / 64;  // of the size: so near the edge of a contact is known
constexpr double kReach = 4;               // tolerances: within this a traced branch passes

bool Transversal(const NetPatch& a, const NetPatch& b) {
  if (!(a.normal.spread < kMostSpread && b.normal.spread < kMostSpread)) return false;
  const double angle = LineAngle(a.normal.axis, b.normal.axis);
  return angle * (1 - kShareOfAngle) > a.normal.spread + b.normal.spread;
}

// Whether the line in which the tangent planes at the middles meet passes the rectangles of both,
// those a little widened: else Newton's method is not worth its while.
bool LinesMeet(const NetPatch& a, const NetPatch& b) {
  const Eigen::Vector3d na = a.half_u.cross(a.half_v), nb = b.half_u.cross(b.half_v);
  const Eigen::Vector3d along = na.cross(nb);
  const Eigen::Vector3d through =
      (na.dot(a.middle) * nb.cross(along) + nb.dot(b.middle) * along.cross(na) +
       along.dot(a.middle + b.middle) / 2 * along) /
      along.squaredNorm();
  double from = -std::numeric_limits<double>::infinity(), to = -from;
  const auto clip = [&](const NetPatch& patch, const Eigen::Vector3d& normal) {
    const double area = normal.squaredNorm();
    const Eigen::Vector3d offset = through - patch.middle;
    const Eigen::Vector2d place(offset.cross(patch.half_v).dot(normal) / area,
                                patch.half_u.cross(offset).dot(normal) / area);
    const Eigen::Vector2d speed(along.cross(patch.half_v).dot(normal) / area,
                                patch.half_u.cross(along).dot(normal) / area);
    constexpr double kWidened = 1.25;
    for (int i = 0; i < 2; ++i) {
      const double x = (-kWidened - place[i]) / speed[i], y = (kWidened - place[i]) / speed[i];
      from = std::max(from, std::min(x, y));
      to = std::min(to, std::max(x, y));
    }
  };
  clip(a, na);
  clip(b, nb);
  return !(from > to);
}

Eigen::Vector4d LowerOf(const NetPatch& a, const NetPatch& b) {
  return {a.box.u0, a.box.v0, b.box.u0, b.box.v0};
}

Eigen::Vector4d UpperOf(const NetPatch& a, const NetPatch& b) {
  return {a.box.u1, a.box.v1, b.box.u1, b.box.v1};
}

// The middle of the part of the line at + τ·velocity in a box a little widened.
std::optional<double> MiddleInBox(const Eigen::Vector4d& at,
                                  const Eigen::Vector4d& velocity,
                                  const Eigen::Vector4d& lower,
                                  const Eigen::Vector4d& upper) {
  double from = -std::numeric_limits<double>::infinity(), to = -from;
  for (int i = 0; i < 4; ++i) {
    if (velocity[i] == 0) {
      if (at[i] < lower[i] || at[i] > upper[i]) return std::nullopt;
      continue;
    }
    const double x = (lower[i] - at[i]) / velocity[i], y = (upper[i] - at[i]) / velocity[i];
    from = std::max(from, std::min(x, y));
    to = std::min(to, std::max(x, y));
  }
  if (!(from <= to) || !std::isfinite(from + to)) return std::nullopt;
  return from / 2 + to / 2;
}

}  // namespace

PairSearch::PairSearch(PatchTree& a, PatchTree& b, NurbsSurface moved_b, double tolerance)
    : a_(a), b_(b), moved_b_(std::move(moved_b)), tolerance_(tolerance) {}

FoundMeets PairSearch::Run() {
  for (const Pair& root : RootPairs()) {
    pairs_.push_back(root);
    while (!pairs_.empty()) {
      const Pair pair = pairs_.back();
      pairs_.pop_back();
      Compare(pair);
    }
  }
  return std::move(found_);
}

// Boxes sorted by their lower ends along x, those of the other surface kept while they last.
std::vector<PairSearch::Pair> PairSearch::RootPairs() const {
  const auto sorted = [](const PatchTree& tree) {
    std::vector<int> order(tree.roots());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](int x, int y) {
      return tree[x].bounds.min()[0] < tree[y].bounds.min()[0];
    });
    return order;
  };
  std::vector<Pair> pairs;
  const std::vector<int> order_a = sorted(a_), order_b = sorted(b_);
  std::vector<int> active_a, active_b;
  const auto drop = [](std::vector<int>& active, const PatchTree& tree, double x) {
    std::erase_if(active, [&](int k) { return tree[k].bounds.max()[0] < x; });
  };
  const double gap = kGap * tolerance_;
  std::size_t i = 0, j = 0;
  while (i < order_a.size() || j < order_b.size()) {
    const bool take_a =
        j == order_b.size() ||
        (i < order_a.size() && a_[order_a[i]].bounds.min()[0] <= b_[order_b[j]].bounds.min()[0]);
    const int k = take_a ? order_a[i++] : order_b[j++];
    const double x = (take_a ? a_ : b_)[k].bounds.min()[0] - gap;
    drop(take_a ? active_b : active_a, take_a ? b_ : a_, x);
    for (const int other : take_a ? active_b : active_a) {
      const Pair pair = take_a ? Pair{k, other} : Pair{other, k};
      if (!Separated(a_[pair.first], b_[pair.second], gap)) pairs.push_back(pair);
    }
    (take_a ? active_a : active_b).push_back(k);
  }
  return pairs;
}

PairContact PairSearch::ContactOf(const Pair& pair) const {
  return PairContact(a_,
                     a_.SmoothBoxOf(pair.first),
                     b_,
                     b_.SmoothBoxOf(pair.second),
                     MeetKind::kCrossing,
                     tolerance_);
}

void PairSearch::Compare(const Pair& pair) {
  const NetPatch &a = a_[pair.first], &b = b_[pair.second];
  if (++seen_ > kMostMeetPairs) {
    Reject("IntersectSurfaces",
           "the surfaces are too alike to be told apart within the tolerance, near u, v = " +
               NumberText(a.Middle()[0]) + ", " + NumberText(a.Middle()[1]) +
               " of the first; ask for a larger tolerance");
  }
  if (Separated(a, b, kGap * tolerance_)) return;
  const double size = std::max(a.size(), b.size());
  if (Transversal(a, b)) {
    if (Decided(pair)) return;
    if (size <= tolerance_) {
      // At a pole Newton's method in a plane may not end.
      const bool regular =
          a.along_u.known() && a.along_v.known() && b.along_u.known() && b.along_v.known();
      if (!regular) FindInSmall(pair);
      return;
    }
  } else {
    const double angle = LineAngle(a.normal.axis, b.normal.axis);
    const bool alike = a.normal.known() && b.normal.known() && size <= kFinestAlike * a_.size() &&
                       std::max(a.flatness, b.flatness) <= tolerance_ / 4 &&
                       angle * size <= tolerance_;
    if (alike || Coincides(pair)) {
      found_.contacts.push_back({a.box, pair.first, pair.second});
      return;
    }
    if (size <= tolerance_) {
      FindInSmall(pair);
      return;
    }
  }
  Subdivide(pair);
}

void PairSearch::FindInSmall(const Pair& pair) {
  const PairContact contact = ContactOf(pair);
  Eigen::Vector4d start;
  start << a_[pair.first].Middle(), b_[pair.second].Middle();
  const auto at = contact.Nearest(start);
  if (at && contact.Inside(contact.OntoBorders(*at))) Found(contact, pair, *at);
}

void PairSearch::Subdivide(const Pair& pair) {
  const NetPatch &a = a_[pair.first], &b = b_[pair.second];
  const double flat = tolerance_ / 4;
  const bool by_bend = std::max(a.flatness, b.flatness) > flat && !Transversal(a, b);
  const bool first = by_bend ? a.flatness >= b.flatness : a.size() >= b.size();
  if (first) {
    const int half = a_.Halve(pair.first);
    pairs_.emplace_back(half, pair.second);
    pairs_.emplace_back(half + 1, pair.second);
  } else {
    const int half = b_.Halve(pair.second);
    pairs_.emplace_back(pair.first, half);
    pairs_.emplace_back(pair.first, half + 1);
  }
}

bool PairSearch::Decided(const Pair& pair) {
  const NetPatch &a = a_[pair.first], &b = b_[pair.second];
  if (!LinesMeet(a, b)) return false;
  const PairContact contact = ContactOf(pair);
  Eigen::Vector4d start;
  start << a.Middle(), b.Middle();
  const Eigen::Vector3d along = a.normal.axis.cross(b.normal.axis).normalized();
  const Eigen::Vector3d through = (a.middle + b.middle) / 2;
  std::optional<Eigen::Vector4d> at = contact.InPlane(start, along, through);
  if (!at) return false;
  constexpr double kWider = 1e-9;
  const Eigen::Vector4d wider = kWider * (UpperOf(a, b) - LowerOf(a, b));
  const Eigen::Vector4d lower = LowerOf(a, b) - wider, upper = UpperOf(a, b) + wider;
  const auto inside = [&](const Eigen::Vector4d& x) {
    return (x.array() >= lower.array()).all() && (x.array() <= upper.array()).all();
  };
  *at = contact.OntoBorders(*at);
  MeetPoint point = contact.PointAt(*at);
  if (!inside(*at)) {
    if (!point.regular) return false;
    const auto middle = MiddleInBox(*at, point.velocity, lower, upper);
    if (!middle) return false;
    at = contact.InPlane(
        *at + *middle * point.velocity, point.tangent, point.point + *middle * point.tangent);
    if (!at) return false;
    *at = contact.OntoBorders(*at);
    if (!inside(*at)) return false;
    point = contact.PointAt(*at);
  }
  Found(contact, pair, *at);
  if (std::max(a.flatness, b.flatness) <= tolerance_ / 4) return true;
  const double turn = std::asin(std::min(
      1.0, (std::sin(a.normal.spread) + std::sin(b.normal.spread)) / std::max(point.sine, 1e-9)));
  return MeetsBordersOnce(a_, pair.first, pair, point.tangent, turn) &&
         MeetsBordersOnce(b_, pair.second, pair, point.tangent, turn);
}

// Whether a branch in direction `tangent`, turned by up to `turn`, crosses each border of the
// smooth box that the patch touches at most once, or runs along it.
bool PairSearch::MeetsBordersOnce(const PatchTree& tree,
                                  int patch,
                                  const Pair& pair,
                                  const Eigen::Vector3d& tangent,
                                  double turn) const {
  const ParameterBox &box = tree[patch].box, &smooth = tree.SmoothBoxOf(patch);
  const auto across = [&](const DirectionCone& border) {
    return LineAngle(tangent, border.axis) > turn + border.spread;
  };
  const auto along = [&](double u0, double v0, double u1, double v1) {
    constexpr int kPlaces = 5;
    for (int k = 0; k < kPlaces; ++k) {
      const double t = k / (kPlaces - 1.0);
      MeetPoint place{};
      place.point = tree.PointAt(smooth, u0 + t * (u1 - u0), v0 + t * (v1 - v0));
      if (!Known(pair, place)) return false;
    }
    return true;
  };
  const auto once = [&](bool touches, const DirectionCone& border, const auto& edge) {
    return !touches || across(border) || edge();
  };
  return once(box.u0 == smooth.u0,
              tree[patch].along_v,
              [&] { return along(box.u0, box.v0, box.u0, box.v1); }) &&
         once(box.u1 == smooth.u1,
              tree[patch].along_v,
              [&] { return along(box.u1, box.v0, box.u1, box.v1); }) &&
         once(box.v0 == smooth.v0,
              tree[patch].along_u,
              [&] { return along(box.u0, box.v0, box.u1, box.v0); }) &&
         once(box.v1 == smooth.v1, tree[patch].along_u, [&] {
           return along(box.u0, box.v1, box.u1, box.v1);
         });
}

std::array<double, 4> PairSearch::BoxesOf(const Pair& pair) const {
  const ParameterBox &a = a_.SmoothBoxOf(pair.first), &b = b_.SmoothBoxOf(pair.second);
  return {a.u0, a.v0, b.u0, b.v0};
}

// Whether a branch known in the pair's smooth boxes passes.
bool PairSearch::Known(const Pair& pair, const MeetPoint& place) const {
  const auto known = by_boxes_.find(BoxesOf(pair));
  return known != by_boxes_.end() &&
         std::any_of(known->second.begin(), known->second.end(), [&](std::size_t k) {
           return found_.branches[k].Passes(place, kReach * tolerance_);
         });
}

void PairSearch::Found(const PairContact& contact, const Pair& pair, const Eigen::Vector4d& at) {
  const MeetPoint point = contact.PointAt(contact.OntoBorders(at));
  if (Known(pair, point)) return;
  if (point.regular) {
    TracedBranch branch = TraceBranch(contact, at);
    if (branch.stations.size() >= 2) {
      by_boxes_[BoxesOf(pair)].push_back(found_.branches.size());
      found_.branches.push_back(std::move(branch));
      return;
    }
  }
  found_.corners.push_back(point);
}

// Distances are those of local foot points: a bound is all that is needed.
bool PairSearch::Coincides(const Pair& pair) {
  const int patch_a = pair.first;
  if (coincides_.contains(patch_a)) return true;
  if (!feet_b_) feet_b_ = std::make_unique<SurfaceFootPoints>(moved_b_);
  const NetPatch& a = a_[patch_a];
  const ParameterBox& smooth = a_.SmoothBoxOf(patch_a);
  Eigen::Vector2d start = b_[pair.second].Middle();
  const auto near = [&](double s, double t) {
    const double u = a.box.u0 + s * (a.box.u1 - a.box.u0);
    const double v = a.box.v0 + t * (a.box.v1 - a.box.v0);
    const SurfaceFoot foot = feet_b_->Near(a_.PointAt(smooth, u, v), start[0], start[1]);
    start = {foot.u, foot.v};
    return foot.distance <= tolerance_;
  };
  // As many places as the difference of two bicubics of the same parameter has coefficients, and
  // more.
  constexpr int kPlaces = 5;
  if (!near(0.5, 0.5)) return false;
  for (int i = 0; i < kPlaces; ++i) {
    for (int j = 0; j < kPlaces; ++j) {
      if (!near(i / (kPlaces - 1.0), j / (kPlaces - 1.0))) return false;
    }
  }
  coincides_.insert(patch_a);
  return true;
}

}  // namespace batten::internal
