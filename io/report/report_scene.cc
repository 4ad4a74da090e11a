// SPDX-License-Identifier: MIT
#include "batten/io/report_scene.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <variant>

#include "batten/fitting/deviation_map.h"
#include "batten/fitting/neighbours.h"
#include "batten/geometry/bounding_box.h"
#include "batten/geometry/curve_evaluator.h"
#include "batten/geometry/surface_evaluator.h"
#include "geometry/nurbs/placed_curve.h"
#include "io/report/report_curve.h"
#include "io/report/report_points.h"
#include "io/report/report_surface.h"

namespace batten {
using namespace internal;
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

void CheckScene(const std::vector<Geometry>& geometry,
                const MeasuredPoints& points,
                const ReportSceneOptions& options) {
  const auto require = [](bool holds, const char* rule) {
    if (!holds) throw std::invalid_argument(std::string("MakeReportScene: ") + rule);
  };
  const Eigen::Index size = points.cloud.size();
  constexpr Eigen::Index kFewest = 1000;
  require(!geometry.empty(), "geometry: there is none");
  require(points.distances.size() == size, "distances: one a point is needed");
  require(points.parameters.cols() == size, "parameters: one column a point is needed");
  require(points.outliers.size() == 0 || points.outliers.size() == size,
          "outliers: one a point is needed, or none");
  require(points.owners.empty() || std::ssize(points.owners) == size,
          "owners: one a point is needed, or none");
  for (const int owner : points.owners) {
    require(owner >= 0 && owner < std::ssize(geometry), "owners: no such geometry");
  }
  require(options.names.empty() || options.names.size() == geometry.size(),
          "names: one a geometry is needed, or none");
  require(!options.tolerance || *options.tolerance > 0, "tolerance: must be positive");
  require(options.max_triangles >= kFewest, "max_triangles: must be 1000 or more");
  require(options.max_points >= kFewest, "max_points: must be 1000 or more");
  for (Eigen::Index k = 0; k < size; ++k) {
    const int owner = points.owners.empty() ? 0 : points.owners[static_cast<std::size_t>(k)];
    const bool surface = std::holds_alternative<NurbsSurface>(geometry[owner]);
    require(points.parameters.rows() >= (surface ? 2 : 1), "parameters: a surface needs two rows");
  }
}

Eigen::AlignedBox3d BoxOf(const NurbsSurface& surface) { return BoundingBox(surface); }
template <int Dim>
Eigen::AlignedBox3d BoxOf(const NurbsCurve<Dim>& curve) {
  const auto box = BoundingBox(curve);
  Eigen::AlignedBox3d result(Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
  result.min().head<Dim>() = box.min();
  result.max().head<Dim>() = box.max();
  return result;
}

// What is drawn: the geometries near the scene's centre, and where each is among its kind.
struct Shapes {
  std::vector<NurbsSurface> surfaces;
  std::vector<NurbsCurve<3>> curves;
  std::vector<int> place;  // of every geometry among those of its kind
  std::vector<bool> is_surface;
  bool plane = true;  // only curves of the plane
};

Shapes ShapesOf(const std::vector<Geometry>& geometry, const Eigen::Vector3d& by) {
  Shapes shapes;
  for (const Geometry& one : geometry) {
    shapes.plane = shapes.plane && std::holds_alternative<NurbsCurve<2>>(one);
    if (const auto* surface = std::get_if<NurbsSurface>(&one)) {
      shapes.place.push_back(static_cast<int>(shapes.surfaces.size()));
      shapes.surfaces.push_back(surface->Translated(by));
    } else {
      const auto* flat = std::get_if<NurbsCurve<2>>(&one);
      shapes.place.push_back(static_cast<int>(shapes.curves.size()));
      shapes.curves.push_back(Translated(flat ? InSpace(*flat) : std::get<NurbsCurve<3>>(one), by));
    }
    shapes.is_surface.push_back(std::holds_alternative<NurbsSurface>(one));
  }
  return shapes;
}

// The points against the shapes.
class Measurement {
 public:
  Measurement(const MeasuredPoints& points, const Shapes& shapes, const Eigen::Vector3d& center)
      : points_(points), shapes_(shapes), by_(points.cloud.origin() - center) {}

  Eigen::Index size() const { return points_.cloud.size(); }
  Eigen::Vector3d Point(Eigen::Index k) const { return points_.cloud.points().col(k) + by_; }
  bool counts(Eigen::Index k) const { return points_.outliers.size() == 0 || !points_.outliers[k]; }
  std::size_t owner(Eigen::Index k) const {
    return points_.owners.empty()
               ? 0
               : static_cast<std::size_t>(points_.owners[static_cast<std::size_t>(k)]);
  }

  // The deviations with their signs; of plane curves, that of the side.
  Eigen::VectorXd Signed(ThreadPool& pool) const {
    if (!shapes_.plane) return points_.distances;
    const std::vector<CurveEvaluator<3>> curves(shapes_.curves.begin(), shapes_.curves.end());
    Eigen::VectorXd result = points_.distances.cwiseAbs();
    constexpr std::ptrdiff_t kBlock = 1024;
    pool.For(size(), kBlock, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      for (std::ptrdiff_t k = begin; k < end; ++k) {
        const CurveJet<3> jet = curves[owner(k)].JetAt(points_.parameters(0, k));
        const Eigen::Vector3d off = Point(k) - jet.point;
        if (jet.first.x() * off.y() - jet.first.y() * off.x() < 0) result[k] = -result[k];
      }
    });
    return result;
  }

  // For every geometry the numbers of the points that count.
  std::vector<std::vector<Eigen::Index>> Members() const {
    std::vector<std::vector<Eigen::Index>> members(shapes_.place.size());
    for (Eigen::Index k = 0; k < size(); ++k) {
      if (counts(k)) members[owner(k)].push_back(k);
    }
    return members;
  }

  struct FootPointSet {
    Eigen::Matrix3Xd places;
    Eigen::VectorXd distances;
  };
  FootPointSet FootPointsOn(const NurbsSurface& surface,
                            const std::vector<Eigen::Index>& members,
                            const Eigen::VectorXd& deviations,
                            ThreadPool& pool) const {
    const auto count = static_cast<Eigen::Index>(members.size());
    Eigen::Matrix2Xd parameters(2, count);
    FootPointSet feet{{}, Eigen::VectorXd(count)};
    for (Eigen::Index j = 0; j < count; ++j) {
      const Eigen::Index k = members[static_cast<std::size_t>(j)];
      parameters.col(j) = points_.parameters.col(k).head<2>();
      feet.distances[j] = deviations[k];
    }
    SurfaceEvaluator(surface).Points(parameters, feet.places, pool);
    return feet;
  }

  ReportCloud Cloud(const Eigen::VectorXd& deviations, Eigen::Index most) const {
    const std::vector<Eigen::Index> shown = ShownPoints(deviations, points_.outliers, most);
    const auto count = static_cast<Eigen::Index>(shown.size());
    ReportCloud cloud;
    cloud.total = size();
    cloud.points.resize(3, count);
    cloud.deviation.resize(count);
    cloud.outlier.resize(count);
    for (Eigen::Index j = 0; j < count; ++j) {
      const Eigen::Index k = shown[static_cast<std::size_t>(j)];
      cloud.points.col(j) = Point(k);
      cloud.deviation[j] = deviations[k];
      cloud.outlier[j] = !counts(k);
    }
    if (shapes_.curves.empty()) return cloud;
    cloud.feet.resize(3, count);
    cloud.parameters.setConstant(count, kNone);
    for (Eigen::Index j = 0; j < count; ++j) {
      const Eigen::Index k = shown[static_cast<std::size_t>(j)];
      const auto place = static_cast<std::size_t>(shapes_.place[owner(k)]);
      const double u = points_.parameters(0, k);
      if (shapes_.is_surface[owner(k)]) {
        cloud.feet.col(j) = shapes_.surfaces[place].At(u, points_.parameters(1, k));
      } else {
        cloud.feet.col(j) = shapes_.curves[place].At(u);
        cloud.parameters[j] = u;
      }
    }
    return cloud;
  }

 private:
  const MeasuredPoints& points_;
  const Shapes& shapes_;
  Eigen::Vector3d by_;
};

// How near a foot has to be to say something of a place: a few times the distance from one point
// to the next, which in scans of lines is more across them than along.
double Reach(double area, Eigen::Index points, double spacing) {
  constexpr double kNear = 3, kFar = 8;
  const double even = std::sqrt(area / static_cast<double>(std::max<Eigen::Index>(points, 1)));
  if (!(spacing > 0)) return kNear * even;
  return std::clamp(kNear * even, kNear * spacing, kFar * spacing);
}

void AddDeviations(ReportScene& scene,
                   const Measurement& measured,
                   const Shapes& shapes,
                   const Eigen::VectorXd& deviations,
                   double spacing,
                   ThreadPool& pool) {
  double area = 0;
  for (const ReportSurface& surface : scene.surfaces) area += AreaOf(surface.mesh);
  const double reach = Reach(area, measured.size(), spacing);
  const std::vector<std::vector<Eigen::Index>> members = measured.Members();
  for (std::size_t g = 0; g < shapes.place.size(); ++g) {
    if (!shapes.is_surface[g]) continue;
    const auto place = static_cast<std::size_t>(shapes.place[g]);
    ReportSurface& surface = scene.surfaces[place];
    const auto feet = measured.FootPointsOn(shapes.surfaces[place], members[g], deviations, pool);
    surface.deviation =
        reach > 0 ? DeviationMap(surface.mesh.vertices, feet.places, feet.distances, reach, pool)
                  : Eigen::VectorXd::Constant(surface.mesh.vertices.cols(), kNone);
  }
}

// The other way: how far each vertex is from the nearest of the points that count.
void AddGaps(ReportScene& scene, const Measurement& measured, ThreadPool& pool) {
  Eigen::Matrix3Xd points(3, measured.size());
  Eigen::Index counted = 0;
  for (Eigen::Index k = 0; k < measured.size(); ++k)
    if (measured.counts(k)) points.col(counted++) = measured.Point(k);
  if (counted == 0 || scene.surfaces.empty()) return;
  points.conservativeResize(3, counted);
  const NeighbourIndex index(points, pool);
  constexpr std::ptrdiff_t kBlock = 4096;
  for (ReportSurface& surface : scene.surfaces) {
    const Eigen::Matrix3Xd& vertices = surface.mesh.vertices;
    surface.gap.resize(vertices.cols());
    pool.For(vertices.cols(), kBlock, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      const std::vector<int> nearest = index.Nearest(vertices.middleCols(begin, end - begin), 1);
      for (std::ptrdiff_t k = begin; k < end; ++k) {
        const int point = nearest[static_cast<std::size_t>(k - begin)];
        surface.gap[k] = (vertices.col(k) - points.col(point)).norm();
      }
    });
  }
}

