// SPDX-License-Identifier: MIT
// Prints, as Markdown tables, how near curve fits come to curves that are known, medians over
// seeds: rms and largest distance of the fitted curve from the noise-free one, points beyond open
// ends left out, and of the noise-free one from the fitted (back), beside the limit that noise
// alone sets.
#include <Eigen/Core>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <string>
#include <variant>
#include <vector>

#include "ablation.h"
#include "batten/fitting/fit_curve.h"
#include "batten/fitting/fit_primitive.h"
#include "batten/fitting/statistics.h"
#include "known_curves.h"

using namespace batten;
using namespace batten::internal;

namespace batten::internal {
namespace {

constexpr int kSeeds = 5;
constexpr int kLine = 20000;  // chords of a fitted curve
constexpr double kHelixNoise = 1e-4, kFlowerNoise = 5e-3, kSquareNoise = 2e-3, kShapeNoise = 1e-2;

struct Fitted {
  Eigen::Matrix3Xd line;
  int control_points = 0;
  double residual_rms = 0, residual_max = 0, seconds = 0;
};

class Clock {
 public:
  double Seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  }

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

template <int Dim>
Fitted Sampled(const NurbsCurve<Dim>& curve, const FitReport& report, double seconds) {
  Fitted fitted{Eigen::Matrix3Xd::Zero(3, kLine + 1),
                static_cast<int>(curve.control_points().cols()),
                report.error.rms,
                report.error.max,
                seconds};
  const SplineBasis& basis = curve.basis();
  if (basis.periodic()) fitted.control_points -= basis.degree();
  for (int k = 0; k <= kLine; ++k) {
    const double u = basis.lower() + (basis.upper() - basis.lower()) * k / kLine;
    fitted.line.col(k).template head<Dim>() = curve.At(u);
  }
  return fitted;
}

struct FreeForm {
  CurveFitOptions options;

  Fitted operator()(const PointCloud& cloud) const {
    return cloud.dimension() == 2 ? Fit<2>(cloud) : Fit<3>(cloud);
  }

  template <int Dim>
  Fitted Fit(const PointCloud& cloud) const {
    const Clock clock;
    const CurveFit<Dim> fit = FitCurve<Dim>(cloud, options);
    return Sampled(fit.curve, fit.report, clock.Seconds());
  }
};

struct Primitive {
  PrimitiveFitOptions options;

