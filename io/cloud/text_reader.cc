// SPDX-License-Identifier: MIT
#include "io/cloud/text_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <limits>
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

// The lines before the rows, and the first row.
struct Head {
  std::vector<TextHeader> before;
  TextHeader row;                    // empty: there is none
  std::vector<std::string> comment;  // words of the last comment before the rows that names x and y
  std::optional<std::int64_t> promised;  // rows, by a count of them
  TextHeader counts;                     // the line of the sizes of blocks, if any, …
  std::size_t blocks = 0;                // … and how many they are
  std::vector<TextHeader> doubtful;      // of those before: titles that may be points
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

void RequireText(const TextHeader& line, const std::string& file) {
  const auto is_control = [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < 0x20 && std::isspace(byte) == 0;
  };
  if (std::any_of(line.line.begin(), line.line.end(), is_control)) {
    throw ReadError::AtLine(file, line.number, "is not text: " + Quoted(line.line));
  }
}

// 61 and, as FORTRAN writes it, 61. too.
std::optional<std::int64_t> Count(std::string_view field) {
  std::int64_t count = 0;
  const char* const last = field.data() + field.size();
  const auto [end, error] = std::from_chars(field.data(), last, count);
  if (error != std::errc() || end == field.data() || count < 0) return std::nullopt;
  const bool whole =
      end == last || (*end == '.' && std::all_of(end + 1, last, [](char c) { return c == '0'; }));
  return whole ? std::optional(count) : std::nullopt;
}

bool IsFilledNumber(std::string_view field) { return !field.empty() && IsNumber(field); }

// Whether two letters of it are side by side, as in no damaged number.
bool IsWord(std::string_view field) {
  const auto is_letter = [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; };
  return !IsNumber(field) && std::adjacent_find(field.begin(), field.end(), [&](char a, char b) {
                               return is_letter(a) && is_letter(b);
                             }) != field.end();
}

// Of lines that are taken for titles though they may be points.
std::string TakenForTitles(const std::vector<TextHeader>& lines) {
  const std::int64_t first = lines.front().number, last = lines.back().number;
  const std::string quoted = Quoted(lines.front().line);
  if (lines.size() == 1)
    return fmt::format("line {} is taken for a title and gives no point: {}", first, quoted);
  const bool all = last - first + 1 == static_cast<std::int64_t>(lines.size());
  return fmt::format("{}lines {} to {} are taken for titles and give no points: {}, …",
                     all ? "" : "some of the ",
                     first,
                     last,
                     quoted);
}

// Reads up to the first row, as what follows shows it.
class HeadReader {
 public:
  HeadReader(LineReader& lines, const CloudReadOptions& options)
      : lines_(lines), file_(lines.source().name()), options_(options) {}

  // A line is a row if it has numbers where the coordinates are, and does not count what follows.
  // So is one that is damaged there, and refused later: it is told from titles and counts by the
  // first row that is whole.
  Head Read() {
    bool named = false;
    std::size_t held = 0;
    std::string_view line;
    while (head_.row.line.empty() && held <= kLongestLine && lines_.Next(line)) {
      if (lines_.number() == 1) RemoveMark(line);
      if (!HoldsContent(line)) {
        std::vector<std::string> words = CommentWords(line);
        if (NamesPlace(words)) head_.comment = std::move(words);
        continue;
      }
      TextHeader content{std::string(line), lines_.number()};
      held += line.size();
      const Fields fields = FieldsOf(content);
      const bool whole = fields.size() > 1 && Coordinates(fields).second;
      if (whole && !head_.promised && CountsRows(fields)) {
        head_.counts = std::move(content);
        head_.blocks = fields.size();
        continue;
      }
      if (whole || (named && fields.size() > 1)) {
        head_.row = std::move(content);
      } else {
        named = named || NamesColumns(content.line);
        head_.before.push_back(std::move(content));
      }
    }
    FindDamagedRow();
    NoteCount();
    NoteDoubtful();
    return std::move(head_);
  }

 private:
  using Fields = std::vector<std::string>;

  void RemoveMark(std::string_view& line) const {
    if (line.starts_with("\xEF\xBB\xBF")) line.remove_prefix(3);
    if (line.starts_with("\xFF\xFE") || line.starts_with("\xFE\xFF")) {
      throw ReadError::AtLine(file_, 1, "is UTF-16 text; save it as UTF-8");
    }
  }

  // With points for decimal commas.
  Fields FieldsOf(const TextHeader& line) const {
    Fields fields;
    DecimalCommas commas(file_);
    for (const std::string_view field : SplitFields(commas.Plain(line.line, line.number)))
      fields.emplace_back(field);
    return fields;
  }

