// SPDX-License-Identifier: MIT
// Options and result of fitting a line, circle, plane, sphere, cylinder, cone or torus.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <variant>

#include "batten/fitting/fit_report.h"
#include "batten/fitting/point_mask.h"
#include "batten/fitting/progress.h"
#include "batten/fitting/robust_loss.h"
#include "batten/geometry/classify_shape.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

enum class PrimitiveKind {
  kAuto,  // the simplest shape that the points do not reject
  kLine,
  kCircle,
  kPlane,
  kSphere,
  kCylinder,
  kCone,
  kTorus,
};

// The name that the report uses, such as "circle".
const char* Name(PrimitiveKind kind);

struct PrimitiveFitOptions {
  PrimitiveKind kind = PrimitiveKind::kAuto;
  std::optional<double> tolerance = std::nullopt;  // distance in the data's units, > 0; only judged
  // Absent: no loss for lines and circles; for surfaces least squares over the inliers, outliers
  // being points farther off than noise of the size the others show can explain.
  std::optional<Loss> loss = std::nullopt;
  std::optional<double> loss_scale =
      std::nullopt;  // standard deviation of inliers, > 0; estimated when absent
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  // subtracted from the coordinates of the result
  std::uint64_t seed = 1;                           // seed of the random samples of a robust start
  int threads = 0;                                  // 0: all cores
  Progress progress = nullptr;
};

// Throws std::invalid_argument naming the field whose value breaks its rule.
void Check(const PrimitiveFitOptions& options);

using PrimitiveShape = std::
    variant<LineShape, CircleShape, PlaneShape, SphereShape, CylinderShape, ConeShape, TorusShape>;

struct PrimitiveFit {
  // In world coordinates less options.shift, like the geometry; shapes of the plane lie at z = 0.
  std::
      variant<LineShape, CircleShape, PlaneShape, SphereShape, CylinderShape, ConeShape, TorusShape>
          shape;
  std::variant<NurbsCurve<2>, NurbsCurve<3>, NurbsSurface> geometry;  // of the plane: the cloud is
  Eigen::MatrixXd parameters;  // of every point's foot: 1 × m, of surfaces 2 × m
  Eigen::VectorXd residuals;   // orthogonal distances, of surfaces signed along the normal
  PointMask outliers;          // points that do not count in the fit
  FitReport report;            // describes exactly this geometry
};

}  // namespace batten
