// SPDX-License-Identifier: MIT
#include "fitting/flattening/cohomology_basis.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <optional>
#include <queue>
#include <utility>

namespace batten::internal {
namespace {

constexpr int kAsked = 24;    // edges that may begin a loop, of those left …
constexpr double kShort = 2;  // … and all of them if it is as short, in lengths that are filled

constexpr int kMostLoops = 64;

// Crossings of the cuts of all loops.
using Count = Eigen::Matrix<int, Eigen::Dynamic, 1, Eigen::ColMajor, kMostLoops, 1>;

struct Triangle {
  int edges[3];  // ab, bc, ac with a < b < c: crossings of the first two add to those of the last
};

constexpr int kSigns[3] = {1, 1, -1};

class Cuts {
 public:
  Cuts(const PoissonDiskSamples& nodes,
       const std::vector<PlanarEdge>& edges,
       double most_filled,
       int most_loops)
      : nodes_(nodes), edges_(edges), most_filled_(most_filled), most_loops_(most_loops) {
    next_.resize(static_cast<size_t>(nodes.size()));
    for (size_t e = 0; e < edges.size(); ++e) {
      next_[edges[e].first].push_back({edges[e].second, static_cast<int>(e)});
      next_[edges[e].second].push_back({edges[e].first, static_cast<int>(e)});
    }
    for (auto& list : next_) std::sort(list.begin(), list.end());
    for (const PlanarEdge& edge : edges) edge_lengths_.push_back(std::abs(edge.from_first));
    FindTriangles();
    known_.assign(edges.size(), false);
    crossings_.assign(edges.size(), Count::Zero(most_loops));
    distance_.assign(next_.size(), kFar);
    before_.assign(next_.size(), {-1, -1});
  }

  std::vector<SheetLoop> Find() {
    GrowTree();
    Propagate();
    for (;;) {
      FillSmallLoops();
      if (static_cast<int>(lengths_.size()) == most_loops_ || !BeginLoop()) break;
      Propagate();
    }
    return Loops();
  }

 private:
  static constexpr double kFar = std::numeric_limits<double>::infinity();

  double Length(int edge) const { return edge_lengths_[edge]; }

  void FindTriangles() {
    around_.resize(edges_.size());
    for (size_t e = 0; e < edges_.size(); ++e) {
      const int a = edges_[e].first, b = edges_[e].second;
      auto i = next_[a].begin(), j = next_[b].begin();
      while (i != next_[a].end() && j != next_[b].end()) {
        if (i->first != j->first) {
          ++(i->first < j->first ? i : j);
          continue;
        }
        if (i->first > b) {
          const auto triangle = static_cast<int>(triangles_.size());
          triangles_.push_back({{static_cast<int>(e), j->second, i->second}});
          for (const int edge : triangles_.back().edges) around_[edge].push_back(triangle);
        }
        ++i;
        ++j;
      }
    }
  }

  void Learn(int edge, Count crossings) {
    known_[edge] = true;
    crossings_[edge] = std::move(crossings);
    fresh_.push_back(edge);
  }

  // Shortest ways from a node over the edges that `usable` lets pass, to nodes no farther than
  // `farthest`, until `goal` is reached. Leaves what it did in distance_ and before_.
  template <typename Usable>
  void Search(int from, int goal, double farthest, const Usable& usable) {
    for (const int node : touched_) distance_[node] = kFar;
    touched_ = {from};
    distance_[from] = 0;
    before_[from] = {-1, -1};
    using Entry = std::pair<double, int>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> front;
    front.emplace(0, from);
    while (!front.empty()) {
      const auto [distance, node] = front.top();
      front.pop();
      if (node == goal) return;
      if (distance > distance_[node]) continue;
      for (const auto& [other, edge] : next_[node]) {
        if (!usable(edge)) continue;
        const double way = distance + Length(edge);
        if (way > farthest || way >= distance_[other]) continue;
        if (distance_[other] == kFar) touched_.push_back(other);
        distance_[other] = way;
        before_[other] = {node, edge};
        front.emplace(way, other);
      }
    }
  }

  void GrowTree() {
    Search(0, -1, kFar, [](int) { return true; });
    for (size_t node = 0; node < next_.size(); ++node) {
      const int edge = before_[node].second;
      if (edge >= 0) Learn(edge, Count::Zero(most_loops_));
    }
  }

  void Propagate() {
    for (; !fresh_.empty(); fresh_.pop_front()) {
      for (const int triangle : around_[fresh_.front()]) Close(triangles_[triangle]);
    }
  }

  // Derives the crossings of a triangle's last unknown edge from the other two; if none is unknown,
  // they may contradict and give a relation.
  void Close(const Triangle& triangle) {
    int unknown = -1, count = 0;
    Count sum = Count::Zero(most_loops_);
    for (int k = 0; k < 3; ++k) {
      if (known_[triangle.edges[k]]) {
        sum += kSigns[k] * crossings_[triangle.edges[k]];
      } else {
        unknown = k;
        ++count;
      }
    }
    if (count == 1) Learn(triangle.edges[unknown], -kSigns[unknown] * sum);
    if (count == 0 && !sum.isZero()) relations_.push_back(std::move(sum));
  }

