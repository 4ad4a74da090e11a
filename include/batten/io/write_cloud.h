// SPDX-License-Identifier: MIT
// Point clouds into files.
#pragma once

#include <string>

#include "batten/fitting/point_cloud.h"

namespace batten {

// Writes every point in world coordinates with its normal, colour, parameters and weight, where
// there are any, whole or not at all. The format is the word's or the extension's (see FormatOf):
//   .ply        binary little-endian, doubles; nx ny nz, red green blue (uchar), u v, w
//   .pcd        binary, float64; normal_x normal_y normal_z, rgb (packed, U4), u v, w
//   .xyz .txt … rows of shortest numbers that read back exactly; attributes follow x y z, named in
//   a comment .csv        the same with commas and a header line
// Plane clouds have two coordinates in text and z = 0 elsewhere. "-" is standard output. Throws
// WriteError, or UsageError where the format is not one of points.
void WriteCloud(const PointCloud& cloud, const std::string& path, const std::string& format = "");

}  // namespace batten
