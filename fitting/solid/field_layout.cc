// SPDX-License-Identifier: MIT
#include "fitting/solid/field_layout.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "batten/fitting/refused_data.h"
#include "fitting/solid/crease_layout.h"
#include "fitting/solid/cross_field.h"
#include "fitting/solid/even_triangles.h"
#include "fitting/solid/grid_faces.h"
#include "fitting/solid/grid_map.h"
#include "fitting/solid/quad_improver.h"
#include "fitting/solid/surface_projector.h"
#include "fitting/solid/triangle_curvature.h"
#include "fitting/solid/triangle_topology.h"
#include "geometry/mesh/triangle_measure.h"

namespace batten::internal {

namespace {

// Of every triangle, such that the faces are so many.
Eigen::VectorXd FaceLengths(const TriangleSurface& surface,
                            const TriangleTopology& topology,
                            double faces,
                            bool by_curvature) {
  const double length = std::sqrt(AreaOf(surface) / faces);
  if (!by_curvature) return Eigen::VectorXd::Constant(topology.triangles(), length);
  Eigen::VectorXd sizes = FaceSizes(surface, topology, length);
  double count = 0;
  for (int t = 0; t < topology.triangles(); ++t)
    count += NormalOf(surface, t).norm() / (2 * sizes[t] * sizes[t]);
  return sizes * std::sqrt(count / faces);
}

// Without angles that are flat or turned over.
QuadMesh Improved(const QuadMesh& raw, const SurfaceProjector& projector) {
  QuadImprover improver(raw, projector);
  constexpr int kSmoothings = 4;
  improver.Smooth(kSmoothings);
  improver.Improve();
  if (improver.LeastSquareness() < 0) throw RefusedData("a face is too uneven");
  return improver.Mesh();
}

// The faces of a grid may collapse between vertices near one another.
QuadMesh Repaired(const QuadMesh& raw, const SurfaceProjector& projector) {
  try {
    CheckQuadMesh(raw);
    return raw;
  } catch (const std::invalid_argument&) {
    QuadImprover improver(raw, projector);
    improver.Improve();
    return improver.Mesh();
  }
}

}  // namespace

QuadMesh FieldLayout(const TriangleSurface& surface,
                     const SurfaceCreases& creases,
                     const SurfaceProjector& projector,
                     double faces,
                     bool by_curvature,
                     const Progress& progress) {
  const double area = AreaOf(surface);
  const double length = std::sqrt(area / faces);
  constexpr double kFine = 0.42;        // of the length of faces
  constexpr double kTriangles = 12000;  // at least, so that they follow the shape
  const double edge = std::min(kFine * length, std::sqrt(4 / std::sqrt(3.0) * area / kTriangles));
  const CreasedSurface made = EvenTriangles(surface, creases, projector, edge, progress);
  const TriangleSurface& even = made.surface;
  const TriangleTopology topology(even);
  const std::vector<char> sharp = CreasesByHalfEdge(topology, made.creases);
  Report(progress, "layout", 0.5);
  const std::vector<double> crosses = SmoothCrosses(even, topology, length, sharp);
  Report(progress, "layout", 0.6);
  const GridMap map = MapOntoGrid(
      even, topology, crosses, FaceLengths(even, topology, faces, by_curvature), made.creases);
  Report(progress, "layout", 0.9);
  const QuadMesh raw = FacesOfGrid(even, topology, map, sharp);
  QuadMesh layout =
      creases.none()
          ? Improved(raw, projector)
          : OntoCreases(Repaired(raw, projector), surface, creases, projector, kEvenRounds);
  CheckQuadMesh(layout);
  if (EulerOf(layout) != EulerOf(surface)) throw RefusedData("its genus differs");
  return layout;
}

}  // namespace batten::internal
