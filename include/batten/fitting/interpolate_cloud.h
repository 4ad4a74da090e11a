// SPDX-License-Identifier: MIT
// Interpolates the points of a cloud, in their order, by a curve.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "batten/fitting/curve_options.h"
#include "batten/fitting/curve_parameterization.h"
#include "batten/fitting/point_cloud.h"

namespace batten {

// The ends of a cubic spline with a knot at every point.
enum class SplineEnds {
  kNatural,    // no curvature
  kClamped,    // the tangents given
  kCurvature,  // the curvatures given
  kNotAKnot,   // the second point from either end is no knot
  kPeriodic,   // none: closed; a function of x: periodic, its last value the first
};

struct CloudInterpolationOptions {
  int degree = 3;  // 1 … 25
  // A cubic spline, C² with a knot at every point; knots are means of parameters when absent. A
  // tangent or curvature given at one end holds there whatever this says. Degree 3.
  std::optional<SplineEnds> spline = std::nullopt;
  // The curve of a function: y(x), in space y and z of x. Its parameter is x, the first coordinate,
  // in which points may come in any order (a warning tells), and C' has x' = 1; `parameterization`
  // is not looked at.
  bool function_of_x = false;
  CurveParameterization parameterization = CurveParameterization::kChord;
  bool keep_order = false;  // given parameters must not decrease from point to point
  bool closed =
      false;  // periodic, C^{p−1} everywhere; the first point may be there again at the end
  // Directions at the ends of an open curve; how fast the curve is there follows from the points
  // (EndTangent in interpolate_curve.h). A plane cloud takes their first two coordinates.
  std::optional<Eigen::Vector3d> start_tangent = std::nullopt;
  std::optional<Eigen::Vector3d> end_tangent = std::nullopt;
  // Curvatures at the ends of a spline: in the plane one number, positive where it turns left; in
  // space the vector towards the centre, one over the radius long, of which the part across the
  // curve counts; a warning tells the other part.
  std::optional<Eigen::VectorXd> start_curvature = std::nullopt;
  std::optional<Eigen::VectorXd> end_curvature = std::nullopt;
  std::optional<double> tolerance = std::nullopt;   // that the report counts by, > 0
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  // subtracted from the coordinates of the result
};

// Interpolates the points in their order, or in that of given parameters (kGiven). Points in a row
// that agree in place, and in parameter where it is given, count once. A closed curve over given
// parameters is back at the first point at the last parameter, if the last point is the first
// again; otherwise the step back is as long for its chord as the others are on average.
// The result's parameters are those at which the curve meets the points, its residuals the
// distances there: rounding. Weights of the cloud do not count. The report says how it
// ended by kToleranceReached or kStalled where a tolerance is given, by kNoiseReached otherwise.
// Throws std::invalid_argument, with a sentence for the user, as InterpolateCurve and OrderPoints
// do, where two different points have one parameter, where a closed curve or a polyline is to have
// end tangents, where a spline lacks what its ends ask for (CubicSplineCurve), where rounding
// leaves a point more than 1e-6 of the points' size off the curve, and if the tolerance is not
// positive. O(m log m + m·p²).
template <int Dim>
CurveFit<Dim> InterpolateCloud(const PointCloud& cloud,
                               const CloudInterpolationOptions& options = {});

extern template CurveFit<2> InterpolateCloud<2>(const PointCloud&,
                                                const CloudInterpolationOptions&);
extern template CurveFit<3> InterpolateCloud<3>(const PointCloud&,
                                                const CloudInterpolationOptions&);

}  // namespace batten
