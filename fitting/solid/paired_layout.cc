// SPDX-License-Identifier: MIT
#include "fitting/solid/paired_layout.h"

#include <cmath>
#include <string>

#include "batten/fitting/refused_data.h"
#include "fitting/solid/even_triangles.h"
#include "fitting/solid/matching_kernel.h"
#include "fitting/solid/quad_improver.h"
#include "fitting/solid/triangle_topology.h"
#include "geometry/mesh/triangle_measure.h"
#include "geometry/subdivision/catmull_clark.h"

namespace batten::internal {
namespace {

// Angles of 14° to 166° at least: where a coarse layout does not follow the shape, faces fold.
constexpr double kEven = 0.15;

// All triangles in pairs. The dual graph has three edges at every node and no bridge, so it has a
// perfect matching. [Petersen 1891; weights: Edmonds 1965]
QuadMesh Paired(const TriangleSurface& surface) {
  const TriangleTopology topology(surface);
  std::vector<std::array<int, 2>> edges;
  std::vector<int> weights;
  std::vector<Quad> quads;
  for (int h = 0; h < topology.half_edges(); ++h) {
    const int other = topology.Twin(h);
    const int a = topology.Origin(h), b = topology.Origin(other);
    if (a > b) continue;
    const int c = topology.Origin(TriangleTopology::Previous(h));
    const int d = topology.Origin(TriangleTopology::Previous(other));
    if (c == d) continue;
    edges.push_back({h / 3, other / 3});
    const Quad quad = {a, d, b, c};
    constexpr double kUnits = 10000;
    weights.push_back(int(kUnits * std::max(-3.0, Squareness(surface.vertices, quad))));
    quads.push_back(quad);
  }
  const std::vector<int> matched = PerfectMatching(topology.triangles(), edges, weights);
  if (matched.empty()) throw RefusedData("the triangles can't be paired");
  QuadMesh paired{surface.vertices, Eigen::Matrix4Xi(4, std::ssize(matched))};
  for (std::size_t k = 0; k < matched.size(); ++k)
    paired.faces.col(Eigen::Index(k)) =
        Eigen::Map<const Eigen::Vector4i>(quads[std::size_t(matched[k])].data());
  return paired;
}

// A layout of about so many faces; throws std::invalid_argument where none of that Euler number
// comes out.
QuadMesh EvenLayout(const TriangleSurface& surface,
                    const SurfaceProjector& projector,
                    double faces,
                    double least_squareness,
                    const Progress& progress) {
  // Two triangles to a face; those of even size have edges of this length.
  const double length = std::sqrt(2 * AreaOf(surface) / (std::sqrt(3.0) * faces));
  const TriangleSurface even = EvenTriangles(surface, {}, projector, length, progress).surface;
  QuadImprover improver(Paired(even), projector);
  improver.Improve();
  if (improver.LeastSquareness() < least_squareness) throw RefusedData("a face is too uneven");
  QuadMesh layout = improver.Mesh();
  CheckQuadMesh(layout);
  if (EulerOf(layout) != EulerOf(surface))
    throw RefusedData("its genus differs from the surface's");
  return layout;
}

// The layout with every face cut in four, on the surface; faces that come out uneven are refused.
QuadMesh Finer(const QuadMesh& layout, const SurfaceProjector& projector) {
  const SubdividedMesh finer =
      Subdivided(QuadTopology(layout.faces, static_cast<int>(layout.vertices.cols())));
  Eigen::Matrix3Xd points = Combined(finer.stencils, layout.vertices);
  for (Eigen::Index v = 0; v < points.cols(); ++v) points.col(v) = projector.Nearest(points.col(v));
  QuadImprover improver({std::move(points), finer.topology.corners()}, projector);
  constexpr int kSmoothings = 10;
  improver.Smooth(kSmoothings);
  if (improver.LeastSquareness() < kEven) throw RefusedData("a face is too uneven");
  QuadMesh mesh = improver.Mesh();
  CheckQuadMesh(mesh);
  return mesh;
}

}  // namespace

QuadMesh PairedLayout(const TriangleSurface& surface,
                      const SurfaceProjector& projector,
                      int faces,
                      const Progress& progress) {
  std::string why;
  // A coarse layout cut finer has fewer extraordinary vertices, where its faces are fine enough for
  // the shape; a layout finer than asked for may be where those are not.
  for (const double coarse : {16.0, 4.0, 1.0, 0.6}) {
    constexpr double kFewest = 40;  // faces of a coarse layout
    if (coarse > 1 && faces / coarse < kFewest) continue;
    Report(progress, "layout", 0.0);
    try {
      // Any that is not cut: the fit judges.
      QuadMesh layout =
          EvenLayout(surface, projector, faces / coarse, coarse > 1 ? kEven : -HUGE_VAL, progress);
      for (double cut = coarse; cut > 1; cut /= 4) layout = Finer(layout, projector);
      return layout;
    } catch (const std::invalid_argument& fault) {
      why = fault.what();
    }
  }
  throw RefusedData(why);
}

}  // namespace batten::internal
