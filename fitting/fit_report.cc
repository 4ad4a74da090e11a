// SPDX-License-Identifier: MIT
#include "batten/fitting/fit_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "batten/fitting/statistics.h"

namespace batten {
const char* Name(Termination termination) {
  switch (termination) {
    case Termination::kToleranceReached:
      return "tolerance_reached";
    case Termination::kNoiseReached:
      return "noise_reached";
    case Termination::kMaxControlPoints:
      return "max_control_points";
    case Termination::kMaxIterations:
      return "max_iterations";
    case Termination::kStalled:
      return "stalled";
    case Termination::kCancelled:
      return "cancelled";
  }
  return "";
}

ErrorSummary Summarise(const Eigen::VectorXd& signed_distances,
                       std::optional<double> tolerance,
                       const Eigen::Array<bool, Eigen::Dynamic, 1>& mask) {
  std::vector<double> values;
  values.reserve(static_cast<size_t>(signed_distances.size()));
  for (Eigen::Index k = 0; k < signed_distances.size(); ++k) {
    if (mask.size() == 0 || mask[k]) values.push_back(signed_distances[k]);
  }
  ErrorSummary result;
  result.tolerance = tolerance;
  result.points = static_cast<Eigen::Index>(values.size());
  if (values.empty()) return result;
  result.signed_p5 = QuantileInPlace(values, 0.05);
  result.signed_p95 = QuantileInPlace(values, 0.95);
  double sum = 0, squares = 0;
  for (double& value : values) {
    value = std::abs(value);
    sum += value;
    squares += value * value;
    result.max = std::max(result.max, value);
    if (tolerance && value > *tolerance) ++result.out_of_tolerance;
  }
  const double count = static_cast<double>(values.size());
  result.mean = sum / count;
  result.rms = std::sqrt(squares / count);
  result.within_tolerance = 1 - static_cast<double>(result.out_of_tolerance) / count;
  result.p50 = QuantileInPlace(values, 0.50);
  result.p95 = QuantileInPlace(values, 0.95);
  result.p99 = QuantileInPlace(values, 0.99);
  return result;
}

const ErrorSummary& FitReport::judged_error() const {
  return judged_at_parameters ? parameter_error.value() : error;
}

std::optional<bool> FitReport::tolerance_reached() const {
  const ErrorSummary& judged = judged_error();
  if (!judged.tolerance) return std::nullopt;
  return judged.out_of_tolerance == 0;
}

void FitReport::Join(const FitReport& other) {
  const auto append = [](auto& list, const auto& more) {
    list.insert(list.end(), more.begin(), more.end());
  };
  append(geometry.control_points, other.geometry.control_points);
  append(geometry.closed, other.geometry.closed);
  append(iterations, other.iterations);
  append(warnings, other.warnings);
  geometry.rational = geometry.rational || other.geometry.rational;
  geometry.count += other.geometry.count;
  input.used += other.input.used;
  input.duplicates += other.input.duplicates;
  input.spacing = std::max(input.spacing, other.input.spacing);
  input.noise = std::max(input.noise, other.input.noise);
  seconds.parameterize += other.seconds.parameterize;
  seconds.solve += other.seconds.solve;
  seconds.project += other.seconds.project;
  seconds.refine += other.seconds.refine;
  seconds.optimize += other.seconds.optimize;
  seconds.total += other.seconds.total;
  optimize.ran = optimize.ran || other.optimize.ran;
  optimize.iterations += other.optimize.iterations;
  termination = std::max(termination, other.termination);
}

std::string FitReport::OneLine() const {
  std::string net, degrees;
  const char* const between = geometry.count > 1 ? " + " : " x ";
  for (const int n : geometry.control_points)
    net += (net.empty() ? "" : between) + std::to_string(n);
  for (const int p : geometry.degree) degrees += (degrees.empty() ? "" : ",") + std::to_string(p);
  const std::string kind = geometry.count > 1
                               ? std::to_string(geometry.count) + " " + geometry.kind + "s"
                               : geometry.kind;
  char text[512];
  std::snprintf(text,
                sizeof text,
                "%s of degree %s, %s control points: rms %.4g, max %.4g over %lld of %lld points",
                kind.c_str(),
                degrees.c_str(),
                net.c_str(),
                error.rms,
                error.max,
                static_cast<long long>(error.points),
                static_cast<long long>(input.points));
  std::string line = text;
  if (geometry.primitive) {
    std::string shape = geometry.primitive->kind;
    if (geometry.primitive->radius) {
      std::snprintf(text, sizeof text, " of radius %.10g", *geometry.primitive->radius);
      shape += text;
    }
    line = shape + ", " + line;
  }
  if (parameter_error) {
    std::snprintf(text,
                  sizeof text,
                  "; at the parameters rms %.4g, max %.4g",
                  parameter_error->rms,
                  parameter_error->max);
    line += text;
  }
  if (error.tolerance) {
    std::snprintf(text,
                  sizeof text,
                  "; %lld out of tolerance %.4g",
                  static_cast<long long>(judged_error().out_of_tolerance),
                  *error.tolerance);
    line += text;
  }
  return line + " (" + Name(termination) + ")";
}

}  // namespace batten
