// SPDX-License-Identifier: MIT
#include "fitting/primitives/primitive_input.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "fitting/core/fit_end.h"
#include "fitting/core/rounding.h"
#include "fitting/core/unit_of.h"

namespace batten::internal {
namespace {

[[noreturn]] void Refuse(const std::string& reason) { throw std::invalid_argument(reason); }

}  // namespace

ShapeData PrimitiveInput::LocalData() const {
  ShapeData data;
  data.points = (points().colwise() - middle) / unit;
  data.plane = plane();
  const Eigen::VectorXd& weights = merged.cloud.weights();
  data.weights = weights.size() > 0 ? (weights / weights.mean()).eval()
                                    : Eigen::VectorXd::Ones(points().cols()).eval();
  return data;
}

PrimitiveInput::PrimitiveInput(const PointCloud& given, const PrimitiveFitOptions& chosen)
    : cloud(given), options(chosen), pool(chosen.threads) {
  report.threads = pool.threads();
  Report(options.progress, "prepare", 0);
  InputSummary& summary = report.input;
  summary.points = cloud.size();
  if (cloud.size() == 0) Refuse("there are no points");
  merged = MergeDuplicates(cloud);
  summary.duplicates = merged.duplicates;
  summary.origin = cloud.origin();
  const Eigen::Vector3d low = points().rowwise().minCoeff(), high = points().rowwise().maxCoeff();
  summary.box_min = cloud.origin() + low;
  summary.box_max = cloud.origin() + high;
  const double size = (high - low).maxCoeff();
  if (points().cols() > 1 && !(size > kLeastSize && size < 1 / kLeastSize)) {
    Refuse("the points' extent is not between 1e-100 and 1e100");
  }
  unit = UnitOf(points());
  middle = (low + high) / 2;
  move = cloud.origin() - options.shift;
  const double far = summary.box_min.cwiseAbs().cwiseMax(summary.box_max.cwiseAbs()).maxCoeff();
  rounding = std::max(kRelativeRounding, 4 * std::numeric_limits<double>::epsilon() * far / size);
  clock.Enter(&StageSeconds::solve);
}

double PrimitiveInput::Anywhere(Eigen::Index count) const {
  const double size = (report.input.box_max - report.input.box_min).maxCoeff() / unit;
  return 6 * std::log(size) * static_cast<double>(count);
}

void PrimitiveInput::Require(const std::string& what, Eigen::Index fewest) const {
  if (points().cols() >= fewest) return;
  Refuse("a " + what + " needs at least " + std::to_string(fewest) + " different points; there " +
         (points().cols() == 1 ? "is " : "are ") + std::to_string(points().cols()));
}

Eigen::Vector3d FarthestPoint(const PrimitiveFit& fit, const PointCloud& cloud) {
  Eigen::Index farthest = 0;
  fit.outliers.select(0, fit.residuals.array().abs()).maxCoeff(&farthest);
  return cloud.World(farthest);
}

void FinishReport(PrimitiveInput& input,
                  PrimitiveSummary primitive,
                  const std::string& kind,
                  PrimitiveFit& fit) {
  FitReport& report = input.report;
  const std::optional<double> tolerance = input.options.tolerance;
  report.error = Summarise(fit.residuals, tolerance, !fit.outliers);
  report.error_all = fit.outliers.any() ? Summarise(fit.residuals, tolerance) : report.error;
  report.input.used = report.error.points;
  report.input.outliers = fit.outliers.count();
  report.input.noise = primitive.scale;
  report.geometry.kind = kind;
  JudgeEnd({.noise = primitive.scale,
            .rounding = input.rounding * (report.input.box_max - report.input.box_min).norm(),
            .farthest = FarthestPoint(fit, input.cloud)},
           report);
  report.geometry.base = primitive.kind;
  report.geometry.primitive = std::move(primitive);
  report.seconds = input.clock.Seconds();
  fit.report = std::move(report);
}

}  // namespace batten::internal
