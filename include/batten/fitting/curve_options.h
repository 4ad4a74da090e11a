// SPDX-License-Identifier: MIT
// Options and result of curve fitting.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <optional>

#include "batten/fitting/fit_estimator.h"
#include "batten/fitting/fit_report.h"
#include "batten/fitting/free_variables.h"
#include "batten/fitting/point_cloud.h"
#include "batten/fitting/point_mask.h"
#include "batten/fitting/progress.h"
#include "batten/fitting/residual_term.h"
#include "batten/fitting/robust_loss.h"
#include "batten/fitting/smooth_by.h"
#include "batten/geometry/nurbs_curve.h"

namespace batten {

// The parameterization of a curve's points.
enum class CurveParameterization {
  kGiven,        // the points' parameters, in their own range
  kUniform,      // equal steps on [0, 1]
  kChord,        // steps in proportion to the distance of neighbours, on [0, 1]
  kCentripetal,  // steps in proportion to its square root, on [0, 1] [Lee 1989]
  kFoley,        // longer steps where the points turn, measured against the spread of all points in
                 // every direction: affine maps of the points change nothing [Foley & Nielson 1989]
  kUniversal,    // where the B-spline functions over uniform knots have their maxima, whatever the
                 // points are [Lim 1999]
};

// The source of the order of a curve's points.
enum class PointOrder {
  kAuto,       // the cloud's order if it follows a curve, else one found from neighbourhoods
  kGiven,      // the order of the cloud; given parameters must not decrease
  kUnordered,  // an order found from neighbourhoods
};

// Whether a curve closes.
enum class ClosedChoice {
  kAuto,  // when its ends are next to each other, or face each other within 30° across a gap below
          // 0.1 of its length
  kYes,   // always; the gap tells what was bridged
  kNo,    // never; a closed curve is cut at its largest gap
};

// The distance of the data from their curve that is minimised.
enum class CurveDistance {
  kAuto,       // at the parameters where those are given, orthogonal otherwise
  kParameter,  // from the point at the datum's own parameter
  kPoint,      // from the nearest point
  kTangent,    // from the nearest point, by tangent distance (distance_minimisation.h)
  kSquared,    // from the nearest point, by squared distance minimisation
};

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
  CurveDistance distance = CurveDistance::kAuto;   // minimised, held to the tolerance
  std::optional<double> smoothing = std::nullopt;  // fairness relative to the data, ≥ 0; 1e-10
  // Choice of the fairness weight by the data instead: knots are then plentiful
  SmoothBy smooth_by = SmoothBy::kWeight;
  // When absent: Tukey's where there are outliers, else none
  std::optional<Loss> loss = std::nullopt;
  std::optional<double> loss_scale =
      std::nullopt;  // standard deviation of good points, > 0; estimated when absent
  std::optional<FreeVariables> optimize =
      std::nullopt;  // joint stage: where it pays when absent, never when nothing is free
  // The user's own terms of the joint stage, which then runs and whose result is taken: called with
  // the basis and the control points (Dim × n) that the stage starts from, so that terms can name
  // them. These and the values handed to the terms are in world coordinates less `shift`
  std::function<ResidualTerms(const SplineBasis& basis, const Eigen::MatrixXd& control_points)>
      terms = nullptr;
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
  Eigen::VectorXd residuals;   // orthogonal distance of each
  // Points that do not count: outliers, those to which the loss gives zero weight and, where one of
  // several curves is fitted alone, those of the others.
  PointMask outliers;
  FitReport report;             // describes exactly this curve
  FitEstimator estimator = {};  // for Uncertainty
};

}  // namespace batten
