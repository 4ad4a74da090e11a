// SPDX-License-Identifier: MIT
// Surfaces of a file as triangle meshes in another: what tessellate and convert share.
#pragma once

#include <string>

#include "cli/arguments/cloud_arguments.h"
#include "cli/terminal/common_flags.h"

namespace batten::internal {

struct MeshRequest {
  std::string geometry, geometry_format, out, out_format;
  double chord_tolerance = 0;   // 0: 1e-3 of the size of all surfaces
  std::string unit = {};        // wanted; empty: the geometry's own, mm where it says none
  std::string cloud_path = {};  // whose deviations colour the mesh; none without
  CloudArguments cloud = {};
  double deviation_range = 0;  // 0: a round number that 95 % are within
  int threads = 0;
  CommonFlags flags;
};

// Whether the word, or else the path, names a format of meshes.
bool NamesMesh(const std::string& path, const std::string& format);

// Writes the mesh, then the line or JSON on standard output. Returns the exit code.
int WriteMeshOf(const MeshRequest& request);

}  // namespace batten::internal
