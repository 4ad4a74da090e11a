// SPDX-License-Identifier: MIT
#include "fitting/least_squares/penalised_system.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "fitting/least_squares/pole_rows.h"
#include "fitting/linear/coefficient_order.h"

namespace batten::internal {
namespace {

// Singularity threshold: a coefficient that only the jitter determines has a pivot hardly above it.
constexpr double kSingularInJitters = 16;

constexpr double kLeastSmoothing = 1e-12;

const SplineBasis* Pointer(const std::optional<SplineBasis>& basis) {
  return basis ? &*basis : nullptr;
}

PointRows Turned(PointRows points) {
  std::swap(points.outer, points.inner);
  return points;
}

}  // namespace

PenalisedSystem::PenalisedSystem(const FittingProblem& problem, ThreadPool& pool)
    : PenalisedSystem(problem.basis_u(),
                      problem.is_curve() ? nullptr : &problem.basis_v(),
                      RowsOf(problem),
                      problem.energy(),
                      pool) {
  if (problem.is_curve()) return;
  ties_ = PoleTies(problem.basis_u(), problem.basis_v(), problem.poles(), u_outside_);
}

PenalisedSystem::PenalisedSystem(const SplineBasis& basis_u,
                                 const SplineBasis* basis_v,
                                 const Eigen::VectorXd& u,
                                 const Eigen::VectorXd& v,
                                 const Eigen::MatrixXd& values,
                                 const Eigen::VectorXd& weights,
                                 FairnessEnergy energy,
                                 ThreadPool& pool)
    : PenalisedSystem(basis_u, basis_v, RowsOf(u, v, values, weights), energy, pool) {}

PenalisedSystem::PenalisedSystem(const SplineBasis& basis_u,
                                 const SplineBasis* basis_v,
                                 const PointRows& points,
                                 FairnessEnergy energy,
                                 ThreadPool& pool)
    : u_outside_(!basis_v || basis_u.size() >= basis_v->size()),
      outer_(u_outside_ ? basis_u : *basis_v),
      inner_(basis_v ? std::optional<SplineBasis>(u_outside_ ? *basis_v : basis_u) : std::nullopt),
      outer_rows_(CoefficientOrder(outer_).Rows(outer_)),
      inner_rows_(DistinctIndices(Pointer(inner_))),
      inner_distinct_(inner_ ? DistinctCount(*inner_) : 1),
      equations_(outer_, Pointer(inner_), u_outside_ ? points : Turned(points), pool),
      fairness_(outer_, Pointer(inner_), energy),
      unit_(equations_.trace() / fairness_.Trace()),
      jitter_(4 * std::numeric_limits<double>::epsilon() * equations_.trace() / unknowns()) {}

BlockBandedMatrix PenalisedSystem::Matrix(double smoothing, double jitters) const {
  BlockBandedMatrix matrix = EmptyMatrix(outer_, Pointer(inner_));
  TensorBand band = equations_.band();
  if (smoothing > 0) fairness_.AddTo(band, smoothing * unit_);
  band.AddTo(matrix, outer_rows_, inner_rows_);
  if (jitters > 0) matrix.AddToDiagonal(jitters * jitter_);
  return matrix;
}

PenalisedSystem::Solution PenalisedSystem::Solve(double smoothing, ThreadPool* pool) const {
  const double asked = smoothing;
  for (int attempt = 0; attempt <= kAttempts; ++attempt) {
    TiedSystem matrix(Matrix(smoothing, JittersOf(attempt)), ties_);
    if (matrix.Factor(pool) && Determines(smoothing, matrix.SmallestPivot())) {
      Eigen::MatrixXd rows = rhs();
      matrix.Solve(rows);
      if (rows.allFinite()) {
        Solution solution{
            std::move(matrix), std::move(rows), Lambda(smoothing), smoothing != asked};
        // zᵀz − 2cᵀb + cᵀAc with (A + λP)c = b, so cᵀAc = cᵀb − λ cᵀPc.
        solution.residual_squares = squares() - solution.rows.cwiseProduct(rhs()).sum() -
                                    solution.lambda * Roughness(solution.rows);
        return solution;
      }
    }
    smoothing = Raised(smoothing);
  }
  throw std::invalid_argument(
      "the points do not determine the control points: too few carry weight, or the degree is too "
      "high for them");
}

double PenalisedSystem::JittersOf(int attempt) { return std::pow(30.0, std::max(0, attempt - 5)); }

double PenalisedSystem::Raised(double smoothing) {
  return std::max(10 * smoothing, kLeastSmoothing);
}

bool PenalisedSystem::Determines(double smoothing, double least_pivot, double margin) const {
  return smoothing >= kFirmSmoothing || least_pivot > margin * kSingularInJitters * jitter_;
}

double PenalisedSystem::Roughness(const Eigen::MatrixXd& rows) const {
  const Eigen::MatrixXd coefficients = InOuterOrder(rows);
  double energy = 0;
  for (Eigen::Index d = 0; d < rows.cols(); ++d) energy += fairness_.Energy(coefficients.col(d));
  return energy;
}

// The coefficients of the bases, outer-inner; repeated ones too.
Eigen::MatrixXd PenalisedSystem::InOuterOrder(const Eigen::MatrixXd& rows) const {
  Eigen::MatrixXd all(static_cast<Eigen::Index>(outer_rows_.size() * inner_rows_.size()),
                      rows.cols());
  Eigen::Index to = 0;
  for (const int i : outer_rows_) {
    for (const int j : inner_rows_) all.row(to++) = rows.row(i * inner_distinct_ + j);
  }
  return all;
}

Eigen::Index PenalisedSystem::RowOf(Eigen::Index coefficient) const {
  const auto size_v =
      static_cast<Eigen::Index>(u_outside_ ? inner_rows_.size() : outer_rows_.size());
  const Eigen::Index i = coefficient / size_v, j = coefficient % size_v;
  return outer_rows_[static_cast<size_t>(u_outside_ ? i : j)] * inner_distinct_ +
         inner_rows_[static_cast<size_t>(u_outside_ ? j : i)];
}

Eigen::MatrixXd PenalisedSystem::Net(const Eigen::MatrixXd& rows) const {
  const auto count = static_cast<Eigen::Index>(outer_rows_.size() * inner_rows_.size());
  Eigen::MatrixXd net(rows.cols(), count);
  for (Eigen::Index k = 0; k < count; ++k) net.col(k) = rows.row(RowOf(k)).transpose();
  return net;
}

}  // namespace batten::internal
