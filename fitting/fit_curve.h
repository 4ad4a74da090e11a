// SPDX-License-Identifier: MIT
// A NURBS curve from measured points along it.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "batten/fitting/cloud_statistics.h"
#include "batten/fitting/curve_arrangement.h"
#include "batten/fitting/curve_spans.h"
#include "batten/fitting/fit_report.h"
#include "batten/fitting/freedom.h"
#include "batten/fitting/point_cloud.h"
#include "batten/fitting/progress.h"
#include "batten/fitting/robust_loss.h"
#include "batten/fitting/smooth_by.h"
#include "batten/geometry/nurbs_curve.h"

namespace batten {

struct CurveFitOptions {
  int degree = 3;                                  // 1 … 25
  std::optional<double> tolerance = std::nullopt;  // distance in the data's units, > 0
  // Chosen by the data, or by the tolerance, when absent; > degree
  std::optional<int> control_points = std::nullopt;
  int max_control_points = 2000;  // > degree
  CurveParameterization parameterization = CurveParameterization::kChord;
  PointOrder order = PointOrder::kAuto;            // where the points' order comes from
  ClosedChoice closed = ClosedChoice::kAuto;       // whether the curve closes
  bool corners = true;                             // found and kept; else the curve is smooth
  CurveDistance distance = CurveDistance::kAuto;   // what is fitted and held to the tolerance
  std::optional<double> smoothing = std::nullopt;  // fairness relative to the data, ≥ 0; 1e-10
  // Fairness from the data in place of that: knots are then more than enough, and smoothing decides
  SmoothBy smooth_by = SmoothBy::kWeight;
  // When absent: Tukey's where there are points far off, else none
  std::optional<Loss> loss = std::nullopt;
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
  PointMask outliers;  // points that the curve does not follow: strays, and what a loss forgets
  FitReport report;    // describes exactly this curve
};

// Fits a curve to points along it, in order or not, open or closed (then periodic and as smooth at
// the seam as elsewhere, unless there is a corner). Without a tolerance it has as many spans as the
// data can tell apart from fewer, fewest where noise is thick; with one, as few as keep it. Corners
// become knots of full multiplicity. Points far off are left out. The domain is [0, 1], or the
// range of given parameters, knots in their units, whose fit is at the parameters. A plane cloud
// (Dim = 2) gives a plane curve; in space it lies at z = 0. Throws std::invalid_argument, with a
// sentence for the user, when the points can't carry a curve, branch, or belong to several
// (FitCurves takes those); Cancelled when progress stops it before there is one.
template <int Dim>
CurveFit<Dim> FitCurve(const PointCloud& cloud, const CurveFitOptions& options = {});

// The same for the curve of every component of unordered points, longest first. Points of the
// others are no outliers of a curve; they are not in its report.
template <int Dim>
std::vector<CurveFit<Dim>> FitCurves(const PointCloud& cloud, const CurveFitOptions& options = {});

// The component-th of them, 1 the longest, alone. Throws std::invalid_argument where there are
// fewer.
template <int Dim>
CurveFit<Dim> FitComponent(const PointCloud& cloud,
                           int component,
                           const CurveFitOptions& options = {});

extern template CurveFit<2> FitCurve<2>(const PointCloud&, const CurveFitOptions&);
extern template CurveFit<3> FitCurve<3>(const PointCloud&, const CurveFitOptions&);
extern template std::vector<CurveFit<2>> FitCurves<2>(const PointCloud&, const CurveFitOptions&);
extern template std::vector<CurveFit<3>> FitCurves<3>(const PointCloud&, const CurveFitOptions&);
extern template CurveFit<2> FitComponent<2>(const PointCloud&, int, const CurveFitOptions&);
extern template CurveFit<3> FitComponent<3>(const PointCloud&, int, const CurveFitOptions&);

}  // namespace batten
