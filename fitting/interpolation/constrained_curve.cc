// SPDX-License-Identifier: MIT
#include "batten/fitting/constrained_curve.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include "fitting/linear/banded_lu.h"
#include "fitting/linear/coefficient_order.h"
#include "geometry/numeric/number_text.h"
#include "geometry/numeric/reject.h"

namespace batten {
using namespace internal;
namespace {

std::string NameOf(size_t index, const CurveCondition& condition) {
  const std::string what =
      condition.order == 0 ? "point" : "derivative of order " + std::to_string(condition.order);
  return "condition " + std::to_string(index + 1) + " (" + what +
         " at u = " + NumberText(condition.u) + ")";
}

void CheckSizes(const SplineBasis& basis,
                const Eigen::VectorXd& parameters,
                const Eigen::MatrixXd& values,
                const Eigen::VectorXd& weights,
                const std::vector<CurveCondition>& conditions) {
  const Eigen::Index m = parameters.size();
  if (values.cols() != m) {
    Reject("ConstrainedLeastSquares",
           std::to_string(m) + " parameters and " + std::to_string(values.cols()) +
               " values do not agree");
  }
  if (weights.size() != 0 && weights.size() != m) {
    Reject("ConstrainedLeastSquares",
           std::to_string(m) + " parameters and " + std::to_string(weights.size()) +
               " weights do not agree");
  }
  if (!parameters.allFinite() || !values.allFinite() || !weights.allFinite()) {
    Reject("ConstrainedLeastSquares", "a parameter, value or weight is not finite");
  }
  if (weights.size() > 0 && weights.minCoeff() < 0)
    Reject("ConstrainedLeastSquares", "a weight is negative");
  const auto inside = [&](double u) { return u >= basis.lower() && u <= basis.upper(); };
  for (Eigen::Index k = 0; k < m; ++k) {
    if (!inside(parameters[k])) {
      Reject("ConstrainedLeastSquares",
             "parameter " + NumberText(parameters[k]) + " leaves the domain");
    }
  }
  for (size_t i = 0; i < conditions.size(); ++i) {
    const CurveCondition& c = conditions[i];
    const std::string name = NameOf(i, c);
    if (!inside(c.u)) Reject("ConstrainedLeastSquares", name + " leaves the domain");
    if (c.order < 0 || c.order > basis.degree()) {
      Reject("ConstrainedLeastSquares", name + ": the order is not between 0 and the degree");
    }
    if (c.value.size() != values.rows() || !c.value.allFinite()) {
      Reject("ConstrainedLeastSquares",
             name + ": the value has not " + std::to_string(values.rows()) + " finite coordinates");
    }
    if (c.weight && !(*c.weight > 0 && std::isfinite(*c.weight))) {
      Reject("ConstrainedLeastSquares", name + ": the weight is not positive");
    }
  }
}

// A linear form of the control points: p + 1 of them in a row.
struct Form {
  int first;
  std::vector<double> values;
};

Form FormAt(const SplineBasis& basis, double u, int order) {
  const int p = basis.degree(), span = basis.Span(u);
  std::vector<double> values(static_cast<size_t>((order + 1) * (p + 1)));
  basis.Derivatives(span, u, order, values.data());
  values.erase(values.begin(), values.begin() + order * (p + 1));
  return {span - p, std::move(values)};
}

double LargestOf(const Form& form) {
  double most = 0;
  for (const double value : form.values) most = std::max(most, std::abs(value));
  return most;
}

// One term of the sum: what it measures, its value from the middle of the data, and its weight.
struct Observation {
  Form form;
  Eigen::VectorXd value;
  double weight;
};

struct ExactCondition {
  Form form;  // scaled so that the largest entry is 1
  Eigen::VectorXd value;
  size_t index;  // among the conditions given
};

// The unknowns, control points and multipliers, in an order in which the equations are banded:
// a condition's multiplier stands behind the middle of its control points. Periodic, the row of
// unknowns is a ring, dealt out from both sides.
class Places {
 public:
  Places(const SplineBasis& basis, const std::vector<ExactCondition>& exact)
      : distinct_(DistinctCount(basis)),
        size_(distinct_ + static_cast<Eigen::Index>(exact.size())),
        periodic_(basis.periodic()),
        control_(static_cast<size_t>(distinct_)),
        multiplier_(exact.size()) {
    std::vector<std::vector<size_t>> behind(static_cast<size_t>(distinct_));
    for (size_t j = 0; j < exact.size(); ++j) {
      behind[static_cast<size_t>((exact[j].form.first + basis.degree() / 2) % distinct_)].push_back(
          j);
    }
    Eigen::Index next = 0;
    for (size_t i = 0; i < control_.size(); ++i) {
      control_[i] = Dealt(next++);
      for (const size_t j : behind[i]) multiplier_[j] = Dealt(next++);
    }
  }

