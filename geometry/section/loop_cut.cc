// SPDX-License-Identifier: MIT
#include "geometry/section/loop_cut.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "batten/geometry/join.h"
#include "batten/geometry/reparameterize.h"
#include "batten/geometry/reverse.h"
#include "batten/geometry/split.h"
#include "batten/geometry/trim_loops.h"
#include "geometry/numeric/polygon.h"
#include "geometry/section/plane_curve_crossings.h"

namespace batten::internal {
namespace {

enum class Kind { kLoop, kForward, kBackward };

// A directed piece with its face on the left.
struct HalfEdge {
  NurbsCurve<2> curve;
  int from, to;
  Kind kind;
  double start_angle, end_angle;  // the directions in which it leaves, and looks back from its end
  bool used = false;
};

// A closed walk round one face.
struct Cycle {
  NurbsCurve<2> curve;
  double area;
  bool has_curve, left;
};

double AngleOf(const Eigen::Vector2d& d) { return std::atan2(d[1], d[0]); }

class Cutter {
 public:
  Cutter(const std::vector<NurbsCurve<2>>& loops,
         const std::vector<NurbsCurve<2>>& curves,
         const std::function<bool(const Eigen::Vector2d&)>& inside,
         double tolerance,
         const char* function)
      : loops_(loops),
        curves_(curves),
        inside_(inside),
        tolerance_(tolerance),
        function_(function) {}

  std::vector<RegionPart> Parts() {
    cuts_of_loops_.resize(loops_.size());
    cuts_of_curves_.resize(curves_.size());
    FindCrossings();
    for (std::size_t k = 0; k < curves_.size(); ++k)
      AddPieces(curves_[k], cuts_of_curves_[k], true);
    if (edges_.empty()) return {};
    for (std::size_t k = 0; k < loops_.size(); ++k) AddPieces(loops_[k], cuts_of_loops_[k], false);
    CheckEnds();
    return Assembled(Cycles());
  }

 private:
  struct Cut {
    double at;
    int node;
  };

  [[noreturn]] void Refuse(const std::string& why) const {
    throw std::invalid_argument(std::string(function_) + ": " + why);
  }

  // The number of the place, a known one if one is near.
  int NodeAt(const Eigen::Vector2d& at) {
    constexpr double kOne = 100;
    for (std::size_t k = 0; k < nodes_.size(); ++k) {
      if ((nodes_[k] - at).norm() <= kOne * tolerance_) return static_cast<int>(k);
    }
    nodes_.push_back(at);
    return static_cast<int>(nodes_.size()) - 1;
  }

  void FindCrossings() {
    for (std::size_t i = 0; i < loops_.size(); ++i) {
      for (std::size_t k = 0; k < curves_.size(); ++k) {
        for (const CurveCrossing& one : CurveCrossings(loops_[i], curves_[k], tolerance_)) {
          const int node = NodeAt(one.at);
          cuts_of_loops_[i].push_back({one.s, node});
          cuts_of_curves_[k].push_back({one.t, node});
        }
      }
    }
  }

  // The curve with its ends put on nodes.
  NurbsCurve<2> Snapped(const NurbsCurve<2>& curve, int from, int to) const {
    NurbsCurve<2>::Points points = curve.control_points();
    points.leftCols<1>() = nodes_[from];
    points.rightCols<1>() = nodes_[to];
    return NurbsCurve<2>(curve.basis(), std::move(points), curve.weights());
  }

  void AddPieces(const NurbsCurve<2>& whole, std::vector<Cut> cuts, bool cutting) {
    const double lower = whole.basis().lower(), upper = whole.basis().upper();
    cuts.push_back({lower, NodeAt(whole.At(lower))});
    cuts.push_back({upper, NodeAt(whole.At(upper))});
    std::stable_sort(
        cuts.begin(), cuts.end(), [](const Cut& a, const Cut& b) { return a.at < b.at; });
    // Neighbours at one node are one, unless the curve has gone round between them.
    std::vector<Cut> places;
    for (const Cut& cut : cuts) {
      const bool again = !places.empty() && places.back().node == cut.node &&
                         StaysNear(whole, places.back().at, cut);
      if (!again) {
        places.push_back(cut);
      } else if (cut.at == upper) {
        places.back().at = places.size() == 1 ? lower : upper;
      }
    }
    for (std::size_t k = 0; k + 1 < places.size(); ++k) {
      AddPiece(
          Snapped(
              Segment(whole, places[k].at, places[k + 1].at), places[k].node, places[k + 1].node),
          places[k].node,
          places[k + 1].node,
          cutting);
    }
  }

  bool StaysNear(const NurbsCurve<2>& curve, double from, const Cut& to) const {
    constexpr double kNear = 400;
    for (const double share : {0.25, 0.5, 0.75}) {
      const Eigen::Vector2d at = curve.At(from + share * (to.at - from));
      if ((at - nodes_[to.node]).norm() > kNear * tolerance_) return false;
    }
    return true;
  }

  void AddPiece(const NurbsCurve<2>& curve, int from, int to, bool cutting) {
    const NurbsCurve<2> even = Reparameterized(curve, 0, PolygonLength(curve.control_points()));
    if (!cutting) {
      AddEdge(even, from, to, Kind::kLoop);
    } else if (Inside(even)) {
      AddEdge(even, from, to, Kind::kForward);
      AddEdge(Reversed(even), to, from, Kind::kBackward);
    }
  }

  // A piece between crossings is inside or outside as a whole: by most of three places.
  bool Inside(const NurbsCurve<2>& curve) const {
    const double a = curve.basis().lower(), length = curve.basis().upper() - a;
    int count = 0;
    for (const double share : {0.31, 0.5, 0.73}) count += inside_(curve.At(a + share * length));
    return count >= 2;
  }

