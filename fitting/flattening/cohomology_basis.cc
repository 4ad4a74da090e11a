// SPDX-License-Identifier: MIT
#include "fitting/flattening/cohomology_basis.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>
#include <utility>

#include "fitting/flattening/flag_complex.h"
#include "geometry/numeric/constants.h"

namespace batten::internal {
namespace {

constexpr int kAsked = 24;    // edges that may begin a loop, of those left …
constexpr double kShort = 2;  // … and all of them if it is as short, in lengths that are filled

// Crossings of the cuts of all loops.
using Count = Eigen::Matrix<int, Eigen::Dynamic, 1, Eigen::ColMajor, kMostLoops, 1>;

// Crossings of a triangle's first two edges add to those of its last.
constexpr int kSigns[3] = {1, 1, -1};

// What is known of the crossings of edges. Keeps a reference.
class Crossings {
 public:
  Crossings(const FlagComplex& complex, int loops)
      : complex_(complex),
        none_(Count::Zero(loops)),
        known_(complex.lengths.size(), false),
        of_(complex.lengths.size(), none_) {}

  bool Known(int edge) const { return known_[edge]; }
  const Count& Of(int edge) const { return of_[edge]; }
  const Count& none() const { return none_; }

  void Learn(int edge, Count crossings) {
    known_[edge] = true;
    of_[edge] = std::move(crossings);
    fresh_.push_back(edge);
  }

  // Learns what follows from the triangles about edges that were learned.
  void Propagate() {
    for (; !fresh_.empty(); fresh_.pop_front()) {
      for (const int triangle : complex_.around[fresh_.front()])
        Close(complex_.triangles[triangle]);
    }
  }

  const std::vector<Count>& all() const { return of_; }
  // Sums that are zero, by triangles that contradict.
  const std::vector<Count>& relations() const { return relations_; }

 private:
  // Derives the crossings of a triangle's last unknown edge from the other two; if none is unknown,
  // they may contradict and give a relation.
  void Close(const FlagComplex::Triangle& triangle) {
    int unknown = -1, count = 0;
    Count sum = none_;
    for (int k = 0; k < 3; ++k) {
      if (known_[triangle[k]]) {
        sum += kSigns[k] * of_[triangle[k]];
      } else {
        unknown = k;
        ++count;
      }
    }
    if (count == 1) Learn(triangle[unknown], -kSigns[unknown] * sum);
    if (count == 0 && !sum.isZero()) relations_.push_back(std::move(sum));
  }

