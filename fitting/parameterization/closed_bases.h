// SPDX-License-Identifier: MIT
// Bases of closed shapes: spheres, tori, surfaces of revolution and tubes.
#pragma once

#include <memory>
#include <vector>

#include "fitting/parameterization/base_attempt.h"
#include "fitting/parameterization/open_bases.h"

namespace batten::internal {

// The closed bases in question by options.base, the simplest first: a sphere, a torus, a surface of
// revolution, each certain where the points are clearly near it; and with `tubes` a tube. Samples
// of the inliers are those of the flattening if it was made before.
std::vector<BaseMethod> ClosedCandidates(const BaseInput& input,
                                         bool tubes,
                                         std::shared_ptr<SheetFlattening> flattening);

}  // namespace batten::internal
