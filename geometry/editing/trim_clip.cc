// SPDX-License-Identifier: MIT
#include "geometry/editing/trim_clip.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "batten/geometry/clamp.h"
#include "batten/geometry/degree_elevation.h"
#include "batten/geometry/join.h"
#include "batten/geometry/remove_knots.h"
#include "batten/geometry/trim_loops.h"
#include "geometry/editing/split_rows.h"

namespace batten::internal {
namespace {

constexpr double kOnLine = 1e-10;  // of the domain
constexpr double kSame = 1e-12;

// Ends that met within kLoopClosure of the old domain would not always do so within that of a part.
NurbsCurve<2> Closed(const NurbsCurve<2>& curve) {
  if (!curve.basis().clamped()) return curve;
  Eigen::Matrix2Xd points = curve.control_points();
  points.rightCols<1>() = points.col(0);
  return NurbsCurve<2>(curve.basis(), std::move(points), curve.weights());
}

NurbsCurve<2> SegmentOf(const NurbsCurve<2>& curve, double a, double b) {
  return Edited(curve, [&](const ControlRows& rows) { return SegmentRows(rows, a, b); });
}

// A stretch of a loop on the kept side, from the line to the line; through the loop's end where
// s1 ≤ s0.
struct Chain {
  int loop;
  double s0, s1;
  Eigen::Vector2d from, to;  // in the unit domain
  double length = 0;         // of the polygon of its arcs
};

// What is left of the loops: some whole, of others chains.
struct Kept {
  std::vector<int> whole;
  std::vector<Chain> chains;
};

class Cutter {
 public:
  Cutter(const TrimLoops& loops,
         const UnitDomain& domain,
         Direction direction,
         double at,
         KeptSide side)
      : loops_(loops),
        domain_(domain),
        axis_(direction == Direction::kU ? 0 : 1),
        at_(at),
        line_((at - domain.lower[axis_]) / domain.length[axis_]),
        sign_(side == KeptSide::kBelow ? 1 : -1) {}

  std::vector<TrimLoops> Parts() const {
    const Kept kept = Kept_();
    TrimLoops left;
    for (const int loop : kept.whole) left.push_back(Closed(loops_[loop]));
    for (const std::vector<int>& ring : Rings(kept.chains)) left.push_back(Curve(kept, ring));
    return Sorted(std::move(left));
  }

 private:
  // 1 on the kept side, −1 on the other, 0 on the line.
  int SideOf(const Eigen::Vector2d& place) const {
    const double beyond = sign_ * (line_ - place[axis_]);
    return beyond > kOnLine ? 1 : beyond < -kOnLine ? -1 : 0;
  }

  // The part [t0, t1] of an arc that is kept.
  std::optional<std::pair<double, double>> KeptPart(const MonotoneArc& arc) const {
    const int from = SideOf(arc.from), to = SideOf(arc.to);
    if (from + to > 0) return std::pair(0.0, 1.0);
    if (from * to >= 0) return std::nullopt;
    const double t = arc.Where(axis_, line_);
    return from > 0 ? std::pair(0.0, t) : std::pair(t, 1.0);
  }

  Kept Kept_() const {
    const std::vector<MonotoneArc> arcs = MonotoneArcs(loops_, domain_);
    Kept kept;
    for (size_t first = 0; first < arcs.size();) {
      size_t end = first;
      while (end < arcs.size() && arcs[end].loop == arcs[first].loop) ++end;
      AddLoop({arcs.begin() + first, arcs.begin() + end}, kept);
      first = end;
    }
    return kept;
  }

  void AddLoop(const std::vector<MonotoneArc>& arcs, Kept& kept) const {
    const size_t count = arcs.size();
    std::vector<std::optional<std::pair<double, double>>> parts;
    for (const MonotoneArc& arc : arcs) parts.push_back(KeptPart(arc));
    const auto ends_after = [&](size_t k) {  // whether what is kept stops in arc k or at its end
      const auto& next = parts[(k + 1) % count];
      return parts[k] && (parts[k]->second < 1 || !next || next->first > 0);
    };
    size_t start = 0;
    while (start < count && !ends_after(start)) ++start;
    if (start == count) {
      if (parts[0]) kept.whole.push_back(arcs[0].loop);
      return;
    }
    std::optional<Chain> open;
    for (size_t i = 1; i <= count; ++i) {
      const size_t k = (start + i) % count;
      if (!parts[k]) continue;
      const MonotoneArc& arc = arcs[k];
      const auto [t0, t1] = *parts[k];
      if (!open) open = Chain{arc.loop, arc.ParameterAt(t0), 0, arc.At(t0), {}};
      open->s1 = t1 < 1 ? arc.ParameterAt(t1) : arc.s1;
      open->to = arc.At(t1);
      open->length += (arc.At(t1) - arc.At(t0)).norm();
      if (!ends_after(k)) continue;
      kept.chains.push_back(*open);
      open.reset();
    }
  }

