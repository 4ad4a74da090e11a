// SPDX-License-Identifier: MIT
#include "batten/fitting/fitting_problem.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "batten/fitting/coefficient_order.h"
#include "batten/fitting/penalised_system.h"

namespace batten {
namespace {

// Sums of squares lose what is less than this share of them; the residual is then taken point by
// point.
constexpr double kCancelled = 1e-9;

[[noreturn]] void Reject(const std::string& rule) {
  throw std::invalid_argument("FittingProblem: " + rule);
}

void RequireInside(const Eigen::RowVectorXd& parameters, const SplineBasis& basis) {
  if (parameters.minCoeff() < basis.lower() || parameters.maxCoeff() > basis.upper())
    Reject("a parameter lies outside the domain");
}

}  // namespace

FittingProblem::FittingProblem(SplineBasis basis_u,
                               std::optional<SplineBasis> basis_v,
                               std::shared_ptr<const FittingData> data,
                               double smoothing,
                               FairnessEnergy energy,
                               const Poles& poles)
    : basis_u_(std::move(basis_u)),
      basis_v_(std::move(basis_v)),
      data_(std::move(data)),
      smoothing_(smoothing),
      energy_(energy),
      poles_(poles) {
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
                     smoothing,
                     FairnessEnergy::kThinPlate,
                     Poles()) {}

FittingProblem::FittingProblem(SplineBasis basis,
                               std::shared_ptr<const FittingData> data,
                               double smoothing)
    : FittingProblem(std::move(basis),
                     std::optional<SplineBasis>(),
                     std::move(data),
                     smoothing,
                     FairnessEnergy::kThinPlate,
                     Poles()) {}

int FittingProblem::unknowns() const {
  if (!basis_v_) return DistinctCount(basis_u_);
  return DistinctCount(basis_u_) * DistinctCount(*basis_v_) -
         PoleConditionCount(basis_u_, *basis_v_, poles_);
}

FittingProblem FittingProblem::WithBases(SplineBasis basis_u, SplineBasis basis_v) const {
  if (is_curve()) Reject("a curve has one basis");
  return FittingProblem(std::move(basis_u),
                        std::optional<SplineBasis>(std::move(basis_v)),
                        data_,
                        smoothing_,
                        energy_,
                        poles_);
}

FittingProblem FittingProblem::WithBasis(SplineBasis basis) const {
  if (!is_curve()) Reject("a surface has two bases");
  return FittingProblem(
      std::move(basis), std::optional<SplineBasis>(), data_, smoothing_, energy_, poles_);
}

FittingProblem FittingProblem::WithWeights(Eigen::VectorXd weights) const {
  auto data = std::make_shared<FittingData>(*data_);
  data->weights = std::move(weights);
  return FittingProblem(basis_u_, basis_v_, std::move(data), smoothing_, energy_, poles_);
}

FittingProblem FittingProblem::WithParameters(Eigen::Matrix2Xd parameters) const {
  auto data = std::make_shared<FittingData>();
  data->parameters = std::move(parameters);
  data->values = data_->values;
  data->weights = data_->weights;
  return FittingProblem(basis_u_, basis_v_, std::move(data), smoothing_, energy_, poles_);
}

FittingProblem FittingProblem::WithSmoothing(double smoothing) const {
  return FittingProblem(basis_u_, basis_v_, data_, smoothing, energy_, poles_);
}

FittingProblem FittingProblem::WithEnergy(FairnessEnergy energy) const {
  return FittingProblem(basis_u_, basis_v_, data_, smoothing_, energy, poles_);
}

FittingProblem FittingProblem::WithPoles(const Poles& poles) const {
  if (is_curve()) Reject("a curve has no poles");
  if (poles.any() && basis_v_->periodic()) Reject("a periodic direction has no pole");
  if (poles.any() && !(poles.turn > 0 && std::isfinite(poles.turn)))
    Reject("the angle about a pole must be positive");
  return FittingProblem(basis_u_, basis_v_, data_, smoothing_, energy_, poles);
}

FittingProblem FittingProblem::WithData(std::shared_ptr<const FittingData> data) const {
  return FittingProblem(basis_u_, basis_v_, std::move(data), smoothing_, energy_, poles_);
}

LinearSolution SolveLinear(const FittingProblem& problem, ThreadPool& pool) {
  const PenalisedSystem system(problem, pool);
  const PenalisedSystem::Solution solution = system.Solve(problem.smoothing());
  LinearSolution result;
  result.coefficients = system.Net(solution.rows);
  result.regularised = solution.raised;
  result.residual_squares = solution.residual_squares;
  if (result.residual_squares < kCancelled * system.squares()) {
    const Eigen::VectorXd errors =
        (EvaluateAt(problem, result.coefficients, pool) - problem.data().values)
            .colwise()
            .squaredNorm();
    const Eigen::VectorXd& weights = problem.data().weights;
    result.residual_squares = weights.size() > 0 ? weights.dot(errors) : errors.sum();
  }
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
