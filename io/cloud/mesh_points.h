// SPDX-License-Identifier: MIT
// Meshes among files of points. Not installed.
#pragma once

#include <string>
#include <vector>

#include "batten/io/cloud_file.h"
#include "batten/io/cloud_options.h"
#include "batten/io/file_format.h"

namespace batten::internal {

// Reads the faces of files whose points are `file.cloud` and adds points on their triangles where
// the options ask for them. What keeps faces from counting is told among the remarks: the vertices
// count all the same.
void TakeFaces(const std::vector<std::string>& paths,
               const std::vector<FileFormat>& formats,
               const CloudReadOptions& options,
               CloudFile& file);

}  // namespace batten::internal
