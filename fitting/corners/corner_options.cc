// SPDX-License-Identifier: MIT
#include "fitting/corners/corner_options.h"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace batten::internal {

void Check(const CornerOptions& options) {
  const auto require = [](bool kept, const char* field, double value, const char* rule) {
    if (!kept) {
      throw std::invalid_argument(std::string("CornerOptions: ") + field + " is " +
                                  std::to_string(value) + ", must be " + rule);
    }
  };
  require(options.noise >= 0 && std::isfinite(options.noise),
          "noise",
          options.noise,
          "0 or more and finite");
  require(!options.closed || (options.period > 0 && std::isfinite(options.period)),
          "period",
          options.period,
          "above 0 and finite for a closed curve");
  require(options.least_angle > 0 && options.least_angle < std::numbers::pi,
          "least_angle",
          options.least_angle,
          "above 0 and below pi");
}

}  // namespace batten::internal
