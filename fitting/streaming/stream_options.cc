// SPDX-License-Identifier: MIT
#include "batten/fitting/stream_options.h"

#include <stdexcept>
#include <string>

namespace batten {

void Check(const StreamOptions& options) {
  if (options.memory < std::int64_t{1} << 25)
    throw std::invalid_argument("memory: " + std::to_string(options.memory) +
                                " bytes are too few; at least 32 MiB are needed");
  if (options.sample < 1000)
    throw std::invalid_argument("sample: " + std::to_string(options.sample) +
                                " points are too few; at least 1000 are needed");
}

}  // namespace batten
