// SPDX-License-Identifier: MIT
// Fits one smooth closed surface to the points of a whole body and makes a solid of it.
#pragma once

#include "batten/fitting/point_cloud.h"
#include "batten/fitting/solid_options.h"
#include "batten/geometry/triangle_surface.h"

namespace batten {

// Fits a Catmull–Clark surface whose control mesh has the layout's faces: least Σ w ((S − q)·n)² at
// foot points with normals within 60° of the points' (the cloud's normals, all outwards or all
// inwards, else estimated ones without a sign), and a thin-plate energy weighed by generalised
// cross-validation. Gauss–Newton steps over the control points with foot points eliminated, damped
// by the tangential distance. Outliers of the cloud do not count. Then, up to
// twice and unless smoothing is given, faces that miss their points by more than noise, or than the
// tolerance, are fitted anew with the control points of a mesh refined once more, where points left
// out are met better by these. [Litke, Levin & Schröder 2001;
// Cheng, Wang, Qin, Wong, Yang & Liu 2007; hierarchical: Wei, Zhang, Hughes & Scott 2015]
//
// The faces are bicubic B-splines: the surface itself but near vertices of other than four edges,
// where their coefficients make tangent planes continuous. The distances reported are from these
// faces. Where one point in twenty is farther from them than points are from one another, and that
// is not noise, the end is structured_residuals, with a warning.
//
// Where the layout has caps, what comes out is an open shell without these, and points beyond its
// borders are measured from them.
//
// The layout is in the cloud's world coordinates. Throws RefusedData, with a sentence for the user,
// where the layout is no closed mesh of quadrilaterals (CheckQuadMesh) or lies apart from the
// points, where there are fewer points than its vertices ask for, and where the faces that come out
// turn over or do not enclose a volume; Cancelled when progress stops it.
SolidFit FitSolid(const PointCloud& cloud,
                  const QuadMesh& layout,
                  const SolidFitOptions& options = {});

// The same over layouts made of a closed surface about the points, in world coordinates: one of
// about `faces` (LayoutOf). With `faces` 0, and smoothing not given, of about a ninth, a third and
// all of LayoutFaces(points): the coarsest whose finer ones do not meet points left out better, but
// for chance. Stopped while a finer one is tried, it returns what it has, with the termination
// `cancelled`. Throws as the other does, and as LayoutOf does.
SolidFit FitSolid(const PointCloud& cloud,
                  const TriangleSurface& surface,
                  int faces,
                  const SolidFitOptions& options = {});

}  // namespace batten
