// SPDX-License-Identifier: MIT
#include "fitting/regions/close_solid.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "fitting/regions/border_curve.h"
#include "fitting/regions/border_repair.h"
#include "fitting/regions/border_sides.h"
#include "fitting/regions/settle_regions.h"
#include "fitting/regions/solid_genus.h"
#include "fitting/regions/solid_samples.h"

namespace batten::internal {
namespace {

using SolidLoop = std::vector<TrimmedSolidCoedge>;

ClosedSolid Refused(std::string words) { return {.solid = {}, .refused = std::move(words)}; }

// A face without edges is a whole sphere or torus. The first that is none, −1: there is none.
int FaceWithoutBorder(const std::vector<Region>& faces, const std::vector<BorderEdge>& edges) {
  std::vector<bool> bounded(faces.size());
  for (const BorderEdge& edge : edges)
    bounded[std::size_t(edge.faces.first)] = bounded[std::size_t(edge.faces.second)] = true;
  for (std::size_t k = 0; k < faces.size(); ++k) {
    const SurfaceKind kind = faces[k].shape.kind;
    if (!bounded[k] && kind != SurfaceKind::kSphere && kind != SurfaceKind::kTorus)
      return static_cast<int>(k);
  }
  return -1;
}

// Vertices and edges; x → scale · x + shift.
TrimmedSolid FrameOf(const FaceBorders& borders, double scale, const Eigen::Vector3d& shift) {
  TrimmedSolid solid;
  std::vector<Eigen::Vector3d> vertices;
  const auto add = [&](const Eigen::Vector3d& place) {
    vertices.push_back(scale * place + shift);
    return static_cast<int>(vertices.size()) - 1;
  };
  std::vector<int> place_of(borders.vertices.size(), -1);
  const auto vertex = [&](int k) {
    int& place = place_of[std::size_t(k)];
    if (place < 0) place = add(borders.vertices[std::size_t(k)].place);
    return place;
  };
  for (const BorderEdge& edge : borders.edges) {
    solid.edges.push_back(CurveOf(edge, scale, shift));
    TrimmedSolidEdge& made = solid.edges.back();
    if (edge.start < 0) {
      made.start = made.end = add(edge.points.col(0));
    } else {
      made.start = vertex(edge.start);
      made.end = vertex(edge.end);
    }
  }
  solid.vertices.resize(3, std::ssize(vertices));
  for (std::size_t k = 0; k < vertices.size(); ++k)
    solid.vertices.col(Eigen::Index(k)) = vertices[k];
  return solid;
}

// Puts edges one after the other; none where they do not close.
std::optional<std::vector<SolidLoop>> Chained(std::vector<TrimmedSolidCoedge> open,
                                              const std::vector<TrimmedSolidEdge>& edges) {
  const auto end = [&](const TrimmedSolidCoedge& coedge, bool last) {
    const TrimmedSolidEdge& edge = edges[std::size_t(coedge.edge)];
    return coedge.reversed == last ? edge.start : edge.end;
  };
  std::vector<SolidLoop> loops;
  while (!open.empty()) {
    SolidLoop loop{open.back()};
    open.pop_back();
    while (end(loop.back(), true) != end(loop.front(), false)) {
      const auto next = std::find_if(open.begin(), open.end(), [&](const auto& one) {
        return end(one, false) == end(loop.back(), true);
      });
      if (next == open.end()) return std::nullopt;
      loop.push_back(*next);
      open.erase(next);
    }
    loops.push_back(std::move(loop));
  }
  return loops;
}

// The loops of a face; none where its border does not close.
std::optional<std::vector<SolidLoop>> LoopsOf(int face,
                                              double outward,
                                              const std::vector<BorderEdge>& borders,
                                              const std::vector<EdgeSides>& sides,
                                              const std::vector<TrimmedSolidEdge>& edges) {
  std::vector<SolidLoop> loops;
  std::vector<TrimmedSolidCoedge> open;
  for (std::size_t e = 0; e < borders.size(); ++e) {
    const FacePair& faces = borders[e].faces;
    if (faces.first != face && faces.second != face) continue;
    const double side = faces.first == face ? sides[e].first : sides[e].second;
    const TrimmedSolidCoedge coedge{static_cast<int>(e), side * outward < 0};
    if (borders[e].start < 0) {
      loops.push_back({coedge});
    } else {
      open.push_back(coedge);
    }
  }
  auto chained = Chained(std::move(open), edges);
  if (!chained) return std::nullopt;
  loops.insert(loops.end(), chained->begin(), chained->end());
  return loops;
}

// A shape goes on where its points end, and so may a solid; faces that cross one another have
// points on both sides of where they meet.
ClosedSolid Checked(TrimmedSolid solid,
                    const RegionPoints& data,
                    const RegionLabels& labels,
                    double most_invented,
                    const Eigen::Vector3d& shift) {
  constexpr double kStep = 2;           // spacings
  constexpr double kMostBeside = 0.05;  // of the points: some at edges are of the wrong face
  const std::vector<SolidSample> samples = SampledSolid(solid, kStep * data.unit * data.spacing);
  if (samples.empty()) return Refused("its faces have no inside");
  std::vector<int> of_faces;
  for (const Region& region : labels.regions)
    of_faces.insert(of_faces.end(), region.points.begin(), region.points.end());
  const SolidCover cover =
      CoverOf(samples, (data.unit * data.points(Eigen::all, of_faces)).colwise() + shift);
  const auto percent = [](double share) { return std::to_string(std::lround(100 * share)); };
  const std::vector<int> shells = ShellsOf(solid);
  ClosedSolid closed;
  closed.invented = cover.invented;
  closed.shells = 1 + *std::max_element(shells.begin(), shells.end());
  closed.genus = GenusOf(solid);
  if (cover.invented > most_invented) {
    closed.refused = "the points do not go all round a body: " + percent(cover.invented) +
                     " % of its area have none near";
  } else if (cover.beside > kMostBeside) {
    closed.refused = "faces cross one another: " + percent(cover.beside) +
                     " % of their points are beyond where they meet";
  } else if (closed.shells > 1 && ShellsInOneAnother(samples, shells)) {
    closed.refused = "the faces are " + std::to_string(closed.shells) +
                     " bodies, of which two lie in one another";
  } else {
    closed.solid = std::move(solid);
  }
  return closed;
}

}  // namespace

ClosedSolid CloseSolid(const RegionPoints& data,
                       const RegionLabels& labels,
                       const std::map<FacePair, FittedSurface>& contacts,
                       double sigma,
                       double most_invented,
                       const Eigen::Vector3d& move) {
  const FaceMeets meets(data, labels, contacts, std::max(1e-8, kApart * sigma));
  FaceBorders borders = FindBorders(meets);
  if (borders.refused.empty()) RepairBorders(meets, borders);
  if (!borders.refused.empty()) return Refused(borders.refused);
  const int lone = FaceWithoutBorder(labels.regions, borders.edges);
  if (lone >= 0) return Refused("face " + std::to_string(lone) + " has no border with another");
  const BorderSides sides = SidesOf(data, labels, borders.edges);
  if (!sides.refused.empty()) return Refused(sides.refused);
  const FaceSides faces = OutsidesOf(data, labels, borders.edges, sides.of);
  if (!faces.refused.empty()) return Refused(faces.refused);

  const Eigen::Vector3d shift = data.middle + move;
  TrimmedSolid solid = FrameOf(borders, data.unit, shift);
  for (std::size_t k = 0; k < labels.regions.size(); ++k) {
    const FittedSurface& shape = labels.regions[k].shape;
    const double outward = faces.outward[k];
    auto loops = LoopsOf(static_cast<int>(k), outward, borders.edges, sides.of, solid.edges);
    if (!loops) return Refused("the border of face " + std::to_string(k) + " does not close");
    solid.faces.push_back(
        {shape.Shape(data.unit, shift), outward * shape.NaturalSide() < 0, std::move(*loops)});
  }
  return Checked(std::move(solid), data, labels, most_invented, shift);
}

}  // namespace batten::internal
