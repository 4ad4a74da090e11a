// SPDX-License-Identifier: MIT
#include "batten/fitting/fit_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <vector>

#include "batten/fitting/statistics.h"
#include "fitting/core/rounding.h"
#include "geometry/numeric/enum_name.h"
#include "geometry/numeric/number_text.h"

namespace batten {
using namespace internal;

namespace {

// Formats a value down to the second digit of its deviation, with ten digits where there is none.
std::string WithDeviation(double value, double deviation) {
  char text[80];
  if (!(deviation > 0)) {
    std::snprintf(text, sizeof text, "%.10g", value);
  } else if (!std::isfinite(deviation)) {
    std::snprintf(text, sizeof text, "%.10g (its error has no limit)", value);
  } else if (!(std::abs(value) < 1e15 * deviation && deviation < 1e3 * std::abs(value))) {
    std::snprintf(text, sizeof text, "%.10g ± %.2g", value, deviation);
  } else {
    const int places = static_cast<int>(std::ceil(-std::log10(deviation))) + 1;
    if (places > 12 || std::abs(value) > 1e12 || places < -3) {
      const double digits = std::log10(std::abs(value) / deviation);
      const int shown = std::clamp(static_cast<int>(std::ceil(digits)) + 2, 2, 17);
      std::snprintf(text, sizeof text, "%.*g ± %.2g", shown, value, deviation);
    } else {
      std::snprintf(text, sizeof text, "%.*f ± %.2g", std::max(0, places), value, deviation);
    }
  }
  return text;
}

}  // namespace
const char* Name(Termination termination) {
  static constexpr std::array kNames{"tolerance_reached",
                                     "noise_reached",
                                     "max_control_points",
                                     "max_iterations",
                                     "stalled",
                                     "cancelled"};
  return NameIn<Termination::kCancelled>(kNames, termination);
}

const char* Name(EndCode code) {
  static constexpr std::array kNames{"tolerance_reached",
                                     "noise_reached",
                                     "cross_validated",
                                     "detail_below_spacing",
                                     "structured_residuals",
                                     "max_control_points",
                                     "max_iterations",
                                     "time_limit",
                                     "cancelled"};
  return NameIn<EndCode::kCancelled>(kNames, code);
}

Termination TerminationOf(EndCode code) {
  switch (code) {
    case EndCode::kToleranceReached:
      return Termination::kToleranceReached;
    case EndCode::kNoiseReached:
      return Termination::kNoiseReached;
    case EndCode::kMaxControlPoints:
      return Termination::kMaxControlPoints;
    case EndCode::kMaxIterations:
    case EndCode::kTimeLimit:
      return Termination::kMaxIterations;
    case EndCode::kCancelled:
      return Termination::kCancelled;
    default:
      return Termination::kStalled;
  }
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

double PrimitiveAccuracy::Deviation(const std::string& name) const {
  double most = std::numeric_limits<double>::quiet_NaN();
  for (size_t i = 0; i < names.size(); ++i) {
    if (names[i] != name && !names[i].starts_with(name + "_")) continue;
    const double deviation = standard_deviations[static_cast<Eigen::Index>(i)];
    if (!(most >= deviation)) most = deviation;
  }
  return most;
}

std::string PrimitiveSummary::Words() const {
  std::string words = kind;
  const auto add = [&](const char* name, const std::optional<double>& value, double unit) {
    if (!value) return;
    std::string key = name;
    std::replace(key.begin(), key.end(), ' ', '_');
    const double deviation = accuracy ? unit * accuracy->Deviation(key) : 0;
    const char* const join = words == kind ? " of " : ", ";
    words += join + std::string(name) + " " + WithDeviation(unit * *value, deviation);
    if (unit != 1) words += " degrees";
  };
  add("radius", radius, 1);
  add("major radius", major_radius, 1);
  add("minor radius", minor_radius, 1);
  add("half angle", half_angle, 1 / internal::kOneDegree);
  return words;
}

const ErrorSummary& FitReport::judged_error() const {
  return judged_at_parameters ? parameter_error.value() : error;
}

std::optional<bool> FitReport::tolerance_reached() const {
  const ErrorSummary& judged = judged_error();
  if (!judged.tolerance) return std::nullopt;
  return judged.out_of_tolerance == 0 && !leaves_points();
}

bool FitReport::leaves_points() const {
  constexpr double kLeaves = 3;  // spacings
  if (!overshoot || overshoot->asked_for) return false;
  return overshoot->of_box || (overshoot->in_spacings > kLeaves &&
                               overshoot->max > std::max(error.max, error.tolerance.value_or(0)));
}

std::vector<Doubt> FitReport::Doubts() const {
  // Levels of docs/report.md, on which scripts rely.
  constexpr double kMostLeftOut = 0.1, kFarInNoise = 10, kFarInSize = 0.01;
  std::vector<Doubt> all = doubts;
  if (end.words.empty()) return all;  // nothing was fitted
  if (end.code == EndCode::kStructuredResiduals) all.push_back({"structured_residuals", end.words});
  if (leaves_points() && end.code != EndCode::kStructuredResiduals)
    all.push_back({"leaves_points", "between the points it goes farther than they do"});
  const double left_out = static_cast<double>(input.outliers) /
                          static_cast<double>(std::max<Eigen::Index>(input.points, 1));
  if (left_out > kMostLeftOut) {
    all.push_back({"points_left_out",
                   NumberText(std::round(100 * left_out)) + " % of the points are left out"});
  }
  const double size = (input.box_max - input.box_min).norm();
  const double far = std::max(kFarInNoise * input.noise, kFarInSize * size);
  // The triangles of a mesh hold no outliers.
  const bool whole = input.mesh && input.mesh->sampled > 0;
  const double missed = whole ? error_all.max : error.max;
  if (size > 0 && missed > std::max(far, error.tolerance.value_or(0))) {
    all.push_back({"points_missed",
                   std::string(whole ? "a place of the mesh" : "a point that counts") +
                       " is missed by " + RoundedText(missed) + ", " +
                       NumberText(std::round(1000 * missed / size) / 10) +
                       " % of the points' size"});
  }
  return all;
}

StageSeconds& StageSeconds::operator+=(const StageSeconds& more) {
  for (double StageSeconds::*const stage : {&StageSeconds::read,
                                            &StageSeconds::prepare,
                                            &StageSeconds::parameterize,
                                            &StageSeconds::solve,
                                            &StageSeconds::project,
                                            &StageSeconds::refine,
                                            &StageSeconds::optimize,
                                            &StageSeconds::trim,
                                            &StageSeconds::write,
                                            &StageSeconds::total})
    this->*stage += more.*stage;
  return *this;
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
  if (other.overshoot && (!overshoot || other.overshoot->max > overshoot->max))
    overshoot = other.overshoot;
  seconds += other.seconds;
  optimize.ran = optimize.ran || other.optimize.ran;
  optimize.iterations += other.optimize.iterations;
  if (other.termination > termination) end = other.end;
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
  const std::string form =
      degrees.empty() ? kind : kind + " of degree " + degrees + ", " + net + " control points";
  char text[512];
  std::snprintf(text,
                sizeof text,
                "%s: rms %.4g, max %.4g over %lld of %lld points",
                form.c_str(),
                error.rms,
                error.max,
                static_cast<long long>(error.points),
                static_cast<long long>(input.points));
  std::string line = text;
  if (geometry.primitive) {
    line = geometry.primitive->Words() + ", " + line;
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
