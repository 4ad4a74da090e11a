// SPDX-License-Identifier: MIT
// Longitude and latitude become metres. Not installed.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "batten/io/cloud_options.h"
#include "io/cloud/cloud_filter.h"

namespace batten::internal {

struct ProjectedDegrees {
  std::optional<Eigen::Vector2d> middle;  // longitude and latitude of x = y = 0; none: nothing done
  std::string remark;                     // a sentence that says what was done, or may be; or none
};

// Replaces x and y of all parts, longitude and latitude in degrees of WGS 84, by metres east and
// north of a middle, where the projection asks for it: that of the options, else the middle of
// their range to 1e-5 degrees, which is one piece cut where the widest range of longitudes holds no
// point. Else the remark says whether x and y look like degrees. `paths`: of the parts.
//
// Throws ReadError naming the file and the reason where a latitude is beyond 90 degrees, where the
// points reach so far that lengths among them are not true to 1 %, or where some parts name
// longitude and latitude and others do not.
ProjectedDegrees ProjectLocally(const CloudReadOptions& options,
                                const std::vector<std::string>& paths,
                                std::vector<FileCloud>& parts);

}  // namespace batten::internal
