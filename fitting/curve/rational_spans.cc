// SPDX-License-Identifier: MIT
#include "fitting/curve/rational_spans.h"

#include <algorithm>

#include "batten/fitting/distances.h"
#include "fitting/curve/parameter_correction.h"
#include "geometry/numeric/polygon.h"

namespace batten::internal {
namespace {

constexpr int kPointsOfControlPoint = 3;  // data at least; each control point has a weight too

template <int Dim>
double Farthest(const OptimizeResult& result, ThreadPool& pool) {
  const FittingData& data = result.problem.data();
  const NurbsCurve<Dim> curve(result.problem.basis_u(), result.control_points, result.weights);
  Eigen::VectorXd distances = DistancesTo<Dim>(curve, PointsInSpace(data.values), pool).distances;
  if (data.weights.size() > 0) distances = (data.weights.array() > 0).select(distances, 0).eval();
  return distances.maxCoeff();
}

bool Reached(const OptimizeResult& result, const RationalSpansOptions& options, ThreadPool& pool) {
  if (result.rms_after <= options.goal) return true;
  if (!options.tolerance || result.rms_after > *options.tolerance) return false;
  const double farthest =
      result.control_points.rows() == 2 ? Farthest<2>(result, pool) : Farthest<3>(result, pool);
  return farthest <= *options.tolerance;
}

}  // namespace

std::optional<OptimizeResult> FewestRationalSpans(const FittingProblem& problem,
                                                  const SpanLayout& start,
                                                  const RationalSpansOptions& options,
                                                  ThreadPool& pool) {
  const std::vector<double>& breaks = start.breaks();
  const int fewest =
      std::max(start.closed() ? start.degree() + 1 : 1, static_cast<int>(start.corners().size()));
  for (int spans = fewest;; spans += std::max(1, spans / 3)) {
    const SpanLayout layout = SpanLayout::Equal(
        start.degree(), spans, breaks.front(), breaks.back(), start.corners(), start.closed());
    if (layout.control_points() > options.most_control_points) return std::nullopt;
    if (problem.size() < kPointsOfControlPoint * layout.control_points()) return std::nullopt;
    Report(options.optimize.progress, "optimize", 0);
    // The valley is narrow: which of the starts leads to its bottom is chance.
    for (const int steps : {kFootPointSteps, 0, 3 * kFootPointSteps}) {
      const CorrectedFit fit = FitWithCorrection(problem.WithBasis(layout.Basis()), steps, pool);
      OptimizeResult result =
          Optimize(fit.problem, fit.solution.coefficients, {}, options.optimize, pool);
      if (result.cancelled || Reached(result, options, pool)) return result;
    }
  }
}

}  // namespace batten::internal
