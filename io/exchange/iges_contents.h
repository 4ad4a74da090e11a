// SPDX-License-Identifier: MIT
// Curves and surfaces of IGES whose numbers come as they stand. Not installed.
#pragma once

#include <string>

#include "batten/io/geometry_types.h"

namespace batten::internal {

struct IgesContents {
  GeometryContents contents;  // of the entities that iges_reader.h lists; maybe none
  int points = 0;             // beside them
  std::string beyond;         // the first entity of other types, a sentence; empty: there is none
  std::string fault;  // where there is one: the first that names what it must not, or is damaged
};

// Throws ReadError naming `name` where the text is not fixed ASCII IGES, truncated or damaged.
IgesContents ParseIgesContents(const std::string& text, const std::string& name);

}  // namespace batten::internal
