// SPDX-License-Identifier: MIT
#include "fitting/ordering/node_paths.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include "batten/fitting/neighbours.h"

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
constexpr double kBent = 0.3;                   // a turn of 45°
constexpr double kMostBent = 0.3;               // of the nodes: more are noise, not corners
constexpr double kDetour = 2;                   // of the spacing, for a single node
constexpr double kDetourOfSeveral = 5;          // these are seldom chance
constexpr int kFewestFacing = 5;                // nodes of a path whose end has a direction
constexpr double kFacing = 0.8660254037844387;  // cos 30°
constexpr double kAsLong = 1.5;       // times the longest link of either path is not remarkable
constexpr double kBridgedPart = 0.1;  // of the length

struct Direction {
  Eigen::Vector3d along;
  double sureness;  // 0 … 1
};

Direction DirectionOf(const Eigen::Matrix3Xd& around) {
  const Eigen::Matrix3Xd local = around.colwise() - around.rowwise().mean();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes;
  axes.computeDirect(local * local.transpose());
  const Eigen::Vector3d values = axes.eigenvalues();
  if (!(values[2] > 0) || around.cols() < 4) return {Eigen::Vector3d::UnitX(), 0};
  return {axes.eigenvectors().col(2), std::clamp(1 - values[1] / values[2], 0.0, 1.0)};
}

// Paths while they grow.
class Linker {
 public:
  Linker(const Eigen::Matrix3Xd& nodes, double spacing)
      : nodes_(nodes),
        spacing_(spacing),
        k_(static_cast<int>(std::min<Eigen::Index>(kNeighbours + 1, nodes.cols()))),
        nearest_(NeighbourIndex(nodes).Nearest(nodes, k_)),
        links_(nodes.cols(), {-1, -1}),
        owner_(nodes.cols()),
        length_(nodes.cols(), 0.0),
        longest_(nodes.cols(), 0.0),
        size_(nodes.cols(), 1) {
    std::iota(owner_.begin(), owner_.end(), 0);
  }

  void LinkNeighbours() {
    const int around =
        std::clamp(static_cast<int>(nodes_.cols()) / kPartAround, 1, std::min(k_, kAround));
    std::vector<Direction> directions;
    for (int a = 0; a < nodes_.cols(); ++a) {
      const int* row = &nearest_[static_cast<size_t>(a) * k_];
      directions.push_back(DirectionOf(nodes_(Eigen::all, std::vector<int>(row, row + around))));
    }
    std::vector<Link> links;
    for (int a = 0; a < nodes_.cols(); ++a) {
      for (int j = 0; j < k_; ++j) {
        const int b = Near(a, j);
        if (b == a) continue;
        const double cost = (Cost(a, b, directions[a]) + Cost(a, b, directions[b])) / 2;
        links.emplace_back(cost, std::min(a, b), std::max(a, b));
      }
    }
    Make(std::move(links), [&](int a, int b) { return IsShort(a, b); });
    neighbours_only_ = false;
  }

  // Links ends until nothing more can be.
  template <typename Rule>
  void LinkEnds(const Rule& rule) {
    for (bool linked = true; linked;) {
      std::vector<int> ends;
      for (int a = 0; a < nodes_.cols(); ++a) {
        if (Degree(a) < 2) ends.push_back(a);
      }
      if (ends.size() < 2) return;
      const Eigen::Matrix3Xd places = nodes_(Eigen::all, ends);
      const int k = static_cast<int>(std::min<size_t>(kEndNeighbours + 1, ends.size()));
      const std::vector<int> nearest = NeighbourIndex(places).Nearest(places, k);
      std::vector<Link> links;
      for (size_t i = 0; i < ends.size(); ++i) {
        for (int j = 0; j < k; ++j) {
          const int a = ends[i], b = ends[nearest[i * k + j]];
          if (a < b) links.emplace_back(Distance(a, b), a, b);
          if (b < a) links.emplace_back(Distance(a, b), b, a);
        }
      }
      linked = Make(std::move(links), rule);
    }
  }

