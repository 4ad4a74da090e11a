// SPDX-License-Identifier: MIT
// Longitude and latitude become metres. Not installed.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "batten/io/cloud_options.h"
#include "io/cloud/cloud_filter.h"

namespace batten::internal {

// Replaces x and y of all parts, longitude and latitude in degrees of WGS 84, by metres east and
// north of the middle of their range, where the projection asks for it; a range across the 180th
// meridian is one piece. Returns the sentence that says so, or one that x and y look like degrees,
// or nothing. `paths`: of the parts. Throws ReadError naming the file and the value where a
// latitude is beyond 90 degrees, or some parts name longitude and latitude and others do not.
std::optional<std::string> ProjectLocally(CloudProjection projection,
                                          const std::vector<std::string>& paths,
                                          std::vector<FileCloud>& parts);

}  // namespace batten::internal
