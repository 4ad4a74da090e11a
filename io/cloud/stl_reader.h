// SPDX-License-Identifier: MIT
// The corners of the triangles of STL files.
#pragma once

#include "batten/io/cloud_options.h"
#include "io/base/byte_source.h"
#include "io/cloud/cloud_filter.h"

namespace batten::internal {

// Binary and ASCII, told apart by the size of the file and, in pipes, by its first bytes. Facets
// repeat their corners: exactly equal ones are one point, in the order in which they first appear.
// Normals of facets are passed over, for they are none of the points. The fields are x y z. The
// header's count is held against the size of the file before any memory is taken. Throws
// ReadError naming line or byte, also where the file ends early.
FileCloud ReadStl(ByteSource& source, const CloudReadOptions& options);

}  // namespace batten::internal
