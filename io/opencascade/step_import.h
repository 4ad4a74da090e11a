// SPDX-License-Identifier: MIT
// OpenCASCADE turns the text of a STEP file into curves and surfaces.
#pragma once

#include <string>

#include "batten/io/geometry_types.h"

namespace batten::internal {

// What ReadStepContents gives of a file that holds this text; PrepareStepText has let it through.
// Throws ReadError, which calls the file `name`.
GeometryContents ImportStep(std::string text, const std::string& name);

}  // namespace batten::internal
