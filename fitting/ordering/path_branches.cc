// SPDX-License-Identifier: MIT
#include "fitting/ordering/path_branches.h"

#include <algorithm>
#include <cmath>

#include "batten/fitting/neighbours.h"
#include "batten/fitting/statistics.h"
#include "geometry/numeric/polygon.h"

namespace batten::internal {
namespace {

constexpr size_t kFewestOpen = 5;
constexpr double kJagged = 0.9;      // mean turn at a node, about 50°
constexpr double kFullTurn = 6.5;    // and a little; a small closed path turns as much
constexpr double kSparse = 3;        // links longer than so many of the longest path's
constexpr int kNear = 24;            // nodes asked whether they are of another stretch
constexpr double kCrossing = 1.2;    // links
constexpr int kFacingEnds = 3;       // an end meets no end: nodes that count as one
constexpr double kEndReach = 2;      // links
constexpr double kLongLink = 2.5;    // of the median: longer ones count as this
constexpr double kSideBySide = 1.5;  // links between stretches that leave a sharp corner

struct Spot {
  int path, place;
};

// Paths as curves: neighbours along them, and lengths of their links.
class PathMap {
 public:
  PathMap(const std::vector<NodePath>& paths, const Eigen::Matrix3Xd& nodes)
      : paths_(paths), nodes_(nodes) {
    std::vector<int> all;
    for (int p = 0; p < static_cast<int>(paths.size()); ++p) {
      std::vector<double> links;
      for (int i = 0; i < Size(p); ++i) {
        spots_.push_back({p, i});
        all.push_back(paths[p].nodes[i]);
        if (Has(p, i + 1)) links.push_back((At(p, i) - At(p, i + 1)).norm());
      }
      medians_.push_back(links.empty() ? 0 : Median(std::move(links)));
    }
    places_ = nodes(Eigen::all, all);
  }

  int Size(int path) const { return static_cast<int>(paths_[path].nodes.size()); }
  bool Closed(int path) const { return paths_[path].closed; }
  bool Has(int path, int place) const { return Closed(path) || (place >= 0 && place < Size(path)); }
  Eigen::Vector3d At(int path, int place) const {
    const int size = Size(path);
    return nodes_.col(paths_[path].nodes[((place % size) + size) % size]);
  }
  bool IsEnd(const Spot& spot) const { return NodesToEnd(spot) == 0; }
  int NodesToEnd(const Spot& spot) const {
    return Closed(spot.path) ? Size(spot.path)
                             : std::min(spot.place, Size(spot.path) - 1 - spot.place);
  }
  double MedianLink(int path) const { return medians_[path]; }

  double LongestLinkAt(const Spot& spot) const {
    double longest = 0;
    for (const int side : {-1, 1}) {
      if (!Has(spot.path, spot.place + side)) continue;
      longest =
          std::max(longest, (At(spot.path, spot.place) - At(spot.path, spot.place + side)).norm());
    }
    return std::min(longest, kLongLink * medians_[spot.path]);
  }

  // To the nearer of the two links at a spot.
  double DistanceToLinks(const Eigen::Vector3d& point, const Spot& spot) const {
    const Eigen::Vector3d here = At(spot.path, spot.place);
    double nearest = (point - here).norm();
    for (const int side : {-1, 1}) {
      if (!Has(spot.path, spot.place + side)) continue;
      nearest =
          std::min(nearest, DistanceFromSegment(point, here, At(spot.path, spot.place + side)));
    }
    return nearest;
  }

  // Nodes between two spots of one path, the shorter way round.
  int Between(const Spot& a, const Spot& b) const {
    const int direct = std::abs(a.place - b.place);
    return Closed(a.path) ? std::min(direct, Size(a.path) - direct) : direct;
  }

  // Whether two spots of one path lie on the sides of a sharp corner: the sides stay together all
  // the way to it.
  bool LeaveOneCorner(const Spot& a, const Spot& b, double spacing) const {
    const int low = std::min(a.place, b.place), high = std::max(a.place, b.place);
    return StayTogether(a.path, low, high, spacing) ||
           (Closed(a.path) && StayTogether(a.path, high, low + Size(a.path), spacing));
  }

  const std::vector<Spot>& spots() const { return spots_; }
  const Eigen::Matrix3Xd& places() const { return places_; }

