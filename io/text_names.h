// SPDX-License-Identifier: MIT
// What the columns of a text are called. Not installed.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "batten/io/cloud_columns.h"

namespace batten {

// Whether x and y are among the names, in any case.
bool NamesPlace(const std::vector<std::string>& names);

// The columns of a text whose first row has `width`: by the names of its header line, else by the
// words of a comment where they name them, else by its extension (.uvxyz, .xyzl, .xyzi, .xyzn,
// .xyzrgb; .pts with intensity, colours or both), filled up with numbers. Throws ReadError where
// there are fewer columns than the extension promises.
std::vector<CloudField> TextFields(const std::string& file,
                                   std::vector<std::string> header,
                                   const std::vector<std::string>& comment,
                                   std::size_t width);

}  // namespace batten
