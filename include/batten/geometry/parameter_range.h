// SPDX-License-Identifier: MIT
// Regions of a domain.
#pragma once

#include <optional>

namespace batten {

// Parameters from … to of the domain, from < to.
struct ParameterRange {
  double from = 0, to = 1;
};

// The part of a surface's domain over both ranges; none: the whole direction.
struct ParameterRegion {
  std::optional<ParameterRange> u, v;
};

}  // namespace batten
