// SPDX-License-Identifier: MIT
// The displacement of a shape along its normal as a linear function of what a fit freed.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <optional>
#include <vector>

#include "batten/fitting/fit_estimator.h"
#include "fitting/uncertainty/selected_inverse.h"
#include "fitting/uncertainty/spline_shape.h"

namespace batten::internal {

// Unknowns: one displacement along the normal for each control point that is free (those repeated
// over a period are one, those of poles are tied, those of held edges are none), then logarithms of
// weights and places of knots, where they were freed.
class DisplacementRows {
 public:
  DisplacementRows(SplineShape shape, const FitEstimator& estimator);

  const SplineShape& shape() const { return shape_; }
  int unknowns() const { return unknowns_; }
  // Unknowns from here on are weights, from there on knots.
  int first_weight() const { return first_weight_; }
  int first_knot() const { return first_knot_; }
  // The shorter gap beside each free knot.
  const std::vector<double>& knot_gaps() const { return gaps_; }

  // ν(u, v) = Σ row · unknowns. Sorted by index.
  SparseRow At(double u, double v) const;

  // Fairness as a form in all coefficients, and the map Z from unknowns to these.
  Eigen::SparseMatrix<double> Fairness(FairnessEnergy energy) const;
  Eigen::SparseMatrix<double> Map() const;

 private:
  struct FreeKnot {
    bool in_u;
    int index;               // in the knot vector
    SplineShape less, more;  // with the knot moved by the step
    double step;
  };
  void MapCoefficients(const FitEstimator& estimator);
  void TiePoles(const Poles& poles);
  void FreeKnotsOf(bool in_u);

  SplineShape shape_;
  std::vector<SparseRow> map_;  // of each coefficient
  std::vector<FreeKnot> knots_;
  std::vector<double> gaps_;
  std::vector<int> weight_;  // unknown of each weight; −1: none
  int unknowns_ = 0, first_weight_ = 0, first_knot_ = 0;
};

}  // namespace batten::internal
