// SPDX-License-Identifier: MIT
#include "io/cloud/obj_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "batten/io/read_error.h"
#include "io/cloud/text_rows.h"
#include "io/cloud/vertex_rows.h"

namespace batten::internal {
namespace {

constexpr std::array kPointNames{"x", "y", "z"};
constexpr std::array kColourNames{"red", "green", "blue"};
constexpr std::array kNormalNames{"nx", "ny", "nz"};

class ObjReader {
 public:
  ObjReader(ByteSource& source, const CloudReadOptions& options)
      : lines_(source), file_(source.name()), options_(options) {}

  FileCloud Read() {
    std::string_view line;
    while (lines_.Next(line)) {
      place_ = lines_.number();
      if (line.size() > 1 && line[0] == 'v' && (line[1] == ' ' || line[1] == '\t')) {
        TakeVertex(Whole(line).substr(2));
      } else if (line.starts_with("vn ") || line.starts_with("vn\t")) {
        TakeNormal(Whole(line).substr(3));
      } else {
        TakeOther(line);
        while (Continues(line) && lines_.Next(line)) continue;
      }
    }
    return Finish();
  }

 private:
  [[noreturn]] void Refuse(const std::string& reason) const {
    throw ReadError::AtLine(file_, place_, reason);
  }

  // A backslash at the end of a comment is part of it: paths may end in one.
  static bool Continues(std::string_view line) {
    return line.ends_with('\\') && line.find('#') == std::string_view::npos;
  }

  // The line with those that continue it, a blank between them.
  std::string_view Whole(std::string_view line) {
    if (!Continues(line)) return line;
    joined_.clear();
    bool more = true;
    while (more) {
      more = Continues(line);
      joined_.append(line.substr(0, line.size() - (more ? 1 : 0))) += ' ';
      if (joined_.size() > kLongestLine) Refuse("goes on over too many lines");
      more = more && lines_.Next(line);
    }
    return joined_;
  }

  // The first numbers of the line, at most as many as there is room for.
  std::size_t Numbers(std::string_view line, std::span<double> numbers) const {
    const char* at = line.data();
    const char* const end = at + line.size();
    std::size_t count = 0;
    for (; count < numbers.size(); ++count) {
      while (at < end && (*at == ' ' || *at == '\t')) ++at;
      if (at == end || *at == '#') break;
      const char* after = ParseNumber(at, end, numbers[count]);
      if (after == nullptr || (after < end && (*after == ',' || *after == ';'))) {
        const auto length =
            std::find_if(at, end, [](char c) { return c == ' ' || c == '\t'; }) - at;
        Refuse("expected a number, found " + Quoted({at, static_cast<std::size_t>(length)}));
      }
      at = after;
    }
    return count;
  }

  void TakeVertex(std::string_view line) {
    std::array<double, 7> numbers;
    const std::size_t count = Numbers(line, numbers);
    if (count < 3) Refuse(fmt::format("a vertex has x y z; found {} numbers", count));
    if (points_.size() == 0) coloured_ = count == 6;
    std::copy_n(numbers.begin(), 3, points_.Add());
    if (count != 6) coloured_ = false;
    if (coloured_) std::copy_n(numbers.begin() + 3, 3, colours_.Add());
  }

  void TakeNormal(std::string_view line) {
    std::array<double, 3> numbers;
    if (Numbers(line, numbers) < 3) Refuse("a normal has three numbers");
    std::copy_n(numbers.begin(), 3, normals_.Add());
  }

  // Anything that can be a line of such a file: a word of letters first.
  void TakeOther(std::string_view line) const {
    const std::size_t first = line.find_first_not_of(" \t");
    if (first == std::string_view::npos || line[first] == '#') return;
    const auto letter = static_cast<unsigned char>(line[first]);
    if (first == 0 && letter < 0x80 && std::isalpha(letter) != 0) return;
    Refuse("expected a line of an OBJ file, found " + Quoted(line));
  }

  FileCloud Finish() {
    std::vector<CloudField> fields;
    for (const char* name : kPointNames) fields.push_back({.name = name});
    std::vector<VertexRows> groups;
    groups.push_back(std::move(points_));
    if (coloured_) {
      for (const char* name : kColourNames) {
        fields.push_back({.name = name, .colour_scale = 255, .colour_limit = 1});
      }
      groups.push_back(std::move(colours_));
    }
    if (normals_.size() == groups[0].size()) {
      for (const char* name : kNormalNames) fields.push_back({.name = name});
      groups.push_back(std::move(normals_));
    }
    CloudFilter filter(file_,
                       fields,
                       ChooseColumns(file_, fields, FieldNaming::kProperties, options_),
                       options_,
                       RowPlace::kVertex);
    FeedRows(std::move(groups), filter);
    return std::move(filter).Finish();
  }

  LineReader lines_;
  const std::string& file_;
  const CloudReadOptions& options_;
  VertexRows points_{3}, colours_{3}, normals_{3};
  bool coloured_ = false;   // all vertices until now
  std::int64_t place_ = 0;  // line on which the statement begins
  std::string joined_;
};

}  // namespace

FileCloud ReadObj(ByteSource& source, const CloudReadOptions& options) {
  return ObjReader(source, options).Read();
}

}  // namespace batten::internal
