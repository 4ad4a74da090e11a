// SPDX-License-Identifier: MIT
#include "io/exchange/iges_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "batten/io/read_error.h"

namespace batten::internal {
namespace {

constexpr size_t kDataColumns = 72, kParameterColumns = 64, kFieldColumns = 8;

struct Line {
  std::string_view text;  // 72 columns at most
  std::int64_t number;    // in the file
};

struct Sections {
  std::vector<Line> global, directory, parameters;
};

std::string_view Trimmed(std::string_view text) {
  const size_t begin = text.find_first_not_of(' ');
  if (begin == text.npos) return {};
  return text.substr(begin, text.find_last_not_of(' ') - begin + 1);
}

Sections SplitSections(std::string_view text, const std::string& path) {
  Sections sections;
  char last = 0;
  std::int64_t number = 0;
  constexpr std::string_view kOrder = "SGDPT";
  for (size_t begin = 0; begin < text.size() && last != 'T';) {
    const size_t end = std::min(text.find('\n', begin), text.size());
    std::string_view line = text.substr(begin, end - begin);
    begin = end + 1;
    ++number;
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (Trimmed(line).empty()) continue;
    const char section = line.size() > kDataColumns ? line[kDataColumns] : 0;
    if (section == 'C' || section == 'B') {
      throw ReadError::AtLine(path, number, "compressed and binary IGES are not in this version");
    }
    const size_t place = kOrder.find(section);
    if (section == 0 || place == kOrder.npos || (last != 0 && place < kOrder.find(last))) {
      throw ReadError::AtLine(
          path, number, "not a line of IGES: column 73 must name the section, in the order SGDPT");
    }
    last = section;
    const Line one = {line.substr(0, kDataColumns), number};
    if (section == 'G') sections.global.push_back(one);
    if (section == 'D') sections.directory.push_back(one);
    if (section == 'P') sections.parameters.push_back(one);
  }
  if (last != 'T') throw ReadError(path, "ends too early: there is no terminate section of IGES");
  return sections;
}

// The delimiters of parameters and of records.
struct Delimiters {
  char parameter = ',', record = ';';
};

Delimiters ReadDelimiters(const Sections& sections) {
  Delimiters delimiters;
  if (sections.global.empty()) return delimiters;
  const std::string_view text = sections.global[0].text;
  size_t next = 0;
  if (text.substr(0, 2) == "1H" && text.size() > 3) {
    delimiters.parameter = text[2];
    next = 4;
  } else {
    next = text.find(delimiters.parameter) + 1;
  }
  if (text.substr(next, 2) == "1H" && text.size() > next + 2) delimiters.record = text[next + 2];
  return delimiters;
}

int Integer(const Line& line, size_t field, const std::string& path) {
  const std::string_view text =
      field * kFieldColumns < line.text.size()
          ? Trimmed(line.text.substr(field * kFieldColumns, kFieldColumns))
          : std::string_view();
  if (text.empty()) return 0;
  int value = 0;
  const char* begin = text.data() + (text[0] == '+' ? 1 : 0);
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(begin, end, value);
  if (error == std::errc() && stop == end) return value;
  throw ReadError::AtLine(
      path, line.number, "field " + std::to_string(field + 1) + " of the directory is no integer");
}

// A number in FORTRAN's forms: 1, 1., .5, 1.5E3, 1.5D3; 0 for what is none.
double Number(std::string_view token) {
  constexpr size_t kLongest = 60;
  token = Trimmed(token);
  if (!token.empty() && token[0] == '+') token.remove_prefix(1);
  if (token.empty() || token.size() > kLongest) return 0;
  char digits[kLongest];
  std::transform(
      token.begin(), token.end(), digits, [](char c) { return c == 'D' || c == 'd' ? 'E' : c; });
  double value = 0;
  const char* end = digits + token.size();
  const auto [stop, error] = std::from_chars(digits, end, value);
  return error == std::errc() && stop == end && std::isfinite(value) ? value : 0;
}

// The characters of a text, nH…; empty for what is none.
std::string_view Characters(std::string_view token) {
  const size_t letter = token.find('H');
  return letter == token.npos ? std::string_view() : token.substr(letter + 1);
}

// The parameters of one record as they stand; none where it does not end.
std::optional<std::vector<std::string_view>> Tokens(const std::string& text,
                                                    const Delimiters& delimiters) {
  std::vector<std::string_view> tokens;
  for (size_t begin = 0; begin < text.size();) {
    size_t end = begin;
    // A text of n characters is nH…, whatever they are.
    const size_t digits = text.find_first_not_of(' ', begin);
    const size_t letter =
        digits == text.npos ? text.npos : text.find_first_not_of("0123456789", digits);
    if (letter != text.npos && letter > digits && letter - digits < 6 && text[letter] == 'H') {
      end = letter + 1 + static_cast<size_t>(Number(text.substr(digits, letter - digits)));
    }
    end = std::min(
        {text.find(delimiters.parameter, end), text.find(delimiters.record, end), text.size()});
    if (end == text.size()) break;
    tokens.push_back(std::string_view(text).substr(begin, end - begin));
    if (text[end] == delimiters.record) return tokens;
    begin = end + 1;
  }
  return std::nullopt;
}

class Parser {
 public:
  Parser(std::string_view text, const std::string& path)
      : path_(path), sections_(SplitSections(text, path)), delimiters_(ReadDelimiters(sections_)) {}

