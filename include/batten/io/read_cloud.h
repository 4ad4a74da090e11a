// SPDX-License-Identifier: MIT
// Point clouds from files.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "batten/fitting/fit_report.h"
#include "batten/io/cloud_file.h"
#include "batten/io/cloud_options.h"
#include "batten/io/file_format.h"

namespace batten {

// What a report says of the mesh; none where there is none.
std::optional<InputMesh> MeshIn(const CloudFile& file);

// The format of a file to be read: FormatOf, but where the extension is none that is known, a
// regular file whose first rows are numbers is text. Throws as FormatOf, and ReadError where the
// file can't be read.
FileFormat InputFormat(const std::string& path, const std::string& format = "");

// Reads PCD, PLY, LAS, text, and the vertices of OBJ, STL, OFF and GLB. Several files become one
// cloud that keeps what all of them hold (normals, weights, colours, parameters). Coordinates stay
// double from the file on; the origin is split off at the end (PointCloud::FromWorld). The path "-"
// is standard input.
//
// Memory grows with the points that have been read, never with what a header promises.
//
// Throws ReadError where a file can't be used, a coordinate is beyond 1e18, a weight is not
// positive, or no point is left; UsageError where the options ask for a column or format that is
// not there.
CloudFile ReadCloud(const std::vector<std::string>& paths, const CloudReadOptions& options = {});

}  // namespace batten
