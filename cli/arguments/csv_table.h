// SPDX-License-Identifier: MIT
// Tables of text with commas.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace batten::internal {

struct CsvRow {
  int line;  // of the file on which the row begins, from 1
  std::vector<std::string> cells;
};

// The rows of a file of comma-separated values: cells in double quotes may hold commas, line ends
// and, doubled, quotes; lines end in LF or CRLF; a byte order mark, empty lines and lines that
// begin with # are passed over. Throws ReadError naming the line where quotes do not end or text
// follows them, or where the file can't be read. [RFC 4180]
std::vector<CsvRow> ReadCsv(const std::string& path);

// The cells as a line that reads back as they are.
std::string CsvLine(const std::vector<std::string>& cells);

// Text without blanks at its ends.
std::string Trimmed(std::string_view text);

}  // namespace batten::internal
