// SPDX-License-Identifier: MIT
#include "cli/arguments/csv_table.h"

#include "batten/io/read_error.h"
#include "io/base/whole_file.h"

namespace batten::internal {
namespace {

class CsvReader {
 public:
  CsvReader(std::string path, std::string_view text) : path_(std::move(path)), text_(text) {
    constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
    if (text_.starts_with(kByteOrderMark)) at_ = kByteOrderMark.size();
  }

  std::vector<CsvRow> Rows() && {
    std::vector<CsvRow> rows;
    while (at_ < text_.size()) {
      if (text_[at_] == '#') {
        SkipLine();
        continue;
      }
      CsvRow row{line_, {}};
      do row.cells.push_back(Cell());
      while (Take(','));
      EndLine();
      if (row.cells.size() > 1 || !row.cells[0].empty()) rows.push_back(std::move(row));
    }
    return rows;
  }

 private:
  bool Take(char wanted) {
    if (at_ == text_.size() || text_[at_] != wanted) return false;
    ++at_;
    return true;
  }

  std::string Cell() {
    if (Take('"')) return Quoted();
    const size_t end = std::min(text_.find_first_of(",\r\n", at_), text_.size());
    std::string cell = Trimmed(text_.substr(at_, end - at_));
    at_ = end;
    return cell;
  }

  std::string Quoted() {
    const int begin = line_;
    std::string cell;
    for (;; ++at_) {
      if (at_ == text_.size()) throw ReadError::AtLine(path_, begin, "quotes that do not end");
      if (text_[at_] == '\n') ++line_;
      if (text_[at_] == '"' && !(at_ + 1 < text_.size() && text_[at_ + 1] == '"')) break;
      if (text_[at_] == '"') ++at_;
      cell += text_[at_];
    }
    ++at_;
    const size_t end = std::min(text_.find_first_of(",\r\n", at_), text_.size());
    const std::string after = Trimmed(text_.substr(at_, end - at_));
    if (!after.empty()) {
      throw ReadError::AtLine(
          path_, line_, "'" + after + "' follows quotes that end; quotes in a cell are doubled");
    }
    at_ = end;
    return cell;
  }

  void EndLine() {
    Take('\r');
    Take('\n');
    ++line_;
  }

  void SkipLine() {
    at_ = std::min(text_.find_first_of("\r\n", at_), text_.size());
    EndLine();
  }

  std::string path_;
  std::string_view text_;
  size_t at_ = 0;
  int line_ = 1;
};

}  // namespace

std::vector<CsvRow> ReadCsv(const std::string& path) {
  const std::string text = ReadWholeFile(path);
  return CsvReader(path, text).Rows();
}

std::string CsvLine(const std::vector<std::string>& cells) {
  std::string line;
  for (size_t k = 0; k < cells.size(); ++k) {
    if (k > 0) line += ',';
    const bool plain = cells[k].find_first_of(",\"\r\n") == std::string::npos &&
                       Trimmed(cells[k]) == cells[k] && !cells[k].starts_with('#');
    if (plain) {
      line += cells[k];
      continue;
    }
    line += '"';
    for (const char c : cells[k]) line += c == '"' ? std::string("\"\"") : std::string(1, c);
    line += '"';
  }
  return line + '\n';
}

std::string Trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t";
  const size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return "";
  return std::string(text.substr(begin, text.find_last_not_of(kBlanks) + 1 - begin));
}

}  // namespace batten::internal
