// SPDX-License-Identifier: MIT
#include "fitting/surface/gap_map.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace batten::internal {
namespace {

constexpr double kGapRadius = 3;       // spacings
constexpr double kPlace = 0.5;         // spacings
constexpr double kFilledAtPole = 1.5;  // spacings to either side of a point
constexpr int kMostPlaces = 320;       // along a side; wider places beyond

constexpr std::array<std::pair<int, int>, 8> kNeighbours{
    {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {1, -1}, {-1, 1}, {-1, -1}}};

int PlacesAlong(double length, double spacing) {
  return spacing > 0
             ? static_cast<int>(std::clamp(length / (kPlace * spacing), 1.0, double{kMostPlaces}))
             : 1;
}

}  // namespace

GapMap::GapMap(const FittingProblem& problem, Eigen::Index measured, double spacing) {
  const SplineBasis &bu = problem.basis_u(), &bv = problem.basis_v();
  round_u_ = bu.periodic();
  round_v_ = bv.periodic();
  u0_ = bu.lower();
  v0_ = bv.lower();
  nu_ = PlacesAlong(bu.upper() - u0_, spacing);
  nv_ = PlacesAlong(bv.upper() - v0_, spacing);
  du_ = (bu.upper() - u0_) / nu_;
  dv_ = (bv.upper() - v0_) / nv_;
  std::vector<char> occupied(static_cast<size_t>(nu_) * static_cast<size_t>(nv_), 0);
  const FittingData& data = problem.data();
  for (Eigen::Index k = 0; k < measured; ++k) {
    if (data.weights.size() > 0 && data.weights[k] == 0) continue;
    Occupy(data.parameters(0, k), data.parameters(1, k), problem.poles(), spacing, occupied);
  }
  FindDataGaps(occupied, std::max(kGapRadius * spacing, 2 * side()));
}

double GapMap::side() const { return std::max(du_, dv_); }

Eigen::Vector2d GapMap::Centre(int place) const {
  return {u0_ + du_ * (place / nv_ + 0.5), v0_ + dv_ * (place % nv_ + 0.5)};
}

int GapMap::Place(double u, double v) const {
  return std::clamp(static_cast<int>((u - u0_) / du_), 0, nu_ - 1) * nv_ +
         std::clamp(static_cast<int>((v - v0_) / dv_), 0, nv_ - 1);
}

int GapMap::Neighbour(int place, int di, int dj) const {
  int i = place / nv_ + di, j = place % nv_ + dj;
  if (round_u_) i = (i + nu_) % nu_;
  if (round_v_) j = (j + nv_) % nv_;
  return i < 0 || j < 0 || i >= nu_ || j >= nv_ ? -1 : i * nv_ + j;
}

// At an arc length s from a pole, lengths round it are stretched by length_u / (turn · s).
void GapMap::Occupy(
    double u, double v, const Poles& poles, double spacing, std::vector<char>& occupied) const {
  const int place = Place(u, v);
  occupied[static_cast<size_t>(place)] = 1;
  if (!poles.any()) return;
  const double length = du_ * nu_;
  double shrunk = 1;
  if (poles.start != PoleKind::kNone) shrunk = std::min(shrunk, poles.turn * (v - v0_) / length);
  if (poles.end != PoleKind::kNone)
    shrunk = std::min(shrunk, poles.turn * (v0_ + dv_ * nv_ - v) / length);
  const double reach = kFilledAtPole * spacing / std::max(shrunk, spacing / length);
  const int steps = std::min(nu_ / 2, static_cast<int>(reach / du_));
  for (int step = 1; step <= steps; ++step) {
    for (const int side : {-step, step}) {
      const int other = Neighbour(place, side, 0);
      if (other >= 0) occupied[static_cast<size_t>(other)] = 1;
    }
  }
}

int GapMap::GapAt(const Eigen::Vector2d& uv) const {
  return gap_of_[static_cast<size_t>(Place(uv[0], uv[1]))];
}

double GapMap::gap_share() const {
  size_t count = 0;
  for (const DataGap& hole : gaps_) count += hole.places.size();
  return static_cast<double>(count) / static_cast<double>(gap_of_.size());
}

std::vector<double> GapMap::DistancesFrom(const std::vector<char>& marked) const {
  std::vector<double> distance(marked.size(), std::numeric_limits<double>::infinity());
  for (size_t k = 0; k < marked.size(); ++k) {
    if (marked[k]) distance[k] = 0;
  }
  const double diagonal = std::hypot(du_, dv_);
  // A second pass carries distances across the seam.
  const std::vector<int> ways =
      round_u_ || round_v_ ? std::vector<int>{1, -1, 1, -1} : std::vector<int>{1, -1};
  for (const int way : ways) {
    for (int a = 0; a < nu_; ++a) {
      for (int b = 0; b < nv_; ++b) {
        const int i = way > 0 ? a : nu_ - 1 - a, j = way > 0 ? b : nv_ - 1 - b;
        const int place = i * nv_ + j;
        double& here = distance[static_cast<size_t>(place)];
        for (const auto& [di, dj, step] :
             {std::tuple{1, 0, du_}, {0, 1, dv_}, {1, 1, diagonal}, {1, -1, diagonal}}) {
          const int other = Neighbour(place, -way * di, -way * dj);
          if (other >= 0) here = std::min(here, distance[static_cast<size_t>(other)] + step);
        }
      }
    }
  }
  return distance;
}

