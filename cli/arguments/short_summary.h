// SPDX-License-Identifier: MIT
// What `info` and `analyze` say first: few lines, in digits that matter.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace batten::internal {

// "kind", "size", "spacing" … of a cloud as `info` describes it, of a geometry or of several as
// SummaryOf does (geometry_summary.h), a line each; of many geometries the first.
std::string ShortSummary(const nlohmann::ordered_json& info);

// Prints that, and after it, where `all` is wanted, every number there is.
void PrintForPeople(const nlohmann::ordered_json& info, bool all);

}  // namespace batten::internal