  std::vector<IgesEntity> Entities() {
    const std::vector<Line>& lines = sections_.directory;
    if (lines.size() % 2 != 0) {
      throw ReadError::AtLine(path_, lines.back().number, "an entry of the directory is cut off");
    }
    std::vector<IgesEntity> entities;
    for (size_t i = 0; i < lines.size(); i += 2) entities.push_back(Entity(lines[i], lines[i + 1]));
    for (IgesEntity& entity : entities) {
      const bool valid = entity.transform >= 0 &&
                         entity.transform < static_cast<int>(entities.size()) &&
                         entities[static_cast<size_t>(entity.transform)].type == 124;
      if (!valid) entity.transform = -1;
    }
    return entities;
  }

 private:
  IgesEntity Entity(const Line& first, const Line& second) {
    IgesEntity entity;
    entity.type = Integer(first, 0, path_);
    entity.form = Integer(second, 4, path_);
    entity.label = Label(second);
    entity.transform = IgesIndex(Integer(first, 6, path_));
    const std::string status = std::string(8, '0') + std::string(Status(first));
    const std::string_view digits = std::string_view(status).substr(status.size() - 8);
    entity.dependent = digits.substr(2, 2) == "01" || digits.substr(2, 2) == "03";
    entity.geometry = digits.substr(4, 2) == "00";
    // An entity has a line of parameters even where the directory says none.
    const int begin = Integer(first, 1, path_), count = std::max(Integer(second, 3, path_), 1);
    const auto available = static_cast<std::int64_t>(sections_.parameters.size());
    if (begin < 1 || std::int64_t{begin} - 1 + count > available) {
      throw ReadError::AtLine(path_, first.number, "the entity's parameters are not in the file");
    }
    used_ += count;
    if (used_ > available) {
      throw ReadError::AtLine(path_, first.number, "entities share their parameter lines");
    }
    std::string text;
    for (int i = 0; i < count; ++i) {
      std::string line(sections_.parameters[static_cast<size_t>(begin - 1 + i)].text.substr(
          0, kParameterColumns));
      line.resize(kParameterColumns, ' ');
      text += line;
    }
    const Line& start = sections_.parameters[static_cast<size_t>(begin - 1)];
    constexpr int kProperty = 406;
    const auto tokens = Tokens(text, delimiters_);
    if (!tokens) {
      throw ReadError::AtLine(path_, start.number, "the parameters of the entity do not end");
    }
    for (const std::string_view token : *tokens) {
      entity.parameters.push_back(Number(token));
      if (entity.type == kProperty && entity.text.empty()) entity.text = Characters(token);
    }
    if (entity.parameters.empty() || entity.parameters[0] != entity.type) {
      throw ReadError::AtLine(path_, start.number, "the parameters are those of another entity");
    }
    entity.parameters.erase(entity.parameters.begin());
    return entity;
  }

  static std::string_view Status(const Line& line) {
    constexpr size_t kBegin = 64;
    return line.text.size() > kBegin ? Trimmed(line.text.substr(kBegin)) : std::string_view();
  }

  static std::string Label(const Line& line) {
    constexpr size_t kBegin = 56;
    return line.text.size() > kBegin ? std::string(Trimmed(line.text.substr(kBegin, kFieldColumns)))
                                     : std::string();
  }

  const std::string& path_;
  Sections sections_;
  Delimiters delimiters_;
  std::int64_t used_ = 0;  // parameter lines
};

}  // namespace

std::vector<IgesEntity> ParseIges(std::string_view text, const std::string& path) {
  return Parser(text, path).Entities();
}

IgesGlobal ParseIgesGlobal(std::string_view text, const std::string& path) {
  const Sections sections = SplitSections(text, path);
  IgesGlobal global;
  if (sections.global.empty()) return global;
  const Delimiters delimiters = ReadDelimiters(sections);
  std::string all;
  for (const Line& line : sections.global) {
    all += line.text;
    all.resize(all.size() + kDataColumns - line.text.size(), ' ');
  }
  constexpr size_t kScale = 12, kUnitFlag = 13, kUnitName = 14;
  const auto found = Tokens(all, delimiters);
  if (!found) return global;
  const std::vector<std::string_view>& tokens = *found;
  if (tokens.size() > kScale) global.scale = Number(tokens[kScale]);
  if (tokens.size() > kUnitFlag) {
    const double flag = Number(tokens[kUnitFlag]);
    global.unit_flag = flag >= 0 && flag < 1000 ? static_cast<int>(flag) : -1;
  }
  if (tokens.size() > kUnitName) global.unit_name = Trimmed(Characters(tokens[kUnitName]));
  return global;
}

std::string IgesName(const std::vector<IgesEntity>& entities, int index) {
  return "entity D" + std::to_string(2 * index + 1) + " (type " +
         std::to_string(entities[static_cast<size_t>(index)].type) + ")";
}

}  // namespace batten::internal
