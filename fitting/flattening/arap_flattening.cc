// SPDX-License-Identifier: MIT
#include "fitting/flattening/arap_flattening.h"

#include <Eigen/Sparse>
#include <cmath>
#include <complex>
#include <queue>
#include <tuple>
#include <utility>
#include <vector>

namespace batten::internal {
namespace {

using Complex = std::complex<double>;

constexpr int kInverseIterations = 30;
constexpr int kMostRounds = 80;
// Few: the first rotations are good, and with free ends many rounds flare a widening tube like a
// trumpet, whose turns then lie on each other.
constexpr int kTubeRounds = 4;
constexpr double kSettled = 1e-4;  // relative decrease of the misfit; below, rounds stop

// Rotation of an edge: the factor that turns r_second into r_first.
Complex Turn(const PlanarEdge& e) {
  const Complex turn = -e.from_second * std::conj(e.from_first);
  return turn / std::abs(turn);
}

// Propagates rotations from node to node, breadth first.
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

// The Laplacian of the graph with the first node held at 0, factorised once; on a tube, whose edges
// cross its seam so many times, with the period.
class PlaceSolver {
 public:
  PlaceSolver(Eigen::Index n, const std::vector<PlanarEdge>& edges, std::vector<int> crossings = {})
      : edges_(edges), crossings_(std::move(crossings)), n_(n) {
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
    if (crossings_.empty()) return;
    jumps_ = Eigen::VectorXd::Zero(n);
    double crossed = 0;
    for (size_t k = 0; k < edges.size(); ++k) {
      const double weighted = edges[k].weight * crossings_[k];
      jumps_[edges[k].first] -= weighted;
      jumps_[edges[k].second] += weighted;
      crossed += weighted * crossings_[k];
    }
    jumps_[0] = 0;
    angle_ = -solver_.solve(jumps_);
    stiffness_ = crossed + jumps_.dot(angle_);
  }

  // Grows by one round the tube: minimises Σ w (θ_j + c − θ_i)².
  const Eigen::VectorXd& angle() const { return angle_; }

  // Places for given rotations, and the period.
  std::pair<Eigen::VectorXcd, Complex> Places(const Eigen::VectorXcd& rotations) const {
    Eigen::MatrixX2d rhs = Eigen::MatrixX2d::Zero(n_, 2);
    Complex crossed = 0;
    for (size_t k = 0; k < edges_.size(); ++k) {
      const PlanarEdge& e = edges_[k];
      const Complex way =
          e.weight / 2 * (rotations[e.first] * e.from_first - rotations[e.second] * e.from_second);
      const Eigen::RowVector2d d(way.real(), way.imag());
      rhs.row(e.first) -= d;
      rhs.row(e.second) += d;
      if (!crossings_.empty()) crossed += static_cast<double>(crossings_[k]) * way;
    }
    rhs.row(0).setZero();
    const Eigen::MatrixX2d still = solver_.solve(rhs);
    Eigen::VectorXcd places(n_);
    places.real() = still.col(0);
    places.imag() = still.col(1);
    if (crossings_.empty()) return {std::move(places), 0};
    const Complex period =
        (crossed - Complex(jumps_.dot(still.col(0)), jumps_.dot(still.col(1)))) / stiffness_;
    places += period * angle_.cast<Complex>();
    return {std::move(places), period};
  }

  Eigen::VectorXcd Ways(const Eigen::VectorXcd& places, const Complex& period = 0) const {
    Eigen::VectorXcd ways(static_cast<Eigen::Index>(edges_.size()));
    for (size_t k = 0; k < edges_.size(); ++k) {
      ways[k] = places[edges_[k].second] - places[edges_[k].first];
      if (!crossings_.empty()) ways[k] += static_cast<double>(crossings_[k]) * period;
    }
    return ways;
  }

 private:
  const std::vector<PlanarEdge>& edges_;
  std::vector<int> crossings_;
  Eigen::Index n_;
  Eigen::VectorXd jumps_, angle_;
  double stiffness_ = 0;  // what a step of one period costs where places have settled to it
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
};

// Those that turn the way of fastest growth along the real axis.
Eigen::VectorXcd RotationsAlong(const Eigen::VectorXcd& ways, LocalMaps maps, Eigen::Index n) {
  maps.Fit(ways, Eigen::VectorXcd::Zero(n));
  // A real function changes by 2 Re(a q): its gradient is 2 conj(a).
  return maps.Rotations(Eigen::VectorXcd::Ones(n));
}

}  // namespace

Flattening FlattenArap(const SheetGraph& graph) {
  const Eigen::Index n = graph.nodes.size();
  const std::vector<PlanarEdge> edges = PlanarEdges(graph);
  Eigen::VectorXcd rotations = AgreedRotations(n, edges);
  const PlaceSolver solver(n, edges);
  LocalMaps maps(n, edges);
  Flattening unfolding;
  unfolding.places = solver.Places(rotations).first;
  Eigen::VectorXcd ways = solver.Ways(unfolding.places);
  unfolding.distortion = MisfitOf(edges, ways, rotations);
  for (int round = 0; round < kMostRounds; ++round) {
    maps.Fit(ways, rotations);
    rotations = maps.Rotations(rotations);
    unfolding.places = solver.Places(rotations).first;
    ways = solver.Ways(unfolding.places);
    const double misfit = MisfitOf(edges, ways, rotations);
    const bool settled = misfit > (1 - kSettled) * unfolding.distortion;
    unfolding.distortion = misfit;
    if (settled) break;
  }
  maps.Fit(ways, rotations);
  unfolding.folded = maps.Folded();
  unfolding.conformal = std::move(maps.a);
  unfolding.anticonformal = std::move(maps.b);
  return unfolding;
}

Flattening FlattenTubeArap(const SheetGraph& graph,
                           const std::vector<PlanarEdge>& edges,
                           const std::vector<int>& crossings) {
  const Eigen::Index n = graph.nodes.size();
  const PlaceSolver solver(n, edges, crossings);
  LocalMaps maps(n, edges);
  Eigen::VectorXcd rotations =
      RotationsAlong(solver.Ways(solver.angle().cast<Complex>(), 1), maps, n);
  Flattening unfolding;
  auto [places, period] = solver.Places(rotations);
  Eigen::VectorXcd ways = solver.Ways(places, period);
  for (int round = 0; round < kTubeRounds; ++round) {
    maps.Fit(ways, rotations);
    rotations = maps.Rotations(rotations);
    std::tie(places, period) = solver.Places(rotations);
    ways = solver.Ways(places, period);
  }
  unfolding.distortion = MisfitOf(edges, ways, rotations);
  maps.Fit(ways, rotations);
  unfolding.folded = maps.Folded();
  unfolding.period = std::abs(period);
  const Complex turn = unfolding.period > 0 ? std::conj(period) / unfolding.period : 1.0;
  unfolding.places = turn * places;
  unfolding.conformal = turn * maps.a;
  unfolding.anticonformal = turn * maps.b;
  return unfolding;
}

}  // namespace batten::internal
