// SPDX-License-Identifier: MIT
// One curve to be fitted: its points as a problem, what is fitted, and what is known of the points.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "batten/fitting/curve_options.h"
#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/ordered_points.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/curve/distance_minimisation.h"
#include "fitting/curve/span_layout.h"

namespace batten::internal {

inline constexpr double kCurvesAlike =
    1e-8;  // share of the size: curves that differ less are equal
inline constexpr double kTiniestScale = 1e-300;  // a scale is positive, even if residuals vanish

struct CurveTask {
  const OrderedPoints& ordered;
  const CurveFitOptions& options;
  ThreadPool& pool;
  FittingProblem problem;  // values relative to the middle, least basis
  Eigen::VectorXd middle;  // of the points, in the cloud's local coordinates
  double size = 0;         // of the points' box
  double noise = 0;        // standard deviation across the curve; 0: unknown
  CurveDistance distance = CurveDistance::kPoint;  // kParameter or kPoint
  std::optional<DistanceModel> model = {};         // to go on with after points
  // Parameters of corners, sharpest first; of a closed curve one is at the seam.
  std::vector<double> corners = {};
  // Data at corners, where points follow the curve closely: each holds its corner. Between sides
  // that hardly part nothing else would.
  std::vector<Eigen::Index> anchored = {};
  Eigen::VectorXd given = {};  // parameters before any fit
  bool near_exact = false;     // the noise of the points is far below their spacing
  // Whether corners were sought as in exact points because there are so few: their apparent noise
  // may be their corners.
  bool sought_as_exact = false;

  bool by_feet() const { return distance == CurveDistance::kPoint; }

  // Distances at the parameters, orthogonal to the curve where these are foot points.
  Eigen::VectorXd DistancesOf(const FittingProblem& of, const Eigen::MatrixXd& net) const;

  // Equal spans between the corners.
  SpanLayout EqualSpans(int spans, std::vector<double> corners) const;
};

// Throws std::invalid_argument, with a sentence for the user, where the points are too few for the
// degree, or the options free knots of a closed curve.
CurveTask MakeCurveTask(const OrderedPoints& ordered,
                        const CurveFitOptions& options,
                        int dimension,
                        ThreadPool& pool);

}  // namespace batten::internal
