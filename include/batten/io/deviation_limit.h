// SPDX-License-Identifier: MIT
// How far a colour range for deviations reaches.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "batten/fitting/point_mask.h"

namespace batten {

// Half the width of a colour range for deviations: the tolerance. Without one what 99 % of the
// points that count keep, or three times the noise where that is more, but no more than three times
// as much; up to the next of 1, 1.5, 2, 2.5, 3, 4, 5, 6, 8 times a power of ten. At least 1e-9 of
// `size`, below which all is rounding; 1 where everything is 0.
double DeviationLimit(const Eigen::VectorXd& distances,
                      const PointMask& outliers,
                      std::optional<double> tolerance,
                      double noise,
                      double size);

}  // namespace batten