std::string NameOf(const ReportSceneOptions& options, std::size_t g, const char* kind, int place) {
  if (!options.names.empty() && !options.names[g].empty()) return options.names[g];
  return std::string(kind) + " " + std::to_string(place + 1);
}

}  // namespace

ReportScene MakeReportScene(const std::vector<Geometry>& geometry,
                            const MeasuredPoints& points,
                            const ReportSceneOptions& options,
                            ThreadPool& pool) {
  CheckScene(geometry, points, options);
  Eigen::AlignedBox3d box;
  for (const Geometry& one : geometry) {
    const Eigen::AlignedBox3d its = std::visit([](const auto& shape) { return BoxOf(shape); }, one);
    box.extend(its.min() + options.shift);
    box.extend(its.max() + options.shift);
  }
  for (Eigen::Index k = 0; k < points.cloud.size(); ++k) {
    if (points.outliers.size() == 0 || !points.outliers[k]) box.extend(points.cloud.World(k));
  }
  ReportScene scene;
  scene.center = box.center();
  scene.size = box.diagonal().norm();
  if (!(scene.size > 0)) scene.size = 1;
  scene.tolerance = options.tolerance;
  scene.limit = DeviationLimit(
      points.distances, points.outliers, options.tolerance, points.noise, scene.size);

  const Shapes shapes = ShapesOf(geometry, options.shift - scene.center);
  scene.signed_values = shapes.plane || !shapes.surfaces.empty();
  constexpr double kOfLimit = 1.0 / 3, kFinest = 5e-5, kCoarsest = 2e-4;
  const double chord =
      std::clamp(kOfLimit * scene.limit, kFinest * scene.size, kCoarsest * scene.size);
  scene.surfaces =
      DrawSurfaces(shapes.surfaces, {chord, options.max_triangles, options.progress}, pool);

  Eigen::Index samples = 0;
  std::vector<Eigen::Matrix3Xd> coarse;
  for (const NurbsCurve<3>& curve : shapes.curves) {
    coarse.push_back(CoarseSamples(curve));
    samples += coarse.back().cols();
  }
  Eigen::Matrix3Xd all(3, samples);
  for (Eigen::Index k = 0, next = 0; k < std::ssize(coarse); next += coarse[k++].cols()) {
    all.middleCols(next, coarse[k].cols()) = coarse[k];
  }
  const Plan plan = PlanOf(all);
  scene.plan_u = plan.u;
  scene.plan_v = plan.v;
  for (const NurbsCurve<3>& curve : shapes.curves) {
    Report(options.progress, "draw", 0);
    scene.curves.push_back(DrawCurve(curve, plan, kFinest * scene.size));
  }
  for (std::size_t g = 0; g < geometry.size(); ++g) {
    const int place = shapes.place[g];
    if (shapes.is_surface[g]) {
      scene.surfaces[static_cast<std::size_t>(place)].name = NameOf(options, g, "surface", place);
    } else {
      scene.curves[static_cast<std::size_t>(place)].name = NameOf(options, g, "curve", place);
    }
  }

  Report(options.progress, "draw", 1);
  const Measurement measured(points, shapes, scene.center);
  const Eigen::VectorXd deviations = measured.Signed(pool);
  AddDeviations(scene, measured, shapes, deviations, points.spacing, pool);
  AddGaps(scene, measured, pool);
  scene.histogram =
      HistogramOf(deviations, points.outliers, options.tolerance, scene.signed_values);
  scene.cloud = measured.Cloud(deviations, options.max_points);
  return scene;
}

