// SPDX-License-Identifier: MIT
#include "fitting/curve/parameter_correction.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "batten/geometry/curve_evaluator.h"
#include "fitting/curve/curve_cut.h"
#include "fitting/curve/span_layout.h"
#include "fitting/foot_points/curve_pieces.h"
#include "fitting/least_squares/fitting_bases.h"

namespace batten::internal {
namespace {

constexpr double kNearCorner = 1.5;   // in mean steps: distance from a corner at which data may end
constexpr double kLeastFilled = 0.5;  // share of a piece: below it the curve is far from its data

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
Eigen::Matrix2Xd FootPointsOf(const FittingProblem& problem,
                              const Eigen::MatrixXd& coefficients,
                              ThreadPool& pool) {
  Eigen::Matrix2Xd parameters = problem.data().parameters;
  const Eigen::VectorXd starts = parameters.row(0).transpose();
  parameters.row(0) =
      LocalFootPointsKernel<Dim>(
          NurbsCurve<Dim>(problem.basis_u(), coefficients), problem.data().values, starts, pool)
          .transpose();
  return parameters;
}

// Where a curve may bend sharply or end: both ends of the domain, and knots of multiplicity p.
// Around a periodic basis without such knots: none.
std::vector<double> SharpPlaces(const SplineBasis& basis) {
  const int p = basis.degree();
  std::vector<double> places;
  bool sharp = !basis.periodic();
  for (const int span : basis.Spans()) {
    const double knot = basis.knots()[static_cast<size_t>(span)];
    const bool corner = p > 1 && basis.Multiplicity(knot) >= p;
    if (corner || knot == basis.lower()) places.push_back(knot);
    sharp = sharp || corner;
  }
  places.push_back(basis.upper());
  return sharp ? places : std::vector<double>{};
}

// First and last parameter of the data with weight in a piece between sharp places.
struct Reach {
  double first, last;
  Eigen::Index count = 0;
};

// The piece between sharp places that holds each parameter.
class PieceNumbers {
 public:
  PieceNumbers(const Eigen::Matrix2Xd& parameters, const std::vector<double>& places) {
    if (places.size() == 2) return;
    pieces_.reserve(static_cast<size_t>(parameters.cols()));
    for (const double u : parameters.row(0)) {
      const auto above = std::upper_bound(places.begin(), places.end(), u);
      pieces_.push_back(static_cast<size_t>(
          std::clamp<std::ptrdiff_t>(above - places.begin() - 1, 0, std::ssize(places) - 2)));
    }
  }

  size_t operator[](Eigen::Index k) const {
    return pieces_.empty() ? 0 : pieces_[static_cast<size_t>(k)];
  }

