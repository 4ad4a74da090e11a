// SPDX-License-Identifier: MIT
// Homogeneous derivatives at the end of a curve, or of all rows of a surface at once.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>

#include "batten/geometry/join_freedom.h"
#include "batten/geometry/joins.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

// (Dim + 1) × rows each: (w·P, w) and its first two derivatives in the sense that leaves the shape.
using EndJet = std::array<Eigen::MatrixXd, 3>;

template <int Dim>
EndJet EndJetOf(const NurbsCurve<Dim>& curve, bool upper);
EndJet EndJetOf(const NurbsSurface& surface, const SurfaceEdge& edge);

// The first derivatives of λ(s) C(φ(s)) from those of C.
EndJet Reparameterized(const EndJet& jet, const JoinFreedom& freedom);

// Columns divided by their last number, which must be positive; `what` the refusal says to change.
Eigen::MatrixXd Places(const Eigen::MatrixXd& columns,
                       const char* function,
                       const std::string& what);

}  // namespace batten::internal
