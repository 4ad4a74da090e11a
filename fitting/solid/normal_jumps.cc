// SPDX-License-Identifier: MIT
#include "fitting/solid/normal_jumps.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "fitting/core/rounding.h"
#include "geometry/mesh/triangle_measure.h"
#include "geometry/numeric/polygon.h"

namespace batten::internal {
namespace {

// Normals of triangles, less their noise.
Eigen::Matrix3Xd MeanNormals(const TriangleSurface& surface, const TriangleTopology& topology) {
  constexpr int kRounds = 8;
  constexpr double kWidth = 25 * kOneDegree;  // normals that differ by more hardly count
  Eigen::Matrix3Xd normals(3, topology.triangles());
  Eigen::VectorXd areas(normals.cols());
  for (Eigen::Index t = 0; t < normals.cols(); ++t) {
    const Eigen::Vector3d cross = NormalOf(surface, t);
    areas[t] = cross.norm();
    normals.col(t) = cross.stableNormalized();
  }
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix3Xd next = normals * areas.asDiagonal();
    for (int h = 0; h < topology.half_edges(); ++h) {
      const int t = h / 3, beside = topology.Twin(h) / 3;
      const double square = (normals.col(t) - normals.col(beside)).squaredNorm();
      next.col(t) += areas[beside] * std::exp(-square / (kWidth * kWidth)) * normals.col(beside);
    }
    for (Eigen::Index t = 0; t < normals.cols(); ++t)
      normals.col(t) = next.col(t).stableNormalized();
  }
  return normals;
}

// How much normals jump over edges, beyond what they bend beside them.
class NormalJumps {
 public:
  // `walls`, by half-edge: over which sides do not go on.
  NormalJumps(const TriangleSurface& surface,
              const TriangleTopology& topology,
              const std::vector<char>& walls)
      : surface_(surface),
        topology_(topology),
        walls_(walls),
        seen_(std::size_t(topology.triangles()), 0) {}

  // The angle between the normals of both sides at an edge.
  double Across(int h) {
    const std::array<Eigen::Vector3d, 2> normal = {NormalAt(h), NormalAt(topology_.Twin(h))};
    return AngleBetween(normal[0], normal[1]);
  }

 private:
  Eigen::Vector3d InwardOf(int h) const {
    const Eigen::Vector3d a = surface_.vertices.col(topology_.Origin(h));
    const Eigen::Vector3d along =
        (surface_.vertices.col(topology_.Origin(TriangleTopology::Next(h))) - a).stableNormalized();
    const Eigen::Vector3d way =
        surface_.vertices.col(topology_.Origin(TriangleTopology::Previous(h))) - a;
    return (way - way.dot(along) * along).stableNormalized();
  }

  // The line through mean normals over triangles on the side of a half-edge, and of walls, where
  // it meets that.
  Eigen::Vector3d NormalAt(int h) {
    constexpr double kFar = 4;  // lengths of the edge
    const Eigen::Vector3d a = surface_.vertices.col(topology_.Origin(h)),
                          b = surface_.vertices.col(topology_.Origin(TriangleTopology::Next(h)));
    const Eigen::Vector3d middle = (a + b) / 2;
    const Eigen::Vector3d inward = InwardOf(h), apart = inward - InwardOf(topology_.Twin(h));
    double weight = 0, first = 0, second = 0;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero(), moment = sum;
    std::vector<int> open = {h / 3}, touched = open;
    seen_[std::size_t(h / 3)] = 1;
    while (!open.empty()) {
      const int t = open.back();
      open.pop_back();
      const auto corner = surface_.triangles.col(t);
      const Eigen::Vector3d p = surface_.vertices.col(corner[0]);
      const Eigen::Vector3d q = surface_.vertices.col(corner[1]);
      const Eigen::Vector3d r = surface_.vertices.col(corner[2]);
      const Eigen::Vector3d twice = (q - p).cross(r - p);
      const double depth = ((p + q + r) / 3 - middle).dot(inward);
      weight += twice.norm();
      first += twice.norm() * depth;
      second += twice.norm() * depth * depth;
      sum += twice;
      moment += depth * twice;
      for (int g = 3 * t; g < 3 * t + 3; ++g) {
        const int beside = topology_.Twin(g) / 3;
        if (walls_[std::size_t(g)] || seen_[std::size_t(beside)]) continue;
        const auto its = surface_.triangles.col(beside);
        const Eigen::Vector3d centre =
            (surface_.vertices.col(its[0]) + surface_.vertices.col(its[1]) +
             surface_.vertices.col(its[2])) /
            3;
        if ((centre - middle).norm() > kFar * (b - a).norm() || (centre - middle).dot(apart) < 0) {
          continue;
        }
        seen_[std::size_t(beside)] = 1;
        touched.push_back(beside);
        open.push_back(beside);
      }
    }
    for (const int t : touched) seen_[std::size_t(t)] = 0;
    const double spread = weight * second - first * first;
    constexpr double kSpread = 1e-6;
    if (!(spread > kSpread * weight * second)) return sum.stableNormalized();
    return (second * sum - first * moment).stableNormalized();
  }

  const TriangleSurface& surface_;
  const TriangleTopology& topology_;
  const std::vector<char>& walls_;
  std::vector<char> seen_;  // triangles
};

}  // namespace

std::vector<double> MeanTurns(const TriangleSurface& surface, const TriangleTopology& topology) {
  const Eigen::Matrix3Xd normals = MeanNormals(surface, topology);
  std::vector<double> turns;
  for (int h = 0; h < topology.half_edges(); ++h) {
    const Eigen::Vector3d one = normals.col(h / 3), two = normals.col(topology.Twin(h) / 3);
    turns.push_back(AngleBetween(one, two));
  }
  return turns;
}

std::vector<double> JumpsAcross(const TriangleSurface& surface,
                                const TriangleTopology& topology,
                                const std::vector<char>& walls,
                                const std::vector<char>& marks) {
  NormalJumps jumps(surface, topology, walls);
  std::vector<double> jump(walls.size(), 0.0);
  for (int h = 0; h < topology.half_edges(); ++h) {
    if (marks[std::size_t(h)] && topology.Twin(h) > h)
      jump[std::size_t(h)] = jump[std::size_t(topology.Twin(h))] = jumps.Across(h);
  }
  return jump;
}

}  // namespace batten::internal
