// SPDX-License-Identifier: MIT
// The text of a .brep file as OpenCASCADE can be trusted with it. Not installed.
#pragma once

#include <string>
#include <string_view>

namespace batten::internal {

// The file in version 1 of the format, without its triangles and what stands before and after it.
// OpenCASCADE's reader trusts counts, indices and lines, and crashes on or never comes back from
// damaged ones: everything is checked here first. Versions 1 to 3 are read. Throws ReadError naming
// `path`, the line and the rule. Linear time.
// [OpenCASCADE, BRep format, 2022]
std::string CheckedBrep(std::string_view text, const std::string& path);

}  // namespace batten::internal