ReportScene MakeReportScene(const SurfaceFit& fit,
                            const PointCloud& cloud,
                            ReportSceneOptions options,
                            ThreadPool& pool) {
  options.tolerance = fit.report.error.tolerance;
  const Eigen::MatrixXd parameters = fit.parameters;
  return MakeReportScene({fit.surface},
                         {.cloud = cloud,
                          .distances = fit.residuals,
                          .parameters = parameters,
                          .outliers = fit.outliers,
                          .spacing = fit.report.input.spacing,
                          .noise = fit.report.input.noise},
                         options,
                         pool);
}

template <int Dim>
ReportScene MakeReportScene(const CurveFit<Dim>& fit,
                            const PointCloud& cloud,
                            ReportSceneOptions options,
                            ThreadPool& pool) {
  options.tolerance = fit.report.error.tolerance;
  const Eigen::MatrixXd parameters = fit.parameters.transpose();
  return MakeReportScene({fit.curve},
                         {.cloud = cloud,
                          .distances = fit.residuals,
                          .parameters = parameters,
                          .outliers = fit.outliers,
                          .spacing = fit.report.input.spacing,
                          .noise = fit.report.input.noise},
                         options,
                         pool);
}

template ReportScene MakeReportScene(const CurveFit<2>&,
                                     const PointCloud&,
                                     ReportSceneOptions,
                                     ThreadPool&);
template ReportScene MakeReportScene(const CurveFit<3>&,
                                     const PointCloud&,
                                     ReportSceneOptions,
                                     ThreadPool&);

}  // namespace batten
