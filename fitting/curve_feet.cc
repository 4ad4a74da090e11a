// SPDX-License-Identifier: MIT
#include "batten/fitting/curve_feet.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "batten/geometry/curve_evaluator.h"
#include "batten/geometry/foot_point.h"
#include "batten/geometry/knot_vectors.h"
#include "batten/geometry/split.h"

namespace batten {
namespace {

constexpr double kMostCut = 0.9;      // of an end span
constexpr double kLeastFilled = 0.5;  // of the domain; less, and the curve is far from its data

template <int Dim>
CurveSamples SamplesOf(const FittingProblem& problem,
                       const Eigen::MatrixXd& coefficients,
                       ThreadPool& pool) {
  const CurveEvaluator<Dim> evaluator(NurbsCurve<Dim>(problem.basis_u(), coefficients));
  const Eigen::VectorXd parameters = problem.data().parameters.row(0);
  typename CurveEvaluator<Dim>::PointColumns columns;
  evaluator.Derivatives(
      {parameters.data(), static_cast<size_t>(parameters.size())}, 1, columns, pool);
  CurveSamples samples{Eigen::MatrixXd(Dim, parameters.size()),
                       Eigen::MatrixXd(Dim, parameters.size())};
  for (Eigen::Index k = 0; k < parameters.size(); ++k) {
    samples.points.col(k) = columns.col(2 * k);
    samples.tangents.col(k) = columns.col(2 * k + 1).stableNormalized();
  }
  return samples;
}

template <int Dim>
Eigen::Matrix2Xd FeetOf(const FittingProblem& problem,
                        const Eigen::MatrixXd& coefficients,
                        ThreadPool& pool) {
  const CurveFootPoints<Dim> feet(NurbsCurve<Dim>(problem.basis_u(), coefficients));
  Eigen::Matrix2Xd parameters = problem.data().parameters;
  pool.For(parameters.cols(), 512, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    Eigen::Vector3d q = Eigen::Vector3d::Zero();
    for (std::ptrdiff_t k = begin; k < end; ++k) {
      q.head<Dim>() = problem.data().values.col(k);
      parameters(0, k) = feet.Near(q, parameters(0, k)).u;
    }
  });
  return parameters;
}

// Stretches the parameters of an open curve's data over the whole domain, which they may have left
// partly empty: a curve that is longer than its data would be free to go anywhere there.
void FillDomain(const FittingProblem& problem, Eigen::Matrix2Xd& parameters) {
  const SplineBasis& basis = problem.basis_u();
  if (basis.periodic()) return;
  double first = basis.upper(), last = basis.lower();
  const Eigen::VectorXd& weights = problem.data().weights;
  for (Eigen::Index k = 0; k < parameters.cols(); ++k) {
    if (weights.size() > 0 && weights[k] == 0) continue;
    first = std::min(first, parameters(0, k));
    last = std::max(last, parameters(0, k));
  }
  const double length = basis.upper() - basis.lower();
  if (!(last - first > kLeastFilled * length) || (first <= basis.lower() && last >= basis.upper()))
    return;
  parameters.row(0) =
      (basis.lower() + (parameters.row(0).array() - first) * (length / (last - first)))
          .max(basis.lower())
          .min(basis.upper());
}

// Whether parameters still run forward, by the means of blocks of data in a row: noise makes single
// ones step back. Around a closed curve steps count the short way.
bool RunForward(const FittingProblem& problem) {
  constexpr Eigen::Index kBlocks = 200, kLeastBlock = 3;
  const auto u = problem.data().parameters.row(0);
  const SplineBasis& basis = problem.basis_u();
  const double period = basis.upper() - basis.lower();
  const Eigen::Index blocks = std::min(kBlocks, u.size() / kLeastBlock);
  double previous = 0;
  for (Eigen::Index b = 0; b < blocks; ++b) {
    const Eigen::Index begin = b * u.size() / blocks, end = (b + 1) * u.size() / blocks;
    const double first = u[begin];
    double mean = 0;  // against the first of the block
    for (Eigen::Index k = begin; k < end; ++k) {
      double step = u[k] - first;
      if (basis.periodic()) step -= period * std::round(step / period);
      mean += step / static_cast<double>(end - begin);
    }
    mean += first;
    double step = mean - previous;
    if (basis.periodic()) step -= period * std::round(step / period);
    if (b > 0 && !(step > 0)) return false;
    previous = mean;
  }
  return true;
}

}  // namespace

CurveSamples CurveAt(const FittingProblem& problem,
                     const Eigen::MatrixXd& coefficients,
                     ThreadPool& pool) {
  return coefficients.rows() == 2 ? SamplesOf<2>(problem, coefficients, pool)
                                  : SamplesOf<3>(problem, coefficients, pool);
}

