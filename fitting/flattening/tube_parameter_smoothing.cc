// SPDX-License-Identifier: MIT
#include "fitting/flattening/tube_parameter_smoothing.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "batten/fitting/distances.h"
#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/solve_linear.h"
#include "batten/geometry/knot_vectors.h"
#include "fitting/core/mask_indices.h"
#include "fitting/core/shared_constants.h"
#include "fitting/flattening/tube_chart.h"
#include "fitting/least_squares/fitting_bases.h"

namespace batten::internal {
namespace {

constexpr int kSmoothingDegree = 5;  // smooth enough that its knots do not show in the feet
constexpr Eigen::Index kSample = 10000;
constexpr int kSmoothingCellsRound[] = {6, 8, 11, 15, 20};
constexpr double kPointsPerControlPoint = 6;
constexpr double kAsGood = 1.3;  // root mean square residual, against the best
constexpr int kSmoothingRounds = 2;
constexpr double kMostFolded = 1e-4;  // of the area

struct Draft {
  FittingProblem problem;
  LinearSolution solution;
  double variance;  // of a residual, what control points take away counted in
};

// Fits surfaces with ever more cells, nearly square ones.
std::vector<Draft> StatesOf(const FlattenedBase& tube,
                            const Eigen::Matrix2Xd& parameters,
                            const Eigen::Matrix3Xd& points,
                            ThreadPool& pool) {
  auto data = std::make_shared<FittingData>();
  data->parameters = parameters;
  data->values = points;
  const auto count = static_cast<double>(points.cols());
  std::vector<Draft> drafts;
  for (const int round : kSmoothingCellsRound) {
    const int along =
        std::max(1, static_cast<int>(std::lround(round * tube.length_v / tube.length_u)));
    const double unknowns = round * (along + kSmoothingDegree);
    if (!drafts.empty() && unknowns * kPointsPerControlPoint > count) break;
    FittingProblem problem(PeriodicUniformKnots(kSmoothingDegree, round, 0, tube.length_u),
                           FittingBasis(kSmoothingDegree, along, 0, tube.length_v),
                           data,
                           kSurfaceSmoothing);
    LinearSolution solution = SolveLinear(problem, pool);
    const double variance = solution.residual_squares / std::max(1.0, count - unknowns);
    drafts.push_back({std::move(problem), std::move(solution), variance});
  }
  return drafts;
}

NurbsSurface SmoothSurface(const FlattenedBase& tube,
                           const Eigen::Matrix2Xd& parameters,
                           const Eigen::Matrix3Xd& points,
                           ThreadPool& pool) {
  const std::vector<Draft> drafts = StatesOf(tube, parameters, points, pool);
  double least = drafts.front().variance;
  for (const Draft& draft : drafts) least = std::min(least, draft.variance);
  const auto chosen = std::find_if(drafts.begin(), drafts.end(), [&](const Draft& draft) {
    return draft.variance <= kAsGood * kAsGood * least;
  });
  return {chosen->problem.basis_u(), chosen->problem.basis_v(), chosen->solution.coefficients};
}

// A smooth surface with its chart, and where to look for the points' feet on it.
struct Settling {
  NurbsSurface surface;
  TubeChart chart;
  Eigen::Matrix2Xd start;
};

}  // namespace

void SmoothTubeParameters(const Eigen::Matrix3Xd& points, ThreadPool& pool, FlattenedBase& base) {
  if (!base.reached.any()) return;
  const std::vector<Eigen::Index> sample = IndicesOf(base.reached, kSample);
  const Eigen::Matrix3Xd some = points(Eigen::all, sample);
  std::optional<Settling> settling;
  const auto settle = [&](const Eigen::Matrix2Xd& feet) {
    const TubeChart& chart = settling->chart;
    base.parameters = chart.At(feet, pool);
    base.length_u = chart.length_round();
    base.length_v = chart.length_along();
    base.distortion = chart.distortion();
  };
  for (int round = 0; round < kSmoothingRounds; ++round) {
    if (settling) {
      // Only points of the sample are moved to their feet, the others carried along.
      Eigen::Matrix2Xd feet = settling->start;
      feet(Eigen::all, sample) =
          DistancesFrom(settling->surface, some, feet(Eigen::all, sample), pool).parameters;
      settle(feet);
    }
    NurbsSurface surface = SmoothSurface(base, base.parameters(Eigen::all, sample), some, pool);
    TubeChart chart(surface);
    if (!(chart.distortion() <= kFlatteningLimits.distortion && chart.folded() <= kMostFolded))
      break;
    settling = {std::move(surface), std::move(chart), base.parameters};
  }
  if (!settling) return;
  settle(DistancesFrom(settling->surface, points, settling->start, pool).parameters);
}

}  // namespace batten::internal