  // An end of a chain on the line. With the kept side at the left hand one goes from where a chain
  // arrives to where the next one leaves.
  struct Event {
    double along;
    int chain;
    bool arrives;
  };

  // Rings of chains, each to be joined to the next along the line.
  std::vector<std::vector<int>> Rings(const std::vector<Chain>& chains) const {
    const double forward = axis_ == 0 ? sign_ : -sign_;
    std::vector<int> next(chains.size(), -1);
    std::vector<Event> events;
    for (int k = 0; k < static_cast<int>(chains.size()); ++k) {
      if ((chains[k].from - chains[k].to).cwiseAbs().maxCoeff() <= kSame) {
        next[k] = k;
        continue;
      }
      events.push_back({forward * chains[k].from[1 - axis_], k, false});
      events.push_back({forward * chains[k].to[1 - axis_], k, true});
    }
    std::sort(events.begin(), events.end(), [](const Event& a, const Event& b) {
      return a.along != b.along ? a.along < b.along : a.arrives > b.arrives;
    });
    for (size_t k = 0; k < events.size(); ++k) {
      BringForward(events, k);
      if (!events[k].arrives) next[events[k - 1].chain] = events[k].chain;
    }
    return Cycles(next);
  }

  // Arrivals and departures take turns; where several meet in one place, their order there is free.
  void BringForward(std::vector<Event>& events, size_t k) const {
    constexpr double kOnePlace = 1e-8;
    const bool arrives = k % 2 == 0;
    size_t found = k;
    while (found < events.size() && events[found].arrives != arrives &&
           events[found].along <= events[k].along + kOnePlace) {
      ++found;
    }
    if (found == events.size() || events[found].arrives != arrives) {
      throw std::invalid_argument(
          "Split: trim loops cross each other or are not turned; CheckTrims says where");
    }
    std::rotate(events.begin() + k, events.begin() + found, events.begin() + found + 1);
  }

  static std::vector<std::vector<int>> Cycles(const std::vector<int>& next) {
    std::vector<std::vector<int>> rings;
    std::vector<bool> seen(next.size(), false);
    for (int first = 0; first < static_cast<int>(next.size()); ++first) {
      if (seen[first]) continue;
      std::vector<int>& ring = rings.emplace_back();
      for (int k = first; !seen[k]; k = next[k]) {
        seen[k] = true;
        ring.push_back(k);
      }
    }
    return rings;
  }

  NurbsCurve<2> Curve(const Kept& kept, const std::vector<int>& ring) const {
    std::optional<NurbsCurve<2>> curve;
    for (size_t i = 0; i < ring.size(); ++i) {
      const Chain& chain = kept.chains[ring[i]];
      const Chain& next = kept.chains[ring[(i + 1) % ring.size()]];
      const NurbsCurve<2> piece = CurveOf(chain);
      curve = curve ? Joined(*curve, piece) : piece;
      if ((next.from - chain.to).cwiseAbs().maxCoeff() <= kSame) continue;
      curve = Joined(*curve, Line(*curve, chain, next));
    }
    return Closed(*curve);
  }

  NurbsCurve<2> Joined(const NurbsCurve<2>& a, const NurbsCurve<2>& b) const {
    return Join(a, b, kLoopClosure * domain_.length.maxCoeff());
  }

  // From the end of the curve to where the next chain begins, run through about as fast as the
  // chain.
  NurbsCurve<2> Line(const NurbsCurve<2>& curve, const Chain& chain, const Chain& next) const {
    const SplineBasis& whole = loops_[chain.loop].basis();
    double parameters = chain.s1 - chain.s0;
    if (parameters <= 0) parameters += whole.upper() - whole.lower();
    const double length = (next.from - chain.to).norm();
    const double speed = chain.length / parameters;
    Eigen::Matrix2Xd points(2, 2);
    points << curve.control_points().rightCols<1>(), OnLine(next.from);
    const SplineBasis basis = SplineBasis::Uniform(1, 2, 0, length / speed);
    return Elevated(NurbsCurve<2>(basis, std::move(points)), curve.basis().degree() - 1);
  }

