// SPDX-License-Identifier: MIT
// The penalised least-squares problem of a spline curve or surface at given parameters.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <optional>

#include "batten/fitting/fairness_energy.h"
#include "batten/fitting/point_rows.h"
#include "batten/fitting/poles.h"
#include "batten/geometry/spline_basis.h"
#include "batten/geometry/thread_pool.h"

namespace batten {

// The data to approximate: value k (d components) at parameters column k, with a weight.
struct FittingData {
  Eigen::Matrix2Xd parameters;  // (u, v); curves: (u, 0)
  Eigen::MatrixXd values;       // d × m: heights over a base (d = 1) or points (d = 2, 3)
  Eigen::VectorXd weights;      // empty: ones
};

// Bases, data and fairness energy, which determine the control points. Minimises
//   Σ w |S(u_k,v_k) − z_k|² + λ ∫∫ S_uu² + 2 S_uv² + S_vv²,   λ = smoothing · tr(A)/tr(P),
// or another energy, A the normal matrix and P that of the energy, so that `smoothing` means the
// same at every number of points and in every unit. A curve has one basis. Data are shared between
// problems that differ in their bases. Over a periodic basis the shape is closed and as smooth at
// the seam as elsewhere; a surface's poles are conditions that every linear solution meets.
class FittingProblem {
 public:
  // Throws std::invalid_argument unless sizes agree, parameters lie in the bases' domains,
  // everything is finite, weights are not negative and smoothing is not negative.
  FittingProblem(SplineBasis basis_u,
                 SplineBasis basis_v,
                 std::shared_ptr<const FittingData> data,
                 double smoothing);

  // A curve's problem.
  FittingProblem(SplineBasis basis, std::shared_ptr<const FittingData> data, double smoothing);

  // The problem with the same data over other bases on the same domain, or with other weights.
  FittingProblem WithBases(SplineBasis basis_u, SplineBasis basis_v) const;
  FittingProblem WithBasis(SplineBasis basis) const;  // of a curve
  FittingProblem WithWeights(Eigen::VectorXd weights) const;
  FittingProblem WithParameters(Eigen::Matrix2Xd parameters) const;
  FittingProblem WithSmoothing(double smoothing) const;
  FittingProblem WithEnergy(FairnessEnergy energy) const;  // thin plate unless said
  // The problem of a surface open in v, with conditions at its poles. Throws std::invalid_argument
  // unless the angle about poles is positive.
  FittingProblem WithPoles(const Poles& poles) const;
  FittingProblem WithData(std::shared_ptr<const FittingData> data) const;

  bool is_curve() const { return !basis_v_; }
  const SplineBasis& basis_u() const { return basis_u_; }
  const SplineBasis& basis_v() const { return basis_v_.value(); }  // surfaces only
  const FittingData& data() const { return *data_.data; }
  const std::shared_ptr<const FittingData>& shared_data() const { return data_.data; }
  double smoothing() const { return smoothing_; }
  FairnessEnergy energy() const { return energy_; }
  const Poles& poles() const { return poles_; }
  Eigen::Index size() const { return data_.data->parameters.cols(); }
  int net_size() const { return basis_u_.size() * (basis_v_ ? basis_v_->size() : 1); }
  // The number of distinct control points, less the conditions on them: periodic bases repeat some,
  // poles tie some together.
  int unknowns() const;

 private:
  // Data of agreeing sizes, finite, with weights that are not negative, and the box of their
  // parameters (empty without points).
  struct CheckedData {
    std::shared_ptr<const FittingData> data;
    Eigen::AlignedBox2d box;
  };
  static CheckedData Check(std::shared_ptr<const FittingData> data);

  FittingProblem(SplineBasis basis_u,
                 std::optional<SplineBasis> basis_v,
                 CheckedData data,
                 double smoothing,
                 FairnessEnergy energy,
                 const Poles& poles);

  SplineBasis basis_u_;
  std::optional<SplineBasis> basis_v_;
  CheckedData data_;
  double smoothing_ = 0;
  FairnessEnergy energy_ = FairnessEnergy::kThinPlate;
  Poles poles_;
};

// A view of the problem's points with the parameters of u and v, valid as long as its data live.
PointRows RowsOf(const FittingProblem& problem);

// Values of a coefficient net at the problem's parameters: d × m.
Eigen::MatrixXd EvaluateAt(const FittingProblem& problem,
                           const Eigen::MatrixXd& coefficients,
                           ThreadPool& pool);

}  // namespace batten
