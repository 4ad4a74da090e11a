// SPDX-License-Identifier: MIT
// What the page of a report shows, as plain numbers: meshes, curves, points and a histogram.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "batten/fitting/cloud_statistics.h"
#include "batten/fitting/fit_curve.h"
#include "batten/fitting/fit_surface.h"
#include "batten/fitting/point_cloud.h"
#include "batten/fitting/progress.h"
#include "batten/geometry/tessellate.h"
#include "batten/geometry/thread_pool.h"
#include "batten/io/geometry_file.h"

namespace batten {

// Everything below is relative to ReportScene::center.
struct ReportSurface {
  std::string name;
  TriangleMesh mesh;
  Eigen::VectorXd deviation;       // at the vertices (DeviationMap); NaN where no point is near
  Eigen::VectorXd gaussian, mean;  // curvature there; NaN where it has no finite limit
  // Polylines on the surface: trim loops, closed; the edges of the domain of an untrimmed one that
  // are neither seam nor point; lines of interior knots, inside the trims.
  std::vector<Eigen::Matrix3Xd> trims, edges, knot_lines;
  int net_u = 0, net_v = 0;
  Eigen::Matrix3Xd net;  // control points, v runs fastest
};

struct ReportCurve {
  std::string name;
  bool closed = false;
  bool planar = false;         // lies in a plane, along the scene's plan axes; curvature has a sign
  Eigen::Matrix3Xd points;     // samples, at a jump of direction or curvature two
  Eigen::VectorXd parameters;  // of these
  Eigen::VectorXd curvature;   // positive to the left where planar; NaN where it is not finite
  Eigen::Matrix3Xd normals;    // unit vectors away from the centre of curvature
  Eigen::Matrix3Xd net, knots;  // control points; the places of distinct interior knots
};

struct ReportCloud {
  Eigen::Matrix3Xd points;
  Eigen::VectorXd deviation;   // of each, signed as the scene says
  PointMask outlier;           // set aside
  Eigen::Matrix3Xd feet;       // on the geometry; none where there are only surfaces
  Eigen::VectorXd parameters;  // of these on their curves, NaN on surfaces; likewise
  Eigen::Index total = 0;      // points there are; those above are what is shown of them
};

// Of the deviations of all points that count.
struct ReportHistogram {
  double low = 0, high = 0;  // the ends of the bins, all equally wide; low < high unless empty
  std::vector<Eigen::Index> counts;
  Eigen::Index below = 0, above = 0;
  double mean = 0, deviation = 0;  // the standard one, of all of them, those beyond the bins too
};

struct ReportScene {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  // in the coordinates of the points
  double size = 0;                                   // diagonal of the box, > 0
  std::optional<double> tolerance = std::nullopt;
  double limit = 0;            // half width of the colour range, > 0 (DeviationLimit)
  bool signed_values = false;  // whether deviations have a sign
  std::vector<ReportSurface> surfaces;
  std::vector<ReportCurve> curves;
  // Axes in which curves are drawn flat, at right angles to each other: x and y for plane curves.
  Eigen::Vector3d plan_u = Eigen::Vector3d::UnitX(), plan_v = Eigen::Vector3d::UnitY();
  ReportCloud cloud;
  ReportHistogram histogram;
};

// Points with their distances from one or several geometries.
struct MeasuredPoints {
  const PointCloud& cloud;
  const Eigen::VectorXd& distances;   // signed along the normals of surfaces, else not negative
  const Eigen::MatrixXd& parameters;  // of the feet, 1 or 2 × m
  PointMask outliers = {};            // points that do not count; empty: none
  std::vector<int> owners = {};       // number of the geometry of each foot; empty: the first
  double spacing = 0, noise = 0;      // of the points, as InputSummary has them; 0: not known
};

struct ReportSceneOptions {
  std::optional<double> tolerance = std::nullopt;   // > 0
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  // the geometry's coordinates are less by this
  Eigen::Index max_triangles = 150000, max_points = 150000;  // ≥ 1000
  std::vector<std::string> names = {};                       // of the geometries; empty ones: none
  Progress progress = nullptr;
};

// The scene of geometries and the points that were measured against them.
//  · Meshes keep a chord tolerance of a third of the limit, within 5e-5 and 2e-4 of the size, and
//    cells small enough to show the deviation everywhere; where that needs more than max_triangles
//    the tolerance grows until it does not.
//  · Deviations from plane curves get a sign: positive on the left.
//  · Of more than max_points points those are kept that do not count (half of max_points at most,
//    the farthest), then those farthest off (one in a hundred), and of the others every k-th or
//    so: one of each run of the cloud's order, chosen by its number. The same input gives the same
//    scene, on any number of threads.
// A million points cost some 0.3 s. Throws std::invalid_argument where sizes disagree, nothing is
// given, or an option is out of range; Cancelled when progress stops it.
ReportScene MakeReportScene(const std::vector<Geometry>& geometry,
                            const MeasuredPoints& points,
                            const ReportSceneOptions& options,
                            ThreadPool& pool);

// Of a fit and the cloud it was made from. `shift` is that of the fit's options; the tolerance and
// what is known of the points are the report's.
ReportScene MakeReportScene(const SurfaceFit& fit,
                            const PointCloud& cloud,
                            ReportSceneOptions options,
                            ThreadPool& pool);
template <int Dim>
ReportScene MakeReportScene(const CurveFit<Dim>& fit,
                            const PointCloud& cloud,
                            ReportSceneOptions options,
                            ThreadPool& pool);

// Half the width of a colour range for deviations: the tolerance. Without one what 99 % of the
// points that count keep, or three times the noise where that is more, but no more than three times
// as much; up to the next of 1, 1.5, 2, 2.5, 3, 4, 5, 6, 8 times a power of ten. At least 1e-9 of
// `size`, below which all is rounding; 1 where everything is 0.
double DeviationLimit(const Eigen::VectorXd& distances,
                      const PointMask& outliers,
                      std::optional<double> tolerance,
                      double noise,
                      double size);

extern template ReportScene MakeReportScene(const CurveFit<2>&,
                                            const PointCloud&,
                                            ReportSceneOptions,
                                            ThreadPool&);
extern template ReportScene MakeReportScene(const CurveFit<3>&,
                                            const PointCloud&,
                                            ReportSceneOptions,
                                            ThreadPool&);

}  // namespace batten
