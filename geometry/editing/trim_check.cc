// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "geometry/editing/monotone_arcs.h"
#include "geometry/numeric/number_text.h"
#include "batten/geometry/trim_loops.h"
#include "geometry/numeric/reject.h"

namespace batten {
using namespace internal;
namespace {

constexpr double kResolution = 1e-9;  // of the domain

std::string LoopName(int loop) {
  return "trim loop " + std::to_string(loop) + (loop == 0 ? " (the outer one)" : " (a hole)");
}

std::string PlaceText(const UnitDomain& domain, const Eigen::Vector2d& place) {
  const Eigen::Vector2d uv = domain.Back(place);
  return "near u = " + NumberText(uv[0]) + ", v = " + NumberText(uv[1]);
}

void CheckInsideDomain(const std::vector<MonotoneArc>& arcs, const UnitDomain& domain) {
  for (const MonotoneArc& arc : arcs) {
    for (const int axis : {0, 1}) {
      if (arc.Low(axis) >= -kResolution && arc.High(axis) <= 1 + kResolution) continue;
      const bool low = arc.Low(axis) < -kResolution;
      const bool from = arc.from[axis] == (low ? arc.Low(axis) : arc.High(axis));
      Reject(
          "CheckTrims",
          LoopName(arc.loop) + " leaves the domain " + PlaceText(domain, from ? arc.from : arc.to));
    }
  }
}

void CheckTurning(const std::vector<NurbsCurve<2>>& loops, const UnitDomain& domain) {
  for (size_t k = 0; k < loops.size(); ++k) {
    const double area = SignedArea(loops[k]) / domain.length.prod();
    const std::string name = LoopName(static_cast<int>(k));
    if (!(std::abs(area) > kResolution * kResolution))
      Reject("CheckTrims", name + " bounds no area");
    if ((area > 0) == (k == 0)) continue;
    Reject("CheckTrims",
           name + (k == 0 ? " is not turned counter-clockwise" : " is not turned clockwise"));
  }
}

// Looks along horizontal lines halfway between neighbouring heights at which arcs begin or end, and
// at neighbours on such a line all the way between the two heights.
class WindingCheck {
 public:
  WindingCheck(const std::vector<MonotoneArc>& arcs, const UnitDomain& domain)
      : arcs_(arcs), domain_(domain) {}

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
    for (size_t k = 0; k + 1 < heights.size(); ++k) {
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

  void CheckSlab(const std::vector<int>& active, double low, double high) const {
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
        RejectWinding(line, k, {line[k].x + gap / 2, middle});
      }
      CheckOrder(line[k].arc, line[k + 1].arc, low, high);
    }
  }

  // Which loops are to blame for a place right of crossing k.
  [[noreturn]] void RejectWinding(const std::vector<Crossing>& line,
                                  size_t k,
                                  const Eigen::Vector2d& place) const {
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
    const std::string where = PlaceText(domain_, place);
    std::vector<int> holes;
    bool in_outer = false;
    for (const auto& [loop, winding] : windings) {
      if (winding == 0) continue;
      if (winding != (loop == 0 ? 1 : -1))
        Reject("CheckTrims", LoopName(loop) + " crosses itself " + where);
      in_outer = in_outer || loop == 0;
      if (loop > 0) holes.push_back(loop);
    }
    if (!in_outer)
      Reject("CheckTrims", LoopName(holes.front()) + " reaches beyond the outer loop " + where);
    Reject("CheckTrims", LoopName(holes[0]) + " and " + LoopName(holes[1]) + " overlap " + where);
  }

  // Throws where the arc `left` comes to lie right of the other. Stretches in which that is not
  // decided by the arcs' ends are halved, the greatest possible overlap first. [an arc is monotone]
  void CheckOrder(int left, int right, double low, double high) const {
    struct Stretch {
      double y0, y1, left0, left1, right0, right1;
      double Overlap() const { return std::max(left0, left1) - std::min(right0, right1); }
    };
    constexpr int kMostHalvings = 256;
    const auto less = [](const Stretch& a, const Stretch& b) { return a.Overlap() < b.Overlap(); };
    std::vector<Stretch> stretches{
        {low, high, At(left, low), At(left, high), At(right, low), At(right, high)}};
    for (int k = 0; k < kMostHalvings; ++k) {
      const Stretch worst = stretches.front();
      if (worst.Overlap() <= kResolution) return;
      const double y = worst.y0 + (worst.y1 - worst.y0) / 2;
      const double at_left = At(left, y), at_right = At(right, y);
      if (at_left > at_right + kResolution) RejectCrossing(left, right, {at_left, y});
      std::pop_heap(stretches.begin(), stretches.end(), less);
      stretches.back() = {worst.y0, y, worst.left0, at_left, worst.right0, at_right};
      std::push_heap(stretches.begin(), stretches.end(), less);
      stretches.push_back({y, worst.y1, at_left, worst.left1, at_right, worst.right1});
      std::push_heap(stretches.begin(), stretches.end(), less);
    }
  }

  [[noreturn]] void RejectCrossing(int a, int b, const Eigen::Vector2d& place) const {
    const int first = arcs_[a].loop, second = arcs_[b].loop;
    const std::string where = PlaceText(domain_, place);
    if (first == second) Reject("CheckTrims", LoopName(first) + " crosses itself " + where);
    Reject("CheckTrims",
           LoopName(std::min(first, second)) + " and " + LoopName(std::max(first, second)) +
               " cross " + where);
  }

  const std::vector<MonotoneArc>& arcs_;
  const UnitDomain& domain_;
};

}  // namespace

void CheckTrims(const NurbsSurface& surface) {
  const UnitDomain domain(surface);
  const std::vector<MonotoneArc> arcs = MonotoneArcs(surface.trims(), domain);
  CheckInsideDomain(arcs, domain);
  CheckTurning(surface.trims(), domain);
  WindingCheck(arcs, domain).Run();
}

}  // namespace batten
