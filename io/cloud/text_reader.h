// SPDX-License-Identifier: MIT
// Points from text: .xyz .txt .csv .asc .pts .xy .dat.
#pragma once

#include "batten/io/cloud_options.h"
#include "io/base/byte_source.h"
#include "io/cloud/cloud_filter.h"

namespace batten::internal {

// One point a line. A first line that does not begin with a number names the columns (or, with
// another number of words and no x and y among them, is a title), unless it has numbers where the
// coordinates are: then it is a row that carries a name, or is damaged and refused. One that holds
// nothing but a count (.pts) says how many rows must follow at least. A first row of two columns
// makes a plane cloud, and then every row has two. Rows whose commas may be decimal are refused.
// Colours count to 1 where none is above and one is not whole, else to 255. A UTF-8 byte order mark
// is passed over. Throws ReadError naming the line, UsageError for a column that is not there.
FileCloud ReadText(ByteSource& source, const CloudReadOptions& options);

}  // namespace batten::internal
