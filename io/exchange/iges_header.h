// SPDX-License-Identifier: MIT
// What an IGES file says beside its shapes: its unit and the names of entities. Not installed.
#pragma once

#include <string>
#include <vector>

#include "batten/io/geometry_types.h"
#include "io/exchange/iges_text.h"

namespace batten::internal {

// The unit of the global section, and remarks on what is odd about it.
void ReadIgesUnit(const IgesGlobal& global, GeometryContents& contents);

// By the entity's name property, its label, or those of the surface it trims; else empty.
std::string NameOfIges(const std::vector<IgesEntity>& entities, const IgesEntity& entity);

}  // namespace batten::internal
