// SPDX-License-Identifier: MIT
// The options of a surface's fit and what it returns.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "batten/fitting/fit_report.h"
#include "batten/fitting/free_variables.h"
#include "batten/fitting/mirror_plane.h"
#include "batten/fitting/point_cloud.h"
#include "batten/fitting/point_mask.h"
#include "batten/fitting/progress.h"
#include "batten/fitting/robust_loss.h"
#include "batten/fitting/smooth_by.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

// Where parameters come from: the plane the points are a height field over; the bent sheet or tube
// they lie on laid out flat; longitude and latitude of the sphere they are near; the two angles of
// such a torus; the angle about an axis and the arc length of the profile. The first of these that
// serves when nothing is said.
enum class BaseShape { kAuto, kPlane, kSheet, kRevolution, kSphere, kTorus };

// In which directions the surface closes on itself: as the points tell, or as said. A direction
// that closes is periodic, without a seam. With kNone a closed shape is cut open along a line.
enum class Closing { kAuto, kNone, kU, kV, kBoth };

// Whether the surface is cut back to the outline and the holes of its points, or stays the whole
// rectangle around them.
enum class Trimming { kAuto, kNone };

// What an edge of the surface is to meet exactly: a curve; or a neighbour in that edge of its that
// runs along the points, with its tangent planes there. In the cloud's world coordinates.
struct BoundaryCondition {
  std::variant<NurbsCurve<3>, NurbsSurface> shape;
  std::string name;  // for messages, as that of its file
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
  // Fairness from the data in place of that; without a loss or a tolerance
  SmoothBy smooth_by = SmoothBy::kWeight;
  std::optional<Loss> loss = std::nullopt;  // robust when outliers are found, when absent
  std::optional<double> loss_scale =
      std::nullopt;  // standard deviation of good points, > 0; estimated
  std::optional<FreeVariables> optimize =
      std::nullopt;  // joint stage: where it pays when absent, never when nothing is free
  BaseShape base = BaseShape::kAuto;
  Closing closed = Closing::kAuto;
  Trimming trim = Trimming::kAuto;
  std::vector<BoundaryCondition> boundary = {};  // at most four, each another edge
  // How far an edge may be from its curve, ≥ 0, for fewer control points
  double boundary_tolerance = 0;
  // Points to be met exactly; those with normals also with the tangent plane there
  std::optional<PointCloud> meet = std::nullopt;
  // The surface is its own mirror image in this plane, of which the points may be one side
  std::optional<MirrorPlane> symmetric = std::nullopt;
  // The domain in place of the smallest rectangle: coordinates along the base plane's axes (which
  // the report names), lengths on a sheet
  std::optional<DomainBox> domain = std::nullopt;
  // The fit rests on one point in each cube of that side, > 0 (Thinned); all points are measured
  std::optional<double> thin = std::nullopt;
  bool side_of_normals = false;   // its normal looks to the side that the cloud's own ones do
  bool given_parameters = false;  // at the cloud's own (u, v) instead of a base's
  bool keep_outliers = false;     // fit them like any other point
  // An exact plane, cylinder, sphere, cone or torus in place of the free-form surface where that
  // explains the points as well
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
  PointMask outliers;           // points the fit does not rest on
  FitReport report;             // describes exactly this surface
};

}  // namespace batten
