// SPDX-License-Identifier: MIT
#include "io/cloud/text_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <optional>
#include <utility>

#include "batten/io/read_error.h"
#include "io/base/plain_decimal.h"

namespace batten::internal {
namespace {

bool IsBlank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v'; }

bool IsDelimiter(char c) { return c == ',' || c == ';'; }

const char* SkipBlanks(const char* at, const char* end) {
  while (at < end && IsBlank(*at)) ++at;
  return at;
}

// At the end of the line, or where a comment begins.
bool AtEnd(const char* at, const char* end) {
  return at == end || *at == '#' || (*at == '/' && end - at > 1 && at[1] == '/');
}

bool EndsField(const char* at, const char* end) {
  return AtEnd(at, end) || IsBlank(*at) || IsDelimiter(*at);
}

// The end of the field that starts at `at`; a quoted one may hold separators.
const char* FieldEnd(const char* at, const char* end) {
  if (at < end && *at == '"') {
    const char* closing = std::find(at + 1, end, '"');
    if (closing != end) at = closing;
  }
  while (!EndsField(at, end)) ++at;
  return at;
}

std::string_view Unquoted(std::string_view field) {
  if (field.size() >= 2 && (field.front() == '"' || field.front() == '\'') &&
      field.back() == field.front()) {
    field = field.substr(1, field.size() - 2);
    while (!field.empty() && IsBlank(field.front())) field.remove_prefix(1);
    while (!field.empty() && IsBlank(field.back())) field.remove_suffix(1);
  }
  return field;
}

// What std::from_chars leaves out: a leading plus, quotes, empty fields, and numbers beyond double.
std::optional<double> UnusualNumber(std::string_view field) {
  field = Unquoted(field);
  if (field.empty()) return std::numeric_limits<double>::quiet_NaN();
  if (field.front() == '+') {
    field.remove_prefix(1);
    if (field.starts_with('-')) return std::nullopt;
  }
  double value = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (end != field.data() + field.size() || error == std::errc::invalid_argument)
    return std::nullopt;
  if (error == std::errc::result_out_of_range) {
    // Too small becomes zero; too large the largest double, which the filter refuses by its size.
    constexpr double kLargest = std::numeric_limits<double>::max();
    value = std::clamp(std::strtod(std::string(field).c_str(), nullptr), -kLargest, kLargest);
  }
  return value;
}

// Whether the commas of a row may be decimal: it has no point; every field between semicolons or
// blanks is a number with at most one comma, between digits, or, beside semicolons or tabs, a word;
// two are numbers, and one has that comma. `plain`: the row with points instead.
bool MayHoldDecimalCommas(std::string_view content, std::string& plain) {
  if (content.find('.') != std::string_view::npos) return false;
  plain = content;
  std::replace(plain.begin(), plain.end(), ',', '.');
  const bool words = content.find_first_of(";\t") != std::string_view::npos;
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  int numbers = 0, commas = 0;
  for (const std::string_view field : SplitFields(plain)) {
    if (field.empty()) continue;
    const std::size_t point = field.find('.');
    const bool whole = point == std::string_view::npos;
    if (IsNumber(field) && (whole || (point > 0 && point + 1 < field.size() &&
                                      is_digit(field[point - 1]) && is_digit(field[point + 1])))) {
      ++numbers;
      commas += whole ? 0 : 1;
    } else if (!words || (!whole && BeginsAsNumber(field))) {
      return false;
    }
  }
  return numbers > 1 && commas > 0;
}

// Whether the field is a number with `thousands` between groups of three digits, if any, and then
// `decimal` and more digits: 1.234,56. `grouped`: there are such groups.
bool IsGroupedNumber(std::string_view field, char thousands, char decimal, bool& grouped) {
  if (field.starts_with('-') || field.starts_with('+')) field.remove_prefix(1);
  const auto digits = [&] {
    const std::size_t count = std::min(field.find_first_not_of("0123456789"), field.size());
    field.remove_prefix(count);
    return count;
  };
  const std::size_t first = digits();
  grouped = field.starts_with(thousands);
  if (first == 0 || (grouped && first > 3)) return false;
  while (field.starts_with(thousands)) {
    field.remove_prefix(1);
    if (digits() != 3) return false;
  }
  if (!field.starts_with(decimal)) return false;
  field.remove_prefix(1);
  return digits() > 0 && field.empty();
}

// Whether all commas of a row belong to numbers between blanks or semicolons that hold a sign
// between thousands too, of which there are two. A single one may be two columns: 1.234,56.
bool HoldsThousands(std::string_view content, char thousands, char decimal) {
  constexpr const char* kBetween = " \t;";
  int numbers = 0, grouped_numbers = 0;
  while (!content.empty()) {
    const std::size_t length = std::min(content.find_first_of(kBetween), content.size());
    const std::string_view field = content.substr(0, length);
    content.remove_prefix(std::min(length + 1, content.size()));
    bool grouped = false;
    if (IsGroupedNumber(field, thousands, decimal, grouped)) {
      ++numbers;
      grouped_numbers += grouped ? 1 : 0;
    } else if (field.find(',') != std::string_view::npos) {
      return false;
    }
  }
  return numbers > 1 && grouped_numbers > 0;
}

// Read as a separator the comma would make two columns of each number.
void RefuseThousands(const std::string& file, std::string_view content, std::int64_t number) {
  if (content.find('.') == std::string_view::npos) return;
  const bool points = HoldsThousands(content, '.', ',');
  if (!points && !HoldsThousands(content, ',', '.')) return;
  throw ReadError::AtLine(
      file,
      number,
      fmt::format("the numbers hold {} between thousands: {}; leave them out, as in 1234.56",
                  points ? "points" : "commas",
                  Quoted(content)));
}

}  // namespace

std::size_t LineReader::NextByte::In(std::string_view bytes, std::int64_t position) {
  if (!found_ || at_ < position) {
    const auto known = static_cast<std::size_t>(std::max<std::int64_t>(at_ - position, 0));
    const void* hit = known < bytes.size()
                          ? std::memchr(bytes.data() + known, byte_, bytes.size() - known)
                          : nullptr;
    found_ = hit != nullptr;
    at_ = position + (found_ ? static_cast<const char*>(hit) - bytes.data()
                             : static_cast<std::ptrdiff_t>(bytes.size()));
  }
  return static_cast<std::size_t>(at_ - position);
}

std::size_t LineReader::LengthOfLine(std::string_view bytes) {
  return std::min(line_feed_.In(bytes, source_.position()),
                  carriage_return_.In(bytes, source_.position()));
}

bool LineReader::Next(std::string_view& line) {
  if (std::exchange(repeat_, false)) {
    line = last_;
    return true;
  }
  std::string_view bytes = source_.Peek(1);
  std::size_t length = LengthOfLine(bytes);
  if (length + 1 >= bytes.size()) {  // the byte behind a "\r" counts too
    bytes = source_.Peek(kLongestLine + 2);
    if (bytes.empty()) return false;
    length = LengthOfLine(bytes);
  }
  ++number_;
  if (length > kLongestLine) {
    throw ReadError::AtLine(
        source_.name(), number_, fmt::format("longer than {} bytes; is this text?", kLongestLine));
  }
  line = bytes.substr(0, length);
  const std::string_view ending = bytes.substr(length, 2);
  if (number_ == 1) first_ends_in_return_ = ending.starts_with('\r') && ending != "\r\n";
  const bool both = ending == "\r\n" && !first_ends_in_return_;
  source_.Skip(static_cast<std::int64_t>(length + (ending.empty() ? 0 : both ? 2 : 1)));
  last_ = line;
  return true;
}

bool IsBlankLine(std::string_view line) { return std::all_of(line.begin(), line.end(), IsBlank); }

bool HoldsContent(std::string_view line) {
  const char* end = line.data() + line.size();
  return !AtEnd(SkipBlanks(line.data(), end), end);
}

std::vector<std::string_view> SplitFields(std::string_view line) {
  std::vector<std::string_view> fields;
  const char* at = line.data();
  const char* end = at + line.size();
  bool after_delimiter = false;
  for (;;) {
    at = SkipBlanks(at, end);
    if (AtEnd(at, end)) break;
    const char* field_end = FieldEnd(at, end);
    fields.push_back(Unquoted({at, static_cast<std::size_t>(field_end - at)}));
    at = SkipBlanks(field_end, end);
    after_delimiter = at < end && IsDelimiter(*at);
    if (after_delimiter) ++at;
  }
  if (after_delimiter) fields.emplace_back();
  return fields;
}

std::string_view WithoutComment(std::string_view line) {
  const char* at = line.data();
  const char* const end = at + line.size();
  while (!AtEnd(at, end)) ++at;
  return line.substr(0, static_cast<std::size_t>(at - line.data()));
}

void RefuseDecimalCommas(const std::string& file, std::string_view line, std::int64_t number) {
  const std::string_view content = WithoutComment(line);
  if (content.find(',') == std::string_view::npos) return;
  RefuseThousands(file, content, number);
  std::string plain;
  if (!MayHoldDecimalCommas(content, plain)) return;
  throw ReadError::AtLine(
      file,
      number,
      "the commas may be decimal or separators: " + Quoted(content) +
          "; write decimal points, or separate the numbers by one kind of separator only");
}

std::string_view DecimalCommas::Plain(std::string_view line, std::int64_t number) {
  if (separate_) return line;
  const bool comma = line.find(',') != std::string_view::npos;
  const std::string_view content = comma ? WithoutComment(line) : line;
  if (!comma || content.find(',') == std::string_view::npos) {
    if (width_ == 0) width_ = SplitFields(line).size();
    return line;
  }
  RefuseThousands(file_, content, number);
  if (MayHoldDecimalCommas(content, plain_)) {
    const std::size_t width = SplitFields(plain_).size();
    if (width_ == 0) width_ = width;
    if (width >= width_) {
      if (since_ == 0) since_ = number;
      return plain_;
    }
  }
  separate_ = width_ == 0;
  if (since_ > 0) {
    throw ReadError::AtLine(
        file_,
        number,
        fmt::format("the commas are decimal from line {} on, but not all of {}; write decimal "
                    "points, or separate the numbers by one kind of separator only",
                    since_,
                    Quoted(content)));
  }
  RefuseDecimalCommas(file_, line, number);
  return line;
}

bool BeginsAsNumber(std::string_view field) {
  const std::size_t first = field.find_first_not_of("+-.");
  return first != std::string_view::npos && first <= 2 && field[first] >= '0' &&
         field[first] <= '9';
}

bool IsNumber(std::string_view field) { return UnusualNumber(field).has_value(); }

const char* ParseNumber(const char* at, const char* end, double& value) {
  const char* const plain = ParsePlainDecimal(at, end, value);
  if (plain != nullptr && EndsField(plain, end)) return plain;
  const auto [parsed, error] = std::from_chars(at, end, value);
  if (error == std::errc() && EndsField(parsed, end)) return parsed;
  const char* field_end = FieldEnd(at, end);
  const auto unusual = UnusualNumber({at, static_cast<std::size_t>(field_end - at)});
  if (!unusual) return nullptr;
  value = *unusual;
  return field_end;
}

std::string Quoted(std::string_view text) {
  constexpr std::size_t kShown = 24;
  std::string result = "'";
  for (const char c : text.substr(0, kShown)) {
    const auto byte = static_cast<unsigned char>(c);
    result += byte >= 0x20 && byte < 0x7f ? std::string(1, c) : fmt::format("\\x{:02x}", byte);
  }
  return result + (text.size() > kShown ? "…'" : "'");
}

RowParser::RowParser(std::string file, const std::vector<int>& columns, int exact_fields)
    : file_(std::move(file)),
      slots_(columns.empty() ? 0 : columns.back() + 1, -1),
      exact_fields_(exact_fields) {
  for (std::size_t c = 0; c < columns.size(); ++c) slots_[columns[c]] = static_cast<int>(c);
}

void RowParser::Parse(std::string_view line, std::int64_t number, RowBatch& batch) const {
  const char* at = line.data();
  const char* const end = at + line.size();
  double* const row = batch.values.data() + batch.rows;
  bool after_delimiter = false;
  for (std::size_t field = 0; field < slots_.size(); ++field) {
    at = SkipBlanks(at, end);
    if (AtEnd(at, end) && !after_delimiter) {
      throw ReadError::AtLine(
          file_, number, fmt::format("expected {} columns, found {}", slots_.size(), field));
    }
    const char* field_end = nullptr;
    if (slots_[field] < 0) {
      field_end = FieldEnd(at, end);
    } else {
      double& value = row[static_cast<std::size_t>(slots_[field]) * RowBatch::kRows];
      field_end = ParseNumber(at, end, value);
      if (field_end == nullptr) {
        const std::string_view text(at, static_cast<std::size_t>(FieldEnd(at, end) - at));
        throw ReadError::AtLine(file_, number, "expected a number, found " + Quoted(text));
      }
    }
    at = SkipBlanks(field_end, end);
    after_delimiter = at < end && IsDelimiter(*at);
    if (after_delimiter) ++at;
  }
  if (exact_fields_ > 0 && !AtEnd(SkipBlanks(at, end), end)) {
    throw ReadError::AtLine(
        file_, number, fmt::format("expected {} columns as above, found more", exact_fields_));
  }
  batch.places[batch.rows++] = number;
}

void ReadTextRows(LineReader& lines,
                  std::int64_t count,
                  const std::vector<int>& columns,
                  CloudFilter& filter) {
  RowParser parser(lines.source().name(), columns);
  RowBatch batch(columns.size());
  std::string_view line;
  for (std::int64_t row = 0; row < count;) {
    if (!lines.Next(line)) {
      throw ReadError::AtLine(lines.source().name(),
                              lines.number(),
                              fmt::format("the file ends after {} of {} points", row, count));
    }
    if (!HoldsContent(line)) continue;
    RefuseDecimalCommas(lines.source().name(), line, lines.number());
    parser.Parse(line, lines.number(), batch);
    ++row;
    if (batch.rows == RowBatch::kRows) filter.Take(batch);
  }
  filter.Take(batch);
}

}  // namespace batten::internal