  // In the surface's parameters, exactly on the line where it is that to rounding.
  Eigen::Vector2d OnLine(const Eigen::Vector2d& place) const {
    Eigen::Vector2d uv = domain_.Back(place);
    if (std::abs(place[axis_] - line_) <= kSame) uv[axis_] = at_;
    return uv;
  }

  NurbsCurve<2> CurveOf(const Chain& chain) const {
    const NurbsCurve<2> loop = Clamped(loops_[chain.loop]);
    const double lower = loop.basis().lower(), upper = loop.basis().upper();
    NurbsCurve<2> curve = loop;
    if (chain.s0 < chain.s1) {
      if (chain.s0 > lower || chain.s1 < upper) curve = SegmentOf(loop, chain.s0, chain.s1);
    } else {
      curve = ThroughItsEnd(loop, chain);
    }
    Eigen::Matrix2Xd points = curve.control_points();
    points.col(0) = OnLine(chain.from);
    points.rightCols<1>() = OnLine(chain.to);
    return NurbsCurve<2>(curve.basis(), std::move(points), curve.weights());
  }

  // Smooth through the loop's end where the loop is.
  NurbsCurve<2> ThroughItsEnd(const NurbsCurve<2>& loop, const Chain& chain) const {
    const double lower = loop.basis().lower(), upper = loop.basis().upper();
    const NurbsCurve<2> whole =
        Joined(SegmentOf(loop, chain.s0, upper), SegmentOf(loop, lower, chain.s1));
    const int times = whole.basis().degree() - 1;
    if (times == 0) return whole;
    return RemoveKnot(whole, upper, times, kSame * domain_.length.minCoeff()).shape;
  }

  // Every hole to the smallest outer loop round it.
  std::vector<TrimLoops> Sorted(TrimLoops left) const {
    struct Part {
      TrimLoops loops;
      double area;
    };
    std::vector<Part> parts;
    TrimLoops holes;
    for (NurbsCurve<2>& loop : left) {
      const double area = SignedArea(loop);
      if (area > 0) {
        parts.push_back({{std::move(loop)}, area});
      } else {
        holes.push_back(std::move(loop));
      }
    }
    for (NurbsCurve<2>& hole : holes) {
      const Eigen::Vector2d place = domain_(hole.At(hole.basis().lower()));
      Part* best = nullptr;
      for (Part& part : parts) {
        if (best != nullptr && part.area >= best->area) continue;
        if (parts.size() > 1 && !Inside(part.loops[0], place)) continue;
        best = &part;
      }
      if (best == nullptr) {
        throw std::invalid_argument("Split: a hole lies outside the outer trim loop");
      }
      best->loops.push_back(std::move(hole));
    }
    std::vector<TrimLoops> result;
    for (Part& part : parts) result.push_back(std::move(part.loops));
    return result;
  }

  bool Inside(const NurbsCurve<2>& loop, const Eigen::Vector2d& place) const {
    bool inside = false;
    for (const MonotoneArc& arc : MonotoneArcs({loop}, domain_)) {
      if (!(arc.Low(1) <= place[1] && place[1] < arc.High(1))) continue;
      if (arc.At(arc.Where(1, place[1]))[0] > place[0]) inside = !inside;
    }
    return inside;
  }

  const TrimLoops& loops_;
  const UnitDomain& domain_;
  int axis_;
  double at_, line_, sign_;
};

}  // namespace

bool FillsDomain(const TrimLoops& loops, const UnitDomain& domain) {
  if (loops.size() != 1) return false;
  const auto along_side = [](const MonotoneArc& arc) {
    for (const int axis : {0, 1}) {
      if (arc.High(axis) <= kOnLine || arc.Low(axis) >= 1 - kOnLine) return true;
    }
    return false;
  };
  const std::vector<MonotoneArc> arcs = MonotoneArcs(loops, domain);
  return std::all_of(arcs.begin(), arcs.end(), along_side);
}

std::vector<TrimLoops> CutTrims(const TrimLoops& loops,
                                const UnitDomain& domain,
                                Direction direction,
                                double at,
                                KeptSide side) {
  return Cutter(loops, domain, direction, at, side).Parts();
}

}  // namespace batten::internal
