// SPDX-License-Identifier: MIT
// Parameter velocities from a tangent vector.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "batten/geometry/nurbs_surface.h"

namespace batten {

// Moving the parameters by (du, dv) per unit of time moves the point of the surface by S_u·du +
// S_v·dv; `residual` is the distance of that from the vector asked for, which is the length of the
// vector's part along the normal. Du and dv in parameters, the residual in the vector's units.
struct TangentInversion {
  double du, dv, residual;
};

// The (du, dv) of least |S_u·du + S_v·dv − tangent|; none where the surface has no tangent plane
// (S_u and S_v are parallel to rounding, or vanish). By Householder reflections of the two columns
// made equally long, so that the scales of u, v and space do not matter: du·|S_u| and dv·|S_v| are
// right to some ε / sin² of the angle between S_u and S_v of the vector's length. Throws
// std::invalid_argument if the vector is not finite. [Piegl & Tiller 1997, §6.1]
std::optional<TangentInversion> InvertTangent(const SurfaceJet& jet,
                                              const Eigen::Vector3d& tangent);

// The same at a parameter, taken as JetAt takes it.
std::optional<TangentInversion> InvertTangent(const NurbsSurface& surface,
                                              double u,
                                              double v,
                                              const Eigen::Vector3d& tangent);

}  // namespace batten
