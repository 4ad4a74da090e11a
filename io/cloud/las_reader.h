// SPDX-License-Identifier: MIT
// Points from LAS files (ASPRS), versions 1.0 to 1.4.
#pragma once

#include "batten/io/cloud_options.h"
#include "io/base/byte_source.h"
#include "io/cloud/cloud_filter.h"

namespace batten::internal {

// Point formats 0 to 10, uncompressed, with records longer than their format; coordinates are
// stored · scale + offset in double. The fields are x y z intensity return_number
// number_of_returns … classification … gps_time red green blue nir, as the format has them.
// Colours of 16 bits become bytes by their high end; where none is above 255 they are bytes
// already. Variable length records are passed over, so units and coordinate systems are not known.
// The header's counts are held against the size of the file before any memory is taken. Throws
// ReadError naming the byte, UsageError for a field that is not there.
// [ASPRS, LAS specification 1.4 – R15]
FileCloud ReadLas(ByteSource& source, const CloudReadOptions& options);

}  // namespace batten::internal
