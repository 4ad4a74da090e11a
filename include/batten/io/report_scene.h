// SPDX-License-Identifier: MIT
// The scene of a report made from geometries and the points that were measured against them.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "batten/fitting/curve_options.h"
#include "batten/fitting/point_cloud.h"
#include "batten/fitting/point_mask.h"
#include "batten/fitting/progress.h"
#include "batten/fitting/surface_options.h"
#include "batten/geometry/thread_pool.h"
#include "batten/io/deviation_limit.h"
#include "batten/io/geometry_types.h"
#include "batten/io/report_types.h"

namespace batten {

// Points with their distances from one or several geometries.
struct MeasuredPoints {
  const PointCloud& cloud;
  const Eigen::VectorXd& distances;   // signed along the normals of surfaces, else not negative
  const Eigen::MatrixXd& parameters;  // of the feet, 1 or 2 × m
  PointMask outliers = {};            // points that do not count; empty: none
  std::vector<int> owners = {};       // number of the geometry of each foot; empty: the first
  double spacing = 0, noise = 0;      // of the points, as InputSummary has them; 0: not known
  Eigen::VectorXd deviations = {};    // of the geometry at the feet; empty: not known
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

extern template ReportScene MakeReportScene(const CurveFit<2>&,
                                            const PointCloud&,
                                            ReportSceneOptions,
                                            ThreadPool&);
extern template ReportScene MakeReportScene(const CurveFit<3>&,
                                            const PointCloud&,
                                            ReportSceneOptions,
                                            ThreadPool&);

}  // namespace batten
