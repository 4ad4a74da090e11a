// SPDX-License-Identifier: MIT
// The length unit of a STEP file being read. Not installed; includes OpenCASCADE.
#pragma once

#include <STEPControl_Reader.hxx>
#include <string>
#include <vector>

namespace batten::internal {

struct StepUnits {
  std::string name;                  // of length_unit.h; empty: the file declares none
  std::vector<std::string> remarks;  // what is missing or contradicts itself
};

// Makes the transfer that follows keep lengths as they stand in the file: the unit OpenCASCADE
// works in becomes the file's first, or mm where that is none of length_unit.h. Parts in other
// units are turned into it.
StepUnits KeepNumbersOf(STEPControl_Reader& reader);

}  // namespace batten::internal
