// SPDX-License-Identifier: MIT
#include "batten/io/text_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <optional>
#include <string_view>
#include <utility>

#include "batten/io/read_error.h"
#include "batten/io/text_names.h"
#include "batten/io/text_rows.h"

namespace batten {
namespace {

// The lines before the rows.
struct Preamble {
  std::vector<std::string> names;    // of a header line
  std::vector<std::string> comment;  // words of the last comment before the rows that names x and y
  std::optional<std::int64_t> promised;  // rows, by a line with nothing but a count
};

std::vector<std::string> HeaderNames(std::string_view line) {
  // Names of a table with delimiters may hold blanks.
  for (const char delimiter : {',', ';', '\t'}) {
    if (line.find(delimiter) == std::string_view::npos) continue;
    std::vector<std::string> names;
    while (!line.empty()) {
      const std::size_t end = std::min(line.find(delimiter), line.size());
      std::string name(line.substr(0, end));
      std::erase_if(name, [](char c) { return c == '"' || c == '\''; });
      const std::size_t first = name.find_first_not_of(" \t\r");
      const std::size_t last = name.find_last_not_of(" \t\r");
      names.push_back(first == std::string::npos ? "" : name.substr(first, last - first + 1));
      line.remove_prefix(std::min(end + 1, line.size()));
    }
    return names;
  }
  std::vector<std::string> names;
  for (const std::string_view name : SplitFields(line)) names.emplace_back(name);
  return names;
}

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
    if (!IsNumber(fields[0])) {
      RequireText(line, lines, file);
      preamble.names = HeaderNames(line);
    } else if (fields.size() == 1 && Count(fields[0])) {
      preamble.promised = Count(fields[0]);
    } else {
      return true;
    }
  }
  return false;
}

}  // namespace

CloudPart ReadText(ByteSource& source, const CloudReadOptions& options) {
  LineReader lines(source);
  Preamble preamble;
  std::string_view line;
  if (!ReadPreamble(lines, line, preamble)) {
    CloudPart empty;
    empty.fields = std::move(preamble.names);
    return empty;
  }
  const std::size_t width = SplitFields(line).size();
  const std::vector<CloudField> fields =
      TextFields(source.name(), std::move(preamble.names), preamble.comment, width);
  const bool plane_by_width = width == 2 && options.columns.empty();
  CloudFilter filter(source.name(),
                     fields,
                     ChooseColumns(source.name(), fields, FieldNaming::kText, options),
                     options,
                     RowPlace::kLine);
  const RowParser parser(source.name(), filter.columns().fields, plane_by_width ? 2 : 0);
  RowBatch batch(filter.columns().fields.size());
  do {
    if (!HoldsContent(line)) continue;
    parser.Parse(line, lines.number(), batch);
    if (batch.rows == RowBatch::kRows) filter.Take(batch);
  } while (lines.Next(line));
  filter.Take(batch);
  if (preamble.promised && filter.rows() < *preamble.promised) {
    throw ReadError::AtLine(
        source.name(),
        lines.number(),
        fmt::format("the file ends after {} of {} points", filter.rows(), *preamble.promised));
  }
  return std::move(filter).Finish();
}

}  // namespace batten