  Eigen::Index size() const { return size_; }
  Eigen::Index Control(int i) const { return control_[static_cast<size_t>(i % distinct_)]; }
  Eigen::Index Multiplier(size_t j) const { return multiplier_[j]; }

 private:
  Eigen::Index Dealt(Eigen::Index i) const { return periodic_ ? DealtPlace(i, size_) : i; }

  Eigen::Index distinct_, size_;
  bool periodic_;
  std::vector<Eigen::Index> control_, multiplier_;
};

// Checks independence of the exact conditions by elimination; a row that vanishes depends on those
// before it. Rows are over all different control points where the basis is periodic, over a window
// of them otherwise.
void CheckIndependent(const SplineBasis& basis,
                      const std::vector<ExactCondition>& exact,
                      const std::vector<CurveCondition>& conditions) {
  constexpr double kNothing = 1e-11;  // of rows whose largest entry is 1
  const int distinct = DistinctCount(basis);
  struct Row {
    int first, pivot;
    std::vector<double> values;
    int last() const { return first + static_cast<int>(values.size()) - 1; }
    double& at(int i) { return values[static_cast<size_t>(i - first)]; }
  };
  std::vector<size_t> order(exact.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    return exact[a].form.first < exact[b].form.first;
  });
  std::vector<Row> rows;
  for (const size_t j : order) {
    const Form& form = exact[j].form;
    Row row{form.first, 0, form.values};
    if (basis.periodic()) {
      row = {0, 0, std::vector<double>(static_cast<size_t>(distinct), 0.0)};
      for (size_t r = 0; r < form.values.size(); ++r) {
        row.at((form.first + static_cast<int>(r)) % distinct) += form.values[r];
      }
    } else {
      std::erase_if(rows, [&](const Row& earlier) { return earlier.last() < form.first; });
    }
    for (Row& earlier : rows) {
      if (earlier.pivot < row.first || row.at(earlier.pivot) == 0) continue;
      if (earlier.first < row.first) {
        row.values.insert(row.values.begin(), static_cast<size_t>(row.first - earlier.first), 0.0);
        row.first = earlier.first;
      }
      const double factor = row.at(earlier.pivot) / earlier.at(earlier.pivot);
      for (int i = earlier.first; i <= earlier.last(); ++i) row.at(i) -= factor * earlier.at(i);
      row.at(earlier.pivot) = 0;
    }
    const auto largest =
        std::max_element(row.values.begin(), row.values.end(), [](double a, double b) {
          return std::abs(a) < std::abs(b);
        });
    if (!(std::abs(*largest) > kNothing)) {
      Reject("ConstrainedLeastSquares",
             NameOf(exact[j].index, conditions[exact[j].index]) +
                 " follows from the other exact conditions or contradicts them");
    }
    row.pivot = row.first + static_cast<int>(largest - row.values.begin());
    rows.push_back(std::move(row));
  }
}

// The least-squares problem with its exact conditions, and its solution.
class Problem {
 public:
  Problem(const SplineBasis& basis,
          std::vector<Observation> observations,
          std::vector<ExactCondition> exact)
      : basis_(basis),
        observations_(std::move(observations)),
        exact_(std::move(exact)),
        places_(basis, exact_),
        scaling_(Scaling()),
        matrix_(Assembled()) {
    constexpr double kSingular = 4 * std::numeric_limits<double>::epsilon();
    const Eigen::Index stop = matrix_.Factor(kSingular);
    if (stop < places_.size()) {
      Reject("ConstrainedLeastSquares",
             "the points and conditions do not determine the control points near u = " +
                 NumberText(ParameterOf(stop)) +
                 ": there are too few of them there for this basis");
    }
  }

