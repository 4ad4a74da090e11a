// SPDX-License-Identifier: MIT
#include "fitting/cloud/residual_outliers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "batten/fitting/neighbours.h"
#include "geometry/numeric/polygon.h"

namespace batten::internal {
namespace {

constexpr double kStructureInSpacings = 4;  // height of structure a surface may miss between points
constexpr int kWitnesses = 8;               // neighbours that are compared with a point
constexpr int kWitnessesNeeded = 3;         // of them alike make it structure within reach
constexpr double kNearlyEqual = 1.25;
constexpr int kMostWitnesses = 5;  // of them nearly equal make it structure at any distance
constexpr double kAlike = 2;       // ratio of distances, either way
constexpr double kFlatTail = 0.6;

// Number of a point's neighbours in the plane with similar distances.
struct Neighbourhood {
  int alike = 0;         // to the same side, within a factor of two
  int nearly_equal = 0;  // within a quarter
};

Neighbourhood NeighbourhoodOf(Eigen::Index point,
                              const NeighbourIndex& index,
                              const Eigen::Matrix3Xd& plan,
                              const Eigen::VectorXd& distances) {
  Neighbourhood neighbourhood;
  for (const int j : index.Nearest(plan.col(point), kWitnesses + 1)) {
    const double ratio = distances[j] / distances[point];
    if (j != point && ratio > 1 / kAlike && ratio < kAlike) ++neighbourhood.alike;
    if (j != point && ratio > 1 / kNearlyEqual && ratio < kNearlyEqual)
      ++neighbourhood.nearly_equal;
  }
  return neighbourhood;
}

std::vector<Eigen::Index> Beyond(const Eigen::VectorXd& distances, double limit) {
  std::vector<Eigen::Index> beyond;
  for (Eigen::Index k = 0; k < distances.size(); ++k) {
    if (!(std::abs(distances[k]) <= limit)) beyond.push_back(k);
  }
  return beyond;
}

}  // namespace

double OutlierThreshold(const Eigen::VectorXd& distances, double limit) {
  if (!(limit > 0)) return std::numeric_limits<double>::infinity();
  const double farthest = distances.cwiseAbs().maxCoeff();
  for (double from = limit; from < farthest; from *= 2) {
    const auto beyond = static_cast<double>((distances.array().abs() > from).count());
    const auto far_beyond = static_cast<double>((distances.array().abs() > 2 * from).count());
    if (far_beyond > kFlatTail * beyond) return from;
  }
  return std::numeric_limits<double>::infinity();
}

PointMask ResidualInliers(const Eigen::Matrix2Xd& places,
                          const Eigen::VectorXd& distances,
                          double least,
                          double spacing,
                          ThreadPool& pool) {
  const double limit = OutlierThreshold(distances, least);
  const double reach = std::max(limit, kStructureInSpacings * spacing);
  const std::vector<Eigen::Index> candidates = Beyond(distances, limit);
  PointMask close = PointMask::Constant(distances.size(), true);
  if (candidates.empty()) return close;
  const Eigen::Matrix3Xd plan = PointsInSpace(places);
  const NeighbourIndex index(plan, pool);
  pool.For(static_cast<std::ptrdiff_t>(candidates.size()),
           64,
           [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
             for (std::ptrdiff_t i = begin; i < end; ++i) {
               const Neighbourhood neighbourhood =
                   NeighbourhoodOf(candidates[i], index, plan, distances);
               close[candidates[i]] = neighbourhood.nearly_equal >= kMostWitnesses ||
                                      (std::abs(distances[candidates[i]]) <= reach &&
                                       neighbourhood.alike >= kWitnessesNeeded);
             }
           });
  return close;
}

}  // namespace batten::internal
