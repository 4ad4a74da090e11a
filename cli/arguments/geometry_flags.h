// SPDX-License-Identifier: MIT
// Flags of the commands that read or write geometry.
#pragma once

#include <string>
#include <vector>

#include "cli/terminal/cli11_forward.h"

namespace batten::internal {

// The words of --unit: what a STEP file can declare.
const std::vector<std::string>& Units();

// Refuses any other. Throws UsageError.
void CheckUnit(const std::string& unit);

// --unit, of what is written.
CLI::Option& AddUnitFlag(CLI::App& command,
                         std::string& unit,
                         const char* help = "Unit of the data, declared in STEP and IGES");

// --format of the geometry that is read, and --output-format of what is written.
void AddGeometryFormatFlag(CLI::App& command, std::string& format, const char* help);
void AddOutputFormatFlag(
    CLI::App& command,
    std::string& format,
    const char* help = "Format of OUT where its name does not tell: json step iges brep");

}  // namespace batten::internal
