// SPDX-License-Identifier: MIT
#include "fitting/regions/border_repair.h"

#include <algorithm>
#include <map>
#include <utility>

#include "fitting/regions/border_places.h"
#include "geometry/numeric/polygon.h"

namespace batten::internal {
namespace {

// The faces of which an odd number of edges' ends is at each vertex.
std::vector<std::vector<int>> OddFaces(const FaceBorders& borders) {
  std::vector<std::map<int, int>> ends(borders.vertices.size());
  for (const BorderEdge& edge : borders.edges) {
    for (const int vertex : {edge.start, edge.end}) {
      if (vertex < 0) continue;
      ++ends[std::size_t(vertex)][edge.faces.first];
      ++ends[std::size_t(vertex)][edge.faces.second];
    }
  }
  std::vector<std::vector<int>> odd;
  for (const auto& at : ends) {
    odd.emplace_back();
    for (const auto& [face, count] : at) {
      if (count % 2 == 1) odd.back().push_back(face);
    }
  }
  return odd;
}

// Whether an edge of the two faces is added from the vertex to another where both are odd.
bool AddShortEdge(const FaceMeets& meets,
                  const FacePair& faces,
                  int from,
                  const std::vector<std::vector<int>>& odd,
                  FaceBorders& borders) {
  const auto has = [&](int vertex, int face) {
    const auto& of = odd[std::size_t(vertex)];
    return std::binary_search(of.begin(), of.end(), face);
  };
  std::vector<WalkEnd> ends;
  for (int k = 0; k < std::ssize(borders.vertices); ++k) {
    if (k != from && has(k, faces.first) && has(k, faces.second))
      ends.push_back({k, borders.vertices[std::size_t(k)].place});
  }
  if (ends.empty()) return false;
  const Eigen::Vector3d start = borders.vertices[std::size_t(from)].place;
  const Eigen::Vector3d tangent = meets.TangentAt(faces, start);
  BorderPlaces places{start};
  for (const WalkEnd& end : ends) places.push_back(end.place);
  for (const Eigen::Vector3d& way : {tangent, Eigen::Vector3d(-tangent)}) {
    BorderWalk walk = FollowBorder(meets, faces, places, ends, start, way, from);
    if (walk.end < 0) continue;
    walk.points.push_back(borders.vertices[std::size_t(walk.end)].place);
    borders.edges.push_back({faces, from, walk.end, AsColumns(walk.points)});
    return true;
  }
  return false;
}

bool AddOne(const FaceMeets& meets, FaceBorders& borders) {
  const auto odd = OddFaces(borders);
  for (int k = 0; k < std::ssize(odd); ++k) {
    const std::vector<int>& faces = odd[std::size_t(k)];
    for (std::size_t i = 0; i < faces.size(); ++i) {
      for (std::size_t j = i + 1; j < faces.size(); ++j) {
        if (AddShortEdge(meets, {faces[i], faces[j]}, k, odd, borders)) return true;
      }
    }
  }
  return false;
}

bool IsShown(const BorderEdge& edge) { return edge.shown >= kFewLinks; }

// Of edges of the same faces between the same vertices that no places show, round the other side of
// a shape too, the shortest stays.
void DropDoubles(FaceBorders& borders) {
  std::map<std::pair<FacePair, std::pair<int, int>>, double> least;
  const auto key = [](const BorderEdge& edge) {
    return std::pair(edge.faces, std::pair(std::minmax(edge.start, edge.end)));
  };
  for (const BorderEdge& edge : borders.edges) {
    if (edge.start < 0) continue;
    const auto [at, is_new] = least.try_emplace(key(edge), PolygonLength(edge.points));
    if (!is_new) at->second = std::min(at->second, PolygonLength(edge.points));
  }
  std::erase_if(borders.edges, [&](const BorderEdge& edge) {
    if (edge.start < 0 || IsShown(edge)) return false;
    double& length = least.at(key(edge));
    if (PolygonLength(edge.points) > length) return true;
    length = -1;  // of equal ones, as edges found from both ends are, the first
    return false;
  });
}

// Whether an edge that no places show goes: the way on of a border beyond its corner. It is alone
// at an end, or faces are odd at both its ends with it and none without.
bool DropBeyond(FaceBorders& borders) {
  const auto odd = OddFaces(borders);
  std::vector<int> edges_at(borders.vertices.size());
  for (const BorderEdge& edge : borders.edges) {
    for (const int vertex : {edge.start, edge.end}) {
      if (vertex >= 0) ++edges_at[std::size_t(vertex)];
    }
  }
  const auto beyond =
      std::find_if(borders.edges.begin(), borders.edges.end(), [&](const BorderEdge& edge) {
        if (edge.start < 0 || edge.start == edge.end || IsShown(edge)) return false;
        const auto start = std::size_t(edge.start), end = std::size_t(edge.end);
        const std::vector<int> own{edge.faces.first, edge.faces.second};
        return edges_at[start] == 1 || edges_at[end] == 1 || (odd[start] == own && odd[end] == own);
      });
  if (beyond == borders.edges.end()) return false;
  borders.edges.erase(beyond);
  return true;
}

// A vertex at which a face is odd and of whose edges places show none is chance: it goes with
// these.
bool DropChance(FaceBorders& borders) {
  const auto odd = OddFaces(borders);
  std::vector<bool> shown(odd.size());
  for (const BorderEdge& edge : borders.edges) {
    if (edge.start < 0 || !IsShown(edge)) continue;
    shown[std::size_t(edge.start)] = shown[std::size_t(edge.end)] = true;
  }
  return std::erase_if(borders.edges, [&](const BorderEdge& edge) {
           if (edge.start < 0) return false;
           const auto chance = [&](int vertex) {
             return !odd[std::size_t(vertex)].empty() && !shown[std::size_t(vertex)];
           };
           return chance(edge.start) || chance(edge.end);
         }) > 0;
}

// The edge turned round.
BorderEdge Reversed(BorderEdge edge) {
  std::swap(edge.start, edge.end);
  edge.points = edge.points.rowwise().reverse().eval();
  return edge;
}

// Joins the two edges that alone are at a vertex, and of the same faces; whether there are such.
bool DropOne(FaceBorders& borders) {
  std::vector<std::vector<std::size_t>> at(borders.vertices.size());
  for (std::size_t k = 0; k < borders.edges.size(); ++k) {
    for (const int vertex : {borders.edges[k].start, borders.edges[k].end}) {
      if (vertex >= 0) at[std::size_t(vertex)].push_back(k);
    }
  }
  for (int k = 0; k < std::ssize(at); ++k) {
    const auto& ends = at[std::size_t(k)];
    if (ends.size() != 2 || ends[0] == ends[1]) continue;
    BorderEdge first = borders.edges[ends[0]], second = borders.edges[ends[1]];
    if (first.faces != second.faces) continue;
    if (first.end != k) first = Reversed(std::move(first));
    if (second.start != k) second = Reversed(std::move(second));
    if (first.start == second.end) continue;  // both are needed to go round
    const Eigen::Index count = first.points.cols(), more = second.points.cols() - 1;
    first.points.conservativeResize(Eigen::NoChange, count + more);
    first.points.rightCols(more) = second.points.rightCols(more);
    first.end = second.end;
    first.shown += second.shown;
    borders.edges[ends[0]] = std::move(first);
    borders.edges.erase(borders.edges.begin() + std::ptrdiff_t(ends[1]));
    return true;
  }
  return false;
}

}  // namespace

void RepairBorders(const FaceMeets& meets, FaceBorders& borders) {
  DropDoubles(borders);
  while (DropBeyond(borders)) {
  }
  while (DropChance(borders)) {
  }
  while (AddOne(meets, borders)) {
  }
  while (DropOne(borders)) {
  }
}

}  // namespace batten::internal
