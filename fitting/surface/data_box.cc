// SPDX-License-Identifier: MIT
#include "fitting/surface/data_box.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "batten/geometry/surface_evaluator.h"
#include "fitting/least_squares/fitting_bases.h"
#include "geometry/numeric/dense_solvers.h"

namespace batten::internal {
namespace {

constexpr double kGrown = 0.2;        // of the diagonal: the law for points …
constexpr double kGrownUp = 0.07;     // … and for heights, whose rectangle may be turned in space
constexpr double kWanted = 0.9;       // of that: what is held is brought so near
constexpr int kRoundsOfData = 6;      // each ten times the weight of the one before
constexpr double kFirstShare = 0.01;  // weight of all held places of the first, of that of the data
constexpr double kFirstFairness = 1e-3, kLastFairness = 1e5, kFairnessStep = 100;

// The box of data along their principal axes, so that it turns with them, and their diagonal in
// space. Heights are above the plane through them, which goes on beyond them.
struct Box {
  Eigen::MatrixXd axes;  // columns
  Eigen::VectorXd low, high;
  double diagonal = 0;
  double grown = kGrown;
  Eigen::Vector3d plane = Eigen::Vector3d::Zero();  // height at (0, 0) and slopes in u and v

  double PlaneAt(double u, double v) const { return plane[0] + plane[1] * u + plane[2] * v; }
  // How far a value is outside along an axis.
  double Beyond(const Eigen::VectorXd& value) const {
    const Eigen::VectorXd at = axes.transpose() * value;
    return std::max(0.0, (low - at).cwiseMax(at - high).maxCoeff());
  }
  bool Holds(const Eigen::VectorXd& value) const { return Beyond(value) <= grown * diagonal; }
  Eigen::VectorXd Nearest(const Eigen::VectorXd& value) const {
    const Eigen::VectorXd by = Eigen::VectorXd::Constant(low.size(), kWanted * grown * diagonal);
    const Eigen::VectorXd at = axes.transpose() * value;
    return axes * at.cwiseMax(low - by).cwiseMin(high + by);
  }
};

// Of no columns: a point.
Box BoxOf(const Eigen::MatrixXd& used) {
  const Eigen::Index d = used.rows();
  Box box{Eigen::MatrixXd::Identity(d, d), Eigen::VectorXd::Zero(d), Eigen::VectorXd::Zero(d)};
  if (used.cols() == 0) return box;
  const Eigen::VectorXd mean = used.rowwise().mean();
  const Eigen::MatrixXd off = used.colwise() - mean;
  if (d > 1) box.axes = EigenOf(off * off.transpose()).vectors;
  const Eigen::MatrixXd along = box.axes.transpose() * used;
  box.low = along.rowwise().minCoeff();
  box.high = along.rowwise().maxCoeff();
  box.diagonal = (box.high - box.low).norm();
  return box;
}

// The plane of least squares through heights; level across places that lie on a line.
Eigen::Vector3d PlaneThrough(const Eigen::Matrix2Xd& places, const Eigen::VectorXd& heights) {
  constexpr double kOnALine = 0.01;  // breadth over length
  const Eigen::Vector2d middle = places.rowwise().mean();
  const double mean = heights.mean();
  const Eigen::Vector2d slopes = LeastNormSolution(
      (places.colwise() - middle).transpose(), (heights.array() - mean).matrix(), kOnALine);
  return {mean - slopes.dot(middle), slopes[0], slopes[1]};
}

Box BoxOf(const FittingData& data) {
  std::vector<Eigen::Index> kept;
  for (Eigen::Index k = 0; k < data.values.cols(); ++k)
    if (WeightOf(data, k) > 0) kept.push_back(k);
  if (data.values.rows() > 1 || kept.empty()) return BoxOf(data.values(Eigen::all, kept));
  const Eigen::Matrix2Xd places = data.parameters(Eigen::all, kept);
  const Eigen::VectorXd heights = data.values.row(0)(kept);
  const Eigen::Vector3d plane = PlaneThrough(places, heights);
  const Eigen::MatrixXd above =
      heights.transpose().array() - plane[0] - (plane.tail<2>().transpose() * places).array();
  Box box = BoxOf(above);
  box.plane = plane;
  box.grown = kGrownUp;
  // Parameters of heights are lengths.
  const Eigen::Vector2d across = places.rowwise().maxCoeff() - places.rowwise().minCoeff();
  box.diagonal = std::hypot(heights.maxCoeff() - heights.minCoeff(), across.norm());
  return box;
}

// Ends, and places between, of the spans of one direction, twice as many as its degree.
std::vector<double> PlacesAlong(const SplineBasis& basis) {
  std::vector<double> places;
  for (const int span : basis.Spans()) {
    const double a = basis.knots()[static_cast<size_t>(span)],
                 b = basis.knots()[static_cast<size_t>(span) + 1];
    const int parts = 2 * basis.degree();
    for (int k = 0; k <= parts; ++k) places.push_back(a + (b - a) * k / parts);
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

// The net above the plane of heights: that of a plane is its heights at Greville's places.
Eigen::MatrixXd AbovePlane(const FittingProblem& problem, Eigen::MatrixXd net, const Box& box) {
  if (net.rows() > 1) return net;
  const SplineBasis &u = problem.basis_u(), &v = problem.basis_v();
  for (int i = 0; i < u.size(); ++i)
    for (int j = 0; j < v.size(); ++j)
      net(0, Eigen::Index{i} * v.size() + j) -= box.PlaneAt(u.Greville(i), v.Greville(j));
  return net;
}

Leaving LeavingPlaces(const FittingProblem& problem,
                      const Eigen::MatrixXd& net,
                      const Box& box,
                      ThreadPool& pool) {
  Leaving leaving;
  if (NetStays(AbovePlane(problem, net, box), box)) return leaving;
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
    const Eigen::Vector2d at = places->parameters.col(k);
    const Eigen::VectorXd plane =
        Eigen::VectorXd::Constant(net.rows(), net.rows() > 1 ? 0 : box.PlaneAt(at[0], at[1]));
    const Eigen::VectorXd above = values.col(k) - plane;
    if (box.Holds(above)) continue;
    leaving.at.push_back(at);
    leaving.wanted.push_back(box.Nearest(above) + plane);
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
                                        ThreadPool& pool,
                                        double grown) {
  Box box = BoxOf(problem.data());
  box.grown *= grown;
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
  const double all = WeightOf(problem);
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
  inside.residual_squares = SquaresOf(problem, inside.coefficients, pool);
  return inside;
}

double BeyondBox(const NurbsSurface& surface, const Eigen::Matrix3Xd& points) {
  const Box box = BoxOf(points);
  if (NetStays(surface.control_points(), box)) return 0;
  const SurfaceEvaluator evaluator(surface);
  double beyond = 0;
  for (const double u : PlacesAlong(surface.basis_u()))
    for (const double v : PlacesAlong(surface.basis_v()))
      beyond = std::max(beyond, box.Beyond(evaluator.At(u, v)));
  return beyond <= kGrown * box.diagonal ? 0 : beyond / box.diagonal;
}

}  // namespace batten::internal
