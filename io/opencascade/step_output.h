// SPDX-License-Identifier: MIT
// What every STEP file that is written has in common. Not installed; includes OpenCASCADE.
#pragma once

#include <STEPControl_Writer.hxx>
#include <string>
#include <vector>

namespace batten::internal {

// Sets OpenCASCADE's words for unit and schema, before a writer is made.
void BeginStep(const char* unit, const char* schema);

// Gives the model's products these names, in their order; "batten-1", "batten-2", … where there is
// none or an empty one: OpenCASCADE's own count the products of the whole process.
void NameProducts(STEPControl_Writer& writer, const std::vector<std::string>& names);

// The text of all that the writer has translated, real numbers with 17 digits, a header of batten's
// own. Throws Standard_Failure where OpenCASCADE does not write it.
std::string StepTextOf(STEPControl_Writer& writer);

}  // namespace batten::internal
