// SPDX-License-Identifier: MIT
#include "batten/geometry/surface_intersection.h"

namespace batten {

const char* NameOf(BranchKind kind) {
  switch (kind) {
    case BranchKind::kTransversal:
      return "transversal";
    case BranchKind::kTangential:
      return "tangential";
    default:
      return "overlap";
  }
}

}  // namespace batten
