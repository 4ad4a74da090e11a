// SPDX-License-Identifier: MIT
#include "batten/fitting/sheet_unfolding.h"

#include <Eigen/Sparse>
#include <algorithm>
#include <cmath>
#include <complex>
#include <queue>
#include <vector>

#include "batten/fitting/sheet_cells.h"

namespace batten {
namespace {

using Complex = std::complex<double>;

constexpr int kInverseIterations = 30;
constexpr int kMostRounds = 80;
constexpr double kSettled = 1e-4;  // share of the misfit that a round no longer takes away

// An edge seen from both its ends: the way to the other one in the own tangent plane.
struct PlanarEdge {
  int first, second;
  double weight;
  Complex from_first, from_second;
};

Complex InTangentPlane(const SheetNodes& nodes, int at, const Eigen::Vector3d& way, double length) {
  const Complex q(way.dot(nodes.tangents.col(at)), way.dot(nodes.Binormal(at)));
  const double size = std::abs(q);
  return size > 0 ? q * (length / size) : Complex(length, 0);
}

std::vector<PlanarEdge> PlanarEdges(const SheetGraph& graph) {
  const SheetNodes& nodes = graph.nodes;
  std::vector<PlanarEdge> edges;
  for (const auto& [i, j, weight] : BordersOf(graph)) {
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

// What r_second must be multiplied with to give r_first.
Complex Turn(const PlanarEdge& e) {
  const Complex turn = -e.from_second * std::conj(e.from_first);
  return turn / std::abs(turn);
}

// Rotations carried from node to node, breadth first.
Eigen::VectorXcd CarriedRotations(Eigen::Index n, const std::vector<PlanarEdge>& edges) {
  std::vector<std::vector<std::pair<int, Complex>>> next(static_cast<size_t>(n));
  for (const PlanarEdge& e : edges) {
    next[e.first].emplace_back(e.second, std::conj(Turn(e)));
    next[e.second].emplace_back(e.first, Turn(e));
  }
  Eigen::VectorXcd rotations = Eigen::VectorXcd::Zero(n);
  rotations[0] = 1;
  std::queue<int> front({0});
  for (; !front.empty(); front.pop()) {
    for (const auto& [j, turn] : next[front.front()]) {
      if (rotations[j] != 0.0) continue;
      rotations[j] = turn * rotations[front.front()];
      front.push(j);
    }
  }
  return rotations;
}

// Minimises Σ|r_first − turn · r_second|² among vectors of one length, then sets |r| = 1.
Eigen::VectorXcd AgreedRotations(Eigen::Index n, const std::vector<PlanarEdge>& edges) {
  std::vector<Eigen::Triplet<Complex>> entries;
  entries.reserve(4 * edges.size());
  for (const PlanarEdge& e : edges) {
    entries.emplace_back(e.first, e.first, e.weight);
    entries.emplace_back(e.second, e.second, e.weight);
    entries.emplace_back(e.first, e.second, -e.weight * Turn(e));
    entries.emplace_back(e.second, e.first, -e.weight * std::conj(Turn(e)));
  }
  constexpr double kShift = 1e-9;  // keeps the matrix of a developable sheet positive
  for (int i = 0; i < n; ++i) entries.emplace_back(i, i, kShift);
  Eigen::SparseMatrix<Complex> matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<Complex>> solver(matrix);
  Eigen::VectorXcd rotations = CarriedRotations(n, edges);
  for (int step = 0; step < kInverseIterations; ++step) {
    const Eigen::VectorXcd before = rotations.normalized();
    rotations = solver.solve(before).normalized();
    if (std::abs(before.dot(rotations)) > 1 - 1e-13) break;
  }
  for (Complex& r : rotations) {
    const double size = std::abs(r);
    r = size > 0 ? r / size : Complex(1, 0);
  }
  return rotations;
}

// The Laplacian of the graph with the first node held at 0, factorised once.
class PlaceSolver {
 public:
  PlaceSolver(Eigen::Index n, const std::vector<PlanarEdge>& edges) : edges_(edges), n_(n) {
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(4 * edges.size() + 1);
    entries.emplace_back(0, 0, 1);
    for (const PlanarEdge& e : edges) {
      if (e.first > 0) entries.emplace_back(e.first, e.first, e.weight);
      if (e.second > 0) entries.emplace_back(e.second, e.second, e.weight);
      if (e.first == 0 || e.second == 0) continue;
      entries.emplace_back(e.first, e.second, -e.weight);
      entries.emplace_back(e.second, e.first, -e.weight);
    }
    Eigen::SparseMatrix<double> matrix(n, n);
    matrix.setFromTriplets(entries.begin(), entries.end());
    solver_.compute(matrix);
  }

  Eigen::VectorXcd Places(const Eigen::VectorXcd& rotations) const {
    Eigen::MatrixX2d rhs = Eigen::MatrixX2d::Zero(n_, 2);
    for (const PlanarEdge& e : edges_) {
      const Complex way =
          e.weight / 2 * (rotations[e.first] * e.from_first - rotations[e.second] * e.from_second);
      const Eigen::RowVector2d d(way.real(), way.imag());
      rhs.row(e.first) -= d;
      rhs.row(e.second) += d;
    }
    rhs.row(0).setZero();
    const Eigen::MatrixX2d solution = solver_.solve(rhs);
    Eigen::VectorXcd places(n_);
    places.real() = solution.col(0);
    places.imag() = solution.col(1);
    return places;
  }

 private:
  const std::vector<PlanarEdge>& edges_;
  Eigen::Index n_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
};

// The linear maps dz = a q + b conj(q) that serve the edges around each node best.
class LocalMaps {
 public:
  LocalMaps(Eigen::Index n, const std::vector<PlanarEdge>& edges)
      : edges_(edges), lengths_(Eigen::VectorXd::Zero(n)), squares_(Eigen::VectorXcd::Zero(n)) {
    for (const PlanarEdge& e : edges) {
      lengths_[e.first] += e.weight * std::norm(e.from_first);
      lengths_[e.second] += e.weight * std::norm(e.from_second);
      squares_[e.first] += e.weight * e.from_first * e.from_first;
      squares_[e.second] += e.weight * e.from_second * e.from_second;
    }
  }

  // Near the rotations where edges leave a map open.
  void Fit(const Eigen::VectorXcd& places, const Eigen::VectorXcd& rotations) {
    constexpr double kSteady = 1e-4;
    Eigen::VectorXcd along = Eigen::VectorXcd::Zero(places.size()), against = along;
    const auto add = [&](int i, double weight, const Complex& q, const Complex& way) {
      const Complex rest = weight * (way - rotations[i] * q);
      along[i] += rest * std::conj(q);
      against[i] += rest * q;
    };
    for (const PlanarEdge& e : edges_) {
      const Complex way = places[e.second] - places[e.first];
      add(e.first, e.weight, e.from_first, way);
      add(e.second, e.weight, e.from_second, -way);
    }
    a = rotations;
    b = Eigen::VectorXcd::Zero(places.size());
    for (Eigen::Index i = 0; i < places.size(); ++i) {
      const double diagonal = (1 + kSteady) * lengths_[i];
      const double determinant = diagonal * diagonal - std::norm(squares_[i]);
      if (!(determinant > 0)) continue;
      a[i] += (diagonal * along[i] - std::conj(squares_[i]) * against[i]) / determinant;
      b[i] = (diagonal * against[i] - squares_[i] * along[i]) / determinant;
    }
  }

  Eigen::VectorXcd a, b;

 private:
  const std::vector<PlanarEdge>& edges_;
  Eigen::VectorXd lengths_;
  Eigen::VectorXcd squares_;
};

double Misfit(const std::vector<PlanarEdge>& edges,
              const Eigen::VectorXcd& places,
              const Eigen::VectorXcd& rotations) {
  double sum = 0, lengths = 0;
  for (const PlanarEdge& e : edges) {
    const Complex way = places[e.second] - places[e.first];
    sum += e.weight * (std::norm(way - rotations[e.first] * e.from_first) +
                       std::norm(way + rotations[e.second] * e.from_second));
    lengths += 2 * e.weight * std::norm(e.from_first);
  }
  return lengths > 0 ? std::sqrt(sum / lengths) : 0;
}

}  // namespace

Unfolding Unfold(const SheetGraph& graph) {
  const Eigen::Index n = graph.nodes.size();
  const std::vector<PlanarEdge> edges = PlanarEdges(graph);
  Eigen::VectorXcd rotations = AgreedRotations(n, edges);
  const PlaceSolver solver(n, edges);
  LocalMaps maps(n, edges);
  Unfolding unfolding;
  unfolding.places = solver.Places(rotations);
  unfolding.distortion = Misfit(edges, unfolding.places, rotations);
  for (int round = 0; round < kMostRounds; ++round) {
    maps.Fit(unfolding.places, rotations);
    for (Eigen::Index i = 0; i < n; ++i) {
      const double size = std::abs(maps.a[i]);
      if (size > 0) rotations[i] = maps.a[i] / size;
    }
    unfolding.places = solver.Places(rotations);
    const double misfit = Misfit(edges, unfolding.places, rotations);
    const bool settled = misfit > (1 - kSettled) * unfolding.distortion;
    unfolding.distortion = misfit;
    if (settled) break;
  }
  maps.Fit(unfolding.places, rotations);
  unfolding.folded = static_cast<double>((maps.a.array().abs() <= maps.b.array().abs()).count()) /
                     static_cast<double>(n);
  unfolding.conformal = std::move(maps.a);
  unfolding.anticonformal = std::move(maps.b);
  return unfolding;
}

}  // namespace batten
