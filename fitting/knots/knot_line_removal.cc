// SPDX-License-Identifier: MIT
#include "fitting/knots/knot_line_removal.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <tuple>
#include <utility>
#include <vector>

#include "fitting/knots/knot_grid_selection.h"
#include "fitting/least_squares/fitting_bases.h"
#include "fitting/linear/coefficient_order.h"

namespace batten::internal {
namespace {

constexpr double kFiner = 1.3;        // cells of a finer grid to begin with
constexpr double kManyPruned = 0.25;  // control points gone, for a finer one to be tried
constexpr int kRefusalsToStop = 3;    // of single lines, one after the other
constexpr double kAtFirst = 0.25;     // of the lines, in the first removal
constexpr Eigen::Index kMostInOrder = 50000;
constexpr double kWorthTrying = 2;  // times what the score grants, for the estimate's sake

struct Line {
  bool in_u;
  double knot;
  double worth;  // per control point
};

// Σ w N Nᵀ over the points' parameters in one direction; of very many points, over some of them
// for all: lines are only put in order by it.
Eigen::MatrixXd Gram(const SplineBasis& basis,
                     const Eigen::RowVectorXd& parameters,
                     const Eigen::VectorXd& weights) {
  const int p = basis.degree();
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(basis.size(), basis.size());
  double N[kMaxDegree + 1];
  const Eigen::Index step = 1 + parameters.size() / kMostInOrder;
  for (Eigen::Index k = 0; k < parameters.size(); k += step) {
    const int span = basis.Span(parameters[k]);
    basis.Values(span, parameters[k], N);
    const double weight = static_cast<double>(step) * (weights.size() > 0 ? weights[k] : 1.0);
    for (int s = 0; s <= p; ++s) {
      for (int r = s; r <= p; ++r) gram(span - p + r, span - p + s) += weight * N[r] * N[s];
    }
  }
  // Where there are no points the rest decides.
  gram.diagonal().array() += 1e-9 * gram.trace() / static_cast<double>(basis.size());
  return gram.selfadjointView<Eigen::Lower>();
}

// Nets of coefficients: a component in a matrix of n_along × n_across.
void CollectLines(bool in_u,
                  const SplineBasis& basis,
                  const std::vector<Eigen::MatrixXd>& nets,
                  const Eigen::MatrixXd& along,
                  const Eigen::MatrixXd& across,
                  double weight,
                  std::vector<Line>& lines) {
  if (basis.periodic()) return;
  const Eigen::LLT<Eigen::MatrixXd> factor(along);
  const std::vector<double>& knots = basis.knots();
  const std::vector<int> rows = DistinctIndices(&basis);
  for (int i = basis.degree() + 1; i < basis.size(); ++i) {
    const double knot = knots[static_cast<size_t>(i)];
    if (basis.Multiplicity(knot) != 1) continue;
    // |aᵀC|² / aᵀA⁻¹a with A the product of the two directions' matrices.
    const Eigen::VectorXd jump = TopDerivativeJump(basis, rows, knot);
    const double spread = jump.dot(factor.solve(jump));
    double squares = 0;
    for (const Eigen::MatrixXd& net : nets) {
      const Eigen::VectorXd form = net.transpose() * jump;
      squares += form.dot(across * form);
    }
    lines.push_back({in_u, knot, squares / (spread * weight * static_cast<double>(across.rows()))});
  }
}

// All lines that could go, the least worth first.
std::vector<Line> LinesByWorth(const FittingProblem& problem, const Eigen::MatrixXd& coefficients) {
  const SplineBasis &basis_u = problem.basis_u(), &basis_v = problem.basis_v();
  const FittingData& data = problem.data();
  const Eigen::MatrixXd gram_u = Gram(basis_u, data.parameters.row(0), data.weights),
                        gram_v = Gram(basis_v, data.parameters.row(1), data.weights);
  std::vector<Eigen::MatrixXd> nets, turned;
  for (Eigen::Index d = 0; d < coefficients.rows(); ++d) {
    const Eigen::VectorXd row = coefficients.row(d);
    turned.push_back(Eigen::Map<const Eigen::MatrixXd>(row.data(), basis_v.size(), basis_u.size()));
    nets.push_back(turned.back().transpose());
  }
  std::vector<Line> lines;
  const double weight = WeightOf(problem);
  CollectLines(true, basis_u, nets, gram_u, gram_v, weight, lines);
  CollectLines(false, basis_v, turned, gram_v, gram_u, weight, lines);
  std::sort(lines.begin(), lines.end(), [](const Line& a, const Line& b) {
    return std::tuple(a.worth, a.in_u, a.knot) < std::tuple(b.worth, b.in_u, b.knot);
  });
  return lines;
}

// Lines next to each other are not worth the sum of what each is worth.
bool NextToOneOf(const SplineBasis& basis, double knot, const std::vector<double>& others) {
  const std::vector<double>& knots = basis.knots();
  const auto place = std::find(knots.begin(), knots.end(), knot);
  return std::any_of(others.begin(), others.end(), [&](double other) {
    return *(place - 1) == other || *(place + 1) == other;
  });
}

// One removal: the first lines of a list that are not to be spared.
struct Removal {
  std::vector<double> u, v;
  size_t size() const { return u.size() + v.size(); }
};

Removal FirstLines(const FittingProblem& problem,
                   const std::vector<Line>& lines,
                   const Removal& spared,
                   double most,
                   size_t count) {
  Removal removal;
  for (const Line& line : lines) {
    if (line.worth > most || removal.size() >= count) break;
    const std::vector<double>& kept = line.in_u ? spared.u : spared.v;
    if (std::find(kept.begin(), kept.end(), line.knot) != kept.end()) continue;
    std::vector<double>& gone = line.in_u ? removal.u : removal.v;
    if (!NextToOneOf(line.in_u ? problem.basis_u() : problem.basis_v(), line.knot, gone)) {
      gone.push_back(line.knot);
    }
  }
  return removal;
}

FittingProblem Thinned(const FittingProblem& problem,
                       const LinearSolution& start,
                       const AcceptRemoval& accept_removal,
                       ThreadPool& pool,
                       double most) {
  FittingProblem best = problem;
  std::vector<Line> lines = LinesByWorth(best, start.coefficients);
  auto count =
      std::max<size_t>(1, static_cast<size_t>(kAtFirst * static_cast<double>(lines.size())));
  Removal spared;
  for (int refusals = 0; refusals < kRefusalsToStop;) {
    const Removal removal = FirstLines(best, lines, spared, most, count);
    if (removal.size() == 0) break;
    FittingProblem fewer = best.WithBases(WithoutInnerKnots(best.basis_u(), removal.u),
                                          WithoutInnerKnots(best.basis_v(), removal.v));
    const LinearSolution solution = SolveLinear(fewer, pool);
    if (accept_removal(fewer, solution)) {
      best = std::move(fewer);
      lines = LinesByWorth(best, solution.coefficients);
      refusals = 0;
    } else if (removal.size() > 1) {
      count = removal.size() / 2;
    } else {
      spared.u.insert(spared.u.end(), removal.u.begin(), removal.u.end());
      spared.v.insert(spared.v.end(), removal.v.begin(), removal.v.end());
      ++refusals;
    }
  }
  return best;
}

struct ScoredProblem {
  FittingProblem problem;
  double score;
};

double Score(const FittingProblem& problem, const LinearSolution& solution) {
  const double points = PointCount(problem);
  const double freedom = std::max(1.0, points - problem.unknowns());
  return points * solution.residual_squares / (freedom * freedom);
}

// Removes the lines that cross-validation rejects.
ScoredProblem Scored(const FittingProblem& problem, ThreadPool& pool) {
  const LinearSolution solution = SolveLinear(problem, pool);
  double score = Score(problem, solution);
  const auto lowers = [&](const FittingProblem& fewer, const LinearSolution& found) {
    const double now = Score(fewer, found);
    if (!(now < score)) return false;
    score = now;
    return true;
  };
  // A line pays if the squares rise by more than two variances for each of its control points.
  const double variance =
      solution.residual_squares / std::max(1.0, PointCount(problem) - problem.unknowns());
  FittingProblem thinned = Thinned(problem, solution, lowers, pool, kWorthTrying * 2 * variance);
  return {std::move(thinned), score};
}

}  // namespace

Eigen::VectorXd TopDerivativeJump(const SplineBasis& basis,
                                  const std::vector<int>& rows,
                                  double knot) {
  const int p = basis.degree(), right = basis.Span(knot),
            left = knot <= basis.lower() ? basis.Span(basis.upper()) : right - 1;
  Eigen::VectorXd jump = Eigen::VectorXd::Zero(DistinctCount(basis));
  std::vector<double> values(static_cast<size_t>((p + 1) * (p + 1)));
  for (const auto& [span, sign] : {std::pair{right, 1.0}, {left, -1.0}}) {
    const double low = basis.knots()[static_cast<size_t>(span)],
                 high = basis.knots()[static_cast<size_t>(span) + 1];
    basis.Derivatives(span, low + (high - low) / 2, p, values.data());
    for (int r = 0; r <= p; ++r) {
      jump[rows[static_cast<size_t>(span - p + r)]] +=
          sign * values[static_cast<size_t>(p * (p + 1) + r)];
    }
  }
  return jump.stableNormalized();
}

FittingProblem RemoveKnotLines(const FittingProblem& problem,
                               const AcceptRemoval& accept_removal,
                               ThreadPool& pool,
                               double most) {
  if (problem.is_curve()) throw std::invalid_argument("RemoveKnotLines: a curve has no lines");
  return Thinned(problem, SolveLinear(problem, pool), accept_removal, pool, most);
}

FittingProblem PruneKnotLines(const FittingProblem& problem, ThreadPool& pool) {
  if (problem.is_curve()) throw std::invalid_argument("PruneKnotLines: a curve has no lines");
  return Scored(problem, pool).problem;
}

FittingProblem RefineAndPruneKnotLines(const FittingProblem& problem,
                                       int max_control_points,
                                       ThreadPool& pool) {
  if (problem.is_curve())
    throw std::invalid_argument("RefineAndPruneKnotLines: a curve has no lines");
  ScoredProblem best = Scored(problem, pool);
  if (best.problem.unknowns() > (1 - kManyPruned) * problem.unknowns()) return best.problem;
  const auto cells = [](const SplineBasis& basis, double finer) {
    return FittingBasisLike(
        basis,
        basis.degree(),
        static_cast<int>(std::lround(finer * static_cast<double>(basis.Spans().size()))));
  };
  for (double finer = kFiner;; finer *= kFiner) {
    const FittingProblem start =
        problem.WithBases(cells(problem.basis_u(), finer), cells(problem.basis_v(), finer));
    if (start.net_size() > max_control_points ||
        start.unknowns() * kLeastPointsPerControlPoint > PointCount(problem)) {
      break;
    }
    ScoredProblem next = Scored(start, pool);
    if (!(next.score < best.score)) break;
    best = std::move(next);
  }
  return best.problem;
}

}  // namespace batten::internal
