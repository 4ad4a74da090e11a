// SPDX-License-Identifier: MIT
#include "fitting/solid/field_layout.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "batten/fitting/closed_surface.h"
#include "batten/fitting/solid_layout.h"
#include "body_clouds.h"
#include "fitting/solid/cross_field.h"
#include "fitting/solid/even_triangles.h"
#include "fitting/solid/grid_faces.h"
#include "fitting/solid/grid_map.h"
#include "fitting/solid/quad_improver.h"
#include "fitting/solid/triangle_curvature.h"
#include "geometry/mesh/triangle_measure.h"
#include "tolerances.h"

namespace batten::internal::field_layout_test {

TriangleSurface SurfaceOf(const QuadMesh& mesh) {
  return CloseSurface(mesh.vertices, FacesOf(mesh)).surface;
}

std::vector<char> NoCreases(const TriangleTopology& topology) {
  return CreasesByHalfEdge(topology, {});
}

// The surface with triangles of even size, and a map of it onto the grid.
struct Mapped {
  Mapped(const QuadMesh& mesh, double faces) : surface(SurfaceOf(mesh)) {
    const double length = std::sqrt(AreaOf(surface) / faces);
    surface = EvenTriangles(surface, {}, SurfaceProjector(surface), length / 2, {}).surface;
    const TriangleTopology topology(surface);
    map = MapOntoGrid(surface,
                      topology,
                      SmoothCrosses(surface, topology, length, NoCreases(topology)),
                      Eigen::VectorXd::Constant(topology.triangles(), length));
  }
  TriangleSurface surface;
  GridMap map;
};

// A double torus: two blocks of a grid with a hole each.
QuadMesh DoubleTorus() {
  constexpr int kLong = 7, kWide = 3;
  std::vector<std::vector<int>> faces;
  std::vector<Eigen::Vector3d> points;
  const auto at = [&](int i, int j, int k) {
    const Eigen::Vector3d p(i, j, k);
    for (std::size_t n = 0; n < points.size(); ++n) {
      if (points[n] == p) return static_cast<int>(n);
    }
    points.push_back(p);
    return static_cast<int>(points.size()) - 1;
  };
  const auto full = [](int i, int j, int k) {
    return i >= 0 && i < kLong && j >= 0 && j < kWide && k == 0 && !(j == 1 && (i == 1 || i == 5));
  };
  for (int i = 0; i < kLong; ++i) {
    for (int j = 0; j < kWide; ++j) {
      if (!full(i, j, 0)) continue;
      const int x = i + 1, y = j + 1;
      if (!full(i - 1, j, 0)) faces.push_back({at(i, j, 0), at(i, j, 1), at(i, y, 1), at(i, y, 0)});
      if (!full(i + 1, j, 0)) faces.push_back({at(x, j, 0), at(x, y, 0), at(x, y, 1), at(x, j, 1)});
      if (!full(i, j - 1, 0)) faces.push_back({at(i, j, 0), at(x, j, 0), at(x, j, 1), at(i, j, 1)});
      if (!full(i, j + 1, 0)) faces.push_back({at(i, y, 0), at(i, y, 1), at(x, y, 1), at(x, y, 0)});
      faces.push_back({at(i, j, 0), at(i, y, 0), at(x, y, 0), at(x, j, 0)});
      faces.push_back({at(i, j, 1), at(x, j, 1), at(x, y, 1), at(i, y, 1)});
    }
  }
  QuadMesh mesh;
  mesh.vertices.resize(3, Eigen::Index(points.size()));
  for (std::size_t n = 0; n < points.size(); ++n) mesh.vertices.col(Eigen::Index(n)) = points[n];
  mesh.faces.resize(4, Eigen::Index(faces.size()));
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (int k = 0; k < 4; ++k) mesh.faces(k, Eigen::Index(f)) = faces[f][std::size_t(k)];
  }
  return Refined(Refined(mesh));
}

// Charts fit at every edge, moved by integers.
TEST(MapOntoGridTest, GoesOnAcrossEveryEdge) {
  for (const QuadMesh& mesh : {CubeSphere(4), Refined(Refined(Torus(12, 8))), DoubleTorus()}) {
    const Mapped mapped(mesh, 300);
    const TriangleTopology topology(mapped.surface);
    const GridMap& map = mapped.map;
    for (int h = 0; h < topology.half_edges(); ++h) {
      const int twin = topology.Twin(h);
      const Complex beyond = map.corners[std::size_t(TriangleTopology::Next(twin))];
      EXPECT_LE(std::abs(map.Across(h, map.corners[std::size_t(h)]) - beyond), kIterated);
      const Complex shift = map.shifts[std::size_t(h)];
      EXPECT_EQ(shift, Complex(std::round(shift.real()), std::round(shift.imag())));
    }
    EXPECT_EQ(map.turned_over, 0);
  }
}

// On a map that turns no triangle over, crosses turn by quarter turns that sum up to those of the
// Euler number: a ball has eight at least, a torus none.
TEST(FieldLayoutTest, HasFewExtraordinaryVertices) {
  const auto extraordinary = [](const QuadMesh& mesh, int faces) {
    const TriangleSurface surface = SurfaceOf(mesh);
    const QuadMesh layout = FieldLayout(surface, {}, SurfaceProjector(surface), faces, false, {});
    EXPECT_EQ(EulerOf(layout), EulerOf(surface));
    EXPECT_GT(layout.faces.cols(), 0.8 * faces);
    EXPECT_LT(layout.faces.cols(), 1.6 * faces);
    return CheckQuadMesh(layout).extraordinary;
  };
  for (const int faces : {100, 400}) {
    EXPECT_EQ(extraordinary(CubeSphere(4), faces), 8);
    EXPECT_EQ(extraordinary(Refined(Refined(Torus(12, 8))), faces), 0);
    EXPECT_LE(extraordinary(DoubleTorus(), faces), 24);  // its corners
  }
}

// Where parts are thin, faces by curvature are smaller.
TEST(FaceSizesTest, AreSmallerWhereTheSurfaceBends) {
  QuadMesh egg = CubeSphere(5);
  egg.vertices.row(2) *= 4;
  const TriangleSurface surface = SurfaceOf(egg);
  const TriangleTopology topology(surface);
  const Eigen::VectorXd sizes = FaceSizes(surface, topology, 0.5);
  double ends = 0, middle = 0;
  int at_ends = 0, in_middle = 0;
  for (int t = 0; t < topology.triangles(); ++t) {
    const double height = std::abs(surface.vertices(2, surface.triangles(0, t)));
    if (height > 3.8) ends += sizes[t], ++at_ends;
    if (height < 1) middle += sizes[t], ++in_middle;
  }
  EXPECT_LT(ends / at_ends, 0.8 * middle / in_middle);
  EXPECT_GE(sizes.minCoeff(), 0.5);
  EXPECT_LE(sizes.maxCoeff(), 1.6);
}

TEST(FieldLayoutTest, GrowsWithItsSurface) {
  TriangleSurface surface = SurfaceOf(CubeSphere(4));
  const QuadMesh one = FieldLayout(surface, {}, SurfaceProjector(surface), 150, false, {});
  surface.vertices *= 1024;  // exact
  const QuadMesh large = FieldLayout(surface, {}, SurfaceProjector(surface), 150, false, {});
  ASSERT_EQ(one.faces, large.faces);
  EXPECT_LE((large.vertices / 1024 - one.vertices).cwiseAbs().maxCoeff(), kIterated);
}

}  // namespace batten::internal::field_layout_test