int Inflections(const SplineBasis& basis, const Eigen::MatrixXd& coefficients) {
  constexpr int kSamples = 16;
  if (coefficients.rows() != 2) return 0;
  const CurveEvaluator<2> evaluator(NurbsCurve<2>(basis, coefficients));
  int changes = 0;
  double last = 0, first = 0;
  for (const int span : basis.Spans()) {
    const double low = basis.knots()[static_cast<size_t>(span)],
                 high = basis.knots()[static_cast<size_t>(span) + 1];
    for (int k = 0; k < kSamples; ++k) {
      const CurveJet<2> jet = evaluator.JetAt(low + (k + 0.5) / kSamples * (high - low));
      const double turn = jet.first[0] * jet.second[1] - jet.first[1] * jet.second[0];
      if (turn == 0) continue;
      if (last * turn < 0) ++changes;
      if (first == 0) first = turn;
      last = turn > 0 ? 1 : -1;
    }
  }
  return changes + (basis.periodic() && last * first < 0 ? 1 : 0);
}

Eigen::MatrixXd Across(Eigen::MatrixXd columns, const Eigen::MatrixXd& tangents) {
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    columns.col(k) -= tangents.col(k) * tangents.col(k).dot(columns.col(k));
  }
  return columns;
}

FittingProblem MovedToFeet(const FittingProblem& problem,
                           const Eigen::MatrixXd& coefficients,
                           const std::vector<Eigen::Index>& anchored,
                           ThreadPool& pool) {
  Eigen::Matrix2Xd parameters = coefficients.rows() == 2 ? FeetOf<2>(problem, coefficients, pool)
                                                         : FeetOf<3>(problem, coefficients, pool);
  FillDomain(problem, parameters);
  for (const Eigen::Index k : anchored) parameters.col(k) = problem.data().parameters.col(k);
  return problem.WithParameters(std::move(parameters));
}

FeetFit FitAtFeet(const FittingProblem& problem,
                  int steps,
                  const std::vector<Eigen::Index>& anchored,
                  ThreadPool& pool) {
  FeetFit fit{problem, SolveLinear(problem, pool), 0};
  for (; fit.steps < steps; ++fit.steps) {
    FittingProblem moved = MovedToFeet(fit.problem, fit.solution.coefficients, anchored, pool);
    if (!RunForward(moved)) break;
    fit.problem = std::move(moved);
    fit.solution = SolveLinear(fit.problem, pool);
  }
  return fit;
}

namespace {

// The same curve from the first to the last datum with weight, on the same domain.
template <int Dim>
void CutToData(FeetFit& fit) {
  const SplineBasis& basis = fit.problem.basis_u();
  if (basis.periodic()) return;
  Eigen::Matrix2Xd parameters = fit.problem.data().parameters;
  double first = basis.upper(), last = basis.lower();
  const Eigen::VectorXd& weights = fit.problem.data().weights;
  for (Eigen::Index k = 0; k < parameters.cols(); ++k) {
    if (weights.size() > 0 && weights[k] == 0) continue;
    first = std::min(first, parameters(0, k));
    last = std::max(last, parameters(0, k));
  }
  const std::vector<int> spans = basis.Spans();
  const auto knot = [&](int i) { return basis.knots()[static_cast<size_t>(i)]; };
  // No further than the end spans, so that there are as many control points.
  first = std::min(
      first, knot(spans.front()) + kMostCut * (knot(spans.front() + 1) - knot(spans.front())));
  last = std::max(
      last, knot(spans.back() + 1) - kMostCut * (knot(spans.back() + 1) - knot(spans.back())));
  if (first <= basis.lower() && last >= basis.upper()) return;
  NurbsCurve<Dim> curve(basis, fit.solution.coefficients);
  if (first > basis.lower()) curve = Split(curve, first).second;
  if (last < basis.upper()) curve = Split(curve, last).first;
  const double length = basis.upper() - basis.lower();
  parameters.row(0) =
      (basis.lower() + (parameters.row(0).array() - first) * (length / (last - first)))
          .max(basis.lower())
          .min(basis.upper());
  const SplineBasis same = Scaled(curve.basis(), basis.lower(), basis.upper());
  fit.problem = fit.problem.WithBasis(same).WithParameters(std::move(parameters));
  fit.solution.coefficients = curve.control_points();
}

}  // namespace

FeetFit AtLeastDistance(const FeetFit& fit,
                        const DistanceMinimisationOptions& options,
                        ThreadPool& pool) {
  const DistanceMinimum found =
      MinimiseDistance(fit.problem, fit.solution.coefficients, options, pool);
  Eigen::Matrix2Xd parameters = Eigen::Matrix2Xd::Zero(2, fit.problem.size());
  parameters.row(0) = found.parameters;
  FeetFit lower{fit.problem.WithParameters(std::move(parameters)), fit.solution, found.rounds};
  lower.solution.coefficients = found.control_points;
  found.control_points.rows() == 2 ? CutToData<2>(lower) : CutToData<3>(lower);
  const Eigen::VectorXd squares =
      (EvaluateAt(lower.problem, lower.solution.coefficients, pool) - lower.problem.data().values)
          .colwise()
          .squaredNorm()
          .transpose();
  const Eigen::VectorXd& weights = lower.problem.data().weights;
  lower.solution.residual_squares = weights.size() > 0 ? weights.dot(squares) : squares.sum();
  return lower;
}

}  // namespace batten
