// SPDX-License-Identifier: MIT
#include "fitting/wings/dealt_sides.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <memory>

#include "batten/fitting/distances.h"
#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/solve_linear.h"
#include "batten/geometry/nurbs_surface.h"
#include "fitting/least_squares/fitting_bases.h"

namespace batten::internal {
namespace {

constexpr int kModelCells = 24, kModelCellsAlong = 3;  // of the net
constexpr int kPins = 200;                             // places of the edge in it
constexpr double kPinWeight = 100;
constexpr double kModelSmoothing = 1e-6;

// Even in 0 … 1 by the point's coordinates alone. [SplitMix64: Steele, Lea & Flood 2014]
double EvenBy(const Eigen::Vector3d& point) {
  std::uint64_t bits = 0x9e3779b97f4a7c15u;
  for (const double x : point) {
    bits += std::bit_cast<std::uint64_t>(x);
    bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9u;
    bits = (bits ^ (bits >> 27)) * 0x94d049bb133111ebu;
    bits ^= bits >> 31;
  }
  return static_cast<double>(bits >> 11) * 0x1p-53;
}

NurbsSurface Model(const Eigen::Matrix3Xd& points,
                   const std::vector<Eigen::Index>& clear,
                   const WingLine& edge,
                   const WingCoordinates& at,
                   ThreadPool& pool) {
  const auto count = std::ssize(clear);
  auto data = std::make_shared<FittingData>();
  data->parameters.resize(2, count + 2 * kPins);
  data->values.resize(3, count + 2 * kPins);
  data->weights = Eigen::VectorXd::Ones(count + 2 * kPins);
  data->weights.tail(2 * kPins).setConstant(kPinWeight);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index k = clear[static_cast<size_t>(i)];
    data->parameters.col(i) = at.Parameters(at.around[k], at.share[k]);
    data->values.col(i) = points.col(k);
  }
  for (int pin = 0; pin < kPins; ++pin) {
    const double share = -at.beyond + (1 + 2 * at.beyond) * pin / (kPins - 1.0);
    for (int side = 0; side < 2; ++side) {
      data->parameters.col(count + 2 * pin + side) = at.Parameters(2 * side - 1, share);
      data->values.col(count + 2 * pin + side) = edge.At(at.EdgeAt(share));
    }
  }
  const FittingProblem problem(FittingBasis(3, kModelCells, -1, 1),
                               FittingBasis(3, kModelCellsAlong, -at.beyond, 1 + at.beyond),
                               data,
                               kModelSmoothing);
  return {problem.basis_u(), problem.basis_v(), SolveLinear(problem, pool).coefficients};
}

}  // namespace

Eigen::Vector2d WingCoordinates::Parameters(double at_around, double at_share) const {
  return {std::clamp(at_around, -1.0, 1.0), std::clamp(at_share, -beyond, 1 + beyond)};
}

void DealOutSides(const Eigen::Matrix3Xd& points,
                  const std::vector<Eigen::Index>& clear,
                  const std::vector<Eigen::Index>& unclear,
                  const WingLine& edge,
                  double noise,
                  ThreadPool& pool,
                  WingCoordinates& at) {
  if (unclear.empty()) return;
  const NurbsSurface model = Model(points, clear, edge, at, pool);
  const auto count = std::ssize(unclear);
  const Eigen::Matrix3Xd places = points(Eigen::all, unclear);
  std::array<Eigen::VectorXd, 2> distances;
  for (int side = 0; side < 2; ++side) {
    Eigen::Matrix2Xd start(2, count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const Eigen::Index k = unclear[static_cast<size_t>(i)];
      const double amount = std::abs(at.around[k]);
      start.col(i) = at.Parameters(side == 0 ? -amount : amount, at.share[k]);
    }
    distances[static_cast<size_t>(side)] = DistancesFrom(model, places, start, pool).distances;
  }
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index k = unclear[static_cast<size_t>(i)];
    const double odds = (distances[0][i] * distances[0][i] - distances[1][i] * distances[1][i]) /
                        (2 * noise * noise);
    const double upper = 1 / (1 + std::exp(-std::clamp(odds, -500.0, 500.0)));
    at.around[k] = std::copysign(at.around[k], EvenBy(points.col(k)) < upper ? 1.0 : -1.0);
  }
}

}  // namespace batten::internal
