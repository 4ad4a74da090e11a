// SPDX-License-Identifier: MIT
#include "batten/fitting/void_map.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace batten {
namespace {

constexpr double kVoidRadius = 3;  // spacings
constexpr double kPlace = 0.5;     // spacings
constexpr int kMostPlaces = 320;   // along a side

constexpr std::array<std::pair<int, int>, 8> kNeighbours{
    {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {1, -1}, {-1, 1}, {-1, -1}}};

int PlacesAlong(double length, double spacing) {
  return spacing > 0
             ? static_cast<int>(std::clamp(length / (kPlace * spacing), 1.0, double{kMostPlaces}))
             : 1;
}

}  // namespace

VoidMap::VoidMap(const FittingProblem& problem, Eigen::Index measured, double spacing) {
  const SplineBasis &bu = problem.basis_u(), &bv = problem.basis_v();
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
    occupied[static_cast<size_t>(Place(data.parameters(0, k), data.parameters(1, k)))] = 1;
  }
  FindVoids(occupied, std::max(kVoidRadius * spacing, 2 * side()));
}

double VoidMap::side() const { return std::max(du_, dv_); }

Eigen::Vector2d VoidMap::Centre(int place) const {
  return {u0_ + du_ * (place / nv_ + 0.5), v0_ + dv_ * (place % nv_ + 0.5)};
}

int VoidMap::Place(double u, double v) const {
  return std::clamp(static_cast<int>((u - u0_) / du_), 0, nu_ - 1) * nv_ +
         std::clamp(static_cast<int>((v - v0_) / dv_), 0, nv_ - 1);
}

int VoidMap::VoidAt(const Eigen::Vector2d& uv) const {
  return void_of_[static_cast<size_t>(Place(uv[0], uv[1]))];
}

double VoidMap::void_share() const {
  size_t count = 0;
  for (const DomainVoid& hole : voids_) count += hole.places.size();
  return static_cast<double>(count) / static_cast<double>(void_of_.size());
}

std::vector<double> VoidMap::DistancesFrom(const std::vector<char>& marked) const {
  std::vector<double> distance(marked.size(), std::numeric_limits<double>::infinity());
  for (size_t k = 0; k < marked.size(); ++k) {
    if (marked[k]) distance[k] = 0;
  }
  const double diagonal = std::hypot(du_, dv_);
  for (const int way : {1, -1}) {
    for (int a = 0; a < nu_; ++a) {
      for (int b = 0; b < nv_; ++b) {
        const int i = way > 0 ? a : nu_ - 1 - a, j = way > 0 ? b : nv_ - 1 - b;
        double& here = distance[static_cast<size_t>(i * nv_ + j)];
        for (const auto& [di, dj, step] :
             {std::tuple{1, 0, du_}, {0, 1, dv_}, {1, 1, diagonal}, {1, -1, diagonal}}) {
          const int i2 = i - way * di, j2 = j - way * dj;
          if (i2 < 0 || j2 < 0 || i2 >= nu_ || j2 >= nv_) continue;
          here = std::min(here, distance[static_cast<size_t>(i2 * nv_ + j2)] + step);
        }
      }
    }
  }
  return distance;
}

// Places deep inside, and what lies no farther from them than they are deep; then connected parts.
void VoidMap::FindVoids(const std::vector<char>& occupied, double radius) {
  const std::vector<double> distance = DistancesFrom(occupied);
  std::vector<char> deep(occupied.size());
  for (size_t k = 0; k < deep.size(); ++k) deep[k] = distance[k] > radius;
  const std::vector<double> from_deep = DistancesFrom(deep);
  void_of_.assign(occupied.size(), -1);
  const auto empty = [&](size_t k) { return from_deep[k] < radius && !occupied[k]; };
  for (size_t seed = 0; seed < occupied.size(); ++seed) {
    if (!empty(seed) || void_of_[seed] >= 0) continue;
    const int number = static_cast<int>(voids_.size());
    DomainVoid hole;
    hole.places = {static_cast<int>(seed)};
    void_of_[seed] = number;
    for (size_t next = 0; next < hole.places.size(); ++next) {
      const int i = hole.places[next] / nv_, j = hole.places[next] % nv_;
      for (const auto& [di, dj] : kNeighbours) {
        const int i2 = i + di, j2 = j + dj;
        if (i2 < 0 || j2 < 0 || i2 >= nu_ || j2 >= nv_) continue;
        const auto other = static_cast<size_t>(i2 * nv_ + j2);
        if (!empty(other) || void_of_[other] >= 0) continue;
        void_of_[other] = number;
        hole.places.push_back(i2 * nv_ + j2);
      }
    }
    std::sort(hole.places.begin(), hole.places.end());
    voids_.push_back(std::move(hole));
  }
  for (DomainVoid& hole : voids_) Describe(hole, distance);
}

void VoidMap::Describe(DomainVoid& hole, const std::vector<double>& distance) const {
  for (size_t k = 0; k < hole.places.size(); ++k) {
    const int place = hole.places[k], i = place / nv_, j = place % nv_;
    hole.distance.push_back(distance[static_cast<size_t>(place)]);
    hole.reach = std::max(hole.reach, hole.distance.back());
    bool rim = false;
    for (const auto& [di, dj] : kNeighbours) {
      const int i2 = i + di, j2 = j + dj;
      const bool outside = i2 < 0 || j2 < 0 || i2 >= nu_ || j2 >= nv_;
      hole.at_border |= outside;
      if (outside || void_of_[static_cast<size_t>(i2 * nv_ + j2)] >= 0) continue;
      rim = true;
      hole.shore.push_back(i2 * nv_ + j2);
    }
    if (rim) hole.rim.push_back(k);
  }
  std::sort(hole.shore.begin(), hole.shore.end());
  hole.shore.erase(std::unique(hole.shore.begin(), hole.shore.end()), hole.shore.end());
}

Eigen::MatrixXd VoidMap::HarmonicFill(const DomainVoid& hole, const Eigen::MatrixXd& rim) const {
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
    const int i = hole.places[k] / nv_, j = hole.places[k] % nv_;
    for (const auto& [di, dj] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      const int i2 = i + di, j2 = j + dj;
      if (i2 < 0 || j2 < 0 || i2 >= nu_ || j2 >= nv_) continue;
      // A place that is not rim has neighbours of its own void only.
      const auto at = std::lower_bound(hole.places.begin(), hole.places.end(), i2 * nv_ + j2);
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

}  // namespace batten
