// SPDX-License-Identifier: MIT
// What every STEP file that is written has in common. Not installed; includes OpenCASCADE.
#pragma once

#include <STEPControl_Writer.hxx>
#include <string>

namespace batten::internal {

// Sets OpenCASCADE's words for unit and schema, before a writer is made.
void BeginStep(const char* unit, const char* schema);

// The text of all that the writer has translated, real numbers with 17 digits, a header of batten's
// own. Throws Standard_Failure where OpenCASCADE does not write it.
std::string StepTextOf(STEPControl_Writer& writer);

}  // namespace batten::internal
