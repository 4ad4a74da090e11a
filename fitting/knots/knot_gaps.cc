// SPDX-License-Identifier: MIT
#include "fitting/knots/knot_gaps.h"

#include <cmath>
#include <utility>

namespace batten::internal {
namespace {

// Share of the domain: a smaller gap is rounding of the knots.
constexpr double kLeastGap = 1e-13;

}  // namespace

KnotGaps::KnotGaps(SplineBasis basis) : basis_(std::move(basis)) {
  const std::vector<double>& knots = basis_.knots();
  for (int i = basis_.degree() + 1; i < basis_.size(); ++i) {
    if (knots[i] <= basis_.lower() || knots[i] >= basis_.upper()) continue;
    if (!first_.empty() && knots[first_.back()] == knots[i]) {
      ++multiplicity_.back();
    } else {
      first_.push_back(i);
      multiplicity_.push_back(1);
    }
  }
}

std::vector<double> KnotGaps::Gaps() const {
  std::vector<double> gaps;
  double last = basis_.lower();
  for (int g = 0; g < groups(); ++g) {
    gaps.push_back(knot(g) - last);
    last = knot(g);
  }
  gaps.push_back(basis_.upper() - last);
  return gaps;
}

std::vector<int> KnotGaps::GroupOfKnots() const {
  std::vector<int> group_of(basis_.knots().size(), -1);
  for (int g = 0; g < groups(); ++g) {
    for (int i = 0; i < multiplicity_[g]; ++i) group_of[first_[g] + i] = g;
  }
  return group_of;
}

Eigen::VectorXd KnotGaps::Variables() const {
  const std::vector<double> gaps = Gaps();
  Eigen::VectorXd x(static_cast<Eigen::Index>(gaps.size()));
  for (Eigen::Index i = 0; i < x.size(); ++i) x[i] = std::log(gaps[i]);
  return x.array() - x.mean();
}

std::optional<KnotGaps> KnotGaps::At(const Eigen::VectorXd& variables) const {
  if (!variables.allFinite()) return std::nullopt;
  const Eigen::VectorXd shares = (variables.array() - variables.maxCoeff()).exp();
  const double sum = shares.sum();
  std::vector<double> knots = basis_.knots();
  double before = 0, last = basis_.lower();
  for (int g = 0; g < groups(); ++g) {
    before += shares[g];
    const double t = basis_.lower() + length() * (before / sum);
    if (!(t - last > kLeastGap * length()) || !(basis_.upper() - t > kLeastGap * length()))
      return std::nullopt;
    for (int i = 0; i < multiplicity_[g]; ++i) knots[first_[g] + i] = t;
    last = t;
  }
  return KnotGaps(SplineBasis(basis_.degree(), std::move(knots)));
}

// With s_i = h_i/L: ∂h_l/∂x_i = L s_l (δ_li − s_i), and t_j sums the h_l of l < j.
Eigen::MatrixXd KnotGaps::Derivatives() const {
  const std::vector<double> gaps = Gaps();
  Eigen::MatrixXd derivatives(groups(), groups() + 1);
  for (int g = 0; g < groups(); ++g) {
    const double share = (knot(g) - basis_.lower()) / length();
    for (int i = 0; i <= groups(); ++i)
      derivatives(g, i) = gaps[i] * ((i <= g ? 1.0 : 0.0) - share);
  }
  return derivatives;
}

std::optional<KnotGaps> KnotGaps::Merged(int group) const {
  const int left = multiplicity_[group], right = multiplicity_[group + 1];
  if (left + right > basis_.degree()) return std::nullopt;
  const double t =
      knot(group) + (knot(group + 1) - knot(group)) * (static_cast<double>(right) / (left + right));
  std::vector<double> knots = basis_.knots();
  for (int i = 0; i < left + right; ++i) knots[first_[group] + i] = t;
  return KnotGaps(SplineBasis(basis_.degree(), std::move(knots)));
}

int KnotGaps::NarrowestMergeable() const {
  int narrowest = -1;
  double least = 0;
  for (int g = 0; g + 1 < groups(); ++g) {
    if (multiplicity_[g] + multiplicity_[g + 1] > basis_.degree()) continue;
    const double gap = knot(g + 1) - knot(g);
    if (narrowest < 0 || gap < least) {
      narrowest = g;
      least = gap;
    }
  }
  return narrowest;
}

KnotGaps KnotGaps::Coalesced(double gap) const {
  KnotGaps merged = *this;
  for (;;) {
    const int g = merged.NarrowestMergeable();
    if (g < 0 || !(merged.knot(g + 1) - merged.knot(g) < gap)) return merged;
    merged = *merged.Merged(g);
  }
}

}  // namespace batten::internal