  bool IsShort(int a, int b) const {
    const double gap = Distance(a, b);
    const int path_a = Owner(a), path_b = Owner(b);
    if (path_a == path_b) {
      if (size_[path_a] < fewest_closed_ || gap > kClosingPart * length_[path_a]) return false;
      const double recent = std::max(LongestRecent(a), LongestRecent(b));
      return gap <= kClosingJump * recent || (gap <= kBridgedPart * length_[path_a] &&
                                              gap <= std::max(kJump * recent, longest_[path_a]));
    }
    const double limit_a = Allowed(a), limit_b = Allowed(b);
    if (size_[path_a] > kFewKnown && size_[path_b] > kFewKnown) {
      return gap <=
             std::min(std::max(limit_a, longest_[path_a]), std::max(limit_b, longest_[path_b]));
    }
    if (std::max(size_[path_a], size_[path_b]) > kFewKnown) {
      return gap <= (size_[path_a] > kFewKnown ? limit_a : limit_b);
    }
    return (neighbours_only_ && std::min(size_[path_a], size_[path_b]) < 3) ||
           gap <= std::max({limit_a, limit_b, kFewFloor * spacing_});
  }

  bool Bridges(int a, int b) const {
    const int path_a = Owner(a), path_b = Owner(b);
    if (size_[path_a] < kFewestFacing || size_[path_b] < kFewestFacing) return false;
    const Eigen::Vector3d across = nodes_.col(b) - nodes_.col(a);
    const double gap = across.norm();
    const double length = std::min(length_[path_a], length_[path_b]);
    const double longest = path_a == path_b ? 0 : std::max(longest_[path_a], longest_[path_b]);
    return gap <= std::max(kBridgedPart * length, kAsLong * longest) &&
           Outward(a, gap).dot(across) >= kFacing * gap &&
           -Outward(b, gap).dot(across) >= kFacing * gap;
  }

  // Small paths close when nothing else is left for them.
  void CloseSmall() {
    fewest_closed_ = kFewestClosed;
    LinkEnds([&](int a, int b) { return Owner(a) == Owner(b) && IsShort(a, b); });
  }

  // Few nodes left alone go between two linked ones where that is not much of a detour, as they are
  // where a link has cut a corner.
  void InsertLeftOver() {
    for (int c = 0; c < nodes_.cols(); ++c) {
      if (Degree(c) == 2 || size_[Owner(c)] > kFewKnown) continue;
      const int d = OtherEnd(c);
      double least = std::numeric_limits<double>::infinity();
      int best_a = -1, best_b = -1;
      for (int j = 0; j < k_; ++j) {
        const int a = Near(c, j);
        if (Owner(a) == Owner(c) || size_[Owner(a)] < kFewestFacing) continue;
        for (const int b : links_[a]) {
          if (b < 0) continue;
          const double link = Distance(a, b);
          const double detour = Distance(a, c) + length_[Owner(c)] + Distance(d, b) - link;
          if (detour >= least || detour > (c == d ? kDetour : kDetourOfSeveral) * spacing_)
            continue;
          least = detour;
          best_a = a;
          best_b = b;
        }
      }
      if (best_a >= 0) Insert(c, d, best_a, best_b);
    }
  }

