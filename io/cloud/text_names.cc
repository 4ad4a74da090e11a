// SPDX-License-Identifier: MIT
#include "io/cloud/text_names.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <utility>

#include "batten/io/read_error.h"
#include "io/cloud/text_rows.h"

namespace batten::internal {
namespace {

using Names = std::vector<std::string>;

// The names that an extension stands for; none where it says nothing.
Names NamesOfExtension(const std::string& file, std::size_t width) {
  std::string extension = std::filesystem::path(file).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), [](unsigned char c) {
    return static_cast<char>(std::tolower(c));
  });
  // Scanners' .pts have an intensity, a colour, or both in this order.
  if (extension == ".pts" && width == 4) return {"x", "y", "z", "intensity"};
  if (extension == ".pts" && width == 6) return {"x", "y", "z", "red", "green", "blue"};
  if (extension == ".pts" && width == 7)
    return {"x", "y", "z", "intensity", "red", "green", "blue"};
  Names names;
  if (extension == ".xyzl") names = {"x", "y", "z", "label"};
  if (extension == ".xyzi") names = {"x", "y", "z", "intensity"};
  if (extension == ".xyzn") names = {"x", "y", "z", "nx", "ny", "nz"};
  if (extension == ".xyzrgb") names = {"x", "y", "z", "red", "green", "blue"};
  if (extension == ".uvxyz") names = {"u", "v", "x", "y", "z"};
  if (names.size() > width) {
    throw ReadError(file,
                    fmt::format("{} names the columns {}, but the first row has {}",
                                extension,
                                fmt::join(names, " "),
                                width));
  }
  return names;
}

// What separates the names of a header line; a blank where nothing else does.
char DelimiterOf(std::string_view line) {
  for (const char delimiter : {',', ';', '\t'}) {
    if (line.find(delimiter) != std::string_view::npos) return delimiter;
  }
  return ' ';
}

// Names in another number than the fields of the first row may be those of other columns. Surplus
// fields that are empty do no harm, nor names of cells left out at the end of the row; but a blank
// may stand inside a name, and an empty cell between two tabs leaves no trace.
bool NamesFit(const Names& names, char delimiter, const std::vector<std::string_view>& row) {
  if (names.size() < row.size()) {
    return std::all_of(row.begin() + static_cast<std::ptrdiff_t>(names.size()),
                       row.end(),
                       [](std::string_view field) { return field.empty(); });
  }
  const int z = PlaceOf(names, "z");
  const bool leading = PlaceOf(names, "x") == 0 && PlaceOf(names, "y") == 1 && (z == 2 || z == -1);
  return names.size() == row.size() || delimiter == ',' || delimiter == ';' || leading;
}

// The names of the header line; none where it is a title.
Names NamesInHeader(const std::string& file,
                    const TextHeader& header,
                    const std::vector<std::string_view>& row,
                    bool numbered) {
  Names names = HeaderNames(header.line);
  if (names.size() == row.size()) return names;
  const char delimiter = DelimiterOf(header.line);
  const bool names_axis =
      PlaceOf(names, "x") >= 0 || PlaceOf(names, "y") >= 0 || PlaceOf(names, "z") >= 0;
  if (!NamesPlace(names) && (delimiter == ' ' || !names_axis)) return {};
  if (!numbered && !NamesFit(names, delimiter, row)) {
    throw ReadError::AtLine(
        file,
        header.number,
        fmt::format("the header names {} columns, but the first row has {} fields; name all, or "
                    "say which to take, as in --columns x=1,y=2,z=3",
                    names.size(),
                    row.size()));
  }
  return names;
}

}  // namespace

Names HeaderNames(std::string_view line) {
  Names names;
  const char delimiter = DelimiterOf(line);
  if (delimiter == ' ') {
    for (const std::string_view name : SplitFields(line)) names.emplace_back(name);
    return names;
  }
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

int PlaceOf(const Names& names, std::string_view sought) {
  const auto same = [](unsigned char a, unsigned char b) { return std::tolower(a) == b; };
  const auto at = std::find_if(names.begin(), names.end(), [&](const std::string& name) {
    return std::equal(name.begin(), name.end(), sought.begin(), sought.end(), same);
  });
  return at == names.end() ? -1 : static_cast<int>(at - names.begin());
}

int PlaceOfRole(const Names& names, std::string_view role) {
  const auto at = std::find_if(
      names.begin(), names.end(), [&](const std::string& name) { return IsRoleName(role, name); });
  return at == names.end() ? -1 : static_cast<int>(at - names.begin());
}

bool NamesPlace(const Names& names) {
  return PlaceOfRole(names, "x") >= 0 && PlaceOfRole(names, "y") >= 0;
}

Names NamesInComment(const Names& words, std::size_t width) {
  if (words.size() == width) return words;
  for (std::size_t start = 0; start + width <= words.size(); ++start) {
    const std::string& first = words[start];
    if (first != "x" && first != "X" && first != "u" && first != "U") continue;
    Names names(words.begin() + static_cast<std::ptrdiff_t>(start),
                words.begin() + static_cast<std::ptrdiff_t>(start + width));
    if (NamesPlace(names)) return names;
  }
  return {};
}

std::vector<CloudField> TextFields(const std::string& file,
                                   const TextHeader& header,
                                   const Names& comment,
                                   const std::vector<std::string_view>& row,
                                   bool numbered) {
  const std::size_t width = row.size();
  Names names = NamesInHeader(file, header, row, numbered);
  if (names.empty()) names = NamesInComment(comment, width);
  if (names.empty()) names = NamesOfExtension(file, width);
  for (std::size_t k = names.size(); k < width; ++k) names.push_back(std::to_string(k + 1));
  std::vector<CloudField> fields;
  for (std::string& name : names) {
    fields.push_back(
        {.name = std::move(name), .colour_scale = 255, .colour_limit = 1, .wide_if_whole = true});
  }
  return fields;
}

}  // namespace batten::internal
