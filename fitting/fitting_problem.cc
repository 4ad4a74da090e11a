// SPDX-License-Identifier: MIT
#include "batten/fitting/fitting_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "batten/fitting/block_banded_matrix.h"
#include "batten/fitting/coefficient_order.h"
#include "batten/fitting/fairness.h"
#include "batten/fitting/normal_equations.h"

namespace batten {
namespace {

// Where nothing but the jitter holds a coefficient, its pivot is hardly more.
constexpr double kSingularInJitters = 16;

// Smoothing from which on fairness carries what it can; what it leaves free no weight would hold.
constexpr double kFirmSmoothing = 1e-7;

// Sums of squares lose what is less than this share of them; the residual is then taken point by
// point.
constexpr double kCancelled = 1e-9;

[[noreturn]] void Reject(const std::string& rule) {
  throw std::invalid_argument("FittingProblem: " + rule);
}

// The rows of the solver as the coefficients of the bases, outer-inner; repeated ones too.
Eigen::MatrixXd InOuterOrder(const Eigen::MatrixXd& rows,
                             const SplineBasis& outer,
                             const SplineBasis* inner) {
  const std::vector<int> outer_rows = CoefficientOrder(outer).Rows(outer),
                         inner_rows = DistinctIndices(inner);
  const Eigen::Index distinct = inner ? DistinctCount(*inner) : 1;
  Eigen::MatrixXd all(static_cast<Eigen::Index>(outer_rows.size() * inner_rows.size()),
                      rows.cols());
  Eigen::Index to = 0;
  for (const int i : outer_rows) {
    for (const int j : inner_rows) all.row(to++) = rows.row(i * distinct + j);
  }
  return all;
}

// From outer-inner order to v fastest: nothing to do when u is outside, a transposition otherwise.
Eigen::MatrixXd InNetOrder(const Eigen::MatrixXd& solution,
                           bool u_outside,
                           int size_u,
                           int size_v) {
  Eigen::MatrixXd net(solution.cols(), solution.rows());
  for (int i = 0; i < size_u; ++i) {
    for (int j = 0; j < size_v; ++j) {
      const Eigen::Index from =
          u_outside ? Eigen::Index{i} * size_v + j : Eigen::Index{j} * size_u + i;
      net.col(Eigen::Index{i} * size_v + j) = solution.row(from).transpose();
    }
  }
  return net;
}

void RequireInside(const Eigen::RowVectorXd& parameters, const SplineBasis& basis) {
  if (parameters.minCoeff() < basis.lower() || parameters.maxCoeff() > basis.upper())
    Reject("a parameter lies outside the domain");
}

}  // namespace

FittingProblem::FittingProblem(SplineBasis basis_u,
                               std::optional<SplineBasis> basis_v,
                               std::shared_ptr<const FittingData> data,
                               double smoothing)
    : basis_u_(std::move(basis_u)),
      basis_v_(std::move(basis_v)),
      data_(std::move(data)),
      smoothing_(smoothing) {
  if (!data_) Reject("no data");
  const Eigen::Index m = data_->parameters.cols();
  if (data_->values.cols() != m) Reject("values and parameters differ in number");
  if (data_->weights.size() != 0 && data_->weights.size() != m)
    Reject("weights and parameters differ in number");
  if (!data_->values.allFinite() || !data_->parameters.allFinite()) Reject("data are not finite");
  if (!data_->weights.allFinite()) Reject("a weight is not finite");
  if (data_->weights.size() != 0 && !(data_->weights.minCoeff() >= 0))
    Reject("a weight is negative");
  if (!(smoothing_ >= 0) || !std::isfinite(smoothing_))
    Reject("smoothing is negative or not finite");
  if (m > 0) {
    RequireInside(data_->parameters.row(0), basis_u_);
    if (basis_v_) RequireInside(data_->parameters.row(1), *basis_v_);
  }
}

FittingProblem::FittingProblem(SplineBasis basis_u,
                               SplineBasis basis_v,
                               std::shared_ptr<const FittingData> data,
                               double smoothing)
    : FittingProblem(std::move(basis_u),
                     std::optional<SplineBasis>(std::move(basis_v)),
                     std::move(data),
                     smoothing) {}

FittingProblem::FittingProblem(SplineBasis basis,
                               std::shared_ptr<const FittingData> data,
                               double smoothing)
    : FittingProblem(std::move(basis), std::optional<SplineBasis>(), std::move(data), smoothing) {}

int FittingProblem::unknowns() const {
  return DistinctCount(basis_u_) * (basis_v_ ? DistinctCount(*basis_v_) : 1);
}

FittingProblem FittingProblem::WithBases(SplineBasis basis_u, SplineBasis basis_v) const {
  if (is_curve()) Reject("a curve has one basis");
  return FittingProblem(
      std::move(basis_u), std::optional<SplineBasis>(std::move(basis_v)), data_, smoothing_);
}

FittingProblem FittingProblem::WithBasis(SplineBasis basis) const {
  if (!is_curve()) Reject("a surface has two bases");
  return FittingProblem(std::move(basis), data_, smoothing_);
}

FittingProblem FittingProblem::WithWeights(Eigen::VectorXd weights) const {
  auto data = std::make_shared<FittingData>(*data_);
  data->weights = std::move(weights);
  return FittingProblem(basis_u_, basis_v_, std::move(data), smoothing_);
}

FittingProblem FittingProblem::WithParameters(Eigen::Matrix2Xd parameters) const {
  auto data = std::make_shared<FittingData>();
  data->parameters = std::move(parameters);
  data->values = data_->values;
  data->weights = data_->weights;
  return FittingProblem(basis_u_, basis_v_, std::move(data), smoothing_);
}

FittingProblem FittingProblem::WithSmoothing(double smoothing) const {
  return FittingProblem(basis_u_, basis_v_, data_, smoothing);
}

FittingProblem FittingProblem::WithData(std::shared_ptr<const FittingData> data) const {
  return FittingProblem(basis_u_, basis_v_, std::move(data), smoothing_);
}

LinearSolution SolveLinear(const FittingProblem& problem, ThreadPool& pool) {
  const bool u_outside = problem.is_curve() || problem.basis_u().size() >= problem.basis_v().size();
  const SplineBasis& outer = u_outside ? problem.basis_u() : problem.basis_v();
  const SplineBasis* inner = problem.is_curve() ? nullptr
                             : u_outside        ? &problem.basis_v()
                                                : &problem.basis_u();
  const int inner_size = inner ? inner->size() : 1;
  const Eigen::VectorXd outer_parameters = problem.data().parameters.row(u_outside ? 0 : 1);
  const Eigen::VectorXd inner_parameters = problem.data().parameters.row(u_outside ? 1 : 0);
  const CellOrder order(outer, inner, outer_parameters, inner_parameters);
  const NormalEquations equations(outer,
                                  inner,
                                  outer_parameters,
                                  inner_parameters,
                                  problem.data().values,
                                  problem.data().weights,
                                  order,
                                  pool);
  const FairnessForm fairness(outer, inner);

  LinearSolution result;
  const double unit = equations.trace() / fairness.Trace();
  // Rounding alone makes a semidefinite matrix look indefinite; this keeps it away from that.
  const double jitter =
      4 * std::numeric_limits<double>::epsilon() * equations.trace() / problem.unknowns();
  double lambda = problem.smoothing() * unit;
  Eigen::MatrixXd solution;
  for (int attempt = 0;; ++attempt) {
    BlockBandedMatrix matrix = EmptyMatrix(outer, inner);
    equations.AddTo(matrix);
    if (lambda > 0) fairness.AddTo(matrix, lambda);
    // High degrees need more than rounding's worth of it.
    matrix.AddToDiagonal(jitter * std::pow(30.0, std::max(0, attempt - 5)));
    if (matrix.Factor() &&
        (lambda >= kFirmSmoothing * unit || matrix.SmallestPivot() > kSingularInJitters * jitter)) {
      solution = equations.rhs();
      matrix.Solve(solution);
      if (solution.allFinite()) break;
    }
    if (attempt == 16) {
      throw std::invalid_argument(
          "the points do not determine the control points: too few carry weight, or the degree is "
          "too high "
          "for them");
    }
    lambda = std::max(10 * lambda, 1e-12 * unit);
    result.regularised = true;
  }
  // zᵀz − 2cᵀb + cᵀAc with (A + λP)c = b, so cᵀAc = cᵀb − λ cᵀPc.
  double squares = equations.squares();
  const Eigen::MatrixXd coefficients = InOuterOrder(solution, outer, inner);
  for (Eigen::Index d = 0; d < solution.cols(); ++d) {
    squares -=
        solution.col(d).dot(equations.rhs().col(d)) + lambda * fairness.Energy(coefficients.col(d));
  }
  result.coefficients = InNetOrder(coefficients,
                                   u_outside,
                                   u_outside ? outer.size() : inner_size,
                                   u_outside ? inner_size : outer.size());
  if (squares < kCancelled * equations.squares()) {
    const Eigen::VectorXd errors =
        (EvaluateAt(problem, result.coefficients, pool) - problem.data().values)
            .colwise()
            .squaredNorm();
    const Eigen::VectorXd& weights = problem.data().weights;
    squares = weights.size() > 0 ? weights.dot(errors) : errors.sum();
  }
  result.residual_squares = squares;
  return result;
}

Eigen::MatrixXd EvaluateAt(const FittingProblem& problem,
                           const Eigen::MatrixXd& coefficients,
                           ThreadPool& pool) {
  const SplineBasis& bu = problem.basis_u();
  const SplineBasis* bv = problem.is_curve() ? nullptr : &problem.basis_v();
  const Eigen::Matrix2Xd& uv = problem.data().parameters;
  const int p = bu.degree(), q = bv ? bv->degree() : 0, size_v = bv ? bv->size() : 1;
  Eigen::MatrixXd values(coefficients.rows(), uv.cols());
  pool.For(uv.cols(), 2048, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    double Nu[kMaxDegree + 1], Nv[kMaxDegree + 1];
    Nv[0] = 1;
    for (std::ptrdiff_t k = begin; k < end; ++k) {
      const int su = bu.Span(uv(0, k)), sv = bv ? bv->Span(uv(1, k)) : 0;
      bu.Values(su, uv(0, k), Nu);
      if (bv) bv->Values(sv, uv(1, k), Nv);
      for (Eigen::Index d = 0; d < coefficients.rows(); ++d) {
        double sum = 0;
        for (int r = 0; r <= p; ++r) {
          const Eigen::Index row = Eigen::Index{su - p + r} * size_v + sv - q;
          double inner = 0;
          for (int s = 0; s <= q; ++s) inner += Nv[s] * coefficients(d, row + s);
          sum += Nu[r] * inner;
        }
        values(d, k) = sum;
      }
    }
  });
  return values;
}

}  // namespace batten