 private:
  bool StayTogether(int path, int low, int high, double spacing) const {
    while (high - low > 2) {
      const double low_moves = (At(path, low + 1) - At(path, high)).norm();
      const double high_moves = (At(path, low) - At(path, high - 1)).norm();
      if (std::min(low_moves, high_moves) > Beside(path, low, high, spacing)) return false;
      if (low_moves < high_moves) {
        ++low;
      } else {
        --high;
      }
    }
    return true;
  }

  // How far apart they may be there.
  double Beside(int path, int low, int high, double spacing) const {
    const double low_link = (At(path, low) - At(path, low + 1)).norm();
    const double high_link = (At(path, high) - At(path, high - 1)).norm();
    return kSideBySide * spacing + std::max(low_link, high_link);
  }

  const std::vector<NodePath>& paths_;
  const Eigen::Matrix3Xd& nodes_;
  std::vector<double> medians_;
  std::vector<Spot> spots_;
  Eigen::Matrix3Xd places_;
};

double TotalTurn(const PathMap& map, int path) {
  double turn = 0;
  for (int i = 0; i < map.Size(path); ++i) {
    if (!map.Has(path, i - 1) || !map.Has(path, i + 1)) continue;
    const Eigen::Vector3d in = map.At(path, i) - map.At(path, i - 1);
    const Eigen::Vector3d out = map.At(path, i + 1) - map.At(path, i);
    turn += AngleBetween(in, out);
  }
  return turn;
}

bool IsCurve(const PathMap& map, int path, double spacing) {
  const auto size = static_cast<size_t>(map.Size(path));
  if (!map.Closed(path) && size < kFewestOpen) return false;
  if (map.MedianLink(path) > kSparse * spacing) return false;
  const double turn = TotalTurn(map, path);
  return turn <= kJagged * static_cast<double>(size) || (map.Closed(path) && turn <= kFullTurn);
}

bool Meet(const PathMap& map, const Spot& a, const Spot& b) {
  if (a.path == b.path && map.Between(a, b) <= 2) return false;
  const double spacing = std::max(map.LongestLinkAt(a), map.LongestLinkAt(b));
  const bool end = map.IsEnd(a) && map.NodesToEnd(b) > kFacingEnds;
  const double reach = (end ? kEndReach : kCrossing) * spacing;
  return map.DistanceToLinks(map.At(a.path, a.place), b) < reach &&
         !(a.path == b.path && map.LeaveOneCorner(a, b, std::max(spacing, reach)));
}

}  // namespace

std::vector<NodePath> CurvesAmong(const std::vector<NodePath>& paths,
                                  const Eigen::Matrix3Xd& nodes) {
  if (paths.size() < 2) return paths;
  const PathMap map(paths, nodes);
  std::vector<double> links;
  for (size_t p = 0; p < paths.size(); ++p) {
    links.insert(links.end(), paths[p].nodes.size() - 1, map.MedianLink(static_cast<int>(p)));
  }
  const double spacing = links.empty() ? 0 : Median(std::move(links));
  std::vector<NodePath> curves;
  for (size_t p = 0; p < paths.size(); ++p) {
    if (!IsCurve(map, static_cast<int>(p), spacing)) continue;
    curves.push_back(paths[p]);
  }
  if (curves.empty()) curves.push_back(paths.front());
  return curves;
}

double MeanTurn(const std::vector<NodePath>& paths, const Eigen::Matrix3Xd& nodes) {
  const PathMap map(paths, nodes);
  double turn = 0;
  for (int p = 0; p < static_cast<int>(paths.size()); ++p) turn += TotalTurn(map, p);
  return turn / static_cast<double>(map.spots().size());
}

std::vector<Eigen::Vector3d> MeetingPlaces(const std::vector<NodePath>& paths,
                                           const Eigen::Matrix3Xd& nodes) {
  const PathMap map(paths, nodes);
  const int k = static_cast<int>(std::min<Eigen::Index>(kNear, map.places().cols()));
  const std::vector<int> nearest = NeighbourIndex(map.places()).Nearest(map.places(), k);
  std::vector<Eigen::Vector3d> meetings;
  for (size_t a = 0; a < map.spots().size(); ++a) {
    for (int j = 0; j < k; ++j) {
      const auto b = static_cast<size_t>(nearest[a * k + j]);
      if (a == b || !Meet(map, map.spots()[a], map.spots()[b])) continue;
      meetings.push_back((map.places().col(a) + map.places().col(b)) / 2);
      break;
    }
  }
  return meetings;
}

}  // namespace batten::internal
