// SPDX-License-Identifier: MIT
#include "cli/arguments/fit_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "batten/fitting/cloud_parts.h"
#include "batten/fitting/fit_surface.h"
#include "cli/terminal/parse_values.h"

namespace batten::internal {
namespace {

// Fits of parts, one after the other, as one.
class PartFits {
 public:
  explicit PartFits(std::optional<double> tolerance) : tolerance_(tolerance) {}

  void Add(SurfaceFit fit, const CloudPart& part, size_t number) {
    for (std::string& warning : fit.report.warnings)
      warning = fmt::format("part {}: {}", number, warning);
    owners_.insert(owners_.end(), part.points.size(), static_cast<int>(surfaces_.size()));
    points_.insert(points_.end(), part.points.begin(), part.points.end());
    surfaces_.emplace_back(std::move(fit.surface));
    fits_.push_back(std::move(fit));
  }

  bool empty() const { return fits_.empty(); }

  int Write(FitFiles& files, std::vector<CloudPartSummary> parts) {
    const auto count = std::ssize(points_);
    Eigen::VectorXd residuals(count);
    Eigen::Matrix2Xd parameters(2, count);
    PointMask outliers(count);
    Eigen::Index next = 0;
    for (const SurfaceFit& fit : fits_) {
      const Eigen::Index size = fit.residuals.size();
      residuals.segment(next, size) = fit.residuals;
      parameters.middleCols(next, size) = fit.parameters;
      outliers.segment(next, size) = fit.outliers;
      next += size;
    }
    FitReport report = std::move(fits_.front().report);
    for (size_t k = 1; k < fits_.size(); ++k) Join(fits_[k].report, report);
    report.error = Summarise(residuals, tolerance_, !outliers);
    report.error_all = Summarise(residuals, tolerance_);
    report.input.used = report.error.points;
    report.input.outliers = outliers.count();
    report.cloud_parts = std::move(parts);
    files.Keep(points_);
    return files.Write(surfaces_,
                       residuals,
                       parameters,
                       outliers,
                       report,
                       surfaces_.size() > 1 ? std::move(owners_) : std::vector<int>());
  }

 private:
  // Degree, control points and base stay those of the largest part.
  static void Join(const FitReport& other, FitReport& report) {
    const GeometrySummary largest = report.geometry;
    report.Join(other);
    report.geometry = largest;
    report.geometry.count += 1;
    report.geometry.trims += other.geometry.trims;
    report.input.box_min = report.input.box_min.cwiseMin(other.input.box_min);
    report.input.box_max = report.input.box_max.cwiseMax(other.input.box_max);
  }

  std::optional<double> tolerance_;
  std::vector<SurfaceFit> fits_;
  std::vector<Geometry> surfaces_;
  std::vector<Eigen::Index> points_;
  std::vector<int> owners_;
};

}  // namespace

PartChoice ToPartChoice(const std::string& text) {
  if (text == "whole") return {};
  if (text == "all") return {.all = true};
  constexpr int kMost = 1000000;
  return {.number = static_cast<int>(ParseWhole("--part", text, 1, kMost))};
}

SurfaceFitOptions QuickOptions(SurfaceFitOptions options, const PointCloud& cloud) {
  constexpr double kEnoughPoints = 20000;
  constexpr int kEnoughControlPoints = 400;
  options.optimize = FreeVariables();
  options.max_control_points = std::min(options.max_control_points, kEnoughControlPoints);
  if (options.control_points) return options;
  const auto points = static_cast<double>(cloud.size());
  if (points > kEnoughPoints && !options.thin) {
    Eigen::Vector3d extents =
        cloud.points().rowwise().maxCoeff() - cloud.points().rowwise().minCoeff();
    std::sort(extents.begin(), extents.end());
    options.thin = std::sqrt(extents[1] * extents[2] / kEnoughPoints);
    if (!(*options.thin > 0)) options.thin.reset();
  }
  return options;
}

int RunPartsFit(FitFiles& files,
                const PointCloud& cloud,
                const SurfaceFitOptions& options,
                const PartChoice& choice) {
  ThreadPool pool(options.threads);
  const CloudParts found = FindCloudParts(cloud, pool);
  const size_t count = found.parts.size();
  if (count == 0) files.Refuse("holds no connected part of points that could carry a surface");
  if (choice.number && static_cast<size_t>(*choice.number) > count) {
    files.Refuse(fmt::format("falls into {} parts: there is no part {} (batten info lists them)",
                             count,
                             *choice.number));
  }
  PartFits fits(options.tolerance);
  std::vector<CloudPartSummary> summaries;
  for (size_t k = 0; k < count; ++k) {
    const CloudPart& part = found.parts[k];
    CloudPartSummary summary{
        std::ssize(part.points), part.share, part.box.min(), part.box.max(), false, ""};
    if (choice.all || static_cast<size_t>(*choice.number) == k + 1) {
      const PointCloud points = cloud.Picked(part.points);
      const auto fit = [&] {
        return files.ExplainedInTime(
            [&] { return FitSurface(points, options); },
            [&] { return FitSurface(points, QuickOptions(options, points)); });
      };
      try {
        fits.Add(fit(), part, k + 1);
        summary.used = true;
      } catch (const ReadError& refusal) {
        if (choice.number) throw;
        summary.refused = refusal.what();
      }
    }
    summaries.push_back(std::move(summary));
  }
  if (fits.empty())
    files.Refuse(
        fmt::format("none of its {} parts can be fitted: {}", count, summaries[0].refused));
  return fits.Write(files, std::move(summaries));
}

}  // namespace batten::internal
