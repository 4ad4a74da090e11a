// SPDX-License-Identifier: MIT
// Every point with the number of the face it is of, as a file.
#pragma once

#include <string>
#include <vector>

#include "batten/fitting/point_cloud.h"

namespace batten {

// In world coordinates, whole or not at all, by the extension, any case:
//   .ply  binary little-endian: doubles x y z, uchars red green blue, a colour for each face and
//   grey
//         for points of none, int label (−1: none)
//   .csv  a header line x,y,z,red,green,blue,label and shortest numbers that read back exactly
// Throws UsageError for another extension, WriteError where it can't be written,
// std::invalid_argument unless there is one label a point.
void WriteLabels(const PointCloud& cloud, const std::vector<int>& labels, const std::string& path);

// Throws UsageError for what WriteLabels refuses by its name.
void CheckLabelsName(const std::string& path);

}  // namespace batten
