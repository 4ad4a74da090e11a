// SPDX-License-Identifier: MIT
#include "io/cloud/off_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <string_view>
#include <utility>

#include "batten/io/read_error.h"
#include "io/cloud/text_rows.h"

namespace batten::internal {
namespace {

struct OffHeader {
  bool normals = false, colours = false, texture = false;
  std::int64_t vertices = 0;
};

class OffReader {
 public:
  OffReader(ByteSource& source, const CloudReadOptions& options)
      : lines_(source), source_(source), options_(options) {}

  FileCloud Read() {
    const OffHeader header = ReadHeader();
    RequireBytes(header);
    std::string_view line;
    do {
      if (header.vertices == 0 || !lines_.Next(line)) break;
    } while (!HoldsContent(line));
    const std::vector<CloudField> fields = Fields(header, SplitFields(line).size());
    CloudFilter filter(source_.name(),
                       fields,
                       ChooseColumns(source_.name(), fields, FieldNaming::kProperties, options_),
                       options_,
                       RowPlace::kLine);
    if (source_.remaining()) filter.Expect(header.vertices);
    if (header.vertices > 0) lines_.Repeat();
    ReadTextRows(lines_, header.vertices, filter.columns().fields, filter);
    return std::move(filter).Finish();
  }

 private:
  [[noreturn]] void Refuse(const std::string& reason) const {
    throw ReadError::AtLine(source_.name(), lines_.number(), reason);
  }

  // The fields of the next line that has any.
  std::vector<std::string_view> NextFields() {
    std::string_view line;
    do {
      if (!lines_.Next(line)) Refuse("the file ends in the header of an OFF file");
      if (lines_.number() == 1 && line.starts_with("\xEF\xBB\xBF")) line.remove_prefix(3);
    } while (!HoldsContent(line));
    return SplitFields(line);
  }

  // The word, which may be left out, then the counts of vertices, faces and edges in one line, its
  // own or the word's.
  OffHeader ReadHeader() {
    OffHeader header;
    std::vector<std::string_view> fields = NextFields();
    if (!IsNumber(fields[0])) {
      header = Word(fields[0]);
      fields.erase(fields.begin());
      if (!fields.empty() && fields[0] == "BINARY") {
        Refuse("binary OFF files are not supported: save it as text");
      }
      if (fields.empty()) fields = NextFields();
    }
    header.vertices = Count(fields[0]);
    return header;
  }

  OffHeader Word(std::string_view word) const {
    OffHeader header;
    std::string_view rest = word;
    const auto take = [&](std::string_view prefix) {
      const bool there = rest.starts_with(prefix);
      if (there) rest.remove_prefix(prefix.size());
      return there;
    };
    header.texture = take("ST");
    header.colours = take("C");
    header.normals = take("N");
    if (rest == "4OFF" || rest == "nOFF" || rest == "4nOFF") {
      Refuse("only OFF files of three dimensions are read, not " + Quoted(word));
    }
    if (rest != "OFF") Refuse("an OFF file begins with the word OFF, not " + Quoted(word));
    return header;
  }

  std::int64_t Count(std::string_view field) const {
    constexpr std::int64_t kMost = std::int64_t{1} << 40;
    std::int64_t count = 0;
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), count);
    if (error != std::errc() || end != field.data() + field.size() || count < 0 || count > kMost) {
      Refuse("expected the number of vertices, found " + Quoted(field));
    }
    return count;
  }

  // Three digits and their separators each; the last separator may be missing.
  void RequireBytes(const OffHeader& header) const {
    const auto remaining = source_.remaining();
    if (remaining && *remaining < 6 * header.vertices - 1) {
      throw ReadError::AtByte(
          source_.name(),
          source_.position(),
          fmt::format("the header promises {} vertices, at least {} bytes, but {} follow",
                      header.vertices,
                      6 * header.vertices - 1,
                      *remaining));
    }
  }

  // What a first row of `width` numbers holds.
  std::vector<CloudField> Fields(const OffHeader& header, std::size_t width) const {
    std::vector<CloudField> fields;
    const auto add = [&](std::initializer_list<const char*> names, bool colour = false) {
      for (const char* name : names) {
        fields.push_back({.name = name});
        if (colour) fields.back().colour_scale = 255, fields.back().colour_limit = 1;
      }
    };
    add({"x", "y", "z"});
    if (header.normals) add({"nx", "ny", "nz"});
    const std::size_t texture = header.texture ? 2 : 0;
    if (header.colours) {
      add({"red", "green", "blue"}, true);
      if (width > fields.size() + texture) add({"alpha"});
    } else if (!header.normals && !header.texture && (width == 6 || width == 7)) {
      // MeshLab and others write colours behind the plain word, too.
      add({"red", "green", "blue"}, true);
    }
    if (header.texture) add({"s", "t"});
    return fields;
  }

  LineReader lines_;
  ByteSource& source_;
  const CloudReadOptions& options_;
};

}  // namespace

FileCloud ReadOff(ByteSource& source, const CloudReadOptions& options) {
  return OffReader(source, options).Read();
}

}  // namespace batten::internal