  // Moves single nodes to other places of their path where that makes it shorter or less bent, as
  // between the sides of a sharp corner, where the nearest node is on the other side.
  void StraightenOut() {
    Eigen::Index bends = 0;
    for (int v = 0; v < nodes_.cols(); ++v) bends += BendAt(v) > kBent;
    if (bends > kMostBent * static_cast<double>(nodes_.cols()) + kNeighbours) return;
    for (int round = 0; round < kStraightenRounds; ++round) {
      bool moved = false;
      for (int v = 0; v < nodes_.cols(); ++v) {
        const bool bent =
            BendAt(v) > kBent || BendAt(links_[v][0]) > kBent || BendAt(links_[v][1]) > kBent;
        if (bent && size_[Owner(v)] > kFewestFacing) moved = MoveToBetterPlace(v) || moved;
      }
      if (!moved) return;
    }
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
      for (int a = 0; a < nodes_.cols(); ++a) {
        if (!seen[a] && Degree(a) <= degree) walk(a);
      }
    }
    return paths;
  }

 private:
  using Link = std::tuple<double, int, int>;  // cost, nodes

  int Degree(int a) const { return (links_[a][0] >= 0) + (links_[a][1] >= 0); }

  int Owner(int a) const {
    while (owner_[a] != a) a = owner_[a] = owner_[owner_[a]];
    return a;
  }

  double Cost(int a, int b, const Direction& direction) const {
    const Eigen::Vector3d arm = nodes_.col(b) - nodes_.col(a);
    const double along = direction.along.dot(arm);
    const double across = std::max(0.0, arm.squaredNorm() - along * along);
    const double weight = 1 + (kAcrossWeight - 1) * direction.sureness;
    return std::sqrt(along * along + weight * weight * across);
  }

  double Distance(int a, int b) const { return (nodes_.col(a) - nodes_.col(b)).norm(); }

  int Near(int a, int j) const { return nearest_[static_cast<size_t>(a) * k_ + j]; }

  int OtherEnd(int end) const {
    int last = end;
    Walk(end, [&](int, int next) {
      last = next;
      return true;
    });
    return last;
  }

  // Bend of a path at a node: 0 where it runs straight on, 2 where it turns back.
  double BendAt(int v) const {
    if (v < 0 || Degree(v) < 2) return 0;
    const Eigen::Vector3d in = nodes_.col(v) - nodes_.col(links_[v][0]);
    const Eigen::Vector3d out = nodes_.col(links_[v][1]) - nodes_.col(v);
    const double sizes = in.norm() * out.norm();
    return sizes > 0 ? 1 - in.dot(out) / sizes : 0;
  }

  double LinkLength(int a, int b) const { return a >= 0 && b >= 0 ? Distance(a, b) : 0; }

  void Relink(int a, int from, int to) {
    if (a >= 0) *std::find(links_[a].begin(), links_[a].end(), from) = to;
  }

  // Puts v between a and b, away from between p and n; -1 is behind an end.
  void Move(int v, int p, int n, int a, int b) {
    Relink(p, v, n);
    Relink(n, v, p);
    Relink(a, b, v);
    Relink(b, a, v);
    links_[v] = {a, b};
  }

  bool MoveToBetterPlace(int v) {
    const auto [p, n] = links_[v];
    double best = -1e-9 * spacing_;
    int best_a = -1, best_b = -1;
    for (int j = 0; j < k_; ++j) {
      const int a = Near(v, j);
      if (a == v || Owner(a) != Owner(v)) continue;
      const std::array<int, 2> ahead = links_[a];
      for (const int b : ahead) {
        if (b < 0 || b == v) continue;
        const double change = ChangeOfMove(v, p, n, a, b);
        if (change >= best) continue;
        best = change;
        best_a = a;
        best_b = b;
      }
    }
    if (best_a < 0) return false;
    Move(v, p, n, best_a, best_b);
    return true;
  }

  // Change of length and bend by a move.
  double ChangeOfMove(int v, int p, int n, int a, int b) {
    std::array<int, 5> touched = {v, p, n, a, b};
    std::sort(touched.begin(), touched.end());
    const auto last = std::unique(touched.begin(), touched.end());
    const auto bend = [&] {
      double sum = 0;
      for (auto i = touched.begin(); i != last; ++i) sum += BendAt(*i);
      return sum;
    };
    const double before = bend();
    Move(v, p, n, a, b);
    const double after = bend();
    Relink(a, v, b);
    Relink(b, v, a);
    Relink(p, n, v);
    Relink(n, p, v);
    links_[v] = {p, n};
    return (after - before) * spacing_ + Distance(a, v) + Distance(v, b) - Distance(a, b) +
           LinkLength(p, n) - LinkLength(p, v) - LinkLength(v, n);
  }

  // Inserts the path from c to d into the link from a to b.
  void Insert(int c, int d, int a, int b) {
    *std::find(links_[a].begin(), links_[a].end(), b) = c;
    *std::find(links_[b].begin(), links_[b].end(), a) = d;
    links_[c][links_[c][0] >= 0] = a;
    links_[d][links_[d][0] >= 0] = b;
    const int path = Owner(a), added = Owner(c);
    length_[path] += Distance(a, c) + Distance(d, b) - Distance(a, b) + length_[added];
    size_[path] += size_[added];
    owner_[added] = path;
  }

  template <typename Rule>
  bool Make(std::vector<Link> links, const Rule& rule) {
    std::sort(links.begin(), links.end());
    links.erase(std::unique(links.begin(), links.end()), links.end());
    bool made = false;
    for (const auto& [cost, a, b] : links) {
      if (Degree(a) == 2 || Degree(b) == 2 || !rule(a, b)) continue;
      made = true;
      const int path_a = Owner(a), path_b = Owner(b);
      const double gap = Distance(a, b);
      links_[a][links_[a][0] >= 0] = b;
      links_[b][links_[b][0] >= 0] = a;
      length_[path_a] += gap;
      longest_[path_a] = std::max({longest_[path_a], longest_[path_b], gap});
      if (path_a == path_b) continue;
      length_[path_a] += length_[path_b];
      size_[path_a] += size_[path_b];
      owner_[path_b] = path_a;
    }
    return made;
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

  // The longest link allowed at this end, by the links before it.
  double Allowed(int end) const { return std::max(kJump * LongestRecent(end), kFloor * spacing_); }

  double LongestRecent(int end) const {
    double longest = 0;
    int count = 0;
    Walk(end, [&](int here, int next) {
      longest = std::max(longest, (nodes_.col(here) - nodes_.col(next)).norm());
      return ++count < kRecent;
    });
    return longest;
  }

  // The direction in which a path leaves through its end, over a stretch as long as the gap ahead
  // and some nodes.
  Eigen::Vector3d Outward(int end, double gap) const {
    int count = 0, last = end;
    Walk(end, [&](int, int next) {
      last = next;
      return ++count < kFewestFacing - 1 ||
             (count < 2 * kFewestFacing && (nodes_.col(last) - nodes_.col(end)).norm() < gap / 2);
    });
    return (nodes_.col(end) - nodes_.col(last)).normalized();
  }

  const Eigen::Matrix3Xd& nodes_;
  double spacing_;
  int k_;
  std::vector<int> nearest_;
  int fewest_closed_ = kFewKnown + 1;
  bool neighbours_only_ = true;  // while paths of one or two nodes may be linked at any distance
  std::vector<std::array<int, 2>> links_;
  mutable std::vector<int> owner_;
  std::vector<double> length_, longest_;
  std::vector<int> size_;
};

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
  Linker linker(nodes, spacing);
  linker.LinkNeighbours();
  linker.LinkEnds([&](int a, int b) { return linker.IsShort(a, b); });
  linker.LinkEnds([&](int a, int b) { return linker.Bridges(a, b); });
  linker.InsertLeftOver();
  linker.CloseSmall();
  linker.StraightenOut();
  std::vector<NodePath> paths = linker.Paths();
  std::stable_sort(paths.begin(), paths.end(), [&](const NodePath& a, const NodePath& b) {
    return LengthOf(a, nodes) > LengthOf(b, nodes);
  });
  return paths;
}

}  // namespace batten::internal
