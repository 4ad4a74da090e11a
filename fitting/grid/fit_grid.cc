// SPDX-License-Identifier: MIT
#include "batten/fitting/fit_grid.h"

#include <cmath>
#include <string>
#include <utility>

#include "batten/fitting/approximate_grid.h"
#include "batten/fitting/interpolate_grid.h"
#include "fitting/core/input_summary.h"
#include "fitting/core/stage_clock.h"
#include "fitting/grid/fill_cells.h"
#include "fitting/grid/grid_input.h"
#include "fitting/parameterization/parameterization.h"
#include "fitting/surface/surface_measurement.h"

namespace batten {
using namespace internal;
namespace {

// The fitted surface and the sentence of the report that says how it was fitted.
struct GridAnswer {
  InterpolatedGrid grid;
  std::string how;
};

GridMethod MethodFor(const GridFitOptions& options) {
  if (options.method != GridMethod::kAuto) return options.method;
  if (options.control_points) return GridMethod::kLeastSquares;
  return options.tolerance ? GridMethod::kAuto : GridMethod::kInterpolate;
}

GridInterpolationOptions InterpolationOf(const GridFitOptions& options, const GridInput& input) {
  GridInterpolationOptions interpolation;
  interpolation.degree_u = options.degree_u;
  interpolation.degree_v = options.degree_v;
  interpolation.parameterization = GridParameterization::kGiven;
  interpolation.parameters = input.parameters;
  interpolation.closed = input.closed;
  return interpolation;
}

GridAnswer Answer(const GridInput& input, const GridFitOptions& options, ThreadPool& pool) {
  const GridMethod method = MethodFor(options);
  const GridInterpolationOptions interpolation = InterpolationOf(options, input);
  if (method == GridMethod::kInterpolateLocally) {
    return {InterpolateGridLocally(input.net, interpolation, pool),
            "bicubic patches through all points"};
  }
  if (method == GridMethod::kInterpolate) {
    return {InterpolateGrid(input.net, interpolation, pool), "through all points"};
  }
  if (method == GridMethod::kAuto) {
    ToleratedGrid kept =
        ApproximateGrid(input.net, *options.tolerance, interpolation, pool, options.progress);
    return {{std::move(kept.surface), std::move(kept.parameters)},
            kept.interpolates
                ? "fewer control points do not keep the tolerance, so through all points"
                : "few control points that keep the tolerance, between the points too"};
  }
  GridLeastSquaresOptions squares;
  squares.degree_u = options.degree_u;
  squares.degree_v = options.degree_v;
  squares.control_u = options.control_points->first;
  squares.control_v = options.control_points->second;
  squares.parameterization = GridParameterization::kGiven;
  squares.parameters = input.parameters;
  squares.meet_corners = false;
  squares.closed = input.closed;
  return {LeastSquaresGrid(input.net, squares, pool), "least squares"};
}

// Spacing is the mean step.
InputSummary Summarise(const PointCloud& cloud, const GridInput& input, Eigen::Index duplicates) {
  const Eigen::Vector2d lengths = MeanLengths(input.net, input.closed);
  const double spacing = std::sqrt(lengths[0] / input.net.rows * lengths[1] / input.net.columns);
  return SummariseInput(cloud, duplicates, spacing, 0);
}

// The parameters of every point of the cloud, merged lines included.
Eigen::Matrix2Xd StartsOf(const MergedCloud& merged,
                          const GridInput& input,
                          const GridParameters& parameters,
                          const GridFitOptions& options) {
  Eigen::Matrix2Xd starts = Eigen::Matrix2Xd::Zero(2, merged.cloud.size());
  size_t next = 0;
  for (int i = 0; i < options.rows; ++i) {
    for (int j = 0; j < options.columns; ++j) {
      const Eigen::Index cell = Eigen::Index{i} * options.columns + j;
      if (options.missing.size() > 0 && options.missing[cell]) continue;
      const int row = input.row_of[static_cast<size_t>(i)],
                column = input.column_of[static_cast<size_t>(j)];
      starts.col(merged.place[next++]) << parameters.u[row], parameters.v[column];
    }
  }
  return starts;
}

Eigen::Matrix2Xd AllPairs(const GridParameters& parameters, int rows, int columns) {
  Eigen::Matrix2Xd pairs(2, Eigen::Index{rows} * columns);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      pairs.col(Eigen::Index{i} * columns + j) << parameters.u[i], parameters.v[j];
    }
  }
  return pairs;
}

}  // namespace

SurfaceFit FitGrid(const PointCloud& cloud, const GridFitOptions& options) {
  Check(options);
  StageClock clock;
  ThreadPool pool(options.threads);
  Report(options.progress, "grid", 0);
  GridInput input = ReadGrid(cloud, options);
  const MergedCloud merged = MergeDuplicates(cloud);
  FitReport report;
  report.threads = pool.threads();
  clock.Enter(&StageSeconds::solve);
  Report(options.progress, "grid", 0.1);
  input.net = WithFilledCells(input.net, input.parameters);
  const GridAnswer answer = Answer(input, options, pool);
  const Eigen::Matrix2Xd starts = StartsOf(merged, input, answer.grid.parameters, options);
  clock.Enter(&StageSeconds::project);
  Report(options.progress, "measure", 0);
  report.input = Summarise(cloud, input, merged.duplicates);
  report.geometry.base = "grid";
  report.geometry.base_why = std::to_string(input.net.rows) + " rows of " +
                             std::to_string(input.net.columns) + " points, " +
                             input.parameters_from + "; " + answer.how;
  report.geometry.distortion = DistortionAt(
      answer.grid.surface, AllPairs(answer.grid.parameters, input.net.rows, input.net.columns));
  const CollapsedLines poles = PolesOf(input.net, input.closed);
  if (poles.any_column()) report.geometry.poles = {poles.first_column, poles.last_column};
  report.warnings = std::move(input.warnings);
  report.optimize.why = "a grid keeps its parameters";
  if (options.control_points) report.end.code = EndCode::kMaxControlPoints;
  SurfaceFit fit = MeasureFit(answer.grid.surface,
                              cloud,
                              merged,
                              PointMask::Constant(merged.cloud.size(), true),
                              AsSurfaceOptions(options),
                              "a smooth surface through the grid",
                              pool,
                              std::move(report),
                              &starts);
  fit.report.seconds = clock.Seconds();
  return fit;
}

}  // namespace batten
