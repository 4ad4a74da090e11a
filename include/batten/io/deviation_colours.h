// SPDX-License-Identifier: MIT
// Colours that show how far measured points stand off a surface.
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace batten {

using Rgb = Eigen::Matrix<std::uint8_t, 3, 1>;  // sRGB
using RgbColumns = Eigen::Matrix<std::uint8_t, 3, Eigen::Dynamic>;

// Blue below the surface, light grey on it, red above: equally light on both sides, so that people
// who do not tell red from green read it too, and darker the farther, so that a print in grey shows
// where. From −range to range; what is beyond is darker at one step, and NaN, where nothing is
// known, a middle grey. Throws std::invalid_argument unless range > 0.
// [Moreland 2009, "Diverging color maps for scientific visualization"]
Rgb DeviationColour(double deviation, double range);
RgbColumns DeviationColours(const Eigen::VectorXd& deviations, double range);

// A range that shows most of them: 1, 2 or 5 times a power of ten, the least of those that 95 % of
// the deviations' sizes are within. Those that are not finite do not count; 1 where all are 0 or
// none is left.
double DeviationRange(const Eigen::VectorXd& deviations);

}  // namespace batten
