// SPDX-License-Identifier: MIT
#include "fitting/flattening/rectangle_base.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "fitting/flattening/border_corners.h"
#include "fitting/flattening/node_charts.h"
#include "fitting/flattening/parameter_blending.h"
#include "fitting/flattening/poisson_disk_samples.h"
#include "fitting/flattening/rectangle_map.h"
#include "fitting/flattening/sheet_triangulation.h"
#include "geometry/numeric/number_text.h"

namespace batten::internal {
namespace {

constexpr Eigen::Index kMoreNodes = 6000;
constexpr Eigen::Index kFewestNodes = 60;  // 8 × 8: fewer show no corners
// Width in reaches. Corners and triangles of narrower strips are those of chance.
constexpr double kNarrow = 8;
constexpr double kLongestHole = 0.5;  // of the border: beyond, it is another border
constexpr double kBeyond = 1.5;       // reaches that points may lie beyond the border's nodes

double AreaOf(const Eigen::Matrix3Xd& places, const SheetTriangulation& sheet) {
  double area = 0;
  for (const auto& t : sheet.triangles)
    area += Eigen::Vector3d(places.col(t[1]) - places.col(t[0]))
                .cross(Eigen::Vector3d(places.col(t[2]) - places.col(t[0])))
                .norm() /
            2;
  return area;
}

// The graph of the nodes and edges of the triangles only; the triangulation gets its numbers.
SheetGraph GraphOf(const SheetGraph& graph, SheetTriangulation& sheet) {
  std::vector<int> rank(static_cast<size_t>(graph.nodes.size()), -1);
  for (const auto& t : sheet.triangles)
    for (const int node : t) rank[static_cast<size_t>(node)] = 0;
  std::vector<Eigen::Index> kept;
  for (size_t i = 0; i < rank.size(); ++i) {
    if (rank[i] < 0) continue;
    rank[i] = static_cast<int>(kept.size());
    kept.push_back(static_cast<Eigen::Index>(i));
  }
  std::set<std::pair<int, int>> edges;
  for (auto& t : sheet.triangles) {
    for (int& node : t) node = rank[static_cast<size_t>(node)];
    for (size_t k = 0; k < 3; ++k) edges.insert(std::minmax(t[k], t[(k + 1) % 3]));
  }
  for (auto& loop : sheet.loops)
    for (int& node : loop) node = rank[static_cast<size_t>(node)];
  SheetGraph result{graph.nodes.Picked(kept), {}, {}, graph.share};
  for (const auto& [first, second] : edges) result.edges.push_back({first, second});
  return result;
}

}  // namespace

RectangleLayout::RectangleLayout(const Eigen::Matrix3Xd& points,
                                 const NeighbourIndex& index,
                                 double noise,
                                 double margin,
                                 ThreadPool& pool)
    : points_(points), index_(index), noise_(noise), margin_(margin), pool_(pool) {
  if (Attempt(PoissonDiskOptions{}.most)) Attempt(kMoreNodes);
}

bool RectangleLayout::Attempt(Eigen::Index nodes) {
  failure_reason_.clear();
  const auto fails = [&](std::string reason, bool more_would_help) {
    failure_reason_ = std::move(reason);
    return more_would_help;
  };
  PoissonDiskOptions sampling;
  sampling.most = nodes;
  sampling.edges_first = true;
  sampling.most_neighbours = 24;
  sampling.own_neighbours = true;
  SheetGraphOptions linking;
  linking.longest = 2.2;
  SheetGraph graph =
      ConnectSheet(SamplePoissonDisk(points_, index_, noise_, sampling, pool_), linking);
  const Eigen::Index sampled = graph.nodes.size();
  const bool are_few = 2 * sampled < nodes;  // as many as the points allow
  if (sampled < kFewestNodes) return fails("too few points for a sheet with four sides", false);
  if (!graph.contradictions.empty() &&
      std::ssize(graph.contradictions) * 200 > std::ssize(graph.edges))
    return fails("the sheet is one-sided, or its turns touch", !are_few);
  SheetTriangulation sheet = TriangulateSheet(graph);
  const double share = graph.share * sheet.vertices / static_cast<double>(sampled);
  if (share < kConnectedShare || sheet.loops.empty())
    return fails("only " + Percent(share) + " of the points hang together as a sheet", !are_few);
  graph_ = GraphOf(graph, sheet);
  const Eigen::Matrix3Xd& places = graph_.nodes.places;
  if (sheet.euler_characteristic() != 2 - static_cast<int>(sheet.loops.size()))
    return fails("the sheet hangs together across its turns", !are_few);
  const double around = BorderLength(places, sheet.loops.front());
  if (sheet.loops.size() > 1 && BorderLength(places, sheet.loops[1]) > kLongestHole * around)
    return fails("the sheet has two borders", false);
  const double width = 2 * AreaOf(places, sheet) / around;
  const bool is_narrow = width < kNarrow * graph_.nodes.reach.mean();
  if (is_narrow && !are_few && nodes < kMoreNodes)
    return fails("the sheet is too narrow for its length", true);
  const BorderCorners corners = FourCornersOf(graph_.nodes, sheet.loops.front(), width);
  if (!corners.ok()) return fails(corners.failure_reason, false);
  const RectangleMap map = MapOntoRectangle(places, sheet, corners.at);
  if (map.flipped > 0) return fails("the map onto a rectangle folds", !are_few);
  length_u_ = map.length_u;
  length_v_ = map.length_v;
  charts_ = QuadraticCharts(graph_, map.places);
  return false;
}

FlattenedBase RectangleLayout::Over(const Eigen::Matrix3Xd& some) const {
  SpreadPlaces spread = BlendLocalCharts(graph_, charts_, some, noise_, pool_);
  const double beyond = kBeyond * graph_.nodes.reach.mean();
  // The rectangle ends where the points do.
  Eigen::Array2d low(length_u_, length_v_), high(0, 0);
  for (Eigen::Index k = 0; k < some.cols(); ++k) {
    auto place = spread.places.col(k);
    place[0] = std::clamp(place[0], -beyond, length_u_ + beyond);
    place[1] = std::clamp(place[1], -beyond, length_v_ + beyond);
    if (!spread.reached[k]) continue;
    low = low.min(place.array());
    high = high.max(place.array());
  }
  const Eigen::Array2d sides = (high - low).max(0);
  FlattenedBase result;
  result.length_u = sides[0] + 2 * margin_;
  result.length_v = sides[1] + 2 * margin_;
  result.parameters = spread.places;
  for (auto place : result.parameters.colwise())
    place = (place.array() - low + margin_)
                .max(0)
                .min(Eigen::Array2d(result.length_u, result.length_v));
  result.reached = std::move(spread.reached);
  return result;
}

}  // namespace batten::internal
