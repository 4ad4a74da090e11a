// SPDX-License-Identifier: MIT
#include "fitting/primitives/surface_choice.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <utility>

#include "batten/fitting/neighbours.h"
#include "fitting/primitives/shape_estimate.h"

namespace batten::internal {
namespace {

struct Candidate {
  ShapeFit fit;
  double variance = 0;
  double inflation = 1;
};

// Truncated sum of squares Σ min(d, c)² over all points.
double Cost(const Eigen::VectorXd& distances, double most) {
  return distances.cwiseAbs().cwiseMin(most).squaredNorm();
}

struct Evidence {
  double found = 0, chance = 0;
};

Evidence Against(const Candidate& simple, const Candidate& later) {
  constexpr double kFarthest = 5;  // standard deviations
  const auto count = static_cast<double>(later.fit.distances.size());
  const double sigma = std::sqrt(later.variance), left = count - later.fit.freedoms;
  const double fall =
      Cost(simple.fit.distances, kFarthest * sigma) - Cost(later.fit.distances, kFarthest * sigma);
  const double units = std::max(0.0, fall) / (later.variance * later.inflation);
  const int more = std::max(1, later.fit.freedoms - simple.fit.freedoms);
  return {left * std::log1p(units / left), 2 * more * std::log(count) * (1 + 2 / left)};
}

std::string Numbers(const Evidence& evidence) {
  char text[80];
  std::snprintf(text, sizeof text, "%.4g; chance is given %.4g", evidence.found, evidence.chance);
  return text;
}

}  // namespace

std::optional<SurfaceChoice> ChooseSurface(ShapeFitter& fitter, double rounding, ThreadPool& pool) {
  constexpr Eigen::Index kPointsAFreedom = 3;
  const Eigen::Index count = fitter.starts().sample.points.cols();
  std::vector<Candidate> candidates;
  for (const SurfaceKind kind : kSurfaceKinds) {
    if (count < kPointsAFreedom * FreedomsOf(kind)) break;
    try {
      Candidate candidate{fitter.Fit(kind)};
      const double least = rounding * fitter.unit();
      candidate.variance = std::max(candidate.fit.sigma * candidate.fit.sigma, least * least);
      candidate.inflation = EstimateOf(candidate.fit, fitter, rounding, pool).inflation;
      candidates.push_back(std::move(candidate));
    } catch (const std::invalid_argument&) {
      continue;  // no shape of this kind: another may be
    }
  }
  if (candidates.empty()) return std::nullopt;
  std::string why;
  for (size_t i = 0; i < candidates.size(); ++i) {
    bool left_behind = false;
    double closest = -1;
    std::string next;
    for (size_t j = i + 1; j < candidates.size() && !left_behind; ++j) {
      const Evidence evidence = Against(candidates[i], candidates[j]);
      const std::string name = Name(candidates[j].fit.kind);
      if (evidence.found > evidence.chance) {
        left_behind = true;
        why = std::string("the points are not of a ") + Name(candidates[i].fit.kind) +
              " (evidence for a " + name + " " + Numbers(evidence) + ")";
      } else if (evidence.found / evidence.chance > closest) {
        closest = evidence.found / evidence.chance;
        next = "a " + name + " explains the points no better than their noise may (evidence " +
               Numbers(evidence) + ")";
      }
    }
    if (left_behind) continue;
    if (!next.empty()) why += (why.empty() ? "" : "; ") + next;
    return SurfaceChoice{std::move(candidates[i].fit), why};
  }
  return std::nullopt;
}

double SharedVariance(const ShapeFit& fit,
                      const Eigen::Matrix3Xd& points,
                      double rounding,
                      std::uint64_t seed) {
  constexpr Eigen::Index kMost = 6000, kFewest = 30;
  std::vector<Eigen::Index> some;
  for (const Eigen::Index k : SampleIndices(points.cols(), kMost, seed)) {
    if (!fit.outliers[k]) some.push_back(k);
  }
  if (static_cast<Eigen::Index>(some.size()) < kFewest || !(fit.sigma > rounding)) return 0;
  const Eigen::Matrix3Xd places = points(Eigen::all, some);
  const NeighbourIndex index(places);
  const std::vector<int> nearest = index.Nearest(places, 2);
  double shared = 0, all = 0;
  for (size_t i = 0; i < some.size(); ++i) {
    const int first = nearest[2 * i], second = nearest[2 * i + 1];
    const int other = first == static_cast<int>(i) ? second : first;
    const double own = fit.distances[some[i]];
    shared += own * fit.distances[some[static_cast<size_t>(other)]];
    all += own * own;
  }
  return std::clamp(shared / all, 0.0, 1.0);
}

}  // namespace batten::internal