  // Directions are taken a little away from the ends, so that tangents that agree tell apart.
  void AddEdge(const NurbsCurve<2>& curve, int from, int to, Kind kind) {
    constexpr double kAway = 1e-3;
    const double a = curve.basis().lower(), b = curve.basis().upper(), step = kAway * (b - a);
    edges_.push_back({curve,
                      from,
                      to,
                      kind,
                      AngleOf(curve.At(a + step) - nodes_[from]),
                      AngleOf(curve.At(b - step) - nodes_[to])});
  }

  void CheckEnds() const {
    std::vector<int> count(nodes_.size(), 0);
    for (const HalfEdge& edge : edges_) {
      ++count[edge.from];
      ++count[edge.to];
    }
    for (const HalfEdge& edge : edges_) {
      if (edge.kind == Kind::kLoop) continue;
      for (const int node : {edge.from, edge.to}) {
        if (edge.from != edge.to && count[node] == 2) {
          Refuse("the curve ends inside, at " + std::to_string(nodes_[node][0]) + ", " +
                 std::to_string(nodes_[node][1]) + "; it must be closed or go through");
        }
      }
    }
  }

  // The edge after `edge` round the face on its left: the first clockwise from where it comes from.
  HalfEdge* After(const HalfEdge& edge, const HalfEdge& first) {
    HalfEdge* best = nullptr;
    double least = std::numeric_limits<double>::infinity();
    for (HalfEdge& next : edges_) {
      if (next.from != edge.to || (next.used && &next != &first)) continue;
      double turn = edge.end_angle - next.start_angle;
      // The way back comes last.
      constexpr double kBack = 1e-9;
      while (turn <= kBack) turn += 2 * std::numbers::pi;
      while (turn > 2 * std::numbers::pi + kBack) turn -= 2 * std::numbers::pi;
      if (turn < least) {
        least = turn;
        best = &next;
      }
    }
    return best;
  }

  std::vector<Cycle> Cycles() {
    std::vector<Cycle> cycles;
    for (HalfEdge& first : edges_) {
      if (first.used) continue;
      first.used = true;
      Cycle cycle{first.curve, 0, false, false};
      const HalfEdge* edge = &first;
      for (;;) {
        if (edge->kind != Kind::kLoop) {
          cycle.has_curve = true;
          cycle.left = edge->kind == Kind::kForward;
        }
        HalfEdge* next = After(*edge, first);
        if (!next) Refuse("the curves do not part the inside: they cross or touch one another");
        if (next == &first) break;
        next->used = true;
        cycle.curve = Join(cycle.curve, next->curve, tolerance_);
        edge = next;
      }
      cycle.area = SignedArea(cycle.curve);
      cycles.push_back(std::move(cycle));
    }
    return cycles;
  }

  // Holes to the smallest outer boundary round them.
  std::vector<RegionPart> Assembled(std::vector<Cycle> cycles) const {
    std::vector<RegionPart> parts;
    std::vector<double> areas;
    for (Cycle& cycle : cycles) {
      if (cycle.area <= 0) continue;
      parts.push_back({{cycle.curve}, cycle.has_curve && cycle.left});
      areas.push_back(cycle.area);
    }
    for (Cycle& cycle : cycles) {
      if (cycle.area > 0) continue;
      const SplineBasis& basis = cycle.curve.basis();
      const Eigen::Vector2d at =
          cycle.curve.At(basis.lower() + 0.37 * (basis.upper() - basis.lower()));
      std::optional<std::size_t> owner;
      constexpr double kLarger = 1 + 1e-9;  // not its own other side
      for (std::size_t k = 0; k < parts.size(); ++k) {
        if (areas[k] > kLarger * -cycle.area && Winds(parts[k].loops[0], at) &&
            (!owner || areas[k] < areas[*owner])) {
          owner = k;
        }
      }
      if (!owner) Refuse("the curves cross one another or themselves");
      if (cycle.has_curve) parts[*owner].left = cycle.left;
      parts[*owner].loops.push_back(std::move(cycle.curve));
    }
    return parts;
  }

  // Whether the loop goes round the place, by its polygon.
  bool Winds(const NurbsCurve<2>& loop, const Eigen::Vector2d& at) const {
    constexpr double kOfTheLoop = 1e-6;
    const Polygon polygon = LoopPolyline(loop, kOfTheLoop * PolygonLength(loop.control_points()));
    bool winds = false;
    const Eigen::Index n = polygon.points.cols();
    for (Eigen::Index k = 0; k < n; ++k) {
      const Eigen::Vector2d a = polygon.points.col(k), b = polygon.points.col((k + 1) % n);
      if ((a[1] > at[1]) == (b[1] > at[1])) continue;
      if (at[0] < a[0] + (at[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])) winds = !winds;
    }
    return winds;
  }

  const std::vector<NurbsCurve<2>>&loops_, &curves_;
  const std::function<bool(const Eigen::Vector2d&)>& inside_;
  double tolerance_;
  const char* function_;
  std::vector<Eigen::Vector2d> nodes_;
  std::vector<std::vector<Cut>> cuts_of_loops_, cuts_of_curves_;
  std::vector<HalfEdge> edges_;
};

}  // namespace

std::vector<RegionPart> CutLoops(const std::vector<NurbsCurve<2>>& loops,
                                 const std::vector<NurbsCurve<2>>& curves,
                                 const std::function<bool(const Eigen::Vector2d&)>& inside,
                                 double tolerance,
                                 const char* function) {
  return Cutter(loops, curves, inside, tolerance, function).Parts();
}

}  // namespace batten::internal
