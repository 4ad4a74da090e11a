// SPDX-License-Identifier: MIT
#include "io/cloud/stl_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string_view>
#include <utility>

#include "batten/io/read_error.h"
#include "io/base/little_endian.h"
#include "io/cloud/distinct_points.h"
#include "io/cloud/text_rows.h"

namespace batten::internal {
namespace {

constexpr std::size_t kHeaderBytes = 84;  // a comment of 80, then the count of facets
constexpr std::size_t kFacetBytes = 50;

template <class T>
FileCloud PartOf(DistinctPoints<T> points,
                 const std::string& file,
                 const CloudReadOptions& options) {
  points.Close();
  const std::vector<CloudField> fields({{.name = "x", .single_precision = sizeof(T) == 4},
                                        {.name = "y", .single_precision = sizeof(T) == 4},
                                        {.name = "z", .single_precision = sizeof(T) == 4}});
  CloudFilter filter(file,
                     fields,
                     ChooseColumns(file, fields, FieldNaming::kProperties, options),
                     options,
                     RowPlace::kVertex);
  filter.Expect(points.size());
  const std::vector<int> columns = filter.columns().fields;
  RowBatch batch(columns.size());
  for (std::int64_t first = 0; first < points.size(); first += RowBatch::kRows) {
    batch.rows = static_cast<int>(std::min<std::int64_t>(RowBatch::kRows, points.size() - first));
    for (int r = 0; r < batch.rows; ++r) {
      const auto& point = points[first + r];
      for (std::size_t c = 0; c < columns.size(); ++c) {
        batch.column(c)[r] = static_cast<double>(point[static_cast<std::size_t>(columns[c])]);
      }
      batch.places[r] = first + r + 1;
    }
    filter.Take(batch);
    points.FreeBefore(first + RowBatch::kRows);
  }
  return std::move(filter).Finish();
}

template <class T>
void RequireRoom(const DistinctPoints<T>& points, const std::string& file) {
  if (points.size() >= DistinctPoints<T>::kMost) {
    throw ReadError(file, fmt::format("holds more than {} vertices", points.size()));
  }
}

FileCloud ReadBinary(ByteSource& source, const CloudReadOptions& options) {
  const std::string_view header = source.Peek(kHeaderBytes);
  if (header.size() < kHeaderBytes) {
    throw ReadError::AtByte(source.name(),
                            static_cast<std::int64_t>(header.size()),
                            "is no STL file: neither the word solid nor a header of 84 bytes");
  }
  const std::int64_t facets = LoadLittleEndian<std::uint32_t>(header, kHeaderBytes - 4);
  source.Skip(kHeaderBytes);
  const auto remaining = source.remaining();
  const std::int64_t bytes = facets * static_cast<std::int64_t>(kFacetBytes);
  if (remaining && *remaining < bytes) {
    throw ReadError::AtByte(
        source.name(),
        kHeaderBytes,
        fmt::format(
            "the header promises {} facets, {} bytes, but {} follow", facets, bytes, *remaining));
  }
  // A closed mesh has half as many vertices as facets.
  DistinctPoints<float> points(remaining ? facets / 2 : 0);
  for (std::int64_t left = facets; left > 0;) {
    const std::string_view block = source.Peek(kFacetBytes);
    const auto whole = std::min(left, static_cast<std::int64_t>(block.size() / kFacetBytes));
    if (whole == 0) {
      throw ReadError::AtByte(
          source.name(),
          source.position() + static_cast<std::int64_t>(block.size()),
          fmt::format("the file ends after {} of {} facets", facets - left, facets));
    }
    for (std::int64_t k = 0; k < whole; ++k) {
      std::size_t at = static_cast<std::size_t>(k) * kFacetBytes + 12;
      for (int corner = 0; corner < 3; ++corner, at += 12) {
        points.Add({LoadLittleEndian<float>(block, at),
                    LoadLittleEndian<float>(block, at + 4),
                    LoadLittleEndian<float>(block, at + 8)});
      }
    }
    RequireRoom(points, source.name());
    left -= whole;
    source.Skip(whole * static_cast<std::int64_t>(kFacetBytes));
  }
  return PartOf(std::move(points), source.name(), options);
}

// A closed mesh has two facets a vertex, and a facet takes some 250 bytes.
constexpr std::int64_t kTextBytesPerVertex = 500;

// The words of ASCII STL, one line after the other.
class AsciiStl {
 public:
  AsciiStl(ByteSource& source, const CloudReadOptions& options)
      : lines_(source),
        file_(source.name()),
        options_(options),
        points_(source.remaining().value_or(0) / kTextBytesPerVertex) {}

