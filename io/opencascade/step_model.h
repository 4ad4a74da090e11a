// SPDX-License-Identifier: MIT
// Whether what a STEP file holds can be translated. Not installed; includes OpenCASCADE.
#pragma once

#include <StepData_StepModel.hxx>
#include <string>

namespace batten::internal {

// OpenCASCADE's translator trusts its entities and crashes on damaged ones, so none may be: throws
// ReadError naming `path` and the entity. Colours and layers are not translated; they may be
// damaged.
void CheckStepModel(const Handle(StepData_StepModel) & model, const std::string& path);

}  // namespace batten::internal
