// SPDX-License-Identifier: MIT
// Fitting of NURBS curves to measured points.
#pragma once

#include <vector>

#include "batten/fitting/curve_options.h"
#include "batten/fitting/point_cloud.h"

namespace batten {

// Fits a curve to points along it, in order or not, open or closed (then periodic and as smooth at
// the seam as elsewhere, unless there is a corner). Without a tolerance the curve has as many spans
// as the data can distinguish from fewer, the fewest where noise is large; with a tolerance, as few
// as keep it. Corners become knots of full multiplicity. Outliers are left out. The domain is [0,
// 1]; with given parameters it is their range, knots are in their units, and by default distances
// are measured at them. A plane cloud (Dim = 2) gives a plane curve; in space it lies at z = 0.
// Throws std::invalid_argument, with a sentence for the user, when the points can't carry a curve,
// branch, or belong to several (FitCurves takes those); Cancelled when progress stops it before
// there is one.
template <int Dim>
CurveFit<Dim> FitCurve(const PointCloud& cloud, const CurveFitOptions& options = {});

// Fits one curve to every component of unordered points, longest first. Points of the other
// components are not outliers of a curve here; its report leaves them out.
template <int Dim>
std::vector<CurveFit<Dim>> FitCurves(const PointCloud& cloud, const CurveFitOptions& options = {});

// Fits one component only: number `component` by length, 1 the longest. Throws
// std::invalid_argument where there are fewer.
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
