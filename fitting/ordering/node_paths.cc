// SPDX-License-Identifier: MIT
#include "fitting/ordering/node_paths.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include "batten/fitting/neighbours.h"
#include "fitting/ordering/curve_closure.h"
#include "geometry/numeric/dense_solvers.h"

namespace batten::internal {
namespace {

constexpr int kNeighbours = 10;        // nearest nodes that a node may be linked to
constexpr int kEndNeighbours = 8;      // the same among ends
constexpr int kAround = 8;             // nodes that give a direction
constexpr int kPartAround = 3;         // but no more than this part of all
constexpr double kAcrossWeight = 3;    // factor on distance across the direction
constexpr int kRecent = 16;            // links before an end that tell its spacing
constexpr double kJump = 3;            // a link may be longer than the longest of these
constexpr double kFloor = 3;           // and than the cloud's spacing
constexpr int kFewKnown = 8;           // nodes of a path that does not yet know its spacing
constexpr double kFewFloor = 6;        // of the cloud's spacing, between two of these
constexpr double kClosingJump = 1.5;   // the same for the link that closes a path
constexpr double kClosingPart = 0.35;  // of the length; four points on a circle need a third
constexpr int kFewestClosed = 4;
constexpr int kStraightenRounds = 20;
constexpr double kBent = 0.3;      // a turn of 45°
constexpr double kMostBent = 0.3;  // of the nodes: more are noise, not corners
constexpr double kDetour = 2;      // of the spacing, for a single node
constexpr int kFewestFacing = 5;   // nodes of a path whose end has a direction
constexpr double kAsLong = 1.5;    // times the longest link of either path is not remarkable

struct Direction {
  Eigen::Vector3d along;
  double sureness;  // 0 … 1
};

Direction DirectionOf(const Eigen::Matrix3Xd& around) {
  const Eigen::Matrix3Xd local = around.colwise() - around.rowwise().mean();
  const SymmetricEigen3 axes = QuickEigenOf3(local * local.transpose());
  const Eigen::Vector3d& values = axes.values;
  if (!(values[2] > 0) || around.cols() < 4) return {Eigen::Vector3d::UnitX(), 0};
  return {axes.vectors.col(2), std::clamp(1 - values[1] / values[2], 0.0, 1.0)};
}

// Paths while they grow: every node has at most two links, and is on one path.
class PathSet {
 public:
  explicit PathSet(const Eigen::Matrix3Xd& nodes)
      : nodes_(nodes),
        links_(nodes.cols(), {-1, -1}),
        owner_(nodes.cols()),
        length_(nodes.cols(), 0.0),
        longest_(nodes.cols(), 0.0),
        size_(nodes.cols(), 1) {
    std::iota(owner_.begin(), owner_.end(), 0);
  }

  int count() const { return static_cast<int>(nodes_.cols()); }
  const std::array<int, 2>& links(int a) const { return links_[a]; }
  int Degree(int a) const { return (links_[a][0] >= 0) + (links_[a][1] >= 0); }
  double Distance(int a, int b) const { return (nodes_.col(a) - nodes_.col(b)).norm(); }

  // The path of a node; its nodes, its length, and the longest of its links.
  int Owner(int a) const {
    while (owner_[a] != a) a = owner_[a] = owner_[owner_[a]];
    return a;
  }
  int size(int path) const { return size_[path]; }
  double length(int path) const { return length_[path]; }
  double longest(int path) const { return longest_[path]; }

  void Join(int a, int b) {
    const int path_a = Owner(a), path_b = Owner(b);
    const double gap = Distance(a, b);
    links_[a][links_[a][0] >= 0] = b;
    links_[b][links_[b][0] >= 0] = a;
    length_[path_a] += gap;
    longest_[path_a] = std::max({longest_[path_a], longest_[path_b], gap});
    if (path_a == path_b) return;
    length_[path_a] += length_[path_b];
    size_[path_a] += size_[path_b];
    owner_[path_b] = path_a;
  }

  // Inserts a single node into the link from a to b.
  void Insert(int c, int a, int b) {
    *std::find(links_[a].begin(), links_[a].end(), b) = c;
    *std::find(links_[b].begin(), links_[b].end(), a) = c;
    links_[c] = {a, b};
    const int path = Owner(a);
    length_[path] += Distance(a, c) + Distance(c, b) - Distance(a, b);
    ++size_[path];
    owner_[Owner(c)] = path;
  }

  // Puts v between a and b, away from between p and n; -1 is behind an end. With the pairs the
  // other way round it goes back.
  void Move(int v, int p, int n, int a, int b) {
    Relink(p, v, n);
    Relink(n, v, p);
    Relink(a, b, v);
    Relink(b, a, v);
    links_[v] = {a, b};
  }