  // d × n. Iterative refinement by residuals of the data restores digits lost in the sums.
  Eigen::MatrixXd Solve(Eigen::Index dimension) {
    constexpr int kCorrections = 2;
    Eigen::MatrixXd unknowns = Eigen::MatrixXd::Zero(places_.size(), dimension);
    for (int round = 0; round <= kCorrections; ++round) {
      RightSides correction = scaling_.asDiagonal() * RightHandSide(unknowns);
      matrix_.Solve(correction);
      unknowns += scaling_.asDiagonal() * correction;
    }
    Eigen::MatrixXd control(dimension, basis_.size());
    for (int i = 0; i < basis_.size(); ++i) {
      control.col(i) = unknowns.row(places_.Control(i)).transpose();
    }
    return control;
  }

 private:
  BandedLu Assembled() {
    const int p = basis_.degree();
    Eigen::Index band = 0;
    const auto widen = [&](Eigen::Index a, Eigen::Index b) {
      band = std::max(band, std::abs(a - b));
    };
    std::vector<bool> seen(static_cast<size_t>(basis_.size()), false);
    for (const Observation& o : observations_) {
      if (seen[static_cast<size_t>(o.form.first)]) continue;
      seen[static_cast<size_t>(o.form.first)] = true;
      for (int r = 0; r <= p; ++r) {
        for (int s = 0; s < r; ++s) {
          widen(places_.Control(o.form.first + r), places_.Control(o.form.first + s));
        }
      }
    }
    for (size_t j = 0; j < exact_.size(); ++j) {
      for (int r = 0; r <= p; ++r) {
        widen(places_.Multiplier(j), places_.Control(exact_[j].form.first + r));
      }
    }
    BandedLu matrix(places_.size(), band, band);
    for (const Observation& o : observations_) {
      for (int r = 0; r <= p; ++r) {
        const Eigen::Index row = places_.Control(o.form.first + r);
        const double factor = o.weight * scaling_[row] * o.form.values[static_cast<size_t>(r)];
        for (int s = 0; s <= p; ++s) {
          const Eigen::Index column = places_.Control(o.form.first + s);
          matrix.at(row, column) +=
              factor * scaling_[column] * o.form.values[static_cast<size_t>(s)];
        }
      }
    }
    for (size_t j = 0; j < exact_.size(); ++j) {
      const Eigen::Index row = places_.Multiplier(j);
      for (int r = 0; r <= p; ++r) {
        const Eigen::Index column = places_.Control(exact_[j].form.first + r);
        const double value =
            scaling_[row] * scaling_[column] * exact_[j].form.values[static_cast<size_t>(r)];
        matrix.at(row, column) += value;
        matrix.at(column, row) += value;
      }
    }
    return matrix;
  }

  // Scale of every unknown: the sums get ones on their diagonal, conditions a largest entry of one.
  Eigen::VectorXd Scaling() const {
    Eigen::VectorXd squares = Eigen::VectorXd::Zero(places_.size());
    for (const Observation& o : observations_) {
      for (size_t r = 0; r < o.form.values.size(); ++r) {
        squares[places_.Control(o.form.first + static_cast<int>(r))] +=
            o.weight * o.form.values[r] * o.form.values[r];
      }
    }
    const double most = squares.maxCoeff();
    Eigen::VectorXd scaling(places_.size());
    for (Eigen::Index i = 0; i < scaling.size(); ++i) {
      const double square = squares[i] > 0 ? squares[i] : most > 0 ? most : 1;
      scaling[i] = 1 / std::sqrt(square);
    }
    for (size_t j = 0; j < exact_.size(); ++j) {
      double largest = 0;
      for (size_t r = 0; r < exact_[j].form.values.size(); ++r) {
        const Eigen::Index i = places_.Control(exact_[j].form.first + static_cast<int>(r));
        largest = std::max(largest, std::abs(scaling[i] * exact_[j].form.values[r]));
      }
      scaling[places_.Multiplier(j)] = 1 / largest;
    }
    return scaling;
  }

