// SPDX-License-Identifier: MIT
// The curves and surfaces of a .brep file are checked. Not installed.
#pragma once

#include "io/exchange/brep_scanner.h"

namespace batten::internal {

// Reads the record of a curve of the plane (2) or of space (3), or of a surface, and what it is
// built on. OpenCASCADE makes nothing of a record that breaks its rules, and crashes on what is
// built on nothing: throws ReadError naming the line and the rule. [OpenCASCADE, BRep format, §3]
void CheckBrepCurve(BrepScanner& scanner, int dimension);
void CheckBrepSurface(BrepScanner& scanner);

}  // namespace batten::internal