  const FlagComplex& complex_;
  const Count none_;
  std::vector<bool> known_;
  std::vector<Count> of_;
  std::deque<int> fresh_;
  std::vector<Count> relations_;
};

// No loop crosses a cut on a spanning tree.
void LearnTree(ShortestWays& ways, int nodes, Crossings& crossings) {
  ways.Search(0, -1, kInfinity, [](int) { return true; });
  for (int node = 0; node < nodes; ++node) {
    const int edge = ways.Before(node).second;
    if (edge >= 0) crossings.Learn(edge, crossings.none());
  }
}

struct Way {
  double length;
  Count crossings;
};

// The shortest known path between the edge's ends.
std::optional<Way> KnownWay(const PlanarEdge& edge,
                            double farthest,
                            const std::vector<PlanarEdge>& edges,
                            const Crossings& crossings,
                            ShortestWays& ways) {
  ways.Search(edge.first, edge.second, farthest, [&](int e) { return crossings.Known(e); });
  if (ways.Distance(edge.second) == kInfinity) return {};
  Count sum = crossings.none();
  for (int node = edge.second; node != edge.first; node = ways.Before(node).first) {
    const int e = ways.Before(node).second;
    if (edges[e].second == node) {
      sum += crossings.Of(e);
    } else {
      sum -= crossings.Of(e);
    }
  }
  return Way{ways.Distance(edge.second), sum};
}

// Fills small loops: an edge whose ends are joined by a short known path encloses nothing with it.
// `most`: their length, in reaches.
void FillSmallLoops(double most,
                    const PoissonDiskSamples& nodes,
                    const std::vector<PlanarEdge>& edges,
                    const FlagComplex& complex,
                    ShortestWays& ways,
                    Crossings& crossings) {
  for (bool filled = true; filled;) {
    filled = false;
    for (int e = 0; e < static_cast<int>(edges.size()); ++e) {
      if (crossings.Known(e)) continue;
      const double reach = (nodes.reach[edges[e].first] + nodes.reach[edges[e].second]) / 2;
      auto way = KnownWay(edges[e], most * reach - complex.lengths[e], edges, crossings, ways);
      if (!way) continue;
      filled = true;
      crossings.Learn(e, std::move(way->crossings));
      crossings.Propagate();
    }
  }
}

struct LoopStart {
  int edge = -1;
  Way way = {kInfinity, {}};  // the loop's length; the crossings of the rest of it
};

// The unknown edge with the shortest way back. Some edges are tried, or all if that way is shorter
// than `is_short` reaches, so that loops round holes are found one by one. None if no edge is left.
std::optional<LoopStart> NextLoop(double is_short,
                                  const PoissonDiskSamples& nodes,
                                  const std::vector<PlanarEdge>& edges,
                                  const FlagComplex& complex,
                                  const Crossings& crossings,
                                  ShortestWays& ways) {
  std::vector<int> left;
  for (int e = 0; e < static_cast<int>(edges.size()); ++e) {
    if (!crossings.Known(e)) left.push_back(e);
  }
  if (left.empty()) return std::nullopt;
  LoopStart best;
  const auto ask = [&](size_t step) {
    for (size_t k = 0; k < left.size(); k += step) {
      const double own = complex.lengths[left[k]];
      const auto way = KnownWay(edges[left[k]], best.way.length - own, edges, crossings, ways);
      if (!way || way->length + own >= best.way.length) continue;
      best = {left[k], {way->length + own, way->crossings}};
    }
  };
  ask(std::max<size_t>(1, left.size() / kAsked));
  if (best.way.length < is_short * nodes.reach[edges[best.edge].first]) ask(1);
  return best;
}

// Eliminates loops by the relations: a loop that is a sum of others is replaced by them, one that
// is zero, or has a multiple that is zero, becomes zero.
void Resolve(std::vector<Count> relations,
             std::vector<double>& lengths,
             std::vector<Count>& crossings) {
  for (size_t r = 0; r < relations.size(); ++r) {
    const Count relation = relations[r];
    Eigen::Index pivot = -1;
    for (Eigen::Index k = 0; k < relation.size(); ++k) {
      if (relation[k] == 0) continue;
      if (pivot < 0 || std::abs(relation[k]) < std::abs(relation[pivot]) ||
          (std::abs(relation[k]) == std::abs(relation[pivot]) && lengths[k] > lengths[pivot])) {
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
    for (size_t s = r + 1; s < relations.size(); ++s) without(relations[s]);
    if (!unit) {
      Count rest = relation;
      rest[pivot] = 0;
      relations.push_back(std::move(rest));
    }
    for (Count& count : crossings) without(count);
    lengths[pivot] = 0;
  }
}

// Those with a length, the longest first.
std::vector<SheetLoop> LoopsOf(const std::vector<double>& lengths,
                               const std::vector<Count>& crossings) {
  std::vector<int> order;
  for (int k = 0; k < static_cast<int>(lengths.size()); ++k) {
    if (lengths[k] > 0) order.push_back(k);
  }
  std::sort(order.begin(), order.end(), [&](int a, int b) { return lengths[a] > lengths[b]; });
  std::vector<SheetLoop> loops;
  for (const int k : order) {
    loops.push_back({lengths[k], {}});
    for (const Count& count : crossings) loops.back().crossings.push_back(count[k]);
  }
  return loops;
}

}  // namespace

std::vector<SheetLoop> CohomologyBasis(const PoissonDiskSamples& nodes,
                                       const std::vector<PlanarEdge>& edges,
                                       double most_filled,
                                       int most_loops) {
  most_loops = std::clamp(most_loops, 1, kMostLoops);
  const FlagComplex complex(static_cast<size_t>(nodes.size()), edges);
  ShortestWays ways(complex);
  Crossings crossings(complex, most_loops);
  LearnTree(ways, static_cast<int>(nodes.size()), crossings);
  std::vector<double> lengths;
  for (;;) {
    crossings.Propagate();
    FillSmallLoops(most_filled, nodes, edges, complex, ways, crossings);
    if (std::ssize(lengths) == most_loops) break;
    auto start = NextLoop(kShort * most_filled, nodes, edges, complex, crossings, ways);
    if (!start) break;
    start->way.crossings[std::ssize(lengths)] += 1;
    lengths.push_back(start->way.length);
    crossings.Learn(start->edge, std::move(start->way.crossings));
  }
  std::vector<Count> of_edges = crossings.all();
  Resolve(crossings.relations(), lengths, of_edges);
  return LoopsOf(lengths, of_edges);
}

}  // namespace batten::internal
