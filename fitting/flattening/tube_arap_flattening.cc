// SPDX-License-Identifier: MIT
#include "fitting/flattening/tube_arap_flattening.h"

#include <Eigen/Sparse>
#include <cmath>
#include <complex>
#include <tuple>
#include <utility>

namespace batten::internal {
namespace {

using Complex = std::complex<double>;

// Few: the first rotations are good, and with free ends many rounds flare a widening tube like a
// trumpet, whose turns then lie on each other.
constexpr int kRounds = 4;

// The Laplacian of the graph with the first node held at 0, factorised once, and the period.
class TubeSolver {
 public:
  TubeSolver(Eigen::Index n,
             const std::vector<PlanarEdge>& edges,
             const std::vector<int>& crossings)
      : edges_(edges), crossings_(crossings), n_(n), jumps_(Eigen::VectorXd::Zero(n)) {
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(4 * edges.size() + 1);
    entries.emplace_back(0, 0, 1);
    for (size_t k = 0; k < edges.size(); ++k) {
      const PlanarEdge& e = edges[k];
      jumps_[e.first] -= e.weight * crossings[k];
      jumps_[e.second] += e.weight * crossings[k];
      crossed_ += e.weight * crossings[k] * crossings[k];
      if (e.first > 0) entries.emplace_back(e.first, e.first, e.weight);
      if (e.second > 0) entries.emplace_back(e.second, e.second, e.weight);
      if (e.first == 0 || e.second == 0) continue;
      entries.emplace_back(e.first, e.second, -e.weight);
      entries.emplace_back(e.second, e.first, -e.weight);
    }
    jumps_[0] = 0;
    Eigen::SparseMatrix<double> matrix(n, n);
    matrix.setFromTriplets(entries.begin(), entries.end());
    solver_.compute(matrix);
    angle_ = -solver_.solve(jumps_);
    // What a step of one period costs where places have settled to it.
    stiffness_ = crossed_ + jumps_.dot(angle_);
  }

  // Grows by one round the tube: minimises Σ w (θ_j + c − θ_i)².
  const Eigen::VectorXd& angle() const { return angle_; }

  // Places and period for given rotations.
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
      crossed += static_cast<double>(crossings_[k]) * way;
    }
    rhs.row(0).setZero();
    const Eigen::MatrixX2d still = solver_.solve(rhs);
    Eigen::VectorXcd places(n_);
    places.real() = still.col(0);
    places.imag() = still.col(1);
    const Complex period =
        (crossed - Complex(jumps_.dot(still.col(0)), jumps_.dot(still.col(1)))) / stiffness_;
    places += period * angle_.cast<Complex>();
    return {std::move(places), period};
  }

  Eigen::VectorXcd Ways(const Eigen::VectorXcd& places, const Complex& period) const {
    Eigen::VectorXcd ways(static_cast<Eigen::Index>(edges_.size()));
    for (size_t k = 0; k < edges_.size(); ++k) {
      ways[k] = places[edges_[k].second] - places[edges_[k].first] +
                static_cast<double>(crossings_[k]) * period;
    }
    return ways;
  }

 private:
  const std::vector<PlanarEdge>& edges_;
  const std::vector<int>& crossings_;
  Eigen::Index n_;
  Eigen::VectorXd jumps_, angle_;
  double crossed_ = 0, stiffness_ = 0;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
};

// Those that turn the way of fastest growth along the real axis.
Eigen::VectorXcd RotationsAlong(const Eigen::VectorXcd& ways, LocalMaps maps, Eigen::Index n) {
  maps.Fit(ways, Eigen::VectorXcd::Zero(n));
  // A real function changes by 2 Re(a q): its gradient is 2 conj(a).
  return maps.Rotations(Eigen::VectorXcd::Ones(n));
}

}  // namespace

Flattening FlattenTubeArap(const SheetGraph& graph,
                           const std::vector<PlanarEdge>& edges,
                           const std::vector<int>& crossings) {
  const Eigen::Index n = graph.nodes.size();
  const TubeSolver solver(n, edges, crossings);
  LocalMaps maps(n, edges);
  Eigen::VectorXcd rotations =
      RotationsAlong(solver.Ways(solver.angle().cast<Complex>(), 1), maps, n);
  Flattening unfolding;
  auto [places, period] = solver.Places(rotations);
  Eigen::VectorXcd ways = solver.Ways(places, period);
  for (int round = 0; round < kRounds; ++round) {
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
