// SPDX-License-Identifier: MIT
// The vertices of OBJ files (Wavefront).
#pragma once

#include "batten/io/cloud_options.h"
#include "io/base/byte_source.h"
#include "io/cloud/cloud_filter.h"

namespace batten::internal {

// Every line v is a point: x y z, then a weight, which is ignored, or red green blue, to 1 or to
// 255. The normals vn are those of the points where there are equally many, else they are left
// out. Faces and all else are passed over. A backslash at its end continues a line. The fields are
// x y z, red green blue, nx ny nz as the file has them. Throws ReadError naming the line,
// UsageError for a field that is not there.
FileCloud ReadObj(ByteSource& source, const CloudReadOptions& options);

}  // namespace batten::internal
