// SPDX-License-Identifier: MIT
#include "fitting/flattening/node_charts.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

namespace batten::internal {
namespace {

using Complex = std::complex<double>;

// Of the weights exp(−(d/w)²), in reaches. Nodes are about 1.2 reaches apart: nearer ones leave a
// quadratic undetermined, farther ones smooth away the map's shape.
constexpr double kWidth = 1.6;
constexpr double kSteady = 1e-6;  // relative, of second derivatives over the width

}  // namespace

Flattening QuadraticCharts(const SheetGraph& graph, const Eigen::VectorXcd& places) {
  const PoissonDiskSamples& nodes = graph.nodes;
  const Eigen::Index n = nodes.size();
  Flattening charts;
  charts.places = places;
  charts.conformal = charts.anticonformal = Eigen::VectorXcd::Zero(n);
  charts.bend = Eigen::Matrix3Xcd::Zero(3, n);
  const std::vector<std::vector<int>> rings = TwoRings(NeighboursOf(n, graph.edges));
  for (Eigen::Index i = 0; i < n; ++i) {
    const double width = kWidth * nodes.reach[i];
    const Eigen::Vector3d tangent = nodes.tangents.col(i), binormal = nodes.Binormal(i);
    Eigen::Matrix<double, 6, 6> gram = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 2> rhs = Eigen::Matrix<double, 6, 2>::Zero();
    for (const int j : rings[static_cast<size_t>(i)]) {
      const Eigen::Vector3d way = nodes.places.col(j) - nodes.places.col(i);
      const double length = way.norm();
      Eigen::Vector2d q(way.dot(tangent), way.dot(binormal));
      const double half =
          std::asin(std::min(1.0, (nodes.normals.col(j) - nodes.normals.col(i)).norm() / 2));
      const double size = q.norm();
      if (size > 0) q *= length * (half > 1e-8 ? half / std::sin(half) : 1.0) / (size * width);
      Eigen::Matrix<double, 6, 1> row;
      row << 1, q[0], q[1], q[0] * q[0], q[0] * q[1], q[1] * q[1];
      const double weight = std::exp(-q.squaredNorm());
      const Complex off = places[j] - places[i];
      gram.noalias() += weight * row * row.transpose();
      rhs.noalias() += weight * row * Eigen::RowVector2d(off.real(), off.imag());
    }
    gram.diagonal().tail<3>().array() += kSteady * gram(0, 0);
    gram.diagonal().array() += 1e-12 * gram(0, 0);
    const Eigen::Matrix<double, 6, 2> c = gram.ldlt().solve(rhs);
    if (!c.allFinite()) continue;
    const auto coefficient = [&](int k) { return Complex(c(k, 0), c(k, 1)); };
    const Complex x = coefficient(1) / width, y = coefficient(2) / width;
    const Complex imaginary(0, 1);
    charts.places[i] += coefficient(0);
    // With x = (q + q̄) / 2 and y = (q − q̄) / 2i.
    charts.conformal[i] = (x - imaginary * y) / 2.0;
    charts.anticonformal[i] = (x + imaginary * y) / 2.0;
    const Complex xx = coefficient(3) / (width * width), xy = coefficient(4) / (width * width),
                  yy = coefficient(5) / (width * width);
    charts.bend(0, i) = (xx - yy - imaginary * xy) / 4.0;
    charts.bend(1, i) = (xx + yy) / 2.0;
    charts.bend(2, i) = (xx - yy + imaginary * xy) / 4.0;
  }
  return charts;
}

}  // namespace batten::internal
