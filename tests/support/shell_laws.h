// SPDX-License-Identifier: MIT
// Laws of meshes of faces that share edges.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "batten/geometry/foot_point.h"
#include "batten/geometry/tessellate.h"

namespace batten::internal {

// Every edge lies between two triangles that run along it in opposite directions, vertices with one
// joint being one; those are one point to the last bit.
inline void ExpectWatertight(const ShellMesh& shell) {
  std::map<int, Eigen::Vector3d> points;
  std::map<std::pair<std::pair<long, int>, std::pair<long, int>>, int> forwards;
  for (std::size_t f = 0; f < shell.faces.size(); ++f) {
    const TriangleMesh& mesh = shell.faces[f];
    ASSERT_EQ(static_cast<Eigen::Index>(shell.joints[f].size()), mesh.vertices.cols());
    const auto name = [&](int vertex) {
      const int joint = shell.joints[f][static_cast<std::size_t>(vertex)];
      return joint < 0 ? std::pair(static_cast<long>(f), vertex) : std::pair(-1L, joint);
    };
    for (Eigen::Index k = 0; k < mesh.vertices.cols(); ++k) {
      const int joint = shell.joints[f][static_cast<std::size_t>(k)];
      if (joint < 0) continue;
      const Eigen::Vector3d point = mesh.vertices.col(k);
      ASSERT_EQ(points.emplace(joint, point).first->second, point);
    }
    for (const auto triangle : mesh.triangles.colwise()) {
      for (int e = 0; e < 3; ++e) {
        ++forwards[{name(triangle[e]), name(triangle[(e + 1) % 3])}];
      }
    }
  }
  for (const auto& [edge, uses] : forwards) {
    const auto back = forwards.find({edge.second, edge.first});
    ASSERT_TRUE(uses == 1 && back != forwards.end() && back->second == 1);
  }
}

inline double VolumeOf(const ShellMesh& shell) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  double volume = 0, count = 0;
  for (const TriangleMesh& mesh : shell.faces) {
    middle += mesh.vertices.rowwise().sum();
    count += static_cast<double>(mesh.vertices.cols());
  }
  middle /= count;
  for (const TriangleMesh& mesh : shell.faces) {
    for (const auto triangle : mesh.triangles.colwise()) {
      const Eigen::Vector3d a = mesh.vertices.col(triangle[0]) - middle;
      const Eigen::Vector3d b = mesh.vertices.col(triangle[1]) - middle;
      const Eigen::Vector3d c = mesh.vertices.col(triangle[2]) - middle;
      volume += a.dot(b.cross(c)) / 6;
    }
  }
  return volume;
}

// Places at random in triangles of each face are no farther from its surface than that.
inline void ExpectNear(const ShellMesh& shell,
                       const std::vector<NurbsSurface>& surfaces,
                       double tolerance,
                       int places = 100) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> share;
  for (std::size_t f = 0; f < shell.faces.size(); ++f) {
    const TriangleMesh& mesh = shell.faces[f];
    if (mesh.triangles.cols() == 0) continue;
    const double far = surfaces[f].control_points().cwiseAbs().maxCoeff();
    const SurfaceFootPoints feet(surfaces[f].WithTrims({}));
    std::uniform_int_distribution<Eigen::Index> pick(0, mesh.triangles.cols() - 1);
    for (int k = 0; k < places; ++k) {
      const Eigen::Vector3i t = mesh.triangles.col(pick(random));
      double a = share(random), b = share(random);
      if (a + b > 1) a = 1 - a, b = 1 - b;
      const Eigen::Vector3d first = mesh.vertices.col(t[0]);
      const Eigen::Vector3d point =
          first + a * (mesh.vertices.col(t[1]) - first) + b * (mesh.vertices.col(t[2]) - first);
      ASSERT_LE(feet.Nearest(point).distance, tolerance + 1e-12 * far) << "face " << f;
    }
  }
}

}  // namespace batten::internal
