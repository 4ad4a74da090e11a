// SPDX-License-Identifier: MIT
#include "fitting/joint/moved_terms.h"

#include <utility>

namespace batten::internal {
namespace {

class MovedTerm : public ResidualTerm {
 public:
  MovedTerm(std::shared_ptr<const ResidualTerm> term, Eigen::VectorXd offset)
      : term_(std::move(term)), offset_(std::move(offset)) {}

  int residuals() const override { return term_->residuals(); }
  std::vector<int> ControlPoints() const override { return term_->ControlPoints(); }
  std::vector<int> Weights() const override { return term_->Weights(); }
  bool needs_knots() const override { return term_->needs_knots(); }

  bool Evaluate(std::span<const double> values,
                std::span<double> residual,
                std::span<double> jacobian) const override {
    std::vector<double> moved(values.begin(), values.end());
    const auto points = static_cast<Eigen::Index>(term_->ControlPoints().size());
    Eigen::Map<Eigen::MatrixXd>(moved.data(), offset_.size(), points).colwise() += offset_;
    return term_->Evaluate(moved, residual, jacobian);
  }

 private:
  std::shared_ptr<const ResidualTerm> term_;
  Eigen::VectorXd offset_;
};

}  // namespace

ResidualTerms MovedTerms(ResidualTerms terms, const Eigen::VectorXd& offset) {
  if (offset.isZero(0)) return terms;
  for (std::shared_ptr<const ResidualTerm>& term : terms)
    if (term) term = std::make_shared<MovedTerm>(std::move(term), offset);
  return terms;
}

}  // namespace batten::internal
