// SPDX-License-Identifier: MIT
// Lines and circles from measured points, as exact NURBS.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <variant>

#include "batten/fitting/cloud_statistics.h"
#include "batten/fitting/fit_report.h"
#include "batten/fitting/point_cloud.h"
#include "batten/fitting/progress.h"
#include "batten/fitting/robust_loss.h"
#include "batten/geometry/classify_shape.h"
#include "batten/geometry/nurbs_curve.h"

namespace batten {

enum class PrimitiveKind {
  kAuto,  // the simplest that the points do not reject
  kLine,
  kCircle,
};

// The word the report uses, as in "circle".
const char* Name(PrimitiveKind kind);

struct PrimitiveFitOptions {
  PrimitiveKind kind = PrimitiveKind::kAuto;
  std::optional<double> tolerance = std::nullopt;  // distance in the data's units, > 0; only judged
  std::optional<Loss> loss = std::nullopt;         // none when absent
  std::optional<double> loss_scale =
      std::nullopt;  // standard deviation of good points, > 0; estimated when absent
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  // subtracted from the coordinates of the result
  std::uint64_t seed = 1;                           // chooses the samples a robust fit starts from
  int threads = 0;                                  // 0: all cores
  Progress progress = nullptr;
};

// Throws std::invalid_argument naming the field whose value breaks its rule.
void Check(const PrimitiveFitOptions& options);

struct PrimitiveFit {
  // In world coordinates less options.shift, like the curve; shapes of the plane lie at z = 0.
  std::variant<LineShape, CircleShape> shape;
  std::variant<NurbsCurve<2>, NurbsCurve<3>> curve;  // of the plane where the cloud is
  Eigen::VectorXd parameters;                        // foot point of every point on the curve
  Eigen::VectorXd residuals;                         // its orthogonal distance
  PointMask outliers;                                // points that do not count
  FitReport report;                                  // describes exactly this curve
};

// The line or circle of least Σ w ρ(d), d the orthogonal distance in the plane or in space, w the
// cloud's weights. Without a loss ρ = d²/2. With one, the search starts from what most points agree
// on and outliers, almost half of the points if need be, count in no sum: those to which Tukey's
// loss gives no weight at the scale given, or else at 1.4826 times the median distance of the
// others. Over the rest the loss asked for is minimised at this scale.
// The curve covers the points that count: a segment between the outermost feet; a full circle where
// they go all round (no gap above 60°, or the largest not above 1.5 times the mean of the others),
// else the arc without the largest gap. With a loss, feet far from all others are passed over. A
// circle turns counter-clockwise about its axis, which in space follows the order of the points; a
// line leads from the first point to the last.
// kAuto takes the circle where it explains more than chance would: with N distance components, D
// the fall of Σ w d² against the line in units of the circle's variance, k the difference of
// freedoms and f = N − those of the circle, where f·log(1 + D/f) > 2 k log N (1 + 2/f): twice the
// penalty of Schwarz's criterion, and more where the points are few. [Schwarz 1978] Throws
// std::invalid_argument, with a sentence for the user, where fewer than two (circle: three) points
// differ, and where a circle is asked for points on one line; Cancelled when progress stops it.
// O(m) a step, O(m log m) in all.
PrimitiveFit FitPrimitive(const PointCloud& cloud, const PrimitiveFitOptions& options = {});

}  // namespace batten
