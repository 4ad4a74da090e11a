// SPDX-License-Identifier: MIT
// Fits lines, circles, planes, spheres, cylinders, cones and tori to measured points, as exact
// NURBS.
#pragma once

#include "batten/fitting/point_cloud.h"
#include "batten/fitting/primitive_options.h"

namespace batten {

// Fits the shape of least Σ w ρ(d), d the orthogonal distance, w the cloud's weights. Returns its
// parameters with standard deviations, and the part of it that the points cover.
//
// Lines and circles, in the plane or in space. Without a loss ρ = d²/2. With one, the search starts
// from sample consensus, and outliers, up to almost half of the points, count in no sum: points to
// which Tukey's loss gives no weight at the scale given, or else at 1.4826 times the median
// distance of the inliers (MAD). Over the inliers the chosen loss is minimised at this scale. The
// curve covers the points that count: a segment between the outermost feet; a full circle where
// they go all round (no gap above 60°, or the largest not above 1.5 times the mean of the others),
// else the arc without the largest gap. With a loss, foot points far from all others are ignored. A
// circle turns counter-clockwise about its axis, which in space follows the order of the points; a
// line leads from the first point to the last.
//
// Surfaces, of clouds in space: see ShapeFitter, ShapeEstimate and PatchOf; the report warns where
// the points do not determine the numbers.
//
// kAuto chooses the circle over the line where it fits significantly better: with N distance
// components, D the fall of Σ w d² against the line in units of the circle's variance, k the
// difference of freedoms and f = N − those of the circle, where f·log(1 + D/f) > 2 k log N (1 +
// 2/f): twice the penalty of Schwarz's criterion, and more where the points are few. [Schwarz 1978]
// Surfaces are judged against each other in the same way, D divided by the inflation of variances,
// in the order above; see surface_choice.h, also for curve against surface.
//
// Throws std::invalid_argument, with a sentence for the user, where fewer points differ than the
// shape has freedoms (of curves two and three), where a circle is asked for points on one line, a
// surface for points of the plane, or where no shape of the kind fits; Cancelled when progress
// stops it. O(m) a step, O(m log m) in all.
PrimitiveFit FitPrimitive(const PointCloud& cloud, const PrimitiveFitOptions& options = {});

}  // namespace batten
