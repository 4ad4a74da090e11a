// SPDX-License-Identifier: MIT
// What IGES says of solids, before OpenCASCADE follows it. Not installed.
#pragma once

#include <vector>

#include "io/exchange/iges_text.h"

namespace batten::internal {

// Whether an entity of a B-rep solid (186, 514, 510, 508, 504, 502) names entities of the types it
// must, and as many as it promises. Throws std::invalid_argument with what is wrong.
// [IGES 5.3, §4.134–4.147]
void CheckIgesSolid(const std::vector<IgesEntity>& entities, const IgesEntity& entity);

}  // namespace batten::internal
