// SPDX-License-Identifier: MIT
// Points from text: .xyz .txt .csv .asc .pts .xy .dat .af .fxs.
#pragma once

#include "batten/io/cloud_options.h"
#include "io/base/byte_source.h"
#include "io/cloud/cloud_filter.h"

namespace batten::internal {

// One point a line. The rows begin with the first line that has numbers where the coordinates are.
// Before it stand titles, keys with values, and counts; the line among them that says where x and y
// are, or else the last that holds no number, names the columns if it has as many names. A line of
// whole numbers that are the sizes of the blocks between lines of blanks after it is a count, and
// so is a single number; then at least as many rows must follow. What has the form of a row but no
// number where one belongs carries a name, or is damaged and refused. A first row of two columns
// makes a plane cloud, and then every row has two. Commas separate, or are decimal as DecimalCommas
// says, with a remark. Colours count to 1 where none is above and one is not whole, else to 255. A
// UTF-8 byte order mark is passed over. Throws ReadError naming the line, UsageError for a column
// that is not there.
FileCloud ReadText(ByteSource& source, const CloudReadOptions& options);

}  // namespace batten::internal