// Marks places farther than the radius from data and all within the radius of those, then splits
// the marked places into connected parts.
void GapMap::FindDataGaps(const std::vector<char>& occupied, double radius) {
  const std::vector<double> distance = DistancesFrom(occupied);
  std::vector<char> deep(occupied.size());
  for (size_t k = 0; k < deep.size(); ++k) deep[k] = distance[k] > radius;
  const std::vector<double> from_deep = DistancesFrom(deep);
  gap_of_.assign(occupied.size(), -1);
  const auto empty = [&](size_t k) { return from_deep[k] < radius && !occupied[k]; };
  for (size_t seed = 0; seed < occupied.size(); ++seed) {
    if (!empty(seed) || gap_of_[seed] >= 0) continue;
    const int number = static_cast<int>(gaps_.size());
    DataGap hole;
    hole.places = {static_cast<int>(seed)};
    gap_of_[seed] = number;
    for (size_t next = 0; next < hole.places.size(); ++next) {
      for (const auto& [di, dj] : kNeighbours) {
        const int other = Neighbour(hole.places[next], di, dj);
        if (other < 0 || !empty(static_cast<size_t>(other)) ||
            gap_of_[static_cast<size_t>(other)] >= 0)
          continue;
        gap_of_[static_cast<size_t>(other)] = number;
        hole.places.push_back(other);
      }
    }
    std::sort(hole.places.begin(), hole.places.end());
    gaps_.push_back(std::move(hole));
  }
  for (DataGap& hole : gaps_) Describe(hole, distance);
}

void GapMap::Describe(DataGap& hole, const std::vector<double>& distance) const {
  for (size_t k = 0; k < hole.places.size(); ++k) {
    const int place = hole.places[k];
    hole.distance.push_back(distance[static_cast<size_t>(place)]);
    hole.reach = std::max(hole.reach, hole.distance.back());
    bool rim = false;
    for (const auto& [di, dj] : kNeighbours) {
      const int other = Neighbour(place, di, dj);
      hole.at_border |= other < 0;
      if (other < 0 || gap_of_[static_cast<size_t>(other)] >= 0) continue;
      rim = true;
      hole.shore.push_back(other);
    }
    if (rim) hole.rim.push_back(k);
  }
  std::sort(hole.shore.begin(), hole.shore.end());
  hole.shore.erase(std::unique(hole.shore.begin(), hole.shore.end()), hole.shore.end());
}

Eigen::MatrixXd GapMap::HarmonicFill(const DataGap& hole, const Eigen::MatrixXd& rim) const {
  const auto count = static_cast<Eigen::Index>(hole.places.size());
  Eigen::MatrixXd values(rim.rows(), count);
  std::vector<int> unknown(hole.places.size(), 0);
  for (size_t r = 0; r < hole.rim.size(); ++r) {
    unknown[hole.rim[r]] = -1;
    values.col(static_cast<Eigen::Index>(hole.rim[r])) = rim.col(static_cast<Eigen::Index>(r));
  }
  int unknowns = 0;
  for (int& u : unknown) u = u < 0 ? -1 : unknowns++;
  if (unknowns == 0) return values;
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixXd rhs = Eigen::MatrixXd::Zero(unknowns, rim.rows());
  for (size_t k = 0; k < hole.places.size(); ++k) {
    if (unknown[k] < 0) continue;
    for (const auto& [di, dj] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      const int neighbour = Neighbour(hole.places[k], di, dj);
      if (neighbour < 0 || neighbour == hole.places[k]) continue;
      // Every neighbour of a place off the rim belongs to the same gap.
      const auto at = std::lower_bound(hole.places.begin(), hole.places.end(), neighbour);
      const auto other = static_cast<size_t>(at - hole.places.begin());
      const double w = di != 0 ? dv_ / du_ : du_ / dv_;
      entries.emplace_back(unknown[k], unknown[k], w);
      if (unknown[other] >= 0) {
        entries.emplace_back(unknown[k], unknown[other], -w);
      } else {
        rhs.row(unknown[k]) += w * values.col(static_cast<Eigen::Index>(other)).transpose();
      }
    }
  }
  Eigen::SparseMatrix<double> matrix(unknowns, unknowns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
  const Eigen::MatrixXd solved = solver.solve(rhs);
  for (size_t k = 0; k < hole.places.size(); ++k) {
    if (unknown[k] >= 0) values.col(static_cast<Eigen::Index>(k)) = solved.row(unknown[k]);
  }
  return values;
}

}  // namespace batten::internal