  Fitted operator()(const PointCloud& cloud) const {
    const Clock clock;
    const PrimitiveFit fit = FitPrimitive(cloud, options);
    const double seconds = clock.Seconds();
    if (const auto* plane = std::get_if<NurbsCurve<2>>(&fit.geometry)) {
      return Sampled(*plane, fit.report, seconds);
    }
    return Sampled(std::get<NurbsCurve<3>>(fit.geometry), fit.report, seconds);
  }
};

// What was measured of every fit.
struct Runs {
  std::vector<double> control_points, rms, max, back, seconds, residual_rms, residual_max;
  int failed = 0;
  std::string why;
};

template <typename Fit>
Runs RunSeeds(const KnownCurve& curve, const CurveCloudKind& kind, const Fit& fit) {
  Runs runs;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const PointCloud cloud = PointCloud::FromWorld(
        CloudAlong(curve, kind, static_cast<unsigned>(seed)), curve.dimension);
    try {
      const Fitted fitted = fit(cloud);
      const TruthError error = ErrorAgainst(curve, fitted.line);
      runs.control_points.push_back(fitted.control_points);
      runs.rms.push_back(error.rms);
      runs.max.push_back(error.max);
      runs.back.push_back(error.back);
      runs.seconds.push_back(fitted.seconds);
      runs.residual_rms.push_back(fitted.residual_rms);
      runs.residual_max.push_back(fitted.residual_max);
    } catch (const std::exception& failure) {
      ++runs.failed;
      runs.why = failure.what();
    }
  }
  return runs;
}

void PrintFailures(const Runs& runs) {
  if (runs.failed == 0) return;
  std::printf("(%d of %d seeds failed: %s)\n", runs.failed, kSeeds, runs.why.c_str());
}

// `freedom` is that of the shape across itself, in all coordinates; none: of its control points.
template <typename Fit>
void PrintRow(const std::string& name,
              const KnownCurve& curve,
              const CurveCloudKind& kind,
              const Fit& fit,
              int freedom = 0) {
  const Runs runs = RunSeeds(curve, kind, fit);
  const double n = Median(runs.control_points);
  const double good = (1 - kind.outliers) * static_cast<double>(kind.count);
  const double free = freedom > 0 ? freedom : (curve.dimension - 1) * n;
  std::printf("| %s | %td | %.0f | %.2e | %.2e | %.2e | %.2e | %.3f |\n",
              name.c_str(),
              kind.count,
              n,
              Median(runs.rms),
              Median(runs.max),
              Median(runs.back),
              kind.sigma * std::sqrt(free / good),
              Median(runs.seconds));
  PrintFailures(runs);
  std::fflush(stdout);
}

constexpr CurveCloudKind kShortHelix{2000, kHelixNoise}, kLongHelix{100000, kHelixNoise};

void PrintFreeForms() {
  std::printf(
      "| cloud | points | control points | truth rms | truth max | back max | limit "
      "σ√((d−1)n/N) | seconds |\n|---|---|---|---|---|---|---|---|\n");
  const KnownCurve helix = WavyHelix(), flower = ClosedFlower(), square = UnitSquare();
  const FreeForm defaults;
  CurveCloudKind short_outliers = kShortHelix;
  short_outliers.outliers = 0.3;
  const CurveCloudKind unordered{5000, kFlowerNoise, 0, false};
  CurveCloudKind unordered_outliers = unordered;
  unordered_outliers.outliers = 0.3;
  PrintRow("helix, ordered, σ = 1e-4", helix, kShortHelix, defaults);
  PrintRow("helix, ordered, σ = 1e-4", helix, kLongHelix, defaults);
  PrintRow("helix, ordered, 30 % outliers", helix, short_outliers, defaults);
  PrintRow("flower, unordered, σ = 5e-3", flower, unordered, defaults);
  PrintRow("flower, unordered, 30 % outliers", flower, unordered_outliers, defaults);
  PrintRow("square, ordered, σ = 2e-3", square, {2000, kSquareNoise}, defaults);
  PrintRow("square, unordered, σ = 2e-3", square, {2000, kSquareNoise, 0, false}, defaults);
}

// A line in the plane has two freedoms, in space four; a circle in the plane three.
void PrintPrimitives() {
  std::printf(
      "\n| primitive (σ = 1e-2) | points | control points | truth rms | truth max | back max | "
      "limit σ√(freedoms/N) | seconds |\n|---|---|---|---|---|---|---|---|\n");
  const Primitive found;
  Primitive robust;
  robust.options.loss = Loss::kTukey;
  const CurveCloudKind plain{1000, kShapeNoise, 0, false};
  CurveCloudKind outliers = plain;
  outliers.outliers = 0.3;
  PrintRow("line in space", StraightLine(), plain, found, 4);
  PrintRow("circle", CircleArc(360), plain, found, 3);
  PrintRow("arc of 90°", CircleArc(90), plain, found, 3);
  PrintRow("line in space, 30 % outliers, Tukey's loss", StraightLine(), outliers, robust, 4);
  PrintRow("circle, 30 % outliers, Tukey's loss", CircleArc(360), outliers, robust, 3);
}

void PrintConicRow(const KnownCurve& curve, bool weights) {
  FreeForm free;
  free.options.degree = 2;
  if (weights) free.options.optimize = FreeVariables{.parameters = true, .weights = true};
  const CurveCloudKind kind{60, 0};
  const Eigen::Matrix3Xd points = CloudAlong(curve, kind, 1);
  const double size = (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
  const Runs runs = RunSeeds(curve, kind, free);
  std::printf("| %s | %td | %s | %.0f | %.1e | %.1e | %.1e | %.3f |\n",
              curve.name.c_str(),
              kind.count,
              weights ? "parameters, weights" : "default",
              Median(runs.control_points),
              Median(runs.residual_rms) / size,
              Median(runs.residual_max) / size,
              Median(runs.max) / size,
              Median(runs.seconds));
  PrintFailures(runs);
  std::fflush(stdout);
}

void PrintConics() {
  std::printf(
      "\n| exact points, degree 2 | points | free | control points | residual rms/size | "
      "max/size | truth max/size | seconds |\n|---|---|---|---|---|---|---|---|\n");
  for (const KnownCurve& curve : {EllipseArc(), HyperbolaArc()}) {
    PrintConicRow(curve, true);
    PrintConicRow(curve, false);
  }
}

}  // namespace
}  // namespace batten::internal

int main() {
  try {
    PrintFreeForms();
    PrintPrimitives();
    PrintConics();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "curve_fitting: %s\n", error.what());
    return 1;
  }
  return 0;
}
