// SPDX-License-Identifier: MIT
#include "io/cloud/text_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "batten/io/read_error.h"
#include "io/cloud/text_names.h"
#include "io/cloud/text_rows.h"

namespace batten::internal {
namespace {

// The lines before the rows.
struct Preamble {
  TextHeader header;                 // or a row that looks like one
  std::vector<std::string> comment;  // words of the last comment before the rows that names x and y
  std::optional<std::int64_t> promised;  // rows, by a line with nothing but a count
};

// The leading identifiers of a comment's words, as in "# x y-5400000 z label(1=ground); metres";
// empty words where there is none.
std::vector<std::string> CommentWords(std::string_view line) {
  line.remove_prefix(std::min(line.find_first_not_of("#/ \t"), line.size()));
  std::vector<std::string> words;
  for (const std::string_view field : SplitFields(line)) {
    std::size_t length = 0;
    while (length < field.size() &&
           (std::isalnum(static_cast<unsigned char>(field[length])) != 0 || field[length] == '_')) {
      ++length;
    }
    words.emplace_back(field.substr(0, length));
  }
  return words;
}

void RequireText(std::string_view line, const LineReader& lines, const std::string& file) {
  const auto is_control = [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < 0x20 && std::isspace(byte) == 0;
  };
  if (std::any_of(line.begin(), line.end(), is_control)) {
    throw ReadError::AtLine(file, lines.number(), "is not text: " + Quoted(line));
  }
}

std::optional<std::int64_t> Count(std::string_view field) {
  std::int64_t count = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), count);
  if (error != std::errc() || end != field.data() + field.size() || count < 0) return std::nullopt;
  return count;
}

bool IsLetter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }

bool IsFilledNumber(std::string_view field) { return !field.empty() && IsNumber(field); }

// Whether it is a number up to a point: 0x10, -1.5D+3, 1"2.
bool BeginsAsNumber(std::string_view field) {
  const std::size_t first = field.find_first_not_of("+-.");
  return first != std::string_view::npos && first <= 2 && field[first] >= '0' &&
         field[first] <= '9';
}

// The first field that holds something begins a row if it is a number; names may begin with an
// empty one.
bool BeginsRow(const std::vector<std::string_view>& fields, std::string_view line) {
  if (!fields[0].empty()) return IsNumber(fields[0]);
  return !NamesPlace(HeaderNames(line));
}

// The column (0-based) of a coordinate, −1 where options give it by a name.
int CoordinateColumn(std::size_t axis, const std::map<std::string, std::string>& columns) {
  constexpr std::array kAxes{"x", "y", "z"};
  const bool asked =
      std::any_of(kAxes.begin(), kAxes.end(), [&](const char* a) { return columns.contains(a); });
  if (!asked) return static_cast<int>(axis);
  const auto column = columns.find(kAxes[axis]);
  if (column == columns.end()) return -1;
  const auto number = Count(column->second);
  return number && *number <= std::numeric_limits<int>::max() ? static_cast<int>(*number) - 1 : -1;
}

// Whether the first line, which does not begin with a number, is a row all the same: with a name
// before its numbers, or damaged, as its reading then tells. `width`: fields of the next row, if
// any. Titles hold numbers too, but rarely two where coordinates belong.
bool IsRow(const std::vector<std::string_view>& fields,
           std::size_t width,
           const CloudReadOptions& options) {
  if (std::none_of(fields.begin(), fields.end(), IsFilledNumber)) return false;
  const auto is_word = [](std::string_view field) {
    return !field.empty() && IsLetter(field[0]) && !IsNumber(field);
  };
  if (BeginsAsNumber(fields[0]) && std::none_of(fields.begin(), fields.end(), is_word)) return true;
  if (width > 0 && width != fields.size()) return false;
  int numbers = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int column = CoordinateColumn(axis, options.columns);
    const bool there = column >= 0 && column < static_cast<int>(fields.size());
    numbers += there && IsFilledNumber(fields[static_cast<std::size_t>(column)]) ? 1 : 0;
  }
  return numbers >= 2;
}

// Reads up to the first row, which stays in `line`; false when there is none.
bool ReadPreamble(LineReader& lines, std::string_view& line, Preamble& preamble) {
  const std::string& file = lines.source().name();
  bool first = true;
  while (lines.Next(line)) {
    if (lines.number() == 1) {
      if (line.starts_with("\xEF\xBB\xBF")) line.remove_prefix(3);
      if (line.starts_with("\xFF\xFE") || line.starts_with("\xFE\xFF")) {
        throw ReadError::AtLine(file, 1, "is UTF-16 text; save it as UTF-8");
      }
    }
    if (!HoldsContent(line)) {
      std::vector<std::string> words = CommentWords(line);
      if (NamesPlace(words)) preamble.comment = std::move(words);
      continue;
    }
    const auto fields = SplitFields(line);
    if (!std::exchange(first, false)) return true;
    if (!BeginsRow(fields, line)) {
      RequireText(line, lines, file);
      preamble.header = {std::string(line), lines.number()};
    } else if (fields.size() == 1 && Count(fields[0])) {
      preamble.promised = Count(fields[0]);
    } else {
      return true;
    }
  }
  return false;
}

}  // namespace

FileCloud ReadText(ByteSource& source, const CloudReadOptions& options) {
  const std::string& file = source.name();
  LineReader lines(source);
  Preamble preamble;
  std::string_view line;
  const bool has_rows = ReadPreamble(lines, line, preamble);
  TextHeader header = std::move(preamble.header), row;
  const std::size_t next_width = has_rows ? SplitFields(line).size() : 0;
  if (!header.line.empty() && IsRow(SplitFields(header.line), next_width, options)) {
    row = std::exchange(header, {});
    if (has_rows) lines.Repeat();
  } else if (!has_rows) {
    FileCloud empty;
    empty.fields = HeaderNames(header.line);
    return empty;
  } else {
    row = {std::string(line), lines.number()};
  }
  RefuseDecimalCommas(file, row.line, row.number);
  const std::vector<std::string_view> first = SplitFields(row.line);
  const bool numbered = options.columns.contains("x") &&
                        CoordinateColumn(0, options.columns) >= 0 &&
                        CoordinateColumn(1, options.columns) >= 0;
  const std::vector<CloudField> fields =
      TextFields(file, header, preamble.comment, first, numbered);
  CloudFilter filter(file,
                     fields,
                     ChooseColumns(file, fields, FieldNaming::kText, options),
                     options,
                     RowPlace::kLine);
  const bool plane_by_width = first.size() == 2 && options.columns.empty();
  RowParser parser(file, filter.columns().fields, plane_by_width ? 2 : 0);
  if (WithoutComment(row.line).find(',') == std::string_view::npos) parser.WatchCommas();
  RowBatch batch(filter.columns().fields.size());
  parser.Parse(row.line, row.number, batch);
  while (lines.Next(line)) {
    if (!HoldsContent(line)) continue;
    parser.Parse(line, lines.number(), batch);
    if (batch.rows == RowBatch::kRows) filter.Take(batch);
  }
  filter.Take(batch);
  if (preamble.promised && filter.rows() < *preamble.promised) {
    throw ReadError::AtLine(
        file,
        lines.number(),
        fmt::format("the file ends after {} of {} points", filter.rows(), *preamble.promised));
  }
  return std::move(filter).Finish();
}

}  // namespace batten::internal
