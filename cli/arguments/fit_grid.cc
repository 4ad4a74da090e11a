// SPDX-License-Identifier: MIT
#include "cli/arguments/fit_grid.h"

#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

#include "cli/terminal/parse_values.h"

namespace batten::internal {
namespace {

// The one value of u that all points of a row have, and of v of a column.
GridParameters GivenLines(const PointCloud& cloud,
                          const GridFitOptions& options,
                          const FitFiles& files) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  GridParameters lines{Eigen::VectorXd::Constant(options.rows, kNone),
                       Eigen::VectorXd::Constant(options.columns, kNone)};
  Eigen::Index next = 0;
  const auto take = [&](double& line, double value, const char* name) {
    if (std::isnan(line)) line = value;
    if (line == value) return;
    files.Refuse(std::string("is no grid over its parameters: ") + name +
                 " is not the same all along a line (leave --parameterization to auto)");
  };
  for (int i = 0; i < options.rows; ++i) {
    for (int j = 0; j < options.columns; ++j) {
      const Eigen::Index cell = Eigen::Index{i} * options.columns + j;
      if (options.missing.size() > 0 && options.missing[cell]) continue;
      take(lines.u[i], cloud.parameters()(0, next), "u");
      take(lines.v[j], cloud.parameters()(1, next), "v");
      ++next;
    }
  }
  if (!lines.u.allFinite() || !lines.v.allFinite())
    files.Refuse("has a row or column without any point, which then has no parameter");
  return lines;
}

}  // namespace

GridFitOptions ToGridOptions(const std::string& grid,
                             const std::string& method,
                             const SurfaceFitOptions& options) {
  constexpr int kMost = 1000000;
  static const std::map<std::string, GridMethod> kMethods = {
      {"auto", GridMethod::kAuto},
      {"interpolate", GridMethod::kInterpolate},
      {"local", GridMethod::kInterpolateLocally},
      {"least-squares", GridMethod::kLeastSquares}};
  GridFitOptions result;
  if (grid.find_first_of(",;") == std::string::npos)
    throw UsageError("--grid: '" + grid + "' is not rows,columns");
  std::tie(result.rows, result.columns) = ParsePair("--grid", grid, 2, kMost);
  result.method = kMethods.at(method);
  result.degree_u = options.degree_u;
  result.degree_v = options.degree_v;
  result.tolerance = options.tolerance;
  result.control_points = options.control_points;
  result.closed = options.closed;
  result.shift = options.shift;
  result.threads = options.threads;
  result.progress = options.progress;
  return result;
}

int RunGridFit(FitFiles& files, GridFitOptions options, bool given) {
  const PointCloud& cloud = files.Read(given, CloudFaces::kIgnored);
  if (given && cloud.parameters().cols() == 0)
    files.Refuse("has no columns u and v, which --parameterization given needs");
  const std::vector<Eigen::Index>& missing = files.missing();
  const Eigen::Index cells = Eigen::Index{options.rows} * options.columns;
  if (!missing.empty() && missing.back() < cells) {
    options.missing = PointMask::Constant(cells, false);
    for (const Eigen::Index cell : missing) options.missing[cell] = true;
  }
  const auto found = cloud.size() + static_cast<Eigen::Index>(missing.size());
  if (found != cells) {
    files.Refuse("holds " + std::to_string(found) + " points; a grid of " +
                 std::to_string(options.rows) + " x " + std::to_string(options.columns) + " has " +
                 std::to_string(cells));
  }
  options.shift = files.shift();
  SurfaceFit fit = files.Explained([&] {
    if (given) {
      options.parameterization = GridParameterization::kGiven;
      options.parameters = GivenLines(cloud, options, files);
    }
    Check(options);
    return FitGrid(cloud, options);
  });
  return files.Write({fit.surface}, fit.residuals, fit.parameters, fit.outliers, fit.report);
}

}  // namespace batten::internal
