// SPDX-License-Identifier: MIT
#include <algorithm>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <vector>

#include "batten/io/file_format.h"
#include "batten/io/read_cloud.h"
#include "batten/io/read_error.h"
#include "io/base/byte_source.h"
#include "io/cloud/text_names.h"
#include "io/cloud/text_rows.h"

namespace batten {
using namespace internal;
namespace {

constexpr int kRows = 3;             // that must be numbers
constexpr std::size_t kLooked = 1 << 14;  // bytes
constexpr std::size_t kLeastFields = 2;

bool IsRowOfNumbers(std::string_view line) {
  const std::vector<std::string_view> fields = SplitFields(line);
  return fields.size() >= kLeastFields &&
         std::all_of(fields.begin(), fields.end(), [](std::string_view field) {
           return !field.empty() && IsNumber(field);
         });
}

// A count of points, or names of columns.
bool MayPrecedeRows(std::string_view line) {
  const std::vector<std::string_view> fields = SplitFields(line);
  return (fields.size() == 1 && IsNumber(fields.front())) || NamesPlace(HeaderNames(line));
}

// Whether a file's first rows are numbers, after comments and at most one line of another kind: a
// count or the columns' names.
bool BeginsWithRows(const std::string& path) {
  ByteSource source(path);
  std::string_view text = source.Peek(kLooked).substr(0, kLooked);
  // The last line may be cut.
  if (text.size() == kLooked) text = text.substr(0, text.find_last_of("\r\n") + 1);
  int rows = 0;
  bool first = true;
  while (!text.empty() && rows < kRows) {
    const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (!HoldsContent(line)) continue;
    if (IsRowOfNumbers(line)) {
      ++rows;
    } else if (!first || !MayPrecedeRows(line)) {
      return false;
    }
    first = false;
  }
  return rows > 0;
}

}  // namespace

FileFormat InputFormat(const std::string& path, const std::string& format) {
  std::error_code error;
  const bool name_tells = !format.empty() || FormatOfName(path) || IsUnsupportedName(path);
  // A pipe can be read only once.
  if (!name_tells && std::filesystem::is_regular_file(path, error) && BeginsWithRows(path))
    return FileFormat::kText;
  return FormatOf(path, format);
}

}  // namespace batten
