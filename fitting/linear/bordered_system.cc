// SPDX-License-Identifier: MIT
#include "fitting/linear/bordered_system.h"

#include <limits>

#include "geometry/numeric/dense_solvers.h"

namespace batten::internal {
namespace {

// Solves after scaling to a unit diagonal; a few units of rounding on it keep undetermined unknowns
// finite.
class ScaledFactor {
 public:
  explicit ScaledFactor(const Eigen::MatrixXd& matrix)
      : scale_(matrix.diagonal().unaryExpr([](double d) { return d > 0 ? 1 / std::sqrt(d) : 1; })) {
    Eigen::MatrixXd scaled = scale_.asDiagonal() * matrix * scale_.asDiagonal();
    scaled.diagonal().array() +=
        4 * static_cast<double>(matrix.rows()) * std::numeric_limits<double>::epsilon();
    factor_ = SymmetricFactor(scaled);
  }

  Eigen::MatrixXd Solve(const Eigen::MatrixXd& right) const {
    return scale_.asDiagonal() * factor_.Solve(scale_.asDiagonal() * right);
  }

 private:
  Eigen::VectorXd scale_;
  SymmetricFactor factor_;
};

}  // namespace

BorderedSolution Solve(const BorderedSystem& system, const BlockBandedMatrix& factor) {
  const Eigen::Index unknowns = system.corner.rows(), conditions = system.condition_right.size();
  Eigen::MatrixXd free = system.right;  // A⁻¹ f
  factor.Solve(free);
  Eigen::MatrixXd reach = system.functionals;  // A⁻¹ φ
  if (reach.cols() > 0) factor.Solve(reach);
  std::array<Eigen::MatrixXd, 3> pushed;  // A⁻¹ B
  Eigen::MatrixXd corner = system.corner, asked = system.condition_rows;
  Eigen::VectorXd corner_right = system.corner_right, missing = system.condition_right;
  const auto functional = [&](Eigen::Index k) { return system.functional[static_cast<size_t>(k)]; };
  for (int d = 0; d < 3; ++d) {
    pushed[d] = system.border[d];
    if (unknowns > 0) factor.Solve(pushed[d]);
    corner -= system.border[d].transpose() * pushed[d];
    corner_right -= system.border[d].transpose() * free.col(d);
    const Eigen::MatrixXd through = reach.transpose() * system.border[d];
    const Eigen::VectorXd values = system.functionals.transpose() * free.col(d);
    for (Eigen::Index k = 0; k < conditions; ++k) {
      if (functional(k) < 0) continue;
      asked.row(k) -= system.directions(d, k) * through.row(functional(k));
      missing[k] -= system.directions(d, k) * values[functional(k)];
    }
  }
  const ScaledFactor corner_factor(corner);
  Eigen::VectorXd t = corner_factor.Solve(corner_right), multipliers(conditions);
  if (conditions > 0) {
    const Eigen::MatrixXd products = system.functionals.transpose() * reach;
    const Eigen::MatrixXd answer = corner_factor.Solve(asked.transpose());
    Eigen::MatrixXd middle = asked * answer;
    for (Eigen::Index a = 0; a < conditions; ++a) {
      for (Eigen::Index b = 0; b < conditions; ++b) {
        if (functional(a) < 0 || functional(b) < 0) continue;
        middle(a, b) += system.directions.col(a).dot(system.directions.col(b)) *
                        products(functional(a), functional(b));
      }
    }
    multipliers = ScaledFactor(middle).Solve(missing - asked * t);
    t += answer * multipliers;
  }
  BorderedSolution solution{free, t};
  for (int d = 0; d < 3; ++d) {
    solution.inner.col(d) -= pushed[d] * t;
    for (Eigen::Index k = 0; k < conditions; ++k) {
      if (functional(k) < 0) continue;
      solution.inner.col(d) += system.directions(d, k) * multipliers[k] * reach.col(functional(k));
    }
  }
  return solution;
}

}  // namespace batten::internal
