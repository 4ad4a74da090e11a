// SPDX-License-Identifier: MIT
#include "batten/fitting/deviation_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <stdexcept>
#include <vector>

#include "batten/fitting/neighbours.h"
#include "batten/fitting/statistics.h"
#include "fitting/core/rounding.h"
#include "fitting/core/shared_constants.h"

namespace batten {
namespace {

constexpr int kNearest = 16;

struct Weighted {
  double value, weight;
};

// Weighted median; the mean of both middle values at a tie, so that negating all values negates it.
// Reorders the values.
double MiddleOf(std::span<Weighted> sample) {
  std::sort(sample.begin(), sample.end(), [](const Weighted& a, const Weighted& b) {
    return a.value < b.value;
  });
  double whole = 0;
  for (const Weighted& one : sample) whole += one.weight;
  double below = 0;
  for (std::size_t k = 0; k < sample.size(); ++k) {
    below += sample[k].weight;
    if (below > (0.5 + internal::kRelativeRounding) * whole) return sample[k].value;
    if (below >= (0.5 - internal::kRelativeRounding) * whole && k + 1 < sample.size()) {
      return sample[k].value / 2 + sample[k + 1].value / 2;
    }
  }
  return sample.back().value;
}

// Tukey's biweight mean about the median.
double RobustMean(std::span<Weighted> sample) {
  double centre = MiddleOf(sample);
  std::array<Weighted, kNearest> offsets;
  for (std::size_t k = 0; k < sample.size(); ++k) {
    offsets[k] = {std::abs(sample[k].value - centre), sample[k].weight};
  }
  const double width =
      internal::kTukeyTuning * kMadToSigma * MiddleOf({offsets.data(), sample.size()});
  if (!(width > 0)) return centre;
  for (int round = 0; round < internal::kRobustRounds; ++round) {
    double sum = 0, weights = 0;
    for (const Weighted& one : sample) {
      const double off = (one.value - centre) / width;
      const double share = std::abs(off) < 1 ? 1 - off * off : 0;
      sum += one.weight * share * share * (one.value - centre);
      weights += one.weight * share * share;
    }
    if (!(weights > 0)) break;
    centre += sum / weights;
  }
  return centre;
}

// The finite foot points, relative to their centre.
struct FootPointSet {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  Eigen::Matrix3Xd places;
  std::vector<double> distances;
};

FootPointSet FiniteFootPoints(const Eigen::Matrix3Xd& feet, const Eigen::VectorXd& distances) {
  FootPointSet finite;
  std::vector<Eigen::Index> kept;
  for (Eigen::Index k = 0; k < feet.cols(); ++k) {
    if (feet.col(k).allFinite() && std::isfinite(distances[k])) kept.push_back(k);
  }
  if (kept.empty()) return finite;
  finite.places.resize(3, static_cast<Eigen::Index>(kept.size()));
  for (std::size_t k = 0; k < kept.size(); ++k) {
    finite.places.col(static_cast<Eigen::Index>(k)) = feet.col(kept[k]);
    finite.distances.push_back(distances[kept[k]]);
  }
  finite.middle = finite.places.rowwise().minCoeff() / 2 + finite.places.rowwise().maxCoeff() / 2;
  finite.places.colwise() -= finite.middle;
  return finite;
}

}  // namespace

Eigen::VectorXd DeviationMap(const Eigen::Matrix3Xd& places,
                             const Eigen::Matrix3Xd& feet,
                             const Eigen::VectorXd& signed_distances,
                             double reach,
                             ThreadPool& pool) {
  if (feet.cols() != signed_distances.size()) {
    throw std::invalid_argument("DeviationMap: signed_distances: one for every foot is needed");
  }
  if (!(reach > 0)) throw std::invalid_argument("DeviationMap: reach: must be positive");
  if (!places.allFinite()) throw std::invalid_argument("DeviationMap: places: must be finite");
  Eigen::VectorXd map = Eigen::VectorXd::Constant(places.cols(), internal::kNone);
  const FootPointSet known = FiniteFootPoints(feet, signed_distances);
  if (known.distances.empty()) return map;
  const NeighbourIndex index(known.places, pool);
  const int count = static_cast<int>(std::min<Eigen::Index>(kNearest, index.size()));
  pool.For(places.cols(), internal::kPointsPerTask, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    const Eigen::Matrix3Xd local = places.middleCols(begin, end - begin).colwise() - known.middle;
    const std::vector<int> nearest = index.Nearest(local, count);
    for (std::ptrdiff_t k = 0; k < local.cols(); ++k) {
      std::array<Weighted, kNearest> sample;
      std::size_t size = 0;
      double farthest = 0;
      for (int j = 0; j < count; ++j) {
        const int foot = nearest[static_cast<std::size_t>(k * count + j)];
        const double distance = (known.places.col(foot) - local.col(k)).norm();
        if (!(distance <= reach)) continue;
        sample[size++] = {known.distances[static_cast<std::size_t>(foot)], distance};
        farthest = std::max(farthest, distance);
      }
      if (size == 0) continue;
      constexpr double kBeyond = 1.1;  // so that the farthest counts too
      for (std::size_t j = 0; j < size; ++j) {
        const double share = farthest > 0 ? sample[j].weight / (kBeyond * farthest) : 0;
        sample[j].weight = (1 - share * share) * (1 - share * share);
      }
      map[begin + k] = RobustMean({sample.data(), size});
    }
  });
  return map;
}

}  // namespace batten
