// SPDX-License-Identifier: MIT
#include "geometry/editing/trim_faults.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "batten/geometry/trim_loops.h"
#include "geometry/editing/monotone_arcs.h"
#include "geometry/numeric/number_text.h"
#include "geometry/numeric/reject.h"

namespace batten {
namespace internal {
namespace {

constexpr double kResolution = 1e-9;  // of the domain
constexpr size_t kMostFaults = 10000;
constexpr double kSameFault = 1e-3;  // of the domain: so near one another they are one fault

// Collects what is wrong with loops of which it knows how they are turned.
class FaultList {
 public:
  FaultList(const std::vector<NurbsCurve<2>>& loops, const UnitDomain& domain) : domain_(domain) {
    for (const NurbsCurve<2>& loop : loops)
      areas_.push_back(SignedArea(loop) / domain.length.prod());
  }

  int size() const { return static_cast<int>(areas_.size()); }
  double area(int loop) const { return areas_[loop]; }
  bool is_outer(int loop) const { return loop == 0 || areas_[loop] > 0; }
  bool full() const { return faults_.size() >= kMostFaults; }
  std::vector<TrimFault> Take() { return std::move(faults_); }

  std::string Name(int loop) const {
    return "trim loop " + std::to_string(loop) + (is_outer(loop) ? " (an outer one)" : " (a hole)");
  }

  void Add(int loop, int other, const std::string& rule) {
    if (!full()) faults_.push_back({loop, other, {}, rule});
  }
  void AddAt(int loop, int other, const Eigen::Vector2d& place, const std::string& rule) {
    if (full()) return;
    const auto [last, fresh] = last_.try_emplace({loop, other}, place);
    if (!fresh && (last->second - place).norm() < kSameFault) return;
    last->second = place;
    const Eigen::Vector2d uv = domain_.Back(place);
    faults_.push_back(
        {loop, other, uv, rule + " near u = " + NumberText(uv[0]) + ", v = " + NumberText(uv[1])});
  }

 private:
  const UnitDomain& domain_;
  std::vector<double> areas_;
  std::vector<TrimFault> faults_;
  std::map<std::pair<int, int>, Eigen::Vector2d> last_;  // where two loops were found at fault last
};

void CheckInsideDomain(const std::vector<MonotoneArc>& arcs, FaultList& faults) {
  for (const MonotoneArc& arc : arcs) {
    for (const int axis : {0, 1}) {
      if (arc.Low(axis) >= -kResolution && arc.High(axis) <= 1 + kResolution) continue;
      const bool low = arc.Low(axis) < -kResolution;
      const bool from = arc.from[axis] == (low ? arc.Low(axis) : arc.High(axis));
      faults.AddAt(
          arc.loop, -1, from ? arc.from : arc.to, faults.Name(arc.loop) + " leaves the domain");
    }
  }
}

void CheckTurning(FaultList& faults) {
  for (int k = 0; k < faults.size(); ++k) {
    if (!(std::abs(faults.area(k)) > kResolution * kResolution)) {
      faults.Add(k, -1, faults.Name(k) + " bounds no area");
    } else if (k == 0 && faults.area(0) < 0) {
      faults.Add(0, -1, faults.Name(0) + " is not turned counter-clockwise");
    }
  }
}

// Looks along horizontal lines halfway between neighbouring heights at which arcs begin or end, and
// at neighbours on such a line all the way between the two heights.
class WindingCheck {
 public:
  WindingCheck(const std::vector<MonotoneArc>& arcs, FaultList& faults)
      : arcs_(arcs), faults_(faults), known_(arcs.size()) {}

  void Run() {
    std::vector<int> by_height(arcs_.size());
    std::vector<double> heights;
    for (size_t k = 0; k < arcs_.size(); ++k) {
      by_height[k] = static_cast<int>(k);
      heights.insert(heights.end(), {arcs_[k].from[1], arcs_[k].to[1]});
    }
    std::sort(heights.begin(), heights.end());
    std::sort(by_height.begin(), by_height.end(), [&](int a, int b) {
      return arcs_[a].Low(1) < arcs_[b].Low(1);
    });
    std::vector<int> active;
    size_t next = 0;
    for (size_t k = 0; k + 1 < heights.size() && !faults_.full(); ++k) {
      const double low = heights[k], high = heights[k + 1];
      while (next < by_height.size() && arcs_[by_height[next]].Low(1) <= low) {
        active.push_back(by_height[next++]);
      }
      if (high - low <= kResolution) continue;
      std::erase_if(active, [&](int arc) { return arcs_[arc].High(1) <= low; });
      CheckSlab(active, low, high);
    }
  }

 private:
  struct Crossing {
    double x;
    int arc;
  };

  double At(int arc, double y) const { return arcs_[arc].At(arcs_[arc].Where(1, y))[0]; }

  // The same at the lower or upper height of a slab, which two slabs and two neighbours ask for.
  double AtHeight(int arc, double y) {
    for (const Known& known : known_[arc])
      if (known.y == y) return known.x;
    known_[arc][0] = known_[arc][1];
    known_[arc][1] = {y, At(arc, y)};
    return known_[arc][1].x;
  }

