// SPDX-License-Identifier: MIT
// The options of offsets.
#pragma once

#include <optional>

namespace batten {

struct OffsetOptions {
  // How far the offset may be from the exact one, > 0, in the data's units; none: 1e-6 of the
  // diagonal of the box of the control points.
  std::optional<double> tolerance = std::nullopt;
};

}  // namespace batten
