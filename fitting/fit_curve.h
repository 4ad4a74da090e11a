// SPDX-License-Identifier: MIT
// A NURBS curve from measured points along it.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "batten/fitting/cloud_statistics.h"
#include "batten/fitting/curve_spans.h"
#include "batten/fitting/fit_report.h"
#include "batten/fitting/freedom.h"
#include "batten/fitting/ordered_points.h"
#include "batten/fitting/point_cloud.h"
#include "batten/fitting/progress.h"
#include "batten/fitting/robust_loss.h"
#include "batten/geometry/nurbs_curve.h"

namespace batten {

struct CurveFitOptions {
  int degree = 3;                                  // 1 … 25
  std::optional<double> tolerance = std::nullopt;  // distance in the data's units, > 0
  // n > degree; chosen by cross-validation, or by the tolerance, when absent
  std::optional<int> control_points = std::nullopt;
  int max_control_points = 2000;  // > degree
  CurveParameterization parameterization = CurveParameterization::kChord;
  bool keep_order = false;  // given parameters must not decrease from point to point
  CurveDistance distance = CurveDistance::kAuto;   // what is fitted and held to the tolerance
  std::optional<double> smoothing = std::nullopt;  // fairness relative to the data, ≥ 0; 1e-10
  std::optional<Loss> loss = std::nullopt;         // none when absent
  std::optional<double> loss_scale =
      std::nullopt;  // standard deviation of good points, > 0; estimated when absent
  std::optional<Freedom> optimize =
      std::nullopt;  // joint stage: where it pays when absent, never when nothing is free
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  // subtracted from the coordinates of the result
  std::uint64_t seed = 1;
  int threads = 0;  // 0: all cores
  Progress progress = nullptr;
};

// Throws std::invalid_argument naming the field whose value breaks its rule.
void Check(const CurveFitOptions& options);

template <int Dim>
struct CurveFit {
  NurbsCurve<Dim> curve;       // in world coordinates less options.shift
  Eigen::VectorXd parameters;  // foot point of every point of the cloud
  Eigen::VectorXd residuals;   // its orthogonal distance
  PointMask outliers;          // points that the loss gives no weight
  FitReport report;            // describes exactly this curve
};

// Fits an open curve to points along it: parameters from the points or given with them, as many
// equal spans as cross-validation finds the data to carry or, where there is a tolerance, spans
// halved until it is kept, reweighting where a loss is asked for. The domain is the range of the
// given parameters, knots in their units, or [0, 1]. A plane cloud (Dim = 2) gives a plane curve;
// in space it lies at z = 0. Throws std::invalid_argument, with a sentence for the user, when the
// points can't carry a curve; Cancelled when progress stops it before there is one.
template <int Dim>
CurveFit<Dim> FitCurve(const PointCloud& cloud, const CurveFitOptions& options = {});

extern template CurveFit<2> FitCurve<2>(const PointCloud& cloud, const CurveFitOptions& options);
extern template CurveFit<3> FitCurve<3>(const PointCloud& cloud, const CurveFitOptions& options);

}  // namespace batten
