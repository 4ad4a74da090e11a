// SPDX-License-Identifier: MIT
// The application protocols of STEP by name.
#pragma once

#include <string>

namespace batten::internal {

// The word OpenCASCADE knows "ap214" or "ap242" by. Throws UsageError for others.
const char* OcctSchema(const std::string& schema);

}  // namespace batten::internal
