// SPDX-License-Identifier: MIT
#include "batten/fitting/fitting_problem.h"

#include <cmath>

#include "fitting/least_squares/net_values.h"
#include "fitting/linear/coefficient_order.h"
#include "geometry/numeric/reject.h"

namespace batten {
using namespace internal;
namespace {

void RequireInside(const Eigen::AlignedBox2d& box, int direction, const SplineBasis& basis) {
  if (box.min()[direction] < basis.lower() || box.max()[direction] > basis.upper())
    Reject("FittingProblem", "a parameter lies outside the domain");
}

void CheckWeights(const Eigen::VectorXd& weights, Eigen::Index points) {
  if (weights.size() == 0) return;
  if (weights.size() != points) Reject("FittingProblem", "weights and parameters differ in number");
  if (!weights.allFinite()) Reject("FittingProblem", "a weight is not finite");
  if (!(weights.minCoeff() >= 0)) Reject("FittingProblem", "a weight is negative");
}

Eigen::AlignedBox2d BoxOf(const Eigen::Matrix2Xd& parameters) {
  Eigen::AlignedBox2d box;
  for (const auto& place : parameters.colwise()) box.extend(place);
  return box;
}

}  // namespace

// Checked once for data that many problems share.
FittingProblem::CheckedData FittingProblem::Check(std::shared_ptr<const FittingData> data) {
  if (!data) Reject("FittingProblem", "no data");
  if (data->values.cols() != data->parameters.cols())
    Reject("FittingProblem", "values and parameters differ in number");
  if (!data->values.allFinite() || !data->parameters.allFinite())
    Reject("FittingProblem", "data are not finite");
  CheckWeights(data->weights, data->parameters.cols());
  return {data, BoxOf(data->parameters)};
}

FittingProblem::FittingProblem(SplineBasis basis_u,
                               std::optional<SplineBasis> basis_v,
                               CheckedData data,
                               double smoothing,
                               FairnessEnergy energy,
                               const Poles& poles)
    : basis_u_(std::move(basis_u)),
      basis_v_(std::move(basis_v)),
      data_(std::move(data)),
      smoothing_(smoothing),
      energy_(energy),
      poles_(poles) {
  if (!(smoothing_ >= 0) || !std::isfinite(smoothing_))
    Reject("FittingProblem", "smoothing is negative or not finite");
  if (data_.box.isEmpty()) return;
  RequireInside(data_.box, 0, basis_u_);
  if (basis_v_) RequireInside(data_.box, 1, *basis_v_);
}

FittingProblem::FittingProblem(SplineBasis basis_u,
                               SplineBasis basis_v,
                               std::shared_ptr<const FittingData> data,
                               double smoothing)
    : FittingProblem(std::move(basis_u),
                     std::optional<SplineBasis>(std::move(basis_v)),
                     Check(std::move(data)),
                     smoothing,
                     FairnessEnergy::kThinPlate,
                     Poles()) {}

FittingProblem::FittingProblem(SplineBasis basis,
                               std::shared_ptr<const FittingData> data,
                               double smoothing)
    : FittingProblem(std::move(basis),
                     std::optional<SplineBasis>(),
                     Check(std::move(data)),
                     smoothing,
                     FairnessEnergy::kThinPlate,
                     Poles()) {}

int FittingProblem::unknowns() const {
  if (!basis_v_) return DistinctCount(basis_u_);
  return DistinctCount(basis_u_) * DistinctCount(*basis_v_) -
         PoleConditionCount(basis_u_, *basis_v_, poles_);
}

FittingProblem FittingProblem::WithBases(SplineBasis basis_u, SplineBasis basis_v) const {
  if (is_curve()) Reject("FittingProblem", "a curve has one basis");
  return FittingProblem(std::move(basis_u),
                        std::optional<SplineBasis>(std::move(basis_v)),
                        data_,
                        smoothing_,
                        energy_,
                        poles_);
}

FittingProblem FittingProblem::WithBasis(SplineBasis basis) const {
  if (!is_curve()) Reject("FittingProblem", "a surface has two bases");
  return FittingProblem(
      std::move(basis), std::optional<SplineBasis>(), data_, smoothing_, energy_, poles_);
}

FittingProblem FittingProblem::WithWeights(Eigen::VectorXd weights) const {
  CheckWeights(weights, size());
  auto data = std::make_shared<FittingData>();
  data->parameters = data_.data->parameters;
  data->values = data_.data->values;
  data->weights = std::move(weights);
  return FittingProblem(
      basis_u_, basis_v_, {std::move(data), data_.box}, smoothing_, energy_, poles_);
}

FittingProblem FittingProblem::WithParameters(Eigen::Matrix2Xd parameters) const {
  auto data = std::make_shared<FittingData>();
  data->parameters = std::move(parameters);
  data->values = data_.data->values;
  data->weights = data_.data->weights;
  return WithData(std::move(data));
}

FittingProblem FittingProblem::WithSmoothing(double smoothing) const {
  return FittingProblem(basis_u_, basis_v_, data_, smoothing, energy_, poles_);
}

FittingProblem FittingProblem::WithEnergy(FairnessEnergy energy) const {
  return FittingProblem(basis_u_, basis_v_, data_, smoothing_, energy, poles_);
}

FittingProblem FittingProblem::WithPoles(const Poles& poles) const {
  if (is_curve()) Reject("FittingProblem", "a curve has no poles");
  if (poles.any() && basis_v_->periodic())
    Reject("FittingProblem", "a periodic direction has no pole");
  if (poles.any() && !(poles.turn > 0 && std::isfinite(poles.turn)))
    Reject("FittingProblem", "the angle about a pole must be positive");
  return FittingProblem(basis_u_, basis_v_, data_, smoothing_, energy_, poles);
}

FittingProblem FittingProblem::WithData(std::shared_ptr<const FittingData> data) const {
  return FittingProblem(basis_u_, basis_v_, Check(std::move(data)), smoothing_, energy_, poles_);
}

PointRows RowsOf(const FittingProblem& problem) {
  const FittingData& data = problem.data();
  const double* parameters = data.parameters.data();
  return {problem.size(),
          parameters,
          problem.is_curve() ? nullptr : parameters + 1,
          2,
          data.values.data(),
          static_cast<int>(data.values.rows()),
          data.weights.size() > 0 ? data.weights.data() : nullptr};
}

Eigen::MatrixXd EvaluateAt(const FittingProblem& problem,
                           const Eigen::MatrixXd& coefficients,
                           ThreadPool& pool) {
  return NetValues(problem.basis_u(),
                   problem.is_curve() ? nullptr : &problem.basis_v(),
                   coefficients,
                   RowsOf(problem),
                   pool);
}

}  // namespace batten
