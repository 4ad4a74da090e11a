// SPDX-License-Identifier: MIT
// Points from PLY files.
#pragma once

#include "batten/io/cloud_options.h"
#include "io/base/byte_source.h"
#include "io/cloud/cloud_filter.h"

namespace batten::internal {

// The vertices of an ASCII or binary PLY file of either byte order; elements before them are passed
// over, those after them not looked at; so are lists among the properties of vertex, which are no
// columns. Own code because PCL's reader takes 28 MB/s (ASCII) and 330
// MB/s (binary) and allocates whatever a header promises. The header's counts are held against the
// size of the file before any memory is taken. Throws ReadError naming line or byte, UsageError for
// a property that is not there.
FileCloud ReadPly(ByteSource& source, const CloudReadOptions& options);

}  // namespace batten::internal
