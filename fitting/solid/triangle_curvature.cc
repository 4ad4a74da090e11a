// SPDX-License-Identifier: MIT
#include "fitting/solid/triangle_curvature.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "geometry/mesh/triangle_measure.h"
#include "geometry/numeric/dense_solvers.h"

namespace batten::internal {
namespace {

using Complex = std::complex<double>;

}  // namespace

Eigen::Matrix3Xd VertexNormals(const TriangleSurface& surface) {
  Eigen::Matrix3Xd normals = Eigen::Matrix3Xd::Zero(3, surface.vertices.cols());
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    const Eigen::Vector3d normal = NormalOf(surface, t);
    for (const int v : surface.triangles.col(t)) normals.col(v) += normal;
  }
  for (auto normal : normals.colwise()) normal.stableNormalize();
  return normals;
}

std::vector<Complex> SquaresAcross(const TriangleTopology& topology,
                                   const std::vector<Complex>& planar) {
  std::vector<Complex> squares;
  for (int h = 0; h < topology.half_edges(); ++h) {
    // The direction of the shared edge is opposite in the two triangles, its square the same.
    const Complex turn = planar[std::size_t(topology.Twin(h))] / planar[std::size_t(h)];
    const double length = std::norm(turn);
    squares.push_back(length > 0 ? turn * turn / length : Complex(1));
  }
  return squares;
}

TriangleCurvature CurvatureOf(const TriangleSurface& surface,
                              const TriangleTopology& topology,
                              int rounds) {
  const Eigen::Matrix3Xd normals = VertexNormals(surface);
  const std::vector<Complex> planar = PlanarEdges(surface);
  const int count = topology.triangles();
  TriangleCurvature curvature{Eigen::VectorXcd(count), Eigen::VectorXd(count)};
  for (int t = 0; t < count; ++t) {
    // The second fundamental form along the three edges.
    Eigen::Matrix3d rows;
    Eigen::Vector3d along;
    for (int k = 0; k < 3; ++k) {
      const int h = 3 * t + k;
      const int from = topology.Origin(h), to = topology.Origin(TriangleTopology::Next(h));
      const Complex e = planar[std::size_t(h)];
      rows.row(k) << e.real() * e.real(), 2 * e.real() * e.imag(), e.imag() * e.imag();
      along[k] = (normals.col(to) - normals.col(from))
                     .dot(surface.vertices.col(to) - surface.vertices.col(from));
    }
    const Eigen::Vector3d form = LeastSquares(rows, along);
    const bool found = form.allFinite();
    curvature.difference[t] = found ? Complex((form[0] - form[2]) / 2, form[1]) : 0;
    curvature.mean[t] = found ? (form[0] + form[2]) / 2 : 0;
  }
  const std::vector<Complex> squares = SquaresAcross(topology, planar);
  for (int round = 0; round < rounds; ++round) {
    TriangleCurvature sum = curvature;
    for (int h = 0; h < topology.half_edges(); ++h) {
      const int beside = topology.Twin(h) / 3;
      sum.difference[beside] += squares[std::size_t(h)] * curvature.difference[h / 3];
      sum.mean[beside] += curvature.mean[h / 3];
    }
    curvature = {sum.difference / 4, sum.mean / 4};
  }
  return curvature;
}

Eigen::VectorXd FaceSizes(const TriangleSurface& surface,
                          const TriangleTopology& topology,
                          double face_length) {
  const TriangleCurvature curvature = CurvatureOf(surface, topology, kCurvatureRounds);
  // Radians over a face: of gentle bends the size is that of faces in flat places.
  constexpr double kGentle = 0.2;
  constexpr double kSmallest = 0.5, kLargest = 1.6;  // of the middle one
  Eigen::VectorXd sizes = (curvature.difference.cwiseAbs() + curvature.mean.cwiseAbs());
  for (double& size : sizes) size = -0.5 * std::log(kGentle + face_length * size);
  Eigen::VectorXd sorted = sizes;
  const auto middle = sorted.begin() + sorted.size() / 2;
  std::nth_element(sorted.begin(), middle, sorted.end());
  for (double& size : sizes) {
    size = std::clamp(size - *middle, std::log(kSmallest), std::log(kLargest));
  }
  constexpr int kSpread = 25;
  for (int round = 0; round < kSpread; ++round) {
    Eigen::VectorXd sum = sizes;
    for (int h = 0; h < topology.half_edges(); ++h) sum[topology.Twin(h) / 3] += sizes[h / 3];
    sizes = sum / 4;
  }
  return sizes.array().exp();
}

}  // namespace batten::internal
