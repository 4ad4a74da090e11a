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
#include "python/core/explained.h"
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

// What is to be done besides measuring.
struct CheckOptions {
  bool align = false, certify = false;
  std::vector<int> datums;
  std::optional<ProfileZone> profile;

  explicit CheckOptions(const Keywords& keywords) {
    keywords.Take("certify", certify);
    align = keywords.Has("align");
    if (keywords.Has("datums"))
      for (const std::int64_t one : keywords.Wholes("datums", py::len(keywords.Value("datums"))))
        datums.push_back(static_cast<int>(one));
    if (!keywords.Has("profile")) return;
    const std::vector<double> zone = keywords.Numbers("profile", 2);
    profile = ProfileZone{zone[0], zone[1]};
  }
};

RigidAlignment Aligned(const std::vector<BodyPtr>& bodies,
                       const PointCloud& cloud,
                       const std::vector<int>& datums,
                       ThreadPool& pool) {
  std::vector<NurbsSurface> surfaces;
  for (const BodyPtr& body : bodies) surfaces.push_back(body->surface());
  return Explained([&] { return AlignRigidly(surfaces, cloud, datums, pool); });
}

// Profile and proofs, of points that are aligned.
void Check(const CheckOptions& checks,
           const std::vector<BodyPtr>& bodies,
           const Nearest& nearest,
           double noise,
           std::optional<double> tolerance,
           ThreadPool& pool,
           Fit& made) {
  const PointCloud& cloud = made.points->cloud;
  if (checks.profile) {
    made.checks.profile = CheckProfile(nearest.found.distances,
                                       DistanceDeviations(cloud, noise, made.checks.alignment),
                                       *checks.profile);
  }
  if (!checks.certify) return;
  std::vector<Geometry> shapes;
  for (const BodyPtr& body : bodies) shapes.push_back(body->geometry());
  made.checks.certified = Certify(shapes, cloud, Eigen::Vector3d::Zero(), tolerance, pool).summary;
}

FitPtr Compare(const std::vector<BodyPtr>& bodies,
               const PointsPtr& given,
               const py::dict& values,
               const std::vector<std::string>& names,
               const py::object& progress) {
  if (bodies.empty()) throw py::value_error("geometry: nothing to compare with");
  if (given->cloud.size() == 0) throw py::value_error("points: there are none");
  const Keywords keywords(values);
  std::optional<double> tolerance;
  keywords.Take("tolerance", tolerance);
  if (tolerance && !(*tolerance > 0)) Keywords::Refuse("tolerance", "must be positive");
  const int threads = keywords.Threads();
  std::uint64_t seed = 1;
  keywords.Take("seed", seed);
  const CheckOptions checks(keywords);
  if (checks.align)
    for (const BodyPtr& body : bodies) body->surface();  // throws for a curve
  using Clock = std::chrono::steady_clock;
  const auto since = [](Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
  };
  auto made = std::make_shared<Fit>();
  auto [nearest, report] = Watched(
      [=](Watch& watch) {
        const auto start = Clock::now();
        ThreadPool pool(threads);
        PointsPtr points = given;
        if (checks.align) {
          made->checks.alignment = Aligned(bodies, given->cloud, checks.datums, pool);
          points = std::make_shared<Points>(*given);
          points->cloud = made->checks.alignment->Moved(given->cloud);
        }
        made->points = points;
        Nearest found = NearestOf(bodies, points->cloud, pool, watch);
        const double projected = since(start);
        FitReport report = ReportOf(bodies, *points, found, names, tolerance, seed, pool);
        report.seconds.project = projected;
        report.seconds.total = since(start);
        report.seconds.prepare = report.seconds.total - projected;
        Check(checks, bodies, found, report.input.noise, tolerance, pool, *made);
        return std::pair(std::move(found), std::move(report));
      },
      progress);
  made->bodies = bodies;
  made->residuals = std::move(nearest.found.distances);
  made->parameters = std::move(nearest.found.parameters);
  made->outliers = PointMask::Constant(given->cloud.size(), false);
  if (bodies.size() > 1) made->owners = std::move(nearest.owners);
  made->report = std::move(report);
  made->names = names;
  Complete(*made, keywords, false);
  return made;
}

}  // namespace

void BindComparison(py::module_& m) { m.def("compare", &Compare); }

}  // namespace batten::python
