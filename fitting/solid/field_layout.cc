// SPDX-License-Identifier: MIT
#include "fitting/solid/field_layout.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "batten/fitting/refused_data.h"
#include "fitting/solid/cross_field.h"
#include "fitting/solid/even_triangles.h"
#include "fitting/solid/grid_faces.h"
#include "fitting/solid/grid_map.h"
#include "fitting/solid/quad_improver.h"
#include "fitting/solid/triangle_topology.h"

namespace batten::internal {

QuadMesh FieldLayout(const TriangleSurface& surface,
                     const SurfaceProjector& projector,
                     double faces,
                     const Progress& progress) {
  const double area = AreaOf(surface);
  const double length = std::sqrt(area / faces);
  constexpr double kFine = 0.5;         // of the length of faces
  constexpr double kTriangles = 12000;  // at least, so that they follow the shape
  const double edge = std::min(kFine * length, std::sqrt(4 / std::sqrt(3.0) * area / kTriangles));
  const TriangleSurface even = EvenTriangles(surface, projector, edge, progress);
  const TriangleTopology topology(even);
  Report(progress, "layout", 0.5);
  const std::vector<double> crosses = SmoothCrosses(even, topology, length);
  Report(progress, "layout", 0.6);
  const GridMap map = MapOntoGrid(even, topology, crosses, length);
  Report(progress, "layout", 0.9);
  const QuadMesh raw = FacesOfGrid(even, topology, map);
  std::vector<Quad> quads;
  for (const auto face : raw.faces.colwise()) quads.push_back({face[0], face[1], face[2], face[3]});
  QuadImprover improver(raw.vertices, std::move(quads), projector);
  constexpr int kSmoothings = 4;
  improver.Smooth(kSmoothings);
  improver.Improve();
  constexpr double kEven = 0;  // no angle is flat
  if (improver.LeastSquareness() < kEven) throw RefusedData("a face is too uneven");
  QuadMesh layout = improver.Mesh();
  CheckQuadMesh(layout);
  if (EulerOf(layout) != EulerOf(surface)) throw RefusedData("its genus differs");
  return layout;
}

}  // namespace batten::internal
