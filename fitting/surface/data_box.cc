// SPDX-License-Identifier: MIT
#include "fitting/surface/data_box.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "batten/geometry/surface_evaluator.h"

namespace batten::internal {
namespace {

constexpr double kGrown = 0.25;       // of the diagonal: the law for points …
constexpr double kGrownUp = 0.15;     // … and for heights, whose rectangle may be turned in space
constexpr double kWanted = 0.1;       // of the diagonal: what is held is brought so near
constexpr int kRoundsOfData = 6;      // each ten times the weight of the one before
constexpr double kFirstShare = 0.01;  // weight of all held places of the first, of that of the data
constexpr double kFirstFairness = 1e-3, kLastFairness = 1e5, kFairnessStep = 100;

// The box of data, and their diagonal in space.
struct Box {
  Eigen::VectorXd low, high;
  double diagonal = 0;
  double grown = kGrown;

  bool Holds(const Eigen::VectorXd& value) const {
    const double by = grown * diagonal;
    return (value.array() >= low.array() - by).all() && (value.array() <= high.array() + by).all();
  }
  Eigen::VectorXd Nearest(const Eigen::VectorXd& value) const {
    const Eigen::VectorXd by = Eigen::VectorXd::Constant(low.size(), kWanted * diagonal);
    return value.cwiseMax(low - by).cwiseMin(high + by);
  }
};

bool Counts(const FittingData& data, Eigen::Index k) {
  return data.weights.size() == 0 || data.weights[k] > 0;
}

Box BoxOf(const FittingData& data, Eigen::Index measured) {
  const Eigen::Index d = data.values.rows();
  Box box{Eigen::VectorXd::Constant(d, HUGE_VAL), Eigen::VectorXd::Constant(d, -HUGE_VAL)};
  Eigen::Vector2d first = Eigen::Vector2d::Constant(HUGE_VAL), last = -first;
  for (Eigen::Index k = 0; k < measured; ++k) {
    if (!Counts(data, k)) continue;
    box.low = box.low.cwiseMin(data.values.col(k));
    box.high = box.high.cwiseMax(data.values.col(k));
    first = first.cwiseMin(data.parameters.col(k));
    last = last.cwiseMax(data.parameters.col(k));
  }
  // Parameters of heights are lengths.
  const double across = d == 1 ? (last - first).norm() : 0;
  if (d == 1) box.grown = kGrownUp;
  box.diagonal = std::hypot((box.high - box.low).norm(), across);
  return box;
}

// Ends, and places between, of the spans of one direction, as many as its degree.
std::vector<double> PlacesAlong(const SplineBasis& basis) {
  std::vector<double> places;
  for (const int span : basis.Spans()) {
    const double a = basis.knots()[static_cast<size_t>(span)],
                 b = basis.knots()[static_cast<size_t>(span) + 1];
    for (int k = 0; k <= basis.degree(); ++k) places.push_back(a + (b - a) * k / basis.degree());
  }
  for (double& place : places) place = basis.Clamp(place);
  places.erase(std::unique(places.begin(), places.end()), places.end());
  return places;
}

// Places of a surface outside of a box, and the nearest points of the box there.
struct Leaving {
  std::vector<Eigen::Vector2d> at;
  std::vector<Eigen::VectorXd> wanted;
};

bool NetStays(const Eigen::MatrixXd& net, const Box& box) {
  for (Eigen::Index k = 0; k < net.cols(); ++k)
    if (!box.Holds(net.col(k))) return false;
  return true;
}

Leaving LeavingPlaces(const FittingProblem& problem,
                      const Eigen::MatrixXd& net,
                      const Box& box,
                      ThreadPool& pool) {
  Leaving leaving;
  if (NetStays(net, box)) return leaving;
  const std::vector<double> us = PlacesAlong(problem.basis_u()),
                            vs = PlacesAlong(problem.basis_v());
  auto places = std::make_shared<FittingData>();
  const auto count = static_cast<Eigen::Index>(us.size() * vs.size());
  places->parameters.resize(2, count);
  Eigen::Index next = 0;
  for (const double u : us)
    for (const double v : vs) places->parameters.col(next++) << u, v;
  places->values = Eigen::MatrixXd::Zero(net.rows(), count);
  const Eigen::MatrixXd values =
      EvaluateAt(FittingProblem(problem.basis_u(), problem.basis_v(), places, 0), net, pool);
  for (Eigen::Index k = 0; k < count; ++k) {
    if (box.Holds(values.col(k))) continue;
    leaving.at.push_back(places->parameters.col(k));
    leaving.wanted.push_back(box.Nearest(values.col(k)));
  }
  return leaving;
}

// The problem with held places as data, so many at the end with other weights than before.
FittingProblem WithPlaces(const FittingProblem& problem, const Leaving& held, double weight) {
  const FittingData& given = problem.data();
  const Eigen::Index before = given.parameters.cols(), more = std::ssize(held.at);
  auto data = std::make_shared<FittingData>();
  data->parameters.resize(2, before + more);
  data->values.resize(given.values.rows(), before + more);
  data->weights = Eigen::VectorXd::Constant(before + more, weight);
  data->parameters.leftCols(before) = given.parameters;
  data->values.leftCols(before) = given.values;
  data->weights.head(before) =
      given.weights.size() > 0 ? given.weights : Eigen::VectorXd::Ones(before).eval();
  for (Eigen::Index k = 0; k < more; ++k) {
    data->parameters.col(before + k) = held.at[static_cast<size_t>(k)];
    data->values.col(before + k) = held.wanted[static_cast<size_t>(k)];
  }
  return problem.WithData(std::move(data));
}

}  // namespace

std::optional<LinearSolution> HeldInBox(const FittingProblem& problem,
                                        const LinearSolution& solution,
                                        Eigen::Index measured,
                                        ThreadPool& pool) {
  const Box box = BoxOf(problem.data(), measured);
  if (!(box.diagonal > 0)) return {};
  Leaving held = LeavingPlaces(problem, solution.coefficients, box, pool);
  if (held.at.empty()) return {};
  LinearSolution inside;
  const auto leaves = [&] {
    const Leaving now = LeavingPlaces(problem, inside.coefficients, box, pool);
    held.at.insert(held.at.end(), now.at.begin(), now.at.end());
    held.wanted.insert(held.wanted.end(), now.wanted.begin(), now.wanted.end());
    return !now.at.empty();
  };
  const Eigen::VectorXd& weights = problem.data().weights;
  const double all = weights.size() > 0 ? weights.sum() : static_cast<double>(problem.size());
  double share = kFirstShare;
  bool outside = true;
  for (int round = 0; outside && round < kRoundsOfData; ++round, share *= 10) {
    inside = SolveLinear(
        WithPlaces(problem, held, share * all / static_cast<double>(held.at.size())), pool);
    outside = leaves();
  }
  for (double fairness = std::max(kFirstFairness, problem.smoothing());
       outside && fairness <= kLastFairness;
       fairness *= kFairnessStep) {
    inside = SolveLinear(problem.WithSmoothing(fairness), pool);
    outside = leaves();
  }
  const Eigen::VectorXd squares =
      (EvaluateAt(problem, inside.coefficients, pool) - problem.data().values)
          .colwise()
          .squaredNorm();
  inside.residual_squares = weights.size() > 0 ? weights.dot(squares) : squares.sum();
  return inside;
}

bool StaysInBox(const NurbsSurface& surface, const Eigen::Matrix3Xd& points) {
  const Eigen::Vector3d low = points.rowwise().minCoeff(), high = points.rowwise().maxCoeff();
  const Box box{low, high, (high - low).norm()};
  if (NetStays(surface.control_points(), box)) return true;
  const SurfaceEvaluator evaluator(surface);
  const std::vector<double> us = PlacesAlong(surface.basis_u()),
                            vs = PlacesAlong(surface.basis_v());
  return std::all_of(us.begin(), us.end(), [&](double u) {
    return std::all_of(
        vs.begin(), vs.end(), [&](double v) { return box.Holds(evaluator.At(u, v)); });
  });
}

}  // namespace batten::internal
