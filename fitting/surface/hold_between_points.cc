// SPDX-License-Identifier: MIT
#include "fitting/surface/hold_between_points.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "batten/fitting/distances.h"
#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/solve_linear.h"
#include "fitting/core/rules.h"
#include "fitting/surface/surface_overshoot.h"

namespace batten::internal {
namespace {

constexpr double kAllowed = 2;  // spacings beyond the heights around: the report's limit is 3
constexpr double kAim = 1;      // spacings beyond them, where places are moved to
constexpr int kMostRounds = 6;
constexpr double kFirmer = 4;  // ratio of the places' weights from round to round
constexpr double kSofter = 8;  // where the first of them is too firm, down to …
constexpr double kSoftest = 0.01;
// Ratio of the greatest overshoot of two rounds above which firmer weights move it no more: it
// stands between points that contradict each other, as at a jump of depth. On nine scans and six
// scenes those brought back fell to 0.6-0.9 a round.
constexpr double kGain = 0.92;
constexpr int kMostInVain = 2;    // rounds in a row: one may be spent on places next to those held
constexpr double kWorthIt = 0.8;  // of the greatest overshoot: what leaves more is not taken
constexpr double kHoldSmoothing = 1e-3;  // of the change: it fades over a cell or two
constexpr double kMostGrowth = 1.05;     // ratio of the rms distance of the points …
constexpr double kUnseen = 0.01;         // … or in spacings, where they lie on the surface

// Where a surface stands to the points, and where it leaves them.
struct Standing {
  Eigen::Matrix2Xd feet = {};
  double squares = 0, max = 0;  // of the distances
  std::vector<Excursion> excursions = {};
  double most = 0;  // of them, in spacings
};

// The least change of the surface that moves places by given ways.
Eigen::Matrix3Xd LeastChange(const SurfaceState& draft,
                             const Eigen::Matrix2Xd& feet,
                             const std::vector<Excursion>& excursions,
                             double weight,
                             ThreadPool& pool) {
  const Eigen::Index points = draft.used.size(), places = std::ssize(excursions);
  auto data = std::make_shared<FittingData>();
  data->parameters.resize(2, points + places);
  data->parameters.leftCols(points) = feet;
  data->values = Eigen::MatrixXd::Zero(3, points + places);
  data->weights = Eigen::VectorXd::Constant(points + places, weight);
  if (draft.weights.size() > 0) {
    data->weights.head(points) = draft.weights;
  } else {
    data->weights.head(points).setOnes();
  }
  for (Eigen::Index k = 0; k < places; ++k) {
    const Excursion& one = excursions[static_cast<std::size_t>(k)];
    data->parameters.col(points + k) = one.uv;
    data->values.col(points + k) = one.back;
  }
  const FittingProblem problem =
      FittingProblem(
          draft.surface.basis_u(), draft.surface.basis_v(), std::move(data), kHoldSmoothing)
          .WithEnergy(FairnessEnergy::kMembrane)
          .WithPoles(draft.poles);
  return SolveLinear(problem, pool).coefficients;
}

}  // namespace

bool HoldBetweenPoints(SurfaceState& draft,
                       double spacing,
                       const std::optional<Eigen::Vector3d>& up,
                       std::optional<double> tolerance,
                       const Progress& progress,
                       ThreadPool& pool) {
  if (!Acts(Rule::kHeldBetween) || draft.surface.rational() || !(spacing > 0)) return false;
  const Eigen::Matrix3Xd& points = draft.used.points();
  const auto overshoots = [&](const NurbsSurface& surface, const Eigen::Matrix2Xd& feet) {
    return FindExcursions({surface, points, feet, spacing, up}, kAllowed, pool);
  };
  if (overshoots(draft.surface, draft.parameters).empty()) return false;
  const auto standing = [&](const NurbsSurface& surface, PointDistances found) {
    Standing now;
    const Eigen::VectorXd squares = found.distances.cwiseAbs2();
    now.squares = draft.weights.size() > 0 ? draft.weights.dot(squares) : squares.sum();
    now.max = found.distances.cwiseAbs().maxCoeff();
    now.feet = std::move(found.parameters);
    now.excursions = overshoots(surface, now.feet);
    for (const Excursion& one : now.excursions)
      now.most = std::max(now.most, one.back.norm() / one.spacing);
    return now;
  };
  // Local foot points serve while it is sought; global ones judge, and take over where they find
  // more.
  const auto nearby = [&](const NurbsSurface& surface, const Eigen::Matrix2Xd& near) {
    return standing(surface, DistancesFrom(surface, points, near, pool));
  };
  const auto anywhere = [&](const NurbsSurface& surface, const Eigen::Matrix2Xd& near) {
    return standing(surface, DistancesTo(surface, points, near, pool));
  };
  const Standing before = nearby(draft.surface, draft.parameters);
  const bool within = tolerance && before.max <= *tolerance;
  const auto allowed = [&](const Standing& now) {
    const double squares = kMostGrowth * kMostGrowth * before.squares +
                           std::pow(kUnseen * spacing, 2) * static_cast<double>(points.cols());
    return now.squares <= squares && !(within && now.max > *tolerance);
  };
  NurbsSurface best = draft.surface;
  Standing of_best = before;
  // From the best so far on, as long as it pays.
  const auto search = [&](const auto& stand) {
    NurbsSurface surface = best;
    Standing now = of_best;
    double weight = 1;
    int in_vain = 0;
    std::vector<Excursion> places;  // of all rounds: those of before stay where they are
    for (int round = 0; round < kMostRounds && !now.excursions.empty();
         ++round, weight *= kFirmer) {
      if (progress && !progress("trim", static_cast<double>(round) / kMostRounds)) break;
      for (Excursion& one : places) one.back.setZero();
      for (Excursion& one : now.excursions) one.back *= 1 - kAim * one.spacing / one.back.norm();
      places.insert(places.end(), now.excursions.begin(), now.excursions.end());
      const Eigen::Matrix3Xd change = LeastChange(draft, now.feet, places, weight, pool);
      surface =
          NurbsSurface(surface.basis_u(), surface.basis_v(), surface.control_points() + change)
              .WithTrims(surface.trims());
      const double least = of_best.most;
      now = stand(surface, now.feet);
      if (!allowed(now)) {
        // The first move may cost the points too much: softer ones bring back less.
        if (weight > 1 || weight <= kSoftest) break;
        surface = best;
        now = of_best;
        places.clear();
        weight /= kFirmer * kSofter;
        continue;
      }
      if (now.most < of_best.most) {
        best = surface;
        of_best = now;
      }
      in_vain = now.most > kGain * least ? in_vain + 1 : 0;
      if (in_vain == kMostInVain) break;
    }
  };
  search(nearby);
  of_best = anywhere(best, of_best.feet);
  if (!allowed(of_best)) return false;
  search(anywhere);
  if (of_best.most > kWorthIt * before.most) return false;
  draft.surface = std::move(best);
  draft.parameters = std::move(of_best.feet);
  return true;
}

}  // namespace batten::internal
