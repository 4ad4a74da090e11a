// SPDX-License-Identifier: MIT
// Distances of points from geometries.
#include <pybind11/stl.h>

#include <chrono>
#include <cmath>
#include <optional>

#include "batten/fitting/cloud_statistics.h"
#include "batten/fitting/distances.h"
#include "batten/geometry/closure.h"
#include "python/core/bind.h"
#include "python/core/fit.h"
#include "python/core/options.h"
#include "python/core/watch.h"

namespace batten::python {
namespace {

template <int Dim>
NurbsCurve<Dim> Moved(const NurbsCurve<Dim>& curve, const Eigen::Vector3d& shift) {
  return NurbsCurve<Dim>(
      curve.basis(), curve.control_points().colwise() + shift.head<Dim>(), curve.weights());
}
NurbsSurface Moved(const NurbsSurface& surface, const Eigen::Vector3d& shift) {
  return surface.Translated(shift);
}

template <int Dim>
GeometrySummary Described(const NurbsCurve<Dim>& curve) {
  GeometrySummary summary;
  summary.kind = "curve";
  summary.degree = {curve.basis().degree()};
  summary.control_points = {curve.basis().size()};
  summary.rational = curve.rational();
  summary.closed = {Closed(curve)};
  return summary;
}
GeometrySummary Described(const NurbsSurface& surface) {
  GeometrySummary summary;
  summary.kind = "surface";
  summary.degree = {surface.basis_u().degree(), surface.basis_v().degree()};
  summary.control_points = {surface.size_u(), surface.size_v()};
  summary.rational = surface.rational();
  summary.closed = {Closed(surface, Direction::kU), Closed(surface, Direction::kV)};
  return summary;
}

struct Nearest {
  PointDistances found;
  std::vector<int> owners;
  Eigen::Index uncertified = 0;
};

// Every point belongs to the nearest of several geometries.
Nearest NearestOf(const std::vector<BodyPtr>& bodies,
                  const PointCloud& cloud,
                  ThreadPool& pool,
                  Watch& watch) {
  Nearest nearest;
  nearest.owners.assign(static_cast<std::size_t>(cloud.size()), 0);
  for (std::size_t g = 0; g < bodies.size(); ++g) {
    const double share = static_cast<double>(g) / static_cast<double>(bodies.size());
    if (!watch.Go("project", 0.9 * share)) throw Cancelled();
    PointDistances found = std::visit(
        [&](const auto& shape) {
          return DistancesTo(Moved(shape, -cloud.origin()), cloud.points(), pool);
        },
        bodies[g]->geometry());
    nearest.uncertified = std::max(nearest.uncertified, found.uncertified);
    if (g == 0) {
      nearest.found = std::move(found);
      continue;
    }
    PointDistances& best = nearest.found;
    if (found.parameters.rows() > best.parameters.rows()) {
      best.parameters.conservativeResizeLike(
          Eigen::MatrixXd::Zero(found.parameters.rows(), cloud.size()));
    }
    for (Eigen::Index k = 0; k < cloud.size(); ++k) {
      if (std::abs(found.distances[k]) >= std::abs(best.distances[k])) continue;
      best.distances[k] = found.distances[k];
      nearest.owners[static_cast<std::size_t>(k)] = static_cast<int>(g);
      best.parameters.col(k).setZero();
      best.parameters.col(k).head(found.parameters.rows()) = found.parameters.col(k);
    }
  }
  return nearest;
}

FitReport ReportOf(const std::vector<BodyPtr>& bodies,
                   const Points& points,
                   const Nearest& nearest,
                   const std::vector<std::string>& names,
                   std::optional<double> tolerance,
                   std::uint64_t seed,
                   ThreadPool& pool) {
  const PointCloud& cloud = points.cloud;
  FitReport report;
  report.threads = pool.threads();
  if (nearest.uncertified > 0) report.warnings.push_back(UncertifiedText(nearest.uncertified));
  const MergedCloud merged = MergeDuplicates(cloud);
  CloudStatisticsOptions statistics;
  statistics.find_outliers = false;
  statistics.seed = seed;
  const CloudStatistics measured =
      MeasureCloud(merged.cloud.points(), NeighbourIndex(merged.cloud.points()), statistics, pool);
  report.input.points = report.input.used = cloud.size();
  report.input.duplicates = merged.duplicates;
  report.input.spacing = measured.spacing;
  report.input.noise = measured.noise;
  report.input.box_min = cloud.origin() + cloud.points().rowwise().minCoeff();
  report.input.box_max = cloud.origin() + cloud.points().rowwise().maxCoeff();
  report.input.origin = cloud.origin();
  report.geometry = std::visit([](const auto& s) { return Described(s); }, bodies[0]->geometry());
  if (bodies.size() > 1) {
    report.geometry.count = static_cast<int>(bodies.size());
    const Eigen::Map<const Eigen::ArrayXi> owner(nearest.owners.data(), std::ssize(nearest.owners));
    for (std::size_t g = 0; g < bodies.size(); ++g) {
      report.parts.push_back(
          {g < names.size() ? names[g] : "",
           bodies[g]->is_surface() ? "surface" : "curve",
           Summarise(nearest.found.distances, tolerance, owner == static_cast<int>(g))});
    }
  }
  report.error = report.error_all = Summarise(nearest.found.distances, tolerance);
  report.optimize.why = "a comparison fits nothing";
  report.termination = tolerance && report.error.out_of_tolerance == 0
                           ? Termination::kToleranceReached
                           : Termination::kStalled;
  return report;
}

FitPtr Compare(const std::vector<BodyPtr>& bodies,
               const PointsPtr& points,
               const py::dict& values,
               const std::vector<std::string>& names,
               const py::object& progress) {
  if (bodies.empty()) throw py::value_error("geometry: nothing to compare with");
  if (points->cloud.size() == 0) throw py::value_error("points: there are none");
  const Keywords keywords(values);
  std::optional<double> tolerance;
  keywords.Take("tolerance", tolerance);
  if (tolerance && !(*tolerance > 0)) Keywords::Refuse("tolerance", "must be positive");
  const int threads = keywords.Threads();
  std::uint64_t seed = 1;
  keywords.Take("seed", seed);
  using Clock = std::chrono::steady_clock;
  const auto since = [](Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
  };
  auto [nearest, report] = Watched(
      [=](Watch& watch) {
        const auto start = Clock::now();
        ThreadPool pool(threads);
        Nearest found = NearestOf(bodies, points->cloud, pool, watch);
        const double projected = since(start);
        FitReport made = ReportOf(bodies, *points, found, names, tolerance, seed, pool);
        made.seconds.project = projected;
        made.seconds.total = since(start);
        made.seconds.prepare = made.seconds.total - projected;
        return std::pair(std::move(found), std::move(made));
      },
      progress);
  auto made = std::make_shared<Fit>();
  made->bodies = bodies;
  made->residuals = std::move(nearest.found.distances);
  made->parameters = std::move(nearest.found.parameters);
  made->outliers = PointMask::Constant(points->cloud.size(), false);
  if (bodies.size() > 1) made->owners = std::move(nearest.owners);
  made->report = std::move(report);
  made->points = points;
  made->names = names;
  Complete(*made, keywords, false);
  return made;
}

}  // namespace

void BindComparison(py::module_& m) { m.def("compare", &Compare); }

}  // namespace batten::python
