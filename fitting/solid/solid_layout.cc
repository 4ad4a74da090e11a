// SPDX-License-Identifier: MIT
#include "batten/fitting/solid_layout.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "batten/fitting/refused_data.h"
#include "fitting/solid/cap_borders.h"
#include "fitting/solid/crease_layout.h"
#include "fitting/solid/field_layout.h"
#include "fitting/solid/paired_layout.h"
#include "fitting/solid/surface_creases.h"
#include "fitting/solid/surface_projector.h"
#include "geometry/mesh/triangle_measure.h"

namespace batten {
using namespace internal;

namespace {

// Shorter ones are finer than what the layout can follow.
double ShortestCrease(const TriangleSurface& surface, double faces) {
  constexpr double kFaces = 3;
  return kFaces * std::sqrt(AreaOf(surface) / faces);
}

// How far the middles of faces and of their edges are from the surface, at most, in edges of faces
// of the mean size.
double Farthest(const QuadMesh& layout,
                const TriangleSurface& surface,
                const SurfaceProjector& projector) {
  double farthest = 0;
  const auto heed = [&](const Eigen::Vector3d& place) {
    farthest = std::max(farthest, (projector.Nearest(place) - place).norm());
  };
  for (const auto face : layout.faces.colwise()) {
    const Eigen::Matrix<double, 3, 4> corners = layout.vertices(Eigen::all, face);
    heed(corners.rowwise().mean());
    for (int k = 0; k < 4; ++k) heed((corners.col(k) + corners.col((k + 1) % 4)) / 2);
  }
  return farthest / std::sqrt(AreaOf(surface) / double(layout.faces.cols()));
}

}  // namespace

QuadMesh WithCreases(const QuadMesh& layout, const TriangleSurface& surface) {
  CheckQuadMesh(layout);
  const SurfaceCreases creases =
      CreasesOf(surface, ShortestCrease(surface, double(layout.faces.cols())));
  if (creases.none()) return layout;
  QuadMesh creased = layout;
  creased.creases = CreasesBetweenFaces(layout, surface, creases);
  // In no rounds: it stays as it is drawn beside them.
  return OntoCreases(creased, surface, creases, SurfaceProjector(surface), 0);
}

QuadMesh LayoutOf(const TriangleSurface& given, int faces, const Progress& progress) {
  if (faces < 6) throw RefusedData("a layout of fewer than six faces closes nothing");
  const TriangleSurface surface = WithEvenCaps(given);
  const SurfaceProjector projector(surface);
  const SurfaceCreases borders = WithCapBorders({}, surface),
                       sharp = WithCapBorders(CreasesOf(surface, ShortestCrease(surface, faces)),
                                              surface);
  const bool open = !surface.caps.empty();
  // Faces of one size meet the points as well as any. Where that leaves too few of them on thin
  // parts, or a face that spans more than half a circle, as from the tip of an ear to the head,
  // smaller ones there may do, or another size that falls differently on the shape. Creases nearer
  // to one another than faces leave none: then they do not count.
  constexpr double kHalfCircle = 0.5;  // its height over its chord
  struct Attempt {
    double finer;
    bool by_curvature, heed_sharp;
  };
  std::vector<Attempt> attempts = {
      {1, false, false}, {1, true, false}, {1.2, false, false}, {1.5, true, false}};
  if (sharp.edges != borders.edges) {
    attempts.insert(attempts.begin(), {{1, false, true}, {1, true, true}, {1.2, false, true}});
  }
  std::string why;
  std::optional<QuadMesh> best;
  double least = 0;
  for (const auto& [finer, by_curvature, heed_sharp] : attempts) {
    try {
      const SurfaceCreases& creases = heed_sharp ? sharp : borders;
      QuadMesh layout =
          FieldLayout(surface, creases, projector, faces * finer, by_curvature, progress);
      if (open) layout.caps = CapFaces(layout, surface);
      if (!creases.none()) RefuseUneven(layout);
      const double farthest = Farthest(layout, surface, projector);
      if (!best || farthest < least) best = std::move(layout);
      if (farthest <= kHalfCircle || finer > 1) return *best;
      least = farthest;
    } catch (const RefusedData& refusal) {
      why = refusal.what();
    } catch (const std::invalid_argument&) {
      why = "faces come out that touch themselves or one another";
    }
    if (best && by_curvature) return *best;  // nothing else is nearer to what was asked
  }
  if (open) throw RefusedData("no layout comes out that ends at the border of the points: " + why);
  try {
    return PairedLayout(surface, projector, faces, progress);
  } catch (const std::invalid_argument& fault) {
    throw RefusedData("no layout of quadrilaterals comes out (" + std::string(fault.what()) +
                      "): give one");
  }
}

int LayoutFaces(Eigen::Index points) {
  constexpr Eigen::Index kEach = 8, kMost = 2500;
  return int(std::clamp<Eigen::Index>(points / kEach, kFewestFaces, kMost));
}

}  // namespace batten
