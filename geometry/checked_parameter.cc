// SPDX-License-Identifier: MIT
#include "batten/geometry/checked_parameter.h"

#include <cmath>
#include <stdexcept>

#include "batten/geometry/number_text.h"

namespace batten {

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

}  // namespace batten