  // How many coordinates there are numbers for, and whether there is one for each.
  std::pair<int, bool> Coordinates(const Fields& fields) const {
    constexpr std::array kAxes{"x", "y", "z"};
    const auto named = NamesInComment(head_.comment, fields.size());
    const bool asked = std::any_of(kAxes.begin(), kAxes.end(), [&](const char* axis) {
      return options_.columns.contains(axis);
    });
    std::pair<int, bool> found{0, true};
    for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
      std::int64_t column = static_cast<std::int64_t>(axis);
      if (asked) {
        const auto column_asked = options_.columns.find(kAxes[axis]);
        if (column_asked == options_.columns.end()) continue;
        column = Count(column_asked->second).value_or(0) - 1;
      } else if (NamesPlace(named)) {
        column = PlaceOfRole(named, kAxes[axis]);
      }
      const bool inside = column >= 0 && column < static_cast<std::int64_t>(fields.size());
      const bool number = inside && IsNumber(fields[static_cast<std::size_t>(column)]);
      if (inside || axis < 2 || asked) found.second = found.second && number;
      found.first += number && !fields[static_cast<std::size_t>(column)].empty() ? 1 : 0;
    }
    return found;
  }

  // Whether the line names the columns, for those that are asked for too.
  bool NamesColumns(const std::string& line) const {
    const std::vector<std::string> names = HeaderNames(line);
    return NamesPlace(names) ||
           std::any_of(options_.columns.begin(), options_.columns.end(), [&](const auto& asked) {
             return !Count(asked.second) && PlaceOf(names, asked.second) >= 0;
           });
  }

  // Whether whole numbers are the sizes of the blocks that follow, one after the other: lines of
  // blanks stand only before the first and where one ends. One such line tells that from a first
  // point of whole numbers; where rows are missing, or not all are at hand, there must be all.
  bool CountsRows(const Fields& fields) {
    constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
    std::vector<std::int64_t> ends{0};  // rows up to there
    for (const std::string& field : fields) {
      const auto count = Count(field);
      if (!count || *count == 0 || *count > kMost - ends.back()) return false;
      ends.push_back(ends.back() + *count);
    }
    std::string_view ahead = lines_.source().Peek(ByteSource::kBlockBytes);
    const bool to_the_end = ahead.size() < ByteSource::kBlockBytes;
    std::int64_t rows = 0;
    std::size_t blanks = 0;
    bool blank = false;
    while (!ahead.empty()) {
      const std::size_t end = std::min(ahead.find_first_of("\r\n"), ahead.size());
      const std::string_view line = ahead.substr(0, end);
      ahead.remove_prefix(
          std::min(end + (ahead.substr(end).starts_with("\r\n") ? 2 : 1), ahead.size()));
      blank = blank || IsBlankLine(line);
      if (!HoldsContent(line)) continue;
      if (std::exchange(blank, false)) {
        if (!std::binary_search(ends.begin(), ends.end(), rows)) return false;
        ++blanks;
      }
      if (++rows > ends.back()) return false;
    }
    if (blanks < (to_the_end && rows == ends.back() ? 1 : fields.size())) return false;
    head_.promised = ends.back();
    return true;
  }

  // Whether a line that is no whole row is one that is damaged, or carries a name: it begins like a
  // number and holds no word, or it has two coordinates and begins as a number or has the form of
  // the row after it.
  bool IsDamaged(const Fields& fields, const Fields& next) const {
    if (fields.size() < 2 || std::none_of(fields.begin(), fields.end(), IsFilledNumber))
      return false;
    if (BeginsAsNumber(fields[0]) && std::none_of(fields.begin(), fields.end(), IsWord))
      return true;
    const bool formed = next.empty() || IsFilledNumber(fields[0]) ||
                        (next.size() == fields.size() && (!IsWord(fields[0]) || IsWord(next[0])));
    return formed && Coordinates(fields).first >= 2;
  }

  void FindDamagedRow() {
    std::vector<TextHeader>& before = head_.before;
    std::vector<Fields> fields;
    for (const TextHeader& line : before) fields.push_back(FieldsOf(line));
    fields.push_back(head_.row.line.empty() ? Fields{} : FieldsOf(head_.row));
    const bool none = head_.row.line.empty();
    std::size_t row = 0;
    while (row < before.size() && !IsDamaged(fields[row], none ? fields[row + 1] : fields.back()))
      ++row;
    // Without any row the second line is to be one, or the first if it begins as one.
    if (row == before.size() && none)
      row = !before.empty() && fields[0].size() > 1 && IsFilledNumber(fields[0][0]) ? 0 : 1;
    if (row < before.size()) {
      head_.row = std::move(before[row]);
      before.resize(row);
    }
    for (const TextHeader& line : before) RequireText(line, file_);
  }

