// SPDX-License-Identifier: MIT
#include "batten/fitting/tile_options.h"

#include <stdexcept>
#include <string>

namespace batten {

void Check(const TileOptions& options) {
  if (options.count_u < 0 || options.count_v < 0 ||
      (options.count_u == 0) != (options.count_v == 0))
    throw std::invalid_argument("count_u, count_v: " + std::to_string(options.count_u) + ", " +
                                std::to_string(options.count_v) +
                                ": tiles are one or more in each direction, or both 0, chosen");
  StreamOptions stream;
  stream.sample = options.sample;
  Check(stream);
}

}  // namespace batten