  void CheckSlab(const std::vector<int>& active, double low, double high) {
    const double middle = low + (high - low) / 2;
    std::vector<Crossing> line;
    for (const int arc : active) {
      if (arcs_[arc].High(1) >= high) line.push_back({At(arc, middle), arc});
    }
    std::sort(line.begin(), line.end(), [](const Crossing& a, const Crossing& b) {
      return a.x != b.x ? a.x < b.x : a.arc < b.arc;
    });
    int winding = 0;
    for (size_t k = 0; k + 1 < line.size(); ++k) {
      const MonotoneArc& arc = arcs_[line[k].arc];
      winding += arc.from[1] > arc.to[1] ? 1 : -1;  // the inside lies right of what runs down
      const double gap = line[k + 1].x - line[k].x;
      if (gap > kResolution && (winding < 0 || winding > 1)) {
        AddWinding(line, k, {line[k].x + gap / 2, middle});
      }
      CheckOrder(line[k].arc, line[k + 1].arc, low, high);
    }
  }

  // Which loops are to blame for a place right of crossing k.
  void AddWinding(const std::vector<Crossing>& line, size_t k, const Eigen::Vector2d& place) {
    std::vector<std::pair<int, int>> windings;  // of the loops that wind round the place
    for (size_t i = 0; i <= k; ++i) {
      const MonotoneArc& arc = arcs_[line[i].arc];
      const auto known = std::find_if(windings.begin(), windings.end(), [&](const auto& entry) {
        return entry.first == arc.loop;
      });
      const int turn = arc.from[1] > arc.to[1] ? 1 : -1;
      if (known == windings.end()) {
        windings.emplace_back(arc.loop, turn);
      } else {
        known->second += turn;
      }
    }
    std::vector<int> outer, holes;
    for (const auto& [loop, winding] : windings) {
      if (winding == 0) continue;
      if (winding != (faults_.is_outer(loop) ? 1 : -1)) {
        faults_.AddAt(loop, loop, place, faults_.Name(loop) + " crosses itself");
        return;
      }
      (faults_.is_outer(loop) ? outer : holes).push_back(loop);
    }
    if (outer.empty()) {
      faults_.AddAt(
          holes.front(), -1, place, faults_.Name(holes.front()) + " reaches beyond the outer loop");
      return;
    }
    const std::vector<int>& both = outer.size() > holes.size() ? outer : holes;
    faults_.AddAt(both[0],
                  both[1],
                  place,
                  faults_.Name(both[0]) + " and " + faults_.Name(both[1]) + " overlap");
  }

  // Adds a fault where the arc `left` comes to lie right of the other. Stretches in which that is
  // not decided by the arcs' ends are halved, the greatest possible overlap first. [an arc is
  // monotone]
  void CheckOrder(int left, int right, double low, double high) {
    struct Stretch {
      double y0, y1, left0, left1, right0, right1;
      double Overlap() const { return std::max(left0, left1) - std::min(right0, right1); }
    };
    constexpr int kMostHalvings = 256;
    const auto less = [](const Stretch& a, const Stretch& b) { return a.Overlap() < b.Overlap(); };
    std::vector<Stretch> stretches{{low,
                                    high,
                                    AtHeight(left, low),
                                    AtHeight(left, high),
                                    AtHeight(right, low),
                                    AtHeight(right, high)}};
    for (int k = 0; k < kMostHalvings; ++k) {
      const Stretch worst = stretches.front();
      if (worst.Overlap() <= kResolution) return;
      const double y = worst.y0 + (worst.y1 - worst.y0) / 2;
      const double at_left = At(left, y), at_right = At(right, y);
      if (at_left > at_right + kResolution) return AddCrossing(left, right, {at_left, y});
      std::pop_heap(stretches.begin(), stretches.end(), less);
      stretches.back() = {worst.y0, y, worst.left0, at_left, worst.right0, at_right};
      std::push_heap(stretches.begin(), stretches.end(), less);
      stretches.push_back({y, worst.y1, at_left, worst.left1, at_right, worst.right1});
      std::push_heap(stretches.begin(), stretches.end(), less);
    }
  }

  void AddCrossing(int a, int b, const Eigen::Vector2d& place) {
    const auto [first, second] = std::minmax(arcs_[a].loop, arcs_[b].loop);
    const std::string name = faults_.Name(first);
    faults_.AddAt(first,
                  second,
                  place,
                  first == second ? name + " crosses itself"
                                  : name + " and " + faults_.Name(second) + " cross");
  }

  struct Known {
    double y = std::numeric_limits<double>::quiet_NaN(), x = 0;
  };

  const std::vector<MonotoneArc>& arcs_;
  FaultList& faults_;
  std::vector<std::array<Known, 2>> known_;  // of an arc
};

}  // namespace

std::vector<TrimFault> TrimFaults(const NurbsSurface& surface) {
  const UnitDomain domain(surface);
  const std::vector<MonotoneArc> arcs = MonotoneArcs(surface.trims(), domain);
  FaultList faults(surface.trims(), domain);
  CheckInsideDomain(arcs, faults);
  CheckTurning(faults);
  WindingCheck(arcs, faults).Run();
  return faults.Take();
}

}  // namespace internal

void CheckTrims(const NurbsSurface& surface) {
  const std::vector<internal::TrimFault> faults = internal::TrimFaults(surface);
  if (!faults.empty()) internal::Reject("CheckTrims", faults.front().rule);
}

}  // namespace batten
