// SPDX-License-Identifier: MIT
#include "batten/fitting/company.h"

#include <cmath>
#include <vector>

#include "batten/fitting/neighbours.h"
#include "batten/fitting/statistics.h"

namespace batten {
namespace {

constexpr int kNeighbour = 6;
constexpr double kMuchFarther = 2.5;
constexpr int kCountedByFew = 1;
constexpr Eigen::Index kFewest = 50;

}  // namespace

PointMask HaveCompany(const Eigen::Matrix3Xd& points, const PointMask& mask) {
  PointMask company = mask;
  std::vector<Eigen::Index> chosen;
  for (Eigen::Index k = 0; k < mask.size(); ++k) {
    if (mask[k]) chosen.push_back(k);
  }
  const auto count = static_cast<Eigen::Index>(chosen.size());
  if (count < kFewest) return company;
  const Eigen::Matrix3Xd some = points(Eigen::all, chosen);
  const NeighbourIndex index(some);
  const std::vector<int> nearest =
      index.Nearest(some, kNeighbour + 1);  // the point itself is first
  const auto neighbour = [&](Eigen::Index k, int n) {
    return static_cast<Eigen::Index>(nearest[static_cast<size_t>(k * (kNeighbour + 1) + n)]);
  };
  Eigen::VectorXd reach(count);
  for (Eigen::Index k = 0; k < count; ++k)
    reach[k] = (some.col(neighbour(k, kNeighbour)) - some.col(k)).norm();
  std::vector<bool> apart(chosen.size());
  std::vector<double> theirs(kNeighbour);
  for (Eigen::Index k = 0; k < count; ++k) {
    for (int n = 1; n <= kNeighbour; ++n)
      theirs[static_cast<size_t>(n - 1)] = reach[neighbour(k, n)];
    apart[static_cast<size_t>(k)] = reach[k] > kMuchFarther * Median(theirs);
  }
  // Where the density falls at a line, those of the thin side next to it have others behind them.
  Eigen::VectorXi counted_by = Eigen::VectorXi::Zero(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    if (apart[static_cast<size_t>(k)]) continue;
    for (int n = 1; n <= kNeighbour; ++n) ++counted_by[neighbour(k, n)];
  }
  for (size_t k = 0; k < chosen.size(); ++k) {
    if (apart[k] && counted_by[static_cast<Eigen::Index>(k)] <= kCountedByFew) {
      company[chosen[k]] = false;
    }
  }
  return company;
}

}  // namespace batten
