// SPDX-License-Identifier: MIT
// The options of a surface fit and its result.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "batten/fitting/fit_estimator.h"
#include "batten/fitting/fit_report.h"
#include "batten/fitting/free_variables.h"
#include "batten/fitting/mirror_plane.h"
#include "batten/fitting/point_cloud.h"
#include "batten/fitting/point_mask.h"
#include "batten/fitting/progress.h"
#include "batten/fitting/residual_term.h"
#include "batten/fitting/robust_loss.h"
#include "batten/fitting/smooth_by.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

// The source of the parameterization. kPlane: the plane over which the points are a height field;
// kSheet: the flattened sheet or tube they lie on; kSphere: longitude and latitude of the sphere
// they are near; kTorus: the two angles of such a torus; kRevolution: the angle about an axis and
// the arc length of the profile; kWing: both sides of a thin section, round its nose, joined along
// a sharp edge. kAuto takes the first of these that serves.
enum class BaseShape { kAuto, kPlane, kSheet, kRevolution, kSphere, kTorus, kWing };

// The directions in which the surface closes on itself; kAuto detects them from the points. A
// closed direction is periodic, without a seam. With kNone a closed shape is cut open along a line.
enum class Closing { kAuto, kNone, kU, kV, kBoth };

// Whether the surface is trimmed to the outline and the holes of its points (kAuto), or stays the
// whole rectangle around them (kNone).
enum class Trimming { kAuto, kNone };

// A condition that an edge of the surface meets exactly: a curve, or the edge of a neighbouring
// surface that runs along the points, with its tangent planes. In the cloud's world coordinates.
struct BoundaryCondition {
  std::variant<NurbsCurve<3>, NurbsSurface> shape;
  std::string name;  // for messages, such as the file's name
};

// A rectangle of parameters.
struct DomainBox {
  double u0, v0, u1, v1;
};

struct SurfaceFitOptions {
  int degree_u = 3, degree_v = 3;                  // 1 … 25
  std::optional<double> tolerance = std::nullopt;  // orthogonal distance in the data's units, > 0
  std::optional<std::pair<int, int>> control_points =
      std::nullopt;                // n_u, n_v; chosen by cross-validation when absent
  int max_control_points = 20000;  // ≥ (degree_u + 1)(degree_v + 1)
  std::optional<double> smoothing =
      std::nullopt;  // fairness relative to the data, ≥ 0; 1e-4 when absent
  // Chooses the fairness weight from the data instead; not with a loss or a tolerance
  SmoothBy smooth_by = SmoothBy::kWeight;
  std::optional<Loss> loss = std::nullopt;  // when absent, robust if outliers are found
  std::optional<double> loss_scale =
      std::nullopt;  // standard deviation of inliers, > 0; estimated when absent
  std::optional<FreeVariables> optimize =
      std::nullopt;  // joint stage: where it pays when absent, never if none
  // The user's own terms of the joint stage, which then runs and whose result is taken: called with
  // the surface that the stage starts from, so that terms can name its control points. That surface
  // and the values handed to the terms are in world coordinates less `shift`. Not beside boundary,
  // meet, symmetric, snap or given_parameters
  std::function<ResidualTerms(const NurbsSurface& start)> terms = nullptr;
  BaseShape base = BaseShape::kAuto;
  Closing closed = Closing::kAuto;
  Trimming trim = Trimming::kAuto;
  std::vector<BoundaryCondition> boundary = {};  // at most four, each another edge
  // The distance an edge may keep from its curve, ≥ 0, to save control points
  double boundary_tolerance = 0;
  // Points the surface interpolates exactly; at points with normals also the tangent plane
  std::optional<PointCloud> meet = std::nullopt;
  // The surface is its own mirror image in this plane; the points may lie on one side of it
  std::optional<MirrorPlane> symmetric = std::nullopt;
  // The domain instead of the smallest rectangle: coordinates along the base plane's axes (which
  // the report names), lengths on a sheet
  std::optional<DomainBox> domain = std::nullopt;
  // The side of the cubes, > 0, of which each gives one point to the fit (Thinned); all points are
  // measured
  std::optional<double> thin = std::nullopt;
  bool side_of_normals = false;   // orients the surface by the cloud's normals
  bool given_parameters = false;  // takes the cloud's own (u, v) as parameters
  bool keep_outliers = false;     // fits outliers like any other point
  // Returns an exact plane, cylinder, sphere, cone or torus instead of the free-form surface where
  // that explains the points as well
  bool snap = false;
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  // subtracted from the coordinates of the result
  std::uint64_t seed = 1;                           // chooses samples
  int threads = 0;                                  // 0: all cores
  Progress progress = nullptr;
};

// Throws std::invalid_argument naming the field whose value breaks its rule.
void Check(const SurfaceFitOptions& options);

struct SurfaceFit {
  NurbsSurface surface;         // in world coordinates less options.shift
  Eigen::Matrix2Xd parameters;  // foot point of every point of the cloud
  Eigen::VectorXd residuals;    // its orthogonal distance, signed along the normal
  PointMask outliers;           // points excluded from the fit
  FitReport report;             // measured on this surface
  FitEstimator estimator = {};  // for Uncertainty
};

}  // namespace batten
