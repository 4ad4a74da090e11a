// SPDX-License-Identifier: MIT
// Lines of a text and the numbers on them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/base/byte_source.h"
#include "io/cloud/cloud_filter.h"
#include "io/cloud/row_batch.h"

namespace batten::internal {

// No line of points is longer; garbage without line ends stops here.
inline constexpr std::size_t kLongestLine = std::size_t{1} << 16;

// The lines of a file, one after the other, without what ends them: "\n", "\r\n" or "\r".
class LineReader {
 public:
  explicit LineReader(ByteSource& source) : source_(source) {}

  // The next line, valid until the next call; false at the end of the file. Throws ReadError where
  // a line is longer than kLongestLine.
  bool Next(std::string_view& line);

  // The line last returned comes again.
  void Repeat() { repeat_ = true; }

  // Of the line last returned, from 1.
  std::int64_t number() const { return number_; }

  ByteSource& source() { return source_; }

 private:
  // Finds the next of one byte without looking at any byte twice, however far away it is.
  class NextByte {
   public:
    explicit NextByte(char byte) : byte_(byte) {}

    // Where it stands in `bytes`, which begin at `position` of the file; their end if nowhere.
    std::size_t In(std::string_view bytes, std::int64_t position);

   private:
    char byte_;
    bool found_ = false;
    std::int64_t at_ = 0;  // in the file; unless found, the end of what was looked at
  };

  std::size_t LengthOfLine(std::string_view bytes);

  ByteSource& source_;
  NextByte line_feed_{'\n'}, carriage_return_{'\r'};
  bool first_ends_in_return_ = false;  // and no "\n": then what follows a "\r" is no part of it
  std::int64_t number_ = 0;
  std::string_view last_;
  bool repeat_ = false;
};

// Whether a line holds nothing but blanks.
bool IsBlankLine(std::string_view line);

// Whether a line holds more than blanks and a comment (from # or // on).
bool HoldsContent(std::string_view line);

// The fields of a line as RowParser sees them, comment left out and quotes stripped.
std::vector<std::string_view> SplitFields(std::string_view line);

// The line without its comment.
std::string_view WithoutComment(std::string_view line);

// Throws ReadError where the line's numbers hold signs between thousands, as in 1.234,56 2.345,67,
// and where its commas may be decimal: it has no point, is in fields
// between semicolons or blanks, each a number with at most one comma, between digits, or a word
// beside semicolons or tabs, and a number has that comma. Read as a separator it would move all
// that follows by a column.
void RefuseDecimalCommas(const std::string& file, std::string_view line, std::int64_t number);

// Reads the commas of a text's rows. Where the first row has some that cannot be decimal, as in
// 1,5,2,0, they separate. Else the first row whose commas may be decimal, and which then has no
// fewer fields than the first row, makes them decimal in all rows that follow.
class DecimalCommas {
 public:
  explicit DecimalCommas(std::string file) : file_(std::move(file)) {}

  // The row with points for its decimal commas, valid until the next call. Throws ReadError where
  // commas are decimal in one row and can't be in another, or may be but leave too few fields, and
  // where numbers hold signs between thousands.
  std::string_view Plain(std::string_view line, std::int64_t number);

  // The first line that has one; 0: none.
  std::int64_t since() const { return since_; }

 private:
  std::string file_;
  bool separate_ = false;
  std::size_t width_ = 0;  // fields of the first row
  std::int64_t since_ = 0;
  std::string plain_;
};

// Whether the field is a number up to a point: 0x10, -1.5D+3, 1"2.
bool BeginsAsNumber(std::string_view field);

// Whether the field is a number, or one of the words nan and inf, or empty.
bool IsNumber(std::string_view field);

// Reads the number at `at`, where no blank stands: the field ends at a blank, a comma, a semicolon,
// a comment or the end. Returns the end of the field; null where it is no number.
const char* ParseNumber(const char* at, const char* end, double& value);

// A piece of the file fit for a message: short, in quotes, unprintable bytes as \xNN.
std::string Quoted(std::string_view text);

// Reads rows of numbers. Fields are separated by blanks and tabs, or by one comma or semicolon with
// blanks around; between two of these an empty field stands for NaN. Columns that are not asked for
// may hold anything.
class RowParser {
 public:
  // `columns`: the fields (0-based, increasing) that go into the columns of a batch. With
  // `exact_fields` > 0 a row with more fields than that is refused.
  RowParser(std::string file, const std::vector<int>& columns, int exact_fields = 0);

  // Appends the row to the batch. Throws ReadError quoting what is no number, or saying how many
  // numbers are missing.
  void Parse(std::string_view line, std::int64_t number, RowBatch& batch) const;

 private:
  std::string file_;
  std::vector<int> slots_;  // for each field up to the last that is needed: its column, or −1
  int exact_fields_;
};

// Hands the next `count` rows to the filter, skipping lines without content; for bodies of PLY and
// PCD files. Throws ReadError where the file ends before.
void ReadTextRows(LineReader& lines,
                  std::int64_t count,
                  const std::vector<int>& columns,
                  CloudFilter& filter);

}  // namespace batten::internal
