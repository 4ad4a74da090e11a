// SPDX-License-Identifier: MIT
#include "batten/geometry/triangle_samples.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

#include "geometry/mesh/half_edges.h"
#include "geometry/mesh/triangle_measure.h"
#include "geometry/numeric/polygon.h"

namespace batten {
using namespace internal;

namespace {

// The points of a sequence of low discrepancy in the unit square, those of its upper right half
// folded into the lower left one.
Eigen::Vector2d PlaceInTriangle(Eigen::Index k) {
  constexpr double kPlastic =
      1.32471795724474602596;  // its powers part the square evenly (Roberts 2018)
  const double n = static_cast<double>(k) + 0.5;
  double u = std::fmod(n / kPlastic, 1.0), v = std::fmod(n / (kPlastic * kPlastic), 1.0);
  if (u + v > 1) {
    u = 1 - u;
    v = 1 - v;
  }
  return {u, v};
}

// An edge between two triangles: by what angle they turn, and twice their areas.
struct EdgeTurn {
  double turn, length, one, other;
};

std::vector<EdgeTurn> EdgeTurns(const TriangleSurface& surface) {
  const auto corner = [&](Eigen::Index h, Eigen::Index k) {
    return surface.triangles((h % 3 + k) % 3, h / 3);
  };
  const HalfEdges edges =
      LinkTriangles(surface.triangles, static_cast<int>(surface.vertices.cols()));
  std::vector<EdgeTurn> turns;
  for (std::size_t k = 0; k < edges.twin.size(); ++k) {
    const auto h = static_cast<Eigen::Index>(k), twin = Eigen::Index{edges.twin[k]};
    if (twin < h) continue;
    const Eigen::Vector3d one = NormalOf(surface, h / 3), other = NormalOf(surface, twin / 3);
    const double length =
        (surface.vertices.col(corner(h, 1)) - surface.vertices.col(corner(h, 0))).norm();
    if (!(length > 0)) continue;
    turns.push_back({AngleBetween(one, other), length, one.norm(), other.norm()});
  }
  return turns;
}

constexpr double kPointsOfCorners = 0.5;  // a closed mesh has half as many vertices as triangles

}  // namespace

double SampleSpacing(const TriangleSurface& surface, Eigen::Index points) {
  return std::sqrt(AreaOf(surface) / static_cast<double>(points));
}

double ChordHeight(const TriangleSurface& surface) {
  constexpr double kCrease = 25 * std::numbers::pi / 180;
  constexpr double kFlat = 1e-3;  // radians: less is rounding
  constexpr double kShare = 0.95;
  std::vector<std::pair<double, double>> heights;  // and the area of each
  double area = 0;
  for (const EdgeTurn& edge : EdgeTurns(surface)) {
    if (!(edge.turn > kFlat && edge.turn < kCrease)) continue;
    // Chords of the circle that the two triangles turn along: their heights over the edge.
    const double a = edge.one / edge.length, b = edge.other / edge.length;
    const double longer = std::max(a, b);
    heights.emplace_back(2 * edge.turn / (a + b) * longer * longer / 8, edge.one + edge.other);
    area += heights.back().second;
  }
  std::sort(heights.begin(), heights.end());
  double below = 0;
  for (const auto& [height, own] : heights) {
    below += own;
    if (below >= kShare * area) return height;
  }
  return 0;
}

double SparseShare(const TriangleSurface& surface) {
  constexpr double kLong = 3;  // level: of triangles whose edges are a spacing long few reach it
  const double longest = kLong * SampleSpacing(surface, surface.vertices.cols());
  double sparse = 0;
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    double edge = 0;
    for (int k = 0; k < 3; ++k) {
      edge = std::max(edge,
                      (surface.vertices.col(surface.triangles(k, t)) -
                       surface.vertices.col(surface.triangles((k + 1) % 3, t)))
                          .norm());
    }
    if (edge > longest) sparse += NormalOf(surface, t).norm() / 2;
  }
  return sparse / AreaOf(surface);
}

TriangleSamples SampleTriangles(const TriangleSurface& surface, double spacing) {
  std::vector<Eigen::Index> owners;
  double due = 0;  // what is left of a point goes to the next triangle
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    const double cells = NormalOf(surface, t).norm() / 2 / (spacing * spacing);
    if (!(cells > kPointsOfCorners)) continue;
    due += cells - kPointsOfCorners;
    for (; due >= 1; due -= 1) owners.push_back(t);
  }
  const auto count = static_cast<Eigen::Index>(owners.size());
  TriangleSamples samples{
      Eigen::Matrix3Xd(3, count), Eigen::Matrix3Xd(3, count), Eigen::VectorXi(count)};
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::Index t = owners[static_cast<std::size_t>(k)];
    const Eigen::Vector2d at = PlaceInTriangle(k);
    const Eigen::Vector3d a = surface.vertices.col(surface.triangles(0, t)),
                          b = surface.vertices.col(surface.triangles(1, t)),
                          c = surface.vertices.col(surface.triangles(2, t));
    samples.points.col(k) = a + at[0] * (b - a) + at[1] * (c - a);
    samples.normals.col(k) = NormalOf(surface, t).normalized();
    samples.triangles[k] = static_cast<int>(t);
  }
  return samples;
}

}  // namespace batten
