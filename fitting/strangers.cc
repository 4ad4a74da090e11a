// SPDX-License-Identifier: MIT
#include "batten/fitting/strangers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "batten/fitting/neighbours.h"

namespace batten {
namespace {

constexpr double kStructureInSpacings = 4;  // what a surface may miss between points
constexpr int kWitnesses = 8;               // neighbours asked whether a point is alone
constexpr int kWitnessesNeeded = 3;         // that are off as it is
constexpr double kNearlyEqual = 1.25;
constexpr int kMostWitnesses = 5;  // that make it structure at any distance
constexpr double kAlike = 2;       // within this factor of its distance
constexpr double kFlatTail = 0.6;

}  // namespace

double StrangersBegin(const Eigen::VectorXd& distances, double limit) {
  if (!(limit > 0)) return std::numeric_limits<double>::infinity();
  const double farthest = distances.cwiseAbs().maxCoeff();
  for (double from = limit; from < farthest; from *= 2) {
    const auto beyond = static_cast<double>((distances.array().abs() > from).count());
    const auto far_beyond = static_cast<double>((distances.array().abs() > 2 * from).count());
    if (far_beyond > kFlatTail * beyond) return from;
  }
  return std::numeric_limits<double>::infinity();
}

PointMask CloseEnough(const Eigen::Matrix2Xd& places,
                      const Eigen::VectorXd& distances,
                      double least,
                      double spacing,
                      ThreadPool& pool) {
  const double limit = StrangersBegin(distances, least);
  const double reach = std::max(limit, kStructureInSpacings * spacing);
  std::vector<Eigen::Index> doubtful;
  for (Eigen::Index k = 0; k < distances.size(); ++k) {
    if (!(std::abs(distances[k]) <= limit)) doubtful.push_back(k);
  }
  PointMask close = PointMask::Constant(distances.size(), true);
  if (doubtful.empty()) return close;
  Eigen::Matrix3Xd plan = Eigen::Matrix3Xd::Zero(3, places.cols());
  plan.topRows<2>() = places;
  const NeighbourIndex index(plan);
  pool.For(static_cast<std::ptrdiff_t>(doubtful.size()),
           64,
           [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
             for (std::ptrdiff_t i = begin; i < end; ++i) {
               const Eigen::Index k = doubtful[i];
               const double own = distances[k];
               int alike = 0, nearly_equal = 0;
               for (const int j : index.Nearest(plan.col(k), kWitnesses + 1)) {
                 const double ratio = distances[j] / own;
                 if (j != k && ratio > 1 / kAlike && ratio < kAlike) ++alike;
                 if (j != k && ratio > 1 / kNearlyEqual && ratio < kNearlyEqual) ++nearly_equal;
               }
               close[k] = nearly_equal >= kMostWitnesses ||
                          (std::abs(own) <= reach && alike >= kWitnessesNeeded);
             }
           });
  return close;
}

}  // namespace batten
