// SPDX-License-Identifier: MIT
// Linear least squares for a surface under exact equality constraints.
#pragma once

#include <vector>

#include "batten/fitting/fitting_problem.h"
#include "fitting/constraints/surface_constraints.h"
#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

struct ConstrainedSolution {
  NurbsSurface surface;                  // over the bases' knots and those the edges need
  std::vector<MissedConstraint> missed;  // contradicting constraints, and by how much
};

// Minimises a FittingProblem's sum (points, fairness of the whole surface) over the surfaces that
// meet the constraints. Unknowns are only the inner control points over the problem's own, coarse,
// bases and, along tangent fields, the coefficients of two coarse splines; so edges with many
// control points add no freedom to follow noise (edge_rows.h). Edges are met by construction, to
// rounding; along a tangent field the angle to its planes is below 1e-6 (6e-5 where knots for it
// would be too many); points and normals are met by Lagrange multipliers, to rounding. Dependent
// conditions are left out; of contradicting ones (in the order corners, points as given) the
// earlier are met and the solution says by how much each other is missed.
//
// Throws std::invalid_argument as edge_rows.h says, unless the problem is of points in space, where
// the surface closes or has a pole, where fixed points lie outside the domain or are not finite, or a normal is zero, and where the points
// do not determine the control points.
// O(m + n · min(n_u, n_v)² + n · min(n_u, n_v) · t) with t coefficients along tangent fields and
// conditions.
ConstrainedSolution SolveConstrained(const FittingProblem& problem,
                                     const SurfaceConstraints& constraints,
                                     ThreadPool& pool);

}  // namespace batten::internal
