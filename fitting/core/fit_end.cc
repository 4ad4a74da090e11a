// SPDX-License-Identifier: MIT
#include "fitting/core/fit_end.h"

#include "geometry/numeric/number_text.h"

namespace batten::internal {
namespace {

constexpr double kExcessToSayNoise = 2;  // rms over noise: estimates of noise differ by as much

bool IsAtNoise(const EndEvidence& evidence, const FitReport& report) {
  const ErrorSummary& error = report.judged_error();
  const bool at_noise = evidence.noise > 0 && error.rms <= kExcessToSayNoise * evidence.noise;
  return at_noise || (!error.tolerance && error.rms <= evidence.rounding);
}

EndCode CodeOf(const EndEvidence& evidence, const FitReport& report) {
  const EndCode search = evidence.search;
  const ErrorSummary& error = report.judged_error();
  if (search == EndCode::kCancelled) return search;
  if (report.leaves_points()) return EndCode::kStructuredResiduals;
  if (error.tolerance && error.out_of_tolerance == 0) return EndCode::kToleranceReached;
  const bool full = search == EndCode::kMaxControlPoints;
  if (error.tolerance) {
    if (full) return search;
    if (search == EndCode::kNoiseReached || IsAtNoise(evidence, report))
      return EndCode::kNoiseReached;
  } else {
    if (IsAtNoise(evidence, report)) return EndCode::kNoiseReached;
    if (full || evidence.control_points_given) return EndCode::kMaxControlPoints;
  }
  if (search == EndCode::kDetailBelowSpacing) return search;
  if (evidence.structured) return EndCode::kStructuredResiduals;
  // Out of tolerance, though more control points were not refused: what is left is random.
  return error.tolerance ? EndCode::kDetailBelowSpacing : EndCode::kCrossValidated;
}

std::string WordsOf(EndCode code, const FitReport& report) {
  if (report.leaves_points() && code == EndCode::kStructuredResiduals)
    return WordsOfLeaving(report);
  const bool tolerance = report.judged_error().tolerance.has_value();
  const std::string shape = report.geometry.kind.empty() ? "geometry" : report.geometry.kind;
  switch (code) {
    case EndCode::kToleranceReached:
      return "every point used is within the tolerance";
    case EndCode::kNoiseReached:
      return tolerance
                 ? "the tolerance is not kept, but what is out of it is the noise of the points"
                 : "residuals are at the noise of the points";
    case EndCode::kCrossValidated:
      return "residuals are above the noise of neighbouring points, but more control points would "
             "not predict left-out points better";
    case EndCode::kDetailBelowSpacing:
      return tolerance
                 ? "the tolerance is not kept: what is out of it is finer than the spacing of "
                   "the points, and no more control points can follow it"
                 : "what is left is finer than the spacing of the points";
    case EndCode::kStructuredResiduals:
      return "residuals are above the noise and neighbours share them: the shape has edges, layers "
             "or detail that this " +
             shape + " does not follow";
    case EndCode::kMaxControlPoints:
      return "the control points allowed are used up, and residuals are above " +
             std::string(tolerance ? "the tolerance" : "the noise");
    case EndCode::kMaxIterations:
      return "the last round changed the " + shape + " still";
    case EndCode::kTimeLimit:
      return "the time allowed is used up";
    case EndCode::kCancelled:
      return "the fit was cancelled";
  }
  return "";
}

}  // namespace

std::string WordsOfLeaving(const FitReport& report) {
  const OvershootSummary& overshoot = *report.overshoot;
  const std::string whose = overshoot.of_box ? "the box of its points" : "its points";
  const std::string size = overshoot.of_box
                               ? RoundedText(*overshoot.of_box) + " of its diagonal"
                               : RoundedText(overshoot.in_spacings) + " times their spacing";
  return "the " + report.geometry.kind + " leaves " + whose + " by " + RoundedText(overshoot.max) +
         ", " + size + ", where they do not determine it";
}

void JudgeEnd(const EndEvidence& evidence, FitReport& report) {
  const EndCode code = CodeOf(evidence, report);
  report.termination = TerminationOf(code);
  report.end = {code, WordsOf(code, report), std::nullopt};
  if (report.leaves_points()) {
    report.end.where = report.overshoot->at;
  } else if (code != EndCode::kToleranceReached && code != EndCode::kNoiseReached) {
    report.end.where = evidence.farthest;
  }
}

}  // namespace batten::internal
