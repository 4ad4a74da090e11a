// SPDX-License-Identifier: MIT
// Solids as the text of a STEP file that is proved to hold them. Not installed; includes
// OpenCASCADE.
#pragma once

#include <TopoDS_Shape.hxx>
#include <string>
#include <vector>

#include "io/exchange/opencascade_functions.h"

namespace batten::internal {

struct ProvedSolid {
  std::string text;
  SolidCensus census;
};

using Bodies = std::vector<TopoDS_Shape>;

// The text, once the solids have been found valid, with every edge used twice, of positive volume,
// and the same when read back; or open shells, with no edge used by more than two faces.
// Tolerances are raised to at most 1e-6 of the size. Throws Standard_Failure with the reason where
// it is not so.
ProvedSolid ProvedStep(const Bodies& bodies, double size, const char* unit, const char* schema);

}  // namespace batten::internal
