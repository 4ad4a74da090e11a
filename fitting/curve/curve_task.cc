// SPDX-License-Identifier: MIT
#include "fitting/curve/curve_task.h"

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "fitting/curve/parameter_correction.h"

namespace batten::internal {
namespace {

constexpr double kNoiseToAnchor = 0.1;  // in spacings: noisier points anchor no corners
constexpr double kSmoothing = 1e-10;  // relative fairness: bridges data gaps, negligible elsewhere

void RequireEnough(const OrderedPoints& ordered, const CurveFitOptions& options) {
  const Eigen::Index points = ordered.cloud.size();
  if (points <= options.degree) {
    throw std::invalid_argument(std::to_string(points) +
                                " different points are too few for a curve of degree " +
                                std::to_string(options.degree) + ": lower the degree to " +
                                std::to_string(std::max<Eigen::Index>(1, points - 1)));
  }
  constexpr Eigen::Index kAlways = 1000, kForEach = 3;  // more is fairness and takes long
  const Eigen::Index most = std::max(kAlways, kForEach * points);
  if (options.control_points && *options.control_points > most) {
    throw std::invalid_argument("control_points: " + std::to_string(*options.control_points) +
                                " are far more than " + std::to_string(points) +
                                " points determine: at most " + std::to_string(most) + " for them");
  }
  if (ordered.closed && points < 3) {
    throw std::invalid_argument("a closed curve needs at least 3 different points");
  }
  if (ordered.closed && options.optimize && options.optimize->knots) {
    throw std::invalid_argument(
        "the knots of a closed curve can't be free; without closing it (closed no) they can");
  }
}

void TakeDistance(CurveTask& task) {
  const CurveFitOptions& options = task.options;
  task.distance = options.distance;
  if (task.distance == CurveDistance::kAuto) {
    task.distance = options.parameterization == CurveParameterization::kGiven
                        ? CurveDistance::kParameter
                        : CurveDistance::kPoint;
  }
  if (task.distance == CurveDistance::kTangent) task.model = DistanceModel::kTangent;
  if (task.distance == CurveDistance::kSquared) task.model = DistanceModel::kSquared;
  if (task.model) task.distance = CurveDistance::kPoint;
}

}  // namespace

Eigen::VectorXd CurveTask::DistancesOf(const FittingProblem& of, const Eigen::MatrixXd& net) const {
  return DistancesAt(of, net, by_feet(), pool);
}

SpanLayout CurveTask::EqualSpans(int spans, std::vector<double> at) const {
  std::sort(at.begin(), at.end());
  return SpanLayout::Equal(options.degree, spans, ordered.lower, ordered.upper, at, ordered.closed);
}

CurveTask MakeCurveTask(const OrderedPoints& ordered,
                        const CurveFitOptions& options,
                        int dimension,
                        ThreadPool& pool) {
  RequireEnough(ordered, options);
  auto data = std::make_shared<FittingData>();
  const Eigen::VectorXd& u = ordered.parameters;
  data->parameters = Eigen::Matrix2Xd::Zero(2, u.size());
  data->parameters.row(0) = u;
  data->values = ordered.cloud.points().topRows(dimension);
  const Eigen::VectorXd middle = data->values.rowwise().mean();
  data->values.colwise() -= middle;
  const double size =
      (data->values.rowwise().maxCoeff() - data->values.rowwise().minCoeff()).norm();
  const Eigen::VectorXd& weights = ordered.cloud.weights();
  if (weights.size() > 0) data->weights = weights / weights.mean();
  const SplineBasis basis =
      SplineBasis::Uniform(options.degree, options.degree + 1, ordered.lower, ordered.upper);
  CurveTask task{ordered,
                 options,
                 pool,
                 FittingProblem(basis, std::move(data), options.smoothing.value_or(kSmoothing)),
                 middle,
                 size,
                 ordered.noise};
  TakeDistance(task);
  task.given = u;
  task.near_exact = ordered.noise <= kNoiseToAnchor * ordered.spacing;
  return task;
}

}  // namespace batten::internal
