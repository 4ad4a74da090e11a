// SPDX-License-Identifier: MIT
// The vertices of OFF files (Geomview).
#pragma once

#include "batten/io/cloud_options.h"
#include "io/base/byte_source.h"
#include "io/cloud/cloud_filter.h"

namespace batten::internal {

// Text with a vertex a line; the header words OFF, NOFF (normals), COFF (colours, to 1 or to 255,
// with or without alpha), STOFF and their combinations. Faces are not read. The fields are x y z,
// nx ny nz, red green blue, alpha, s t as the file has them. The header's count is held against
// the size of the file before any memory is taken. Throws ReadError naming the line, also for
// binary files and those of other dimensions; UsageError for a field that is not there.
FileCloud ReadOff(ByteSource& source, const CloudReadOptions& options);

}  // namespace batten::internal
