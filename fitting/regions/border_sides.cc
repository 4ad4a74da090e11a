// SPDX-License-Identifier: MIT
#include "fitting/regions/border_sides.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "fitting/regions/border_curve.h"
#include "fitting/regions/border_places.h"

namespace batten::internal {
namespace {

// 0 where as many points are on either side, or none.
double SideOf(const RegionPoints& data, const Region& region, const BorderEdge& edge) {
  constexpr double kOff = 0.3;  // spacings
  const Eigen::Index count = edge.points.cols();
  double sum = 0;
  for (const Eigen::Index at : {count / 4, count / 2, 3 * count / 4}) {
    const Eigen::Index next = std::min(at + 1, count - 1),
                       before = std::max<Eigen::Index>(next - 1, 0);
    const Eigen::Vector3d here = (edge.points.col(before) + edge.points.col(next)) / 2;
    const Eigen::Vector3d way = edge.points.col(next) - edge.points.col(before);
    const Eigen::Vector3d left =
        region.shape.TouchingNear(here).normal.cross(way).stableNormalized();
    for (const int point : region.points) {
      const Eigen::Vector3d off = data.points.col(point) - here;
      if (off.squaredNorm() > std::pow(kBorderReach * data.spacing, 2)) continue;
      const double side = off.dot(left);
      if (std::abs(side) > kOff * data.spacing) sum += side > 0 ? 1 : -1;
    }
  }
  return sum > 0 ? 1 : sum < 0 ? -1 : 0;
}

// Whether the loop of a face comes to a vertex along its only edge there beside one; none where
// that is not known.
std::optional<bool> ArrivesAt(int vertex,
                              int face,
                              std::size_t beside,
                              const std::vector<BorderEdge>& edges,
                              const std::vector<EdgeSides>& sides) {
  std::optional<bool> arrives;
  for (std::size_t k = 0; k < sides.size(); ++k) {
    const BorderEdge& edge = edges[k];
    const bool of_face = edge.faces.first == face || edge.faces.second == face;
    if (k == beside || !of_face || (edge.start != vertex && edge.end != vertex)) continue;
    const double side = face == edge.faces.first ? sides[k].first : sides[k].second;
    if (arrives || side == 0 || edge.start == edge.end) return std::nullopt;
    arrives = (edge.end == vertex) == (side > 0);
  }
  return arrives;
}

// Tells the side of one more edge by the next; false where there is none.
bool TellSideByNext(const std::vector<BorderEdge>& edges, std::vector<EdgeSides>& sides) {
  for (std::size_t k = 0; k < sides.size(); ++k) {
    const BorderEdge& edge = edges[k];
    for (const int face : {edge.faces.first, edge.faces.second}) {
      double& side = face == edge.faces.first ? sides[k].first : sides[k].second;
      for (const int vertex : {edge.start, edge.end}) {
        if (side != 0 || vertex < 0) continue;
        const auto arrives = ArrivesAt(vertex, face, k, edges, sides);
        if (!arrives) continue;
        side = (*arrives == (edge.start == vertex)) ? 1 : -1;
        return true;
      }
    }
  }
  return false;
}

// Turns the faces of a shell where its outermost point looks inwards.
void TurnOutwards(const RegionPoints& data,
                  const RegionLabels& labels,
                  const std::vector<int>& shell,
                  std::vector<double>& outward) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  double count = 0;
  for (const int face : shell) {
    for (const int point : labels.regions[std::size_t(face)].points) {
      middle += data.points.col(point);
      ++count;
    }
  }
  middle /= count;
  double farthest = -1, side = 1;
  for (const int face : shell) {
    const Region& region = labels.regions[std::size_t(face)];
    for (const int point : region.points) {
      const Eigen::Vector3d from = data.points.col(point) - middle;
      if (!(from.squaredNorm() > farthest)) continue;
      farthest = from.squaredNorm();
      side = region.shape.TouchingNear(data.points.col(point)).normal.dot(from) *
             outward[std::size_t(face)];
    }
  }
  if (side >= 0) return;
  for (const int face : shell) outward[std::size_t(face)] *= -1;
}

}  // namespace

BorderSides SidesOf(const RegionPoints& data,
                    const RegionLabels& labels,
                    const std::vector<BorderEdge>& edges) {
  std::vector<EdgeSides> sides;
  for (const BorderEdge& edge : edges) {
    // One that ends where it began has a way round.
    if (edge.start >= 0 && edge.start == edge.end && OnSegment(edge.points))
      return {{}, "the border of " + WordsOf(edge.faces) + " comes back to where it began"};
    const auto of = [&](int face) { return SideOf(data, labels.regions[std::size_t(face)], edge); };
    sides.push_back({of(edge.faces.first), of(edge.faces.second)});
  }
  while (TellSideByNext(edges, sides)) {
  }
  for (std::size_t k = 0; k < sides.size(); ++k) {
    if (sides[k].first == 0 || sides[k].second == 0)
      return {{}, "the border of " + WordsOf(edges[k].faces) + " is too short for its points"};
  }
  return {std::move(sides), ""};
}

FaceSides OutsidesOf(const RegionPoints& data,
                     const RegionLabels& labels,
                     const std::vector<BorderEdge>& edges,
                     const std::vector<EdgeSides>& sides) {
  std::vector<double> outward(labels.regions.size(), 0);
  for (int seed = 0; seed < std::ssize(outward); ++seed) {
    if (outward[std::size_t(seed)] != 0) continue;
    std::vector<int> shell{seed};
    outward[std::size_t(seed)] = 1;
    for (std::size_t k = 0; k < shell.size(); ++k) {
      for (std::size_t e = 0; e < edges.size(); ++e) {
        const FacePair& faces = edges[e].faces;
        if (faces.first != shell[k] && faces.second != shell[k]) continue;
        const int other = faces.first == shell[k] ? faces.second : faces.first;
        const double wanted = -outward[std::size_t(shell[k])] * sides[e].first * sides[e].second;
        double& there = outward[std::size_t(other)];
        if (there == 0) {
          there = wanted;
          shell.push_back(other);
        } else if (there != wanted) {
          return {{},
                  "sides of faces " + std::to_string(shell[k]) + " and " + std::to_string(other) +
                      " contradict each other"};
        }
      }
    }
    TurnOutwards(data, labels, shell, outward);
  }
  return {std::move(outward), ""};
}

}  // namespace batten::internal
