// SPDX-License-Identifier: MIT
#include "cli/terminal/written_format.h"

#include "batten/io/read_error.h"

namespace batten::internal {

FileFormat WrittenFormat(const std::string& path,
                         const std::string& format,
                         const std::string& what_is_written) {
  const bool by_name = format.empty() && path != "-" && !path.empty();
  if (by_name && !FormatOfName(path)) {
    throw UsageError(path + ": " + what_is_written +
                     " (--output-format says which where the name does not)");
  }
  return FormatOf(path, format);
}

}  // namespace batten::internal
