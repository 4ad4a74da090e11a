// SPDX-License-Identifier: MIT
#include "fitting/revolution/base_profile.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/solve_linear.h"
#include "fitting/core/rounding.h"
#include "fitting/core/shared_constants.h"
#include "fitting/neighbours/nearest_sample.h"

namespace batten::internal {
namespace {

constexpr int kDegree = 3;
constexpr int kSamplesASpan = 8;

SplineBasis BasisOf(double range, int spans, bool closed) {
  if (!closed) return SplineBasis::Uniform(kDegree, spans + kDegree, 0, range);
  std::vector<double> knots;
  for (int i = -kDegree; i <= spans + kDegree; ++i) knots.push_back(range * i / spans);
  return SplineBasis::Periodic(kDegree, std::move(knots));
}

// Arc length ∫ |C'| over [0, t] of a span, by the Gauss rule with five nodes.
double ArcOf(const Eigen::Matrix<double, 2, 4>& c, double t) {
  constexpr double kNodes[] = {
      0.04691007703066802, 0.23076534494715845, 0.5, 0.7692346550528415, 0.9530899229693319};
  constexpr double kWeights[] = {0.11846344252809454,
                                 0.23931433524968324,
                                 0.28444444444444444,
                                 0.23931433524968324,
                                 0.11846344252809454};
  double sum = 0;
  for (int g = 0; g < 5; ++g) {
    const double x = kNodes[g] * t;
    const double r = c(0, 1) + x * (2 * c(0, 2) + x * 3 * c(0, 3));
    const double z = c(1, 1) + x * (2 * c(1, 2) + x * 3 * c(1, 3));
    sum += kWeights[g] * std::sqrt(r * r + z * z);
  }
  return sum * t;
}

}  // namespace

BaseProfile::BaseProfile(const Eigen::Matrix2Xd& places,
                         const Eigen::VectorXd& parameters,
                         const Eigen::VectorXd& weights,
                         double range,
                         int spans,
                         bool closed,
                         ThreadPool& pool)
    : range_(range), width_(range / spans), closed_(closed) {
  const SplineBasis basis = BasisOf(range, spans, closed);
  auto data = std::make_shared<FittingData>();
  data->parameters = Eigen::Matrix2Xd::Zero(2, places.cols());
  data->parameters.row(0) = parameters.transpose();
  data->values = places;
  data->weights = weights;
  const Eigen::MatrixXd points =
      SolveLinear(FittingProblem(basis, std::move(data), kSurfaceSmoothing), pool).coefficients;
  for (const int span : basis.Spans()) {
    double values[4 * (kDegree + 1)];
    basis.Derivatives(span, basis.knots()[span], kDegree, values);
    Eigen::Matrix<double, 2, 4> powers;
    double factorial = 1;
    for (int k = 0; k <= kDegree; ++k) {
      if (k > 1) factorial *= k;
      const Eigen::Map<const Eigen::Vector4d> row(values + k * (kDegree + 1));
      powers.col(k) = points.middleCols<kDegree + 1>(span - kDegree) * row / factorial;
    }
    spans_.push_back(powers);
  }
  lengths_.push_back(0);
  for (const auto& powers : spans_) lengths_.push_back(lengths_.back() + ArcOf(powers, width_));
  const int count = spans * kSamplesASpan;
  sample_step_ = range_ / count;
  const Eigen::Index samples = closed ? count : count + 1;
  samples_.setConstant((samples + kSampleLanes - 1) / kSampleLanes * kSampleLanes, 2, HUGE_VAL);
  for (Eigen::Index i = 0; i < samples; ++i) {
    samples_.row(i) = At(sample_step_ * static_cast<double>(i)).place.transpose();
  }
}

int BaseProfile::SpanOf(double s) const {
  return std::clamp(static_cast<int>(s / width_), 0, static_cast<int>(spans_.size()) - 1);
}

BaseProfile::Jet BaseProfile::At(double s) const {
  const int span = SpanOf(s);
  const double t = s - width_ * span;
  const Eigen::Matrix<double, 2, 4>& c = spans_[span];
  return {c.col(0) + t * (c.col(1) + t * (c.col(2) + t * c.col(3))),
          c.col(1) + t * (2 * c.col(2) + t * 3 * c.col(3)),
          2 * c.col(2) + t * 6 * c.col(3)};
}

double BaseProfile::Foot(const Eigen::Vector2d& place) const {
  const Eigen::Index nearest = NearestSample(
      samples_.col(0).data(), samples_.col(1).data(), samples_.rows(), place[0], place[1]);
  constexpr int kMostSteps = 8;
  double s = sample_step_ * static_cast<double>(nearest);
  for (int step = 0; step < kMostSteps; ++step) {
    const Jet jet = At(s);
    const Eigen::Vector2d off = jet.place - place;
    const double speed = jet.first.squaredNorm();
    const double bend = speed + off.dot(jet.second);
    const double slope = bend > 0.1 * speed ? bend : speed;
    if (!(slope > 0)) break;
    const double move =
        std::clamp(-off.dot(jet.first) / slope, -2 * sample_step_, 2 * sample_step_);
    s += move;
    if (closed_) {
      s -= range_ * std::floor(s / range_);
    } else {
      s = std::clamp(s, 0.0, range_);
    }
    // The next step would be of its square.
    if (std::abs(move) <= kRelativelyEqual * range_) break;
  }
  return s;
}

double BaseProfile::Length(double s) const {
  const int span = SpanOf(s);
  return lengths_[span] + ArcOf(spans_[span], s - width_ * span);
}

}  // namespace batten::internal
