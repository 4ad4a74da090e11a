// SPDX-License-Identifier: MIT
// Curvature of curves and surfaces.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

// With n = S_u × S_v / |S_u × S_v|; principal curvatures in increasing order.
struct SurfaceCurvature {
  double gaussian, mean, principal_low, principal_high;
};

// From the first and second fundamental forms; none where the surface has no normal. The principal
// curvatures are the eigenvalues of the second form in an orthonormal frame of the tangent plane,
// right to rounding at umbilics too. [do Carmo 1976, §3.3]
std::optional<SurfaceCurvature> CurvatureOf(const SurfaceJet& jet);

// Unit tangent vectors in which the normal curvature is least and greatest, at right angles to each
// other; their signs, and at umbilics the directions themselves, mean nothing.
struct PrincipalDirections {
  Eigen::Vector3d low, high;
};
std::optional<PrincipalDirections> PrincipalDirectionsOf(const SurfaceJet& jet);

// The curvature at a parameter, right-continuous at knots. Where S_u × S_v vanishes to rounding
// (collapsed edge or corner, tangents parallel) the limit along straight lines of parameters into
// the piece, if all of them have the same: so at the pole of a sphere. None where the curvature
// grows without bound (the tip of a cone) or depends on the direction.
std::optional<SurfaceCurvature> CurvatureAt(const NurbsSurface& surface, double u, double v);

struct CurveCurvature {
  double curvature;
  double torsion;  // zero for planar curves and where the curvature vanishes
};

// From the first, second and third derivative (a plane curve has z = 0); the curvature is not
// negative. None where the first derivative vanishes.
std::optional<CurveCurvature> CurvatureOf(const Eigen::Vector3d& first,
                                          const Eigen::Vector3d& second,
                                          const Eigen::Vector3d& third);

// The curvature at a parameter, right-continuous at knots, left at the end. Where C′ vanishes to
// rounding (coincident control points, cusps) the limit from that side; none where that is infinite
// or the curve is a point. Where C′ or the curvature vanishes the torsion is the limit too, and
// zero if there is none.
template <int Dim>
std::optional<CurveCurvature> CurvatureAt(const NurbsCurve<Dim>& curve, double u);

extern template std::optional<CurveCurvature> CurvatureAt(const NurbsCurve<2>&, double);
extern template std::optional<CurveCurvature> CurvatureAt(const NurbsCurve<3>&, double);

}  // namespace batten