  // Bend of a path at a node: 0 where it runs straight on, 2 where it turns back.
  double BendAt(int v) const {
    if (v < 0 || Degree(v) < 2) return 0;
    const Eigen::Vector3d in = nodes_.col(v) - nodes_.col(links_[v][0]);
    const Eigen::Vector3d out = nodes_.col(links_[v][1]) - nodes_.col(v);
    const double sizes = in.norm() * out.norm();
    return sizes > 0 ? 1 - in.dot(out) / sizes : 0;
  }

  // Calls visit(here, next) link by link from an end until it says stop.
  template <typename Visit>
  void Walk(int end, const Visit& visit) const {
    for (int here = end, from = -1;;) {
      const int next = links_[here][0] != from && links_[here][0] >= 0 ? links_[here][0]
                       : links_[here][1] != from                       ? links_[here][1]
                                                                       : -1;
      if (next < 0 || !visit(here, next)) return;
      from = here;
      here = next;
    }
  }

  double LongestRecent(int end) const {
    double longest = 0;
    int count = 0;
    Walk(end, [&](int here, int next) {
      longest = std::max(longest, Distance(here, next));
      return ++count < kRecent;
    });
    return longest;
  }

  std::vector<NodePath> Paths() const {
    std::vector<NodePath> paths;
    std::vector<bool> seen(nodes_.cols(), false);
    const auto walk = [&](int first) {
      NodePath path;
      for (int here = first, from = -1; here >= 0 && !seen[here];) {
        seen[here] = true;
        path.nodes.push_back(here);
        const int next = links_[here][0] != from ? links_[here][0] : links_[here][1];
        from = here;
        here = next;
      }
      path.closed = Degree(first) == 2;
      paths.push_back(std::move(path));
    };
    for (const int degree : {1, 2}) {  // ends first; what remains has none
      for (int a = 0; a < count(); ++a) {
        if (!seen[a] && Degree(a) <= degree) walk(a);
      }
    }
    return paths;
  }

 private:
  void Relink(int a, int from, int to) {
    if (a >= 0) *std::find(links_[a].begin(), links_[a].end(), from) = to;
  }

  const Eigen::Matrix3Xd& nodes_;
  std::vector<std::array<int, 2>> links_;
  mutable std::vector<int> owner_;
  std::vector<double> length_, longest_;
  std::vector<int> size_;
};

using Link = std::tuple<double, int, int>;  // cost, nodes

// The nodes nearest to each, itself first.
struct NearNodes {
  std::vector<int> nearest;
  int k;

  int At(int a, int j) const { return nearest[static_cast<size_t>(a) * k + j]; }
};

NearNodes NearNodesOf(const Eigen::Matrix3Xd& nodes) {
  const int k = static_cast<int>(std::min<Eigen::Index>(kNeighbours + 1, nodes.cols()));
  return {NeighbourIndex(nodes).Nearest(nodes, k), k};
}

// Makes the links that the rule allows, from short to long. Returns whether any was made.
template <typename Rule>
bool Make(std::vector<Link> links, const Rule& rule, PathSet& paths) {
  std::sort(links.begin(), links.end());
  links.erase(std::unique(links.begin(), links.end()), links.end());
  bool made = false;
  for (const auto& [cost, a, b] : links) {
    if (paths.Degree(a) == 2 || paths.Degree(b) == 2 || !rule(a, b)) continue;
    made = true;
    paths.Join(a, b);
  }
  return made;
}

// Which links are short enough to be made.
struct ShortLinks {
  const PathSet& paths;
  double spacing;
  bool neighbours_only;  // paths of one or two nodes may be linked at any distance
  int fewest_closed = kFewKnown + 1;

  bool operator()(int a, int b) const {
    const double gap = paths.Distance(a, b);
    const int path_a = paths.Owner(a), path_b = paths.Owner(b);
    const int size_a = paths.size(path_a), size_b = paths.size(path_b);
    if (path_a == path_b) {
      const double length = paths.length(path_a);
      if (size_a < fewest_closed || gap > kClosingPart * length) return false;
      const double recent = std::max(paths.LongestRecent(a), paths.LongestRecent(b));
      return gap <= kClosingJump * recent ||
             (gap <= kGapInLength * length &&
              gap <= std::max(kJump * recent, paths.longest(path_a)));
    }
    const double limit_a = Allowed(a), limit_b = Allowed(b);
    if (size_a > kFewKnown && size_b > kFewKnown) {
      return gap <= std::min(std::max(limit_a, paths.longest(path_a)),
                             std::max(limit_b, paths.longest(path_b)));
    }
    if (std::max(size_a, size_b) > kFewKnown)
      return gap <= (size_a > kFewKnown ? limit_a : limit_b);
    return (neighbours_only && std::min(size_a, size_b) < 3) ||
           gap <= std::max({limit_a, limit_b, kFewFloor * spacing});
  }

