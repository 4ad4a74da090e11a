// SPDX-License-Identifier: MIT
// The format of a file that a command is to write.
#pragma once

#include <string>

#include "batten/io/file_format.h"

namespace batten::internal {

// FormatOf; where the name tells none that is read or written, or one that is not supported, the
// UsageError says what the command writes instead: "geometry is written as .json, .step, ...".
FileFormat WrittenFormat(const std::string& path,
                         const std::string& format,
                         const std::string& what_is_written);

}  // namespace batten::internal