 private:
  std::vector<size_t> pieces_;  // empty: one piece
};

std::vector<Reach> ReachOf(const FittingProblem& problem,
                           const Eigen::Matrix2Xd& parameters,
                           const std::vector<double>& places,
                           const PieceNumbers& piece_of) {
  std::vector<Reach> reach(places.size() - 1, {places.back(), places.front(), 0});
  const Eigen::VectorXd& weights = problem.data().weights;
  for (Eigen::Index k = 0; k < parameters.cols(); ++k) {
    if (weights.size() > 0 && weights[k] == 0) continue;
    Reach& piece = reach[piece_of[k]];
    piece.first = std::min(piece.first, parameters(0, k));
    piece.last = std::max(piece.last, parameters(0, k));
    ++piece.count;
  }
  return reach;
}

// Data stay between the corners they lie between and reach near them, and to the ends of an open
// domain: a curve that is longer than its data would be free to go anywhere.
void KeepReach(const FittingProblem& problem, Eigen::Matrix2Xd& parameters) {
  const SplineBasis& basis = problem.basis_u();
  const std::vector<double> places = SharpPlaces(basis);
  if (places.empty()) return;
  const double period = basis.periodic() ? basis.upper() - basis.lower() : 0;
  const PieceNumbers piece_of(problem.data().parameters, places);
  for (Eigen::Index k = 0; k < parameters.cols(); ++k) {
    const size_t piece = piece_of[k];
    double& u = parameters(0, k);
    // Feet beyond the seam are near the end they came from.
    if (period > 0) u += period * std::round((problem.data().parameters(0, k) - u) / period);
    u = std::clamp(u, places[piece], places[piece + 1]);
  }
  std::vector<Reach> before = ReachOf(problem, problem.data().parameters, places, piece_of);
  const std::vector<Reach> after = ReachOf(problem, parameters, places, piece_of);
  if (!basis.periodic()) {
    before.front().first = basis.lower();
    before.back().last = basis.upper();
  }
  for (Eigen::Index k = 0; k < parameters.cols(); ++k) {
    const size_t piece = piece_of[k];
    const Reach &was = before[piece], &is = after[piece];
    const double length = is.last - is.first;
    const auto count = static_cast<double>(std::max<Eigen::Index>(1, is.count));
    const double near = kNearCorner * length / count;
    const bool from_end = !basis.periodic() && piece == 0,
               to_end = !basis.periodic() && piece + 2 == places.size();
    const double first =
        std::min(is.first, from_end ? was.first : std::max(was.first, places[piece] + near));
    const double last =
        std::max(is.last, to_end ? was.last : std::min(was.last, places[piece + 1] - near));
    if (!(length > kLeastFilled * (last - first))) continue;
    double& u = parameters(0, k);
    const double stretched = u <= is.first  ? first
                             : u >= is.last ? last
                                            : first + (u - is.first) * ((last - first) / length);
    u = std::clamp(stretched, places[piece], places[piece + 1]);
  }
}

// The parameters of the data that have weight.
std::vector<double> OfWeight(const FittingProblem& problem) {
  const Eigen::VectorXd& weights = problem.data().weights;
  std::vector<double> parameters;
  parameters.reserve(static_cast<size_t>(problem.size()));
  for (Eigen::Index k = 0; k < problem.size(); ++k) {
    if (weights.size() == 0 || weights[k] > 0)
      parameters.push_back(problem.data().parameters(0, k));
  }
  return parameters;
}

// Whether parameters still increase, by the means of consecutive blocks of data: noise makes single
// ones step back. Around a closed curve steps count the short way.
bool RunForward(const FittingProblem& problem) {
  constexpr size_t kBlocks = 200, kLeastBlock = 3;
  const std::vector<double> u = OfWeight(problem);
  const SplineBasis& basis = problem.basis_u();
  const double period = basis.upper() - basis.lower();
  const size_t blocks = std::min(kBlocks, u.size() / kLeastBlock);
  double previous = 0;
  for (size_t b = 0; b < blocks; ++b) {
    const size_t begin = b * u.size() / blocks, end = (b + 1) * u.size() / blocks;
    const double first = u[begin];
    double mean = 0;  // against the first of the block
    for (size_t k = begin; k < end; ++k) {
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
  if (coefficients.rows() != 2) return 0;
  const CurveEvaluator<2> evaluator(NurbsCurve<2>(basis, coefficients));
  int changes = 0;
  double last = 0, first = 0;
  for (const int span : basis.Spans()) {
    const double low = basis.knots()[static_cast<size_t>(span)],
                 high = basis.knots()[static_cast<size_t>(span) + 1];
    for (int k = 0; k < kSamplesOfSpan; ++k) {
      const CurveJet<2> jet = evaluator.JetAt(low + (k + 0.5) / kSamplesOfSpan * (high - low));
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

Eigen::VectorXd DistancesAt(const FittingProblem& problem,
                            const Eigen::MatrixXd& coefficients,
                            bool across,
                            ThreadPool& pool) {
  const CurveSamples samples = CurveAt(problem, coefficients, pool);
  Eigen::MatrixXd offsets = problem.data().values - samples.points;
  if (across) offsets = Across(std::move(offsets), samples.tangents);
  Eigen::VectorXd distances = offsets.colwise().norm().transpose();
  const Eigen::VectorXd& weights = problem.data().weights;
  if (weights.size() > 0) distances = (weights.array() > 0).select(distances, 0).eval();
  return distances;
}

FittingProblem CorrectedParameters(const FittingProblem& problem,
                                   const Eigen::MatrixXd& coefficients,
                                   ThreadPool& pool,
                                   const std::vector<Eigen::Index>& anchored) {
  Eigen::Matrix2Xd parameters = coefficients.rows() == 2
                                    ? FootPointsOf<2>(problem, coefficients, pool)
                                    : FootPointsOf<3>(problem, coefficients, pool);
  KeepReach(problem, parameters);
  for (const Eigen::Index k : anchored) parameters.col(k) = problem.data().parameters.col(k);
  return problem.WithParameters(std::move(parameters));
}

CorrectedFit FitWithCorrection(const FittingProblem& problem,
                               int steps,
                               ThreadPool& pool,
                               const std::vector<Eigen::Index>& anchored) {
  // Data of zero weight under a loss may have been all there was at an end.
  Eigen::Matrix2Xd parameters = problem.data().parameters;
  if (steps > 0 && problem.data().weights.size() > 0) KeepReach(problem, parameters);
  const FittingProblem filled =
      parameters == problem.data().parameters ? problem : problem.WithParameters(parameters);
  CorrectedFit fit{filled, SolveLinear(filled, pool), 0};
  for (; fit.steps < steps; ++fit.steps) {
    FittingProblem moved =
        CorrectedParameters(fit.problem, fit.solution.coefficients, pool, anchored);
    if (!RunForward(moved)) break;
    fit.problem = std::move(moved);
    fit.solution = SolveLinear(fit.problem, pool);
  }
  return fit;
}

namespace {

// Cuts the curve to its data; false where that would cost control points.
template <int Dim>
bool Cut(CorrectedFit& fit) {
  auto cut = CutToData(NurbsCurve<Dim>(fit.problem.basis_u(), fit.solution.coefficients),
                       fit.problem.data());
  if (!cut) return false;
  fit.problem =
      fit.problem.WithBasis(cut->curve.basis()).WithParameters(std::move(cut->parameters));
  fit.solution.coefficients = cut->curve.control_points();
  return true;
}

}  // namespace

CorrectedFit AtMinimumDistance(const CorrectedFit& fit,
                               const DistanceMinimisationOptions& options,
                               ThreadPool& pool) {
  const DistanceMinimum found =
      MinimiseDistance(fit.problem, fit.solution.coefficients, options, pool);
  Eigen::Matrix2Xd parameters = Eigen::Matrix2Xd::Zero(2, fit.problem.size());
  parameters.row(0) = found.parameters;
  CorrectedFit lower{fit.problem.WithParameters(std::move(parameters)), fit.solution, found.rounds};
  lower.solution.coefficients = found.control_points;
  const bool cut = found.control_points.rows() == 2 ? Cut<2>(lower) : Cut<3>(lower);
  if (!cut) return fit;
  lower.solution.residual_squares = SquaresOf(lower.problem, lower.solution.coefficients, pool);
  return lower;
}

}  // namespace batten::internal
