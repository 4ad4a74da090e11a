// SPDX-License-Identifier: MIT
// Points from PCD files (Point Cloud Library), versions 0.5 to 0.7.
#pragma once

#include "batten/io/cloud_options.h"
#include "io/base/byte_source.h"
#include "io/cloud/cloud_filter.h"

namespace batten::internal {

// ASCII, binary and compressed bodies; fields of any type, with more than one element (named by the
// first; "name[1]", … the others) and padding ("_", which is no field). The viewpoint is ignored.
// The header's counts are held against the size of the file before any memory is taken. Throws
// ReadError naming line or byte, UsageError for a field that is not there.
FileCloud ReadPcd(ByteSource& source, const CloudReadOptions& options);

}  // namespace batten::internal
