// SPDX-License-Identifier: MIT
#include "geometry/nurbs/checked_parameter.h"

#include <cmath>
#include <stdexcept>

#include "geometry/numeric/number_text.h"

namespace batten::internal {

double CheckedParameter(const SplineBasis& basis,
                        double value,
                        const std::string& function,
                        const std::string& name) {
  if (value >= basis.lower() && value <= basis.upper()) return value;
  if (basis.periodic() && std::isfinite(value)) return basis.Clamp(value);
  throw std::invalid_argument(function + ": " + name + " = " + NumberText(value) +
                              " is outside the domain " +
                              IntervalText(basis.lower(), basis.upper()));
}

}  // namespace batten::internal
