// SPDX-License-Identifier: MIT
// OpenCASCADE turns a solid into the text of a STEP file, and proves it.
#pragma once

#include <string>

#include "batten/geometry/solid_model.h"

namespace batten::internal {

// The text, once all that solid_writer.h promises has been found true of the solid and of what is
// read back from the text. Throws WriteError naming `path` where it is not.
std::string ExportSolid(const SolidModel& solid,
                        const std::string& path,
                        const char* unit,
                        const char* schema);

}  // namespace batten::internal
