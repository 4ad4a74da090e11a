// SPDX-License-Identifier: MIT
// The vertices of glTF 2.0 files in binary form. Not installed.
#pragma once

#include "batten/io/cloud_options.h"
#include "io/base/byte_source.h"
#include "io/cloud/cloud_filter.h"

namespace batten::internal {

// The distinct places of vertices, as PolygonsOfGlb has them, in metres and z up, which a remark
// says. Throws as that does.
FileCloud ReadGlb(ByteSource& source, const CloudReadOptions& options);

}  // namespace batten::internal
