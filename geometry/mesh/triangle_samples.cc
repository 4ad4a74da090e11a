// SPDX-License-Identifier: MIT
#include "batten/geometry/triangle_samples.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>
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
  Eigen::Index triangle, beside;
};

constexpr double kFlat = 1e-3;                           // radians: less is rounding
constexpr double kCrease = 25 * std::numbers::pi / 180;  // less is round

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
    turns.push_back({AngleBetween(one, other), length, one.norm(), other.norm(), h / 3, twin / 3});
  }
  return turns;
}

constexpr double kPointsOfCorners = 0.5;  // a closed mesh has half as many vertices as triangles

// Numbers the patches of triangles that edges of less than a crease join; returns how many.
int SmoothPatches(const TriangleSurface& surface, std::vector<int>& patch) {
  std::iota(patch.begin(), patch.end(), 0);
  const auto root = [&](int t) {
    while (patch[std::size_t(t)] != t) {
      int& above = patch[std::size_t(t)];
      t = above = patch[std::size_t(above)];
    }
    return t;
  };
  for (const EdgeTurn& edge : EdgeTurns(surface)) {
    if (!(edge.turn < kCrease)) continue;
    const int a = root(static_cast<int>(edge.triangle)), b = root(static_cast<int>(edge.beside));
    patch[std::size_t(std::max(a, b))] = std::min(a, b);
  }
  int count = 0;
  std::vector<int> number(patch.size(), -1);
  for (std::size_t t = 0; t < patch.size(); ++t) {
    int& own = number[std::size_t(root(static_cast<int>(t)))];
    if (own < 0) own = count++;
  }
  std::vector<int> numbered(patch.size());
  for (std::size_t t = 0; t < patch.size(); ++t)
    numbered[t] = number[std::size_t(root(static_cast<int>(t)))];
  patch = std::move(numbered);
  return count;
}

// As many points on each triangle as it has cells more than its corners stand for.
TriangleSamples SamplesOf(const TriangleSurface& surface, const Eigen::VectorXd& cells) {
  std::vector<Eigen::Index> owners;
  double due = 0;  // what is left of a point goes to the next triangle
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    if (!(cells[t] > kPointsOfCorners)) continue;
    due += cells[t] - kPointsOfCorners;
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

}  // namespace

double SampleSpacing(const TriangleSurface& surface, Eigen::Index points) {
  return std::sqrt(AreaOf(surface) / static_cast<double>(points));
}

double ChordHeight(const TriangleSurface& surface) {
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

double ChordDeviation(const TriangleSurface& surface) {
  constexpr double kSpread = 0.2981423969999720;  // 2 / 3√5
  return kSpread * ChordHeight(surface);
}

bool IsSparse(const TriangleSurface& surface) {
  constexpr double kMostSparse = 1.0 / 3;  // level: between the two kinds
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
  return sparse > kMostSparse * AreaOf(surface);
}

bool IsMostlyFlat(const TriangleSurface& surface) {
  Eigen::VectorXd flat = Eigen::VectorXd::Zero(surface.triangles.cols());
  for (const EdgeTurn& edge : EdgeTurns(surface)) {
    if (edge.turn > kFlat) continue;
    flat[edge.triangle] = edge.one;
    flat[edge.beside] = edge.other;
  }
  return flat.sum() > AreaOf(surface);  // of twice the areas more than half
}

TriangleSamples SamplesBesideVertices(const TriangleSurface& surface) {
  constexpr Eigen::Index kEnough = 20000;  // budget
  constexpr double kOfPatch = 150;         // budget: what a surface of several numbers needs
  const double spacing = SampleSpacing(surface, std::max(kEnough, surface.vertices.cols()));
  std::vector<int> patch(std::size_t(surface.triangles.cols()));
  const int patches = SmoothPatches(surface, patch);
  Eigen::VectorXd area = Eigen::VectorXd::Zero(patches), count = area;
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    area[patch[std::size_t(t)]] += NormalOf(surface, t).norm() / 2;
    count[patch[std::size_t(t)]] += 1;
  }
  const double least = std::min(kOfPatch, double(kEnough) / patches);
  Eigen::VectorXd cells(surface.triangles.cols());
  for (Eigen::Index t = 0; t < cells.size(); ++t) {
    const int p = patch[std::size_t(t)];
    const double wanted = (least + kPointsOfCorners * count[p]) / area[p];
    cells[t] = NormalOf(surface, t).norm() / 2 * std::max(1 / (spacing * spacing), wanted);
  }
  return SamplesOf(surface, cells);
}

TriangleSamples SampleTriangles(const TriangleSurface& surface, double spacing) {
  Eigen::VectorXd cells(surface.triangles.cols());
  for (Eigen::Index t = 0; t < cells.size(); ++t)
    cells[t] = NormalOf(surface, t).norm() / 2 / (spacing * spacing);
  return SamplesOf(surface, cells);
}

TriangleSamples MiddlesWithout(const TriangleSurface& surface, const TriangleSamples& samples) {
  std::vector<bool> has(std::size_t(surface.triangles.cols()), false);
  for (const int t : samples.triangles) has[std::size_t(t)] = true;
  const auto count = std::count(has.begin(), has.end(), false);
  TriangleSamples middles{
      Eigen::Matrix3Xd(3, count), Eigen::Matrix3Xd(3, count), Eigen::VectorXi(count)};
  Eigen::Index k = 0;
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    if (has[std::size_t(t)]) continue;
    middles.points.col(k) = surface.vertices(Eigen::all, surface.triangles.col(t)).rowwise().mean();
    middles.normals.col(k) = NormalOf(surface, t).normalized();
    middles.triangles[k++] = static_cast<int>(t);
  }
  return middles;
}

}  // namespace batten
