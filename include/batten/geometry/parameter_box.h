// SPDX-License-Identifier: MIT
// A rectangle of parameters of a surface.
#pragma once

namespace batten {

struct ParameterBox {
  double u0, u1, v0, v1;
};

}  // namespace batten
