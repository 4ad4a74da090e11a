// SPDX-License-Identifier: MIT
// Where points of two faces are neighbours.
#pragma once

#include <map>
#include <string>

#include "fitting/regions/border_walk.h"

namespace batten::internal {

struct FoundPlaces {
  std::map<FacePair, BorderPlaces> of;  // on both shapes
  std::string refused;  // of faces that meet smoothly without a contact; empty: there are none
};

FoundPlaces FindPlaces(const FaceMeets& meets);

std::string WordsOf(const FacePair& faces);

}  // namespace batten::internal