  // The residual of the equations.
  Eigen::MatrixXd RightHandSide(const Eigen::MatrixXd& unknowns) const {
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(unknowns.rows(), unknowns.cols());
    const auto value_of = [&](const Form& form) {
      Eigen::VectorXd value = Eigen::VectorXd::Zero(unknowns.cols());
      for (size_t r = 0; r < form.values.size(); ++r) {
        value += form.values[r] *
                 unknowns.row(places_.Control(form.first + static_cast<int>(r))).transpose();
      }
      return value;
    };
    const auto add = [&](const Form& form, const Eigen::VectorXd& value) {
      for (size_t r = 0; r < form.values.size(); ++r) {
        result.row(places_.Control(form.first + static_cast<int>(r))) +=
            form.values[r] * value.transpose();
      }
    };
    for (const Observation& o : observations_) {
      add(o.form, o.weight * (o.value - value_of(o.form)));
    }
    for (size_t j = 0; j < exact_.size(); ++j) {
      const Eigen::Index at = places_.Multiplier(j);
      add(exact_[j].form, -unknowns.row(at).transpose());
      result.row(at) = (exact_[j].value - value_of(exact_[j].form)).transpose();
    }
    return result;
  }

  // The parameter at which the control point at this place acts most.
  double ParameterOf(Eigen::Index place) const {
    Eigen::Index nearest = 0;
    for (int i = 0; i < basis_.size(); ++i) {
      if (std::abs(places_.Control(i) - place) <
          std::abs(places_.Control(static_cast<int>(nearest)) - place)) {
        nearest = i;
      }
    }
    return basis_.Clamp(basis_.Greville(static_cast<int>(nearest)));
  }

  const SplineBasis& basis_;
  std::vector<Observation> observations_;
  std::vector<ExactCondition> exact_;
  Places places_;
  Eigen::VectorXd scaling_;
  BandedLu matrix_;
};

}  // namespace

Eigen::MatrixXd ConstrainedLeastSquares(const SplineBasis& basis,
                                        const Eigen::VectorXd& parameters,
                                        const Eigen::MatrixXd& values,
                                        const Eigen::VectorXd& weights,
                                        const std::vector<CurveCondition>& conditions) {
  CheckSizes(basis, parameters, values, weights, conditions);
  // Values are relative to the middle of the data, so that large coordinates cost no digits.
  Eigen::VectorXd middle = Eigen::VectorXd::Zero(values.rows());
  if (values.cols() > 0) {
    const Eigen::VectorXd low = values.rowwise().minCoeff();
    middle = low + (values.rowwise().maxCoeff() - low) / 2;
  }
  std::vector<Observation> observations;
  std::vector<ExactCondition> exact;
  for (Eigen::Index k = 0; k < parameters.size(); ++k) {
    const double weight = weights.size() > 0 ? weights[k] : 1;
    if (weight == 0) continue;
    observations.push_back({FormAt(basis, parameters[k], 0), values.col(k) - middle, weight});
  }
  for (size_t i = 0; i < conditions.size(); ++i) {
    const CurveCondition& c = conditions[i];
    Form form = FormAt(basis, c.u, c.order);
    Eigen::VectorXd value = c.order == 0 ? Eigen::VectorXd(c.value - middle) : c.value;
    if (c.weight) {
      observations.push_back({std::move(form), std::move(value), *c.weight});
      continue;
    }
    const double largest = LargestOf(form);
    for (double& entry : form.values) entry /= largest;
    exact.push_back({std::move(form), value / largest, i});
  }
  CheckIndependent(basis, exact, conditions);
  return Problem(basis, std::move(observations), std::move(exact)).Solve(values.rows()).colwise() +
         middle;
}

}  // namespace batten