  // The longest link allowed at this end, by the links before it.
  double Allowed(int end) const {
    return std::max(kJump * paths.LongestRecent(end), kFloor * spacing);
  }
};

// The length of an arm, across the direction counting more.
double CostOf(const Eigen::Vector3d& arm, const Direction& direction) {
  const double along = direction.along.dot(arm);
  const double across = std::max(0.0, arm.squaredNorm() - along * along);
  const double weight = 1 + (kAcrossWeight - 1) * direction.sureness;
  return std::sqrt(along * along + weight * weight * across);
}

void LinkNeighbours(const Eigen::Matrix3Xd& nodes,
                    const NearNodes& near,
                    double spacing,
                    PathSet& paths) {
  const int around = std::clamp(paths.count() / kPartAround, 1, std::min(near.k, kAround));
  std::vector<Direction> directions;
  for (int a = 0; a < paths.count(); ++a) {
    const int* row = &near.nearest[static_cast<size_t>(a) * near.k];
    directions.push_back(DirectionOf(nodes(Eigen::all, std::vector<int>(row, row + around))));
  }
  std::vector<Link> links;
  for (int a = 0; a < paths.count(); ++a) {
    for (int j = 0; j < near.k; ++j) {
      const int b = near.At(a, j);
      if (b == a) continue;
      const Eigen::Vector3d arm = nodes.col(b) - nodes.col(a);
      const double cost = (CostOf(arm, directions[a]) + CostOf(arm, directions[b])) / 2;
      links.emplace_back(cost, std::min(a, b), std::max(a, b));
    }
  }
  Make(std::move(links), ShortLinks{paths, spacing, true}, paths);
}

// Links ends until nothing more can be.
template <typename Rule>
void LinkEnds(const Eigen::Matrix3Xd& nodes, const Rule& rule, PathSet& paths) {
  for (bool linked = true; linked;) {
    std::vector<int> ends;
    for (int a = 0; a < paths.count(); ++a) {
      if (paths.Degree(a) < 2) ends.push_back(a);
    }
    if (ends.size() < 2) return;
    const Eigen::Matrix3Xd places = nodes(Eigen::all, ends);
    const int k = static_cast<int>(std::min<size_t>(kEndNeighbours + 1, ends.size()));
    const std::vector<int> nearest = NeighbourIndex(places).Nearest(places, k);
    std::vector<Link> links;
    for (size_t i = 0; i < ends.size(); ++i) {
      for (int j = 0; j < k; ++j) {
        const int a = ends[i], b = ends[nearest[i * k + j]];
        if (a != b) links.emplace_back(paths.Distance(a, b), std::min(a, b), std::max(a, b));
      }
    }
    linked = Make(std::move(links), rule, paths);
  }
}

// The direction in which a path leaves through its end, over a stretch as long as the gap ahead and
// some nodes.
Eigen::Vector3d Outward(const Eigen::Matrix3Xd& nodes, const PathSet& paths, int end, double gap) {
  int count = 0, last = end;
  paths.Walk(end, [&](int, int next) {
    last = next;
    return ++count < kFewestFacing - 1 ||
           (count < 2 * kFewestFacing && paths.Distance(last, end) < gap / 2);
  });
  return (nodes.col(end) - nodes.col(last)).normalized();
}

// Whether a link bridges a gap between ends that face each other.
bool Bridges(const Eigen::Matrix3Xd& nodes, const PathSet& paths, int a, int b) {
  const int path_a = paths.Owner(a), path_b = paths.Owner(b);
  if (paths.size(path_a) < kFewestFacing || paths.size(path_b) < kFewestFacing) return false;
  const Eigen::Vector3d across = nodes.col(b) - nodes.col(a);
  const double gap = across.norm();
  const double length = std::min(paths.length(path_a), paths.length(path_b));
  const double longest =
      path_a == path_b ? 0 : std::max(paths.longest(path_a), paths.longest(path_b));
  return gap <= std::max(kGapInLength * length, kAsLong * longest) &&
         Outward(nodes, paths, a, gap).dot(across) >= std::cos(kFacingAngle) * gap &&
         -Outward(nodes, paths, b, gap).dot(across) >= std::cos(kFacingAngle) * gap;
}

// Nodes left alone go between two linked ones where that is not much of a detour, as they are where
// a link has cut a corner.
void InsertLeftOver(const NearNodes& near, double spacing, PathSet& paths) {
  for (int c = 0; c < paths.count(); ++c) {
    if (paths.Degree(c) > 0) continue;
    double least = kDetour * spacing;
    int best_a = -1, best_b = -1;
    for (int j = 0; j < near.k; ++j) {
      const int a = near.At(c, j);
      if (paths.Owner(a) == paths.Owner(c) || paths.size(paths.Owner(a)) < kFewestFacing) continue;
      for (const int b : paths.links(a)) {
        if (b < 0) continue;
        const double detour = paths.Distance(a, c) + paths.Distance(c, b) - paths.Distance(a, b);
        if (best_a >= 0 ? detour >= least : detour > least) continue;
        least = detour;
        best_a = a;
        best_b = b;
      }
    }
    if (best_a >= 0) paths.Insert(c, best_a, best_b);
  }
}

// Change of length and bend by a move of v from between p and n to between a and b.
double ChangeOfMove(int v, int p, int n, int a, int b, double spacing, PathSet& paths) {
  std::array<int, 5> touched = {v, p, n, a, b};
  std::sort(touched.begin(), touched.end());
  const auto last = std::unique(touched.begin(), touched.end());
  const auto bend = [&] {
    double sum = 0;
    for (auto i = touched.begin(); i != last; ++i) sum += paths.BendAt(*i);
    return sum;
  };
  const auto length = [&](int i, int j) { return i >= 0 && j >= 0 ? paths.Distance(i, j) : 0; };
  const double before = bend();
  paths.Move(v, p, n, a, b);
  const double after = bend();
  paths.Move(v, a, b, p, n);
  return (after - before) * spacing + paths.Distance(a, v) + paths.Distance(v, b) -
         paths.Distance(a, b) + length(p, n) - length(p, v) - length(v, n);
}

bool MoveToBetterPlace(int v, const NearNodes& near, double spacing, PathSet& paths) {
  const auto [p, n] = paths.links(v);
  double best = -1e-9 * spacing;
  int best_a = -1, best_b = -1;
  for (int j = 0; j < near.k; ++j) {
    const int a = near.At(v, j);
    if (a == v || paths.Owner(a) != paths.Owner(v)) continue;
    const std::array<int, 2> ahead = paths.links(a);
    for (const int b : ahead) {
      if (b < 0 || b == v) continue;
      const double change = ChangeOfMove(v, p, n, a, b, spacing, paths);
      if (change >= best) continue;
      best = change;
      best_a = a;
      best_b = b;
    }
  }
  if (best_a < 0) return false;
  paths.Move(v, p, n, best_a, best_b);
  return true;
}

// Moves single nodes to other places of their path where that makes it shorter or less bent, as
// between the sides of a sharp corner, where the nearest node is on the other side.
void StraightenOut(const NearNodes& near, double spacing, PathSet& paths) {
  Eigen::Index bends = 0;
  for (int v = 0; v < paths.count(); ++v) bends += paths.BendAt(v) > kBent;
  if (static_cast<double>(bends) > kMostBent * paths.count() + kNeighbours) return;
  for (int round = 0; round < kStraightenRounds; ++round) {
    bool moved = false;
    for (int v = 0; v < paths.count(); ++v) {
      const auto& [p, n] = paths.links(v);
      const bool bent =
          paths.BendAt(v) > kBent || paths.BendAt(p) > kBent || paths.BendAt(n) > kBent;
      if (bent && paths.size(paths.Owner(v)) > kFewestFacing)
        moved = MoveToBetterPlace(v, near, spacing, paths) || moved;
    }
    if (!moved) return;
  }
}

}  // namespace

double LengthOf(const NodePath& path, const Eigen::Matrix3Xd& nodes) {
  double length = 0;
  for (size_t i = 1; i < path.nodes.size(); ++i) {
    length += (nodes.col(path.nodes[i]) - nodes.col(path.nodes[i - 1])).norm();
  }
  if (path.closed) length += (nodes.col(path.nodes.front()) - nodes.col(path.nodes.back())).norm();
  return length;
}

std::vector<NodePath> LinkNodes(const Eigen::Matrix3Xd& nodes, double spacing) {
  const NearNodes near = NearNodesOf(nodes);
  PathSet growing(nodes);
  LinkNeighbours(nodes, near, spacing, growing);
  LinkEnds(nodes, ShortLinks{growing, spacing, false}, growing);
  LinkEnds(
      nodes, [&](int a, int b) { return Bridges(nodes, growing, a, b); }, growing);
  InsertLeftOver(near, spacing, growing);
  // Small paths close when nothing else is left for them.
  const ShortLinks close{growing, spacing, false, kFewestClosed};
  LinkEnds(
      nodes,
      [&](int a, int b) { return growing.Owner(a) == growing.Owner(b) && close(a, b); },
      growing);
  StraightenOut(near, spacing, growing);
  std::vector<NodePath> paths = growing.Paths();
  std::stable_sort(paths.begin(), paths.end(), [&](const NodePath& a, const NodePath& b) {
    return LengthOf(a, nodes) > LengthOf(b, nodes);
  });
  return paths;
}

}  // namespace batten::internal