  // A single line of nothing but a count says how many rows there are; several have other meanings.
  void NoteCount() {
    std::vector<std::int64_t> counts;
    for (const TextHeader& line : head_.before) {
      const Fields fields = FieldsOf(line);
      const auto count = fields.size() == 1 ? Count(fields[0]) : std::nullopt;
      if (count) counts.push_back(*count);
    }
    if (counts.size() == 1 && !head_.promised) head_.promised = counts[0];
  }

  // Lines that are no rows, yet hold numbers as rows do: as many fields, or numbers where two
  // coordinates are. A word and a whole number name a profile: NACA 2412.
  void NoteDoubtful() {
    if (head_.row.line.empty()) return;
    const std::size_t width = FieldsOf(head_.row).size();
    bool point = width > 2;
    for (const TextHeader& line : head_.before) {
      const Fields fields = FieldsOf(line);
      if (std::none_of(fields.begin(), fields.end(), IsFilledNumber)) continue;
      if (NamesPlace(HeaderNames(line.line))) continue;
      if (fields.size() != width && (width == 2 || Coordinates(fields).first < 2)) continue;
      point = point || !Count(IsFilledNumber(fields[0]) ? fields[0] : fields[1]);
      head_.doubtful.push_back(line);
    }
    if (!point && head_.doubtful.size() < 2) head_.doubtful.clear();
  }

  LineReader& lines_;
  const std::string& file_;
  const CloudReadOptions& options_;
  Head head_;
};

// The line that names the columns: where x and y are, else the last without numbers, if any.
TextHeader HeaderAmong(const std::vector<TextHeader>& before) {
  TextHeader header;
  bool placed = false;
  for (const TextHeader& line : before) {
    const std::vector<std::string> names = HeaderNames(line.line);
    const bool places = NamesPlace(names);
    if (placed && !places) continue;
    if (!places && std::any_of(names.begin(), names.end(), IsFilledNumber)) continue;
    placed = places;
    header = line;
  }
  return header;
}

}  // namespace

FileCloud ReadText(ByteSource& source, const CloudReadOptions& options) {
  const std::string& file = source.name();
  LineReader lines(source);
  const Head head = HeadReader(lines, options).Read();
  if (head.row.line.empty()) {
    FileCloud empty;
    if (!head.before.empty()) empty.fields = HeaderNames(head.before.front().line);
    return empty;
  }
  DecimalCommas commas(file);
  const std::string row(commas.Plain(head.row.line, head.row.number));
  const std::vector<std::string_view> first = SplitFields(row);
  const auto is_numbered = [&](const char* role) {
    const auto asked = options.columns.find(role);
    return asked != options.columns.end() && Count(asked->second).value_or(0) > 0;
  };
  const std::vector<CloudField> fields = TextFields(
      file, HeaderAmong(head.before), head.comment, first, is_numbered("x") && is_numbered("y"));
  CloudFilter filter(file,
                     fields,
                     ChooseColumns(file, fields, FieldNaming::kText, options),
                     options,
                     RowPlace::kLine);
  const bool plane_by_width = first.size() == 2 && options.columns.empty();
  const RowParser parser(file, filter.columns().fields, plane_by_width ? 2 : 0);
  RowBatch batch(filter.columns().fields.size());
  parser.Parse(row, head.row.number, batch);
  bool blank = false;
  std::string_view line;
  while (lines.Next(line)) {
    if (!HoldsContent(line)) {
      blank = blank || IsBlankLine(line);
      continue;
    }
    if (std::exchange(blank, false)) {
      filter.Take(batch);
      filter.BeginBlock();
    }
    parser.Parse(commas.Plain(line, lines.number()), lines.number(), batch);
    if (batch.rows == RowBatch::kRows) filter.Take(batch);
  }
  filter.Take(batch);
  if (head.promised && filter.rows() < *head.promised) {
    throw ReadError::AtLine(
        file,
        lines.number(),
        fmt::format(
            "the file ends after {} of the {} points that a line before them counts; mend or "
            "remove that line",
            filter.rows(),
            *head.promised));
  }
  if (!head.doubtful.empty()) filter.Remark(TakenForTitles(head.doubtful));
  if (head.blocks == static_cast<std::size_t>(filter.columns().dimension())) {
    filter.Remark(fmt::format("line {} counts the rows of its blocks and is no point: {}",
                              head.counts.number,
                              Quoted(head.counts.line)));
  }
  if (commas.since() > 0)
    filter.Remark(fmt::format("the commas of its numbers are decimal (line {})", commas.since()));
  return std::move(filter).Finish();
}

}  // namespace batten::internal