  FileCloud Read() {
    std::string_view line;
    while (lines_.Next(line)) {
      const std::size_t first = line.find_first_not_of(" \t\r");
      if (first != std::string_view::npos) Take(line.substr(first));
    }
    if (inside_) Refuse("the file ends before endsolid");
    RequireRoom(points_, file_);
    return PartOf(std::move(points_), file_, options_);
  }

 private:
  [[noreturn]] void Refuse(const std::string& reason) const {
    throw ReadError::AtLine(file_, lines_.number(), reason);
  }

  // Whether the line's first word is this one, in any case.
  static bool Begins(std::string_view line, std::string_view word) {
    const auto lower = [](char c) {
      return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    };
    return line.size() >= word.size() &&
           std::equal(word.begin(),
                      word.end(),
                      line.begin(),
                      [&](char a, char b) { return a == lower(b); }) &&
           (line.size() == word.size() || line[word.size()] == ' ' || line[word.size()] == '\t');
  }

  void Take(std::string_view line) {
    if (inside_ && Begins(line, "vertex")) {
      TakeVertex(line.substr(std::string_view("vertex").size()));
    } else if (inside_ && Begins(line, "facet")) {
      corners_ = 0;
    } else if (inside_ && Begins(line, "endfacet")) {
      if (corners_ != 3) Refuse(fmt::format("a facet has three corners, not {}", corners_));
    } else if (inside_ && (Begins(line, "outer") || Begins(line, "endloop"))) {
      return;
    } else if (inside_ && Begins(line, "endsolid")) {
      inside_ = false;
    } else if (!inside_ && Begins(line, "solid")) {
      inside_ = true;
    } else {
      Refuse("expected a line of an STL file, found " + Quoted(line));
    }
  }

  void TakeVertex(std::string_view line) {
    std::array<double, 3> point;
    const char* at = line.data();
    const char* const end = at + line.size();
    for (double& number : point) {
      while (at < end && (*at == ' ' || *at == '\t')) ++at;
      const char* after = at == end ? nullptr : ParseNumber(at, end, number);
      if (after == nullptr) Refuse("a vertex has three numbers, not " + Quoted(line));
      at = after;
    }
    points_.Add(point);
    ++corners_;
  }

  LineReader lines_;
  const std::string& file_;
  const CloudReadOptions& options_;
  DistinctPoints<double> points_;
  bool inside_ = false;  // between solid and endsolid
  int corners_ = 0;      // of the facet
};

// Binary headers may begin with the word of ASCII files, too: the size then tells, or a byte that
// no text has.
bool IsAscii(ByteSource& source) {
  constexpr std::size_t kLook = 1024;
  std::string_view bytes = source.Peek(kLook);
  bytes = bytes.substr(0, kLook);
  const auto remaining = source.remaining();
  if (remaining && bytes.size() >= kHeaderBytes) {
    const std::int64_t facets = LoadLittleEndian<std::uint32_t>(bytes, kHeaderBytes - 4);
    if (*remaining == static_cast<std::int64_t>(kHeaderBytes + kFacetBytes * facets)) return false;
  }
  const std::size_t first = bytes.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos || bytes.size() < first + 5) return false;
  const std::string_view word = bytes.substr(first, 5);
  const auto is_letter_of = [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) == b;
  };
  if (!std::equal(word.begin(), word.end(), "solid", is_letter_of)) return false;
  return bytes.find('\0') == std::string_view::npos;
}

}  // namespace

FileCloud ReadStl(ByteSource& source, const CloudReadOptions& options) {
  return IsAscii(source) ? AsciiStl(source, options).Read() : ReadBinary(source, options);
}

}  // namespace batten::internal
