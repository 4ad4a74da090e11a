// SPDX-License-Identifier: MIT
// The interior knots of a basis seen as logarithms of the gaps between them. Used by the free-knot
// search only.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "batten/geometry/spline_basis.h"

namespace batten::internal {

// Longest change of the logarithm of a gap in one step: two multiplies a gap by seven, the limit of
// trust.
inline constexpr double kFarthestLogGap = 2;

// Interior knots t_1 < … < t_k, each with a multiplicity that it keeps, in a domain [a, b] of
// length L, and the k + 1 gaps h_0 … h_k between them and the domain's ends. The variables are
// x_i = log h_i − mean log h: any x of mean zero stands for a valid knot vector,
//   h_i = L e^{x_i} / Σ_l e^{x_l},   t_j = a + h_0 + … + h_{j−1},
// knots cannot pass each other, and the common scale of the e^{x_i}, which changes nothing, is
// fixed. Knots outside the open domain stay. [Jupp 1978, "Approximation to data by splines with
// free knots", §3, with the gauge in the mean instead of in the first gap]
class KnotGaps {
 public:
  // Exactly equal interior knots are one group.
  explicit KnotGaps(SplineBasis basis);

  const SplineBasis& basis() const { return basis_; }
  int groups() const { return static_cast<int>(first_.size()); }          // k
  int multiplicity(int group) const { return multiplicity_[group]; }      // 1 … degree
  double knot(int group) const { return basis_.knots()[first_[group]]; }  // t_{group+1}
  double length() const { return basis_.upper() - basis_.lower(); }       // L
  std::vector<double> Gaps() const;                                       // h_0 … h_k

  // The group that knot index i of the basis belongs to, −1 for those that stay. One entry a knot.
  std::vector<int> GroupOfKnots() const;

  Eigen::VectorXd Variables() const;  // x, k + 1 of them

  // The same groups at other variables (of any mean); nothing if a gap is less than 1e-13 of the
  // domain, where knots round, or not a number.
  std::optional<KnotGaps> At(const Eigen::VectorXd& variables) const;

  // ∂t/∂x, k × (k+1), at the present knots.
  Eigen::MatrixXd Derivatives() const;

  // Merges groups `group` and `group` + 1 into one, at the mean of their knots; nothing if their
  // multiplicities add up to more than the degree. Requires 0 ≤ group < groups() − 1.
  std::optional<KnotGaps> Merged(int group) const;

  // The left group of the narrowest gap between two groups that may be merged, or −1.
  int NarrowestMergeable() const;

  // Merges all groups nearer than `gap`, as far as the degree allows.
  KnotGaps Coalesced(double gap) const;

 private:
  SplineBasis basis_;
  std::vector<int> first_, multiplicity_;
};

}  // namespace batten::internal
