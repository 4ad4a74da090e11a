// SPDX-License-Identifier: MIT
// A user's own term in the joint optimisation.
#pragma once

#include <memory>
#include <span>
#include <vector>

namespace batten {

// A least-squares term ½·|r|² beside the distances of the points: symmetry, a volume, a neighbour
// to join, a place to pass. It names the unknowns it looks at and is handed their values one after
// the other: the coordinates of its control points, then its weights, then, if it asks, all knots
// of the u and of the v basis. It writes residuals and their derivatives. Whether an unknown is
// free or fixed is none of its business: of what is fixed the derivatives are not used. A scale
// that suits: a residual of the data's unit counts as much as the distance of one point of
// weight 1.
class ResidualTerm {
 public:
  virtual ~ResidualTerm() = default;

  virtual int residuals() const = 0;                   // ≥ 1
  virtual std::vector<int> ControlPoints() const = 0;  // indices, v fastest; no index twice
  virtual std::vector<int> Weights() const { return {}; }
  virtual bool needs_knots() const { return false; }

  // `jacobian` is empty or has residuals() × values.size() entries, row by row. Returns whether the
  // term can be evaluated there; where not, the step is refused. Called from several threads at
  // once; must neither throw nor remember.
  virtual bool Evaluate(std::span<const double> values,
                        std::span<double> residual,
                        std::span<double> jacobian) const = 0;
};

using ResidualTerms = std::vector<std::shared_ptr<const ResidualTerm>>;

}  // namespace batten
