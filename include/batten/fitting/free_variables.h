// SPDX-License-Identifier: MIT
// What a joint optimisation may move.
#pragma once

namespace batten {

// What is free besides the control points. Nothing: there is no joint stage.
struct FreeVariables {
  bool parameters = false;  // every point's own
  bool weights = false;
  bool knots = false;

  bool any() const { return parameters || weights || knots; }
  bool operator==(const FreeVariables&) const = default;
};

}  // namespace batten
