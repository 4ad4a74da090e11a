// SPDX-License-Identifier: MIT
// The two parameter directions of a surface.
#pragma once

namespace batten {

enum class Direction { kU, kV };

}  // namespace batten
