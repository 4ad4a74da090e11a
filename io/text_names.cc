// SPDX-License-Identifier: MIT
#include "batten/io/text_names.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <utility>

#include "batten/io/read_error.h"

namespace batten {
namespace {

using Names = std::vector<std::string>;

// A comment names the columns where its words are as many as they, or where as many in a row begin
// with x or u and hold x and y; else it is prose.
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

}  // namespace

bool NamesPlace(const Names& names) {
  const auto has = [&](char axis) {
    return std::any_of(names.begin(), names.end(), [&](const std::string& name) {
      return name.size() == 1 && std::tolower(static_cast<unsigned char>(name[0])) == axis;
    });
  };
  return has('x') && has('y');
}

std::vector<CloudField> TextFields(const std::string& file,
                                   Names header,
                                   const Names& comment,
                                   std::size_t width) {
  Names names = std::move(header);
  if (names.size() != width && !NamesPlace(names)) names.clear();
  if (names.empty()) names = NamesInComment(comment, width);
  if (names.empty()) names = NamesOfExtension(file, width);
  for (std::size_t k = names.size(); k < width; ++k) names.push_back(std::to_string(k + 1));
  std::vector<CloudField> fields;
  for (std::string& name : names) fields.push_back({.name = std::move(name)});
  return fields;
}

}  // namespace batten
