// SPDX-License-Identifier: MIT
// The free variables of a joint optimisation.
#pragma once

namespace batten {

// Variables that are free besides the control points; with none of them there is no joint stage.
struct FreeVariables {
  bool parameters = false;  // every point's own
  bool weights = false;
  bool knots = false;

  bool any() const { return parameters || weights || knots; }
  bool operator==(const FreeVariables&) const = default;
};

}  // namespace batten