  // Finds the shortest known path between the edge's ends: its length and crossings.
  std::optional<std::pair<double, Count>> KnownWay(int edge, double farthest) {
    const int from = edges_[edge].first, to = edges_[edge].second;
    Search(from, to, farthest, [&](int e) { return known_[e]; });
    if (distance_[to] == kFar) return {};
    Count sum = Count::Zero(most_loops_);
    for (int node = to; node != from; node = before_[node].first) {
      const int e = before_[node].second;
      if (edges_[e].second == node) {
        sum += crossings_[e];
      } else {
        sum -= crossings_[e];
      }
    }
    return std::pair(distance_[to], sum);
  }

  // Fills small loops: an edge whose ends are joined by a short known path encloses nothing with
  // it.
  void FillSmallLoops() {
    for (bool filled = true; filled;) {
      filled = false;
      for (int e = 0; e < static_cast<int>(edges_.size()); ++e) {
        if (known_[e]) continue;
        const double reach = (nodes_.reach[edges_[e].first] + nodes_.reach[edges_[e].second]) / 2;
        auto way = KnownWay(e, most_filled_ * reach - Length(e));
        if (!way) continue;
        filled = true;
        Learn(e, std::move(way->second));
        Propagate();
      }
    }
  }

  // Begins a loop at the unknown edge with the shortest way back. Some edges are tried, or all if
  // that way is short, so that loops round holes are found one by one. False if no edge is left.
  bool BeginLoop() {
    std::vector<int> left;
    for (int e = 0; e < static_cast<int>(edges_.size()); ++e) {
      if (!known_[e]) left.push_back(e);
    }
    if (left.empty()) return false;
    double least = kFar;
    int chosen = -1;
    Count sum;
    const auto ask = [&](size_t step) {
      for (size_t k = 0; k < left.size(); k += step) {
        const auto way = KnownWay(left[k], least - Length(left[k]));
        if (!way || way->first + Length(left[k]) >= least) continue;
        least = way->first + Length(left[k]);
        chosen = left[k];
        sum = way->second;
      }
    };
    ask(std::max<size_t>(1, left.size() / kAsked));
    if (least < kShort * most_filled_ * nodes_.reach[edges_[chosen].first]) ask(1);
    sum[static_cast<Eigen::Index>(lengths_.size())] += 1;
    lengths_.push_back(least);
    Learn(chosen, std::move(sum));
    return true;
  }

  // Eliminates loops by the relations: a loop that is a sum of others is replaced by them, one that
  // is zero, or has a multiple that is zero, becomes zero.
  void Resolve() {
    std::vector<Count> pending = std::move(relations_);
    for (size_t r = 0; r < pending.size(); ++r) {
      const Count relation = pending[r];
      Eigen::Index pivot = -1;
      for (Eigen::Index k = 0; k < relation.size(); ++k) {
        if (relation[k] == 0) continue;
        if (pivot < 0 || std::abs(relation[k]) < std::abs(relation[pivot]) ||
            (std::abs(relation[k]) == std::abs(relation[pivot]) && lengths_[k] > lengths_[pivot])) {
          pivot = k;
        }
      }
      if (pivot < 0) continue;
      const bool unit = std::abs(relation[pivot]) == 1;
      const auto without = [&](Count& count) {
        if (unit) {
          count -= count[pivot] * relation[pivot] * relation;
        } else {
          count[pivot] = 0;
        }
      };
      for (size_t s = r + 1; s < pending.size(); ++s) without(pending[s]);
      if (!unit) {
        Count rest = relation;
        rest[pivot] = 0;
        pending.push_back(std::move(rest));
      }
      for (Count& count : crossings_) without(count);
      lengths_[pivot] = 0;
    }
  }

  std::vector<SheetLoop> Loops() {
    Resolve();
    std::vector<int> order;
    for (int k = 0; k < static_cast<int>(lengths_.size()); ++k) {
      if (lengths_[k] > 0) order.push_back(k);
    }
    std::sort(order.begin(), order.end(), [&](int a, int b) { return lengths_[a] > lengths_[b]; });
    std::vector<SheetLoop> loops;
    for (const int k : order) {
      loops.push_back({lengths_[k], {}});
      for (const Count& count : crossings_) loops.back().crossings.push_back(count[k]);
    }
    return loops;
  }

  const PoissonDiskSamples& nodes_;
  const std::vector<PlanarEdge>& edges_;
  double most_filled_;
  int most_loops_;
  std::vector<std::vector<std::pair<int, int>>> next_;  // of a node: neighbour and edge
  std::vector<Triangle> triangles_;
  std::vector<std::vector<int>> around_;  // triangles of an edge
  std::vector<double> edge_lengths_;
  std::vector<bool> known_;
  std::vector<Count> crossings_;
  std::deque<int> fresh_;
  std::vector<double> lengths_;  // of the loops
  std::vector<Count> relations_;
  std::vector<double> distance_;
  std::vector<std::pair<int, int>> before_;  // of a node: the one before it and the edge between
  std::vector<int> touched_;
};

}  // namespace

std::vector<SheetLoop> CohomologyBasis(const PoissonDiskSamples& nodes,
                                       const std::vector<PlanarEdge>& edges,
                                       double most_filled,
                                       int most_loops) {
  return Cuts(nodes, edges, most_filled, std::clamp(most_loops, 1, kMostLoops)).Find();
}

}  // namespace batten::internal
