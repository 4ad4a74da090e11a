// SPDX-License-Identifier: MIT
// The length unit of a STEP file being read. Not installed; includes OpenCASCADE.
#pragma once

#include <STEPControl_Reader.hxx>

namespace batten {

// Makes the transfer that follows keep lengths as they stand in the file: the unit OpenCASCADE
// works in becomes the file's first.
void KeepNumbersOf(STEPControl_Reader& reader);

}  // namespace batten
