// SPDX-License-Identifier: MIT
#include "fitting/flattening/planar_edges.h"

#include <algorithm>
#include <cmath>

#include "fitting/flattening/voronoi_weights.h"

namespace batten::internal {
namespace {

using Complex = std::complex<double>;

Complex InTangentPlane(const PoissonDiskSamples& nodes,
                       int at,
                       const Eigen::Vector3d& way,
                       double length) {
  const Complex q(way.dot(nodes.tangents.col(at)), way.dot(nodes.Binormal(at)));
  const double size = std::abs(q);
  return size > 0 ? q * (length / size) : Complex(length, 0);
}

}  // namespace

std::vector<PlanarEdge> PlanarEdges(const SheetGraph& graph) {
  const PoissonDiskSamples& nodes = graph.nodes;
  std::vector<PlanarEdge> edges;
  for (const auto& [i, j, weight] : VoronoiEdgeWeights(graph)) {
    const Eigen::Vector3d way = nodes.places.col(j) - nodes.places.col(i);
    const double chord = (nodes.normals.col(j) - nodes.normals.col(i)).norm() / 2;
    const double half = std::asin(std::min(1.0, chord));  // of the angle between the normals
    const double length = way.norm() * (half > 1e-8 ? half / std::sin(half) : 1.0);
    edges.push_back({i,
                     j,
                     weight,
                     InTangentPlane(nodes, i, way, length),
                     InTangentPlane(nodes, j, -way, length)});
  }
  return edges;
}

LocalMaps::LocalMaps(Eigen::Index nodes, const std::vector<PlanarEdge>& edges)
    : edges_(edges),
      lengths_(Eigen::VectorXd::Zero(nodes)),
      squares_(Eigen::VectorXcd::Zero(nodes)) {
  for (const PlanarEdge& e : edges) {
    lengths_[e.first] += e.weight * std::norm(e.from_first);
    lengths_[e.second] += e.weight * std::norm(e.from_second);
    squares_[e.first] += e.weight * e.from_first * e.from_first;
    squares_[e.second] += e.weight * e.from_second * e.from_second;
  }
}

void LocalMaps::Fit(const Eigen::VectorXcd& ways, const Eigen::VectorXcd& rotations) {
  constexpr double kSteady = 1e-4;
  Eigen::VectorXcd along = Eigen::VectorXcd::Zero(rotations.size()), against = along;
  const auto add = [&](int i, double weight, const Complex& q, const Complex& way) {
    const Complex rest = weight * (way - rotations[i] * q);
    along[i] += rest * std::conj(q);
    against[i] += rest * q;
  };
  for (size_t k = 0; k < edges_.size(); ++k) {
    const PlanarEdge& e = edges_[k];
    add(e.first, e.weight, e.from_first, ways[k]);
    add(e.second, e.weight, e.from_second, -ways[k]);
  }
  a = rotations;
  b = Eigen::VectorXcd::Zero(rotations.size());
  for (Eigen::Index i = 0; i < rotations.size(); ++i) {
    const double diagonal = (1 + kSteady) * lengths_[i];
    const double determinant = diagonal * diagonal - std::norm(squares_[i]);
    if (!(determinant > 0)) continue;
    a[i] += (diagonal * along[i] - std::conj(squares_[i]) * against[i]) / determinant;
    b[i] = (diagonal * against[i] - squares_[i] * along[i]) / determinant;
  }
}

Eigen::VectorXcd LocalMaps::Rotations(const Eigen::VectorXcd& otherwise) const {
  Eigen::VectorXcd rotations = otherwise;
  for (Eigen::Index i = 0; i < a.size(); ++i) {
    const double size = std::abs(a[i]);
    if (size > 0) rotations[i] = a[i] / size;
  }
  return rotations;
}

double LocalMaps::Folded() const {
  return static_cast<double>((a.array().abs() <= b.array().abs()).count()) /
         static_cast<double>(a.size());
}

double MisfitOf(const std::vector<PlanarEdge>& edges,
                const Eigen::VectorXcd& ways,
                const Eigen::VectorXcd& rotations) {
  double sum = 0, lengths = 0;
  for (size_t k = 0; k < edges.size(); ++k) {
    const PlanarEdge& e = edges[k];
    sum += e.weight * (std::norm(ways[k] - rotations[e.first] * e.from_first) +
                       std::norm(ways[k] + rotations[e.second] * e.from_second));
    lengths += 2 * e.weight * std::norm(e.from_first);
  }
  return lengths > 0 ? std::sqrt(sum / lengths) : 0;
}

}  // namespace batten::internal
