// SPDX-License-Identifier: MIT
#include "io/cloud/pcd_reader.h"

#include <fmt/format.h>
#include <lzf.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstring>
#include <map>
#include <memory>
#include <string_view>
#include <utility>

#include "batten/io/read_error.h"
#include "io/cloud/binary_column.h"
#include "io/cloud/text_rows.h"

namespace batten::internal {
namespace {

constexpr std::int64_t kMostPoints = std::int64_t{1} << 40;
constexpr std::size_t kMostElements = 1 << 16;  // in a point

enum class PcdBody { kAscii, kBinary, kCompressed };

// An entry of FIELDS.
struct PcdField {
  std::string name;
  ScalarType type = ScalarType::kFloat32;
  std::size_t count = 1;

  bool padding() const { return name == "_"; }
  std::size_t bytes() const { return count * SizeOf(type); }
};

struct PcdHeader {
  std::vector<PcdField> fields;
  std::int64_t points = 0;
  PcdBody body = PcdBody::kAscii;

  std::size_t stride(bool with_padding = true) const {
    std::size_t sum = 0;
    for (const PcdField& field : fields)
      sum += with_padding || !field.padding() ? field.bytes() : 0;
    return sum;
  }
};

// One entry of the header: the words after its keyword, and its line.
struct HeaderEntry {
  std::vector<std::string> words;
  std::int64_t line = 0;
};

class PcdHeaderReader {
 public:
  explicit PcdHeaderReader(LineReader& lines) : lines_(lines), file_(lines.source().name()) {}

  PcdHeader Read() {
    ReadEntries();
    PcdHeader header;
    header.fields = Fields();
    header.points = Points();
    header.body = Body();
    return header;
  }

 private:
  // Every line up to DATA.
  void ReadEntries() {
    std::string_view line;
    while (!entries_.contains("DATA")) {
      if (!lines_.Next(line)) {
        throw ReadError::AtLine(
            file_, lines_.number(), "the header of a PCD file ends without DATA");
      }
      if (!HoldsContent(line)) continue;
      const std::vector<std::string_view> words = SplitFields(line);
      if (std::find(kKeywords.begin(), kKeywords.end(), words[0]) == kKeywords.end()) {
        throw ReadError::AtLine(
            file_, lines_.number(), "expected an entry of a PCD header, found " + Quoted(words[0]));
      }
      entries_[std::string(words[0])] = {{words.begin() + 1, words.end()}, lines_.number()};
    }
  }

  // Before version 0.7 FIELDS was called COLUMNS.
  std::vector<PcdField> Fields() {
    const HeaderEntry& names = Entry(entries_.contains("COLUMNS") ? "COLUMNS" : "FIELDS");
    std::vector<PcdField> fields(names.words.size());
    const HeaderEntry& sizes = Entry("SIZE", fields.size());
    const HeaderEntry& types = Entry("TYPE", fields.size());
    const HeaderEntry* counts =
        entries_.contains("COUNT") ? &Entry("COUNT", fields.size()) : nullptr;
    std::size_t elements = 0;
    for (std::size_t k = 0; k < fields.size(); ++k) {
      fields[k].name = names.words[k];
      fields[k].type = Type(types.words[k], sizes.words[k], types.line);
      if (counts != nullptr) {
        fields[k].count = static_cast<std::size_t>(
            Number(counts->words[k], counts->line, 1, static_cast<std::int64_t>(kMostElements)));
      }
      elements += fields[k].count;
    }
    if (elements == 0 || elements > kMostElements) {
      throw ReadError::AtLine(
          file_, names.line, fmt::format("a point of {} numbers is not possible", elements));
    }
    return fields;
  }

  ScalarType Type(const std::string& letter, const std::string& size, std::int64_t line) const {
    static const std::map<std::string, ScalarType> kTypes{
        {"I1", ScalarType::kInt8},
        {"U1", ScalarType::kUint8},
        {"I2", ScalarType::kInt16},
        {"U2", ScalarType::kUint16},
        {"I4", ScalarType::kInt32},
        {"U4", ScalarType::kUint32},
        {"I8", ScalarType::kInt64},
        {"U8", ScalarType::kUint64},
        {"F4", ScalarType::kFloat32},
        {"F8", ScalarType::kFloat64},
    };
    const auto type = kTypes.find(letter + size);
    if (type == kTypes.end()) {
      throw ReadError::AtLine(
          file_, line, "no field has TYPE " + Quoted(letter) + " of SIZE " + Quoted(size));
    }
    return type->second;
  }

  // POINTS and WIDTH × HEIGHT must agree; either may be missing.
  std::int64_t Points() {
    const bool has_points = entries_.contains("POINTS");
    const std::int64_t points = has_points ? NumberOf("POINTS") : -1;
    if (has_points && !entries_.contains("WIDTH")) return points;
    const std::int64_t width = NumberOf("WIDTH");
    const std::int64_t height = entries_.contains("HEIGHT") ? NumberOf("HEIGHT") : 1;
    if (height > 0 && width > kMostPoints / height) {
      throw ReadError::AtLine(
          file_, entries_["WIDTH"].line, fmt::format("{} × {} points are too many", width, height));
    }
    if (has_points && points != width * height) {
      throw ReadError::AtLine(
          file_,
          entries_["POINTS"].line,
          fmt::format("POINTS {} is not WIDTH × HEIGHT = {}", points, width * height));
    }
    return width * height;
  }

  PcdBody Body() {
    const HeaderEntry& data = Entry("DATA", 1);
    if (data.words[0] == "ascii") return PcdBody::kAscii;
    if (data.words[0] == "binary") return PcdBody::kBinary;
    if (data.words[0] == "binary_compressed") return PcdBody::kCompressed;
    throw ReadError::AtLine(
        file_,
        data.line,
        "DATA is ascii, binary or binary_compressed, not " + Quoted(data.words[0]));
  }

  const HeaderEntry& Entry(const std::string& keyword) {
    if (!entries_.contains(keyword)) throw ReadError(file_, "the PCD header has no " + keyword);
    return entries_[keyword];
  }

  const HeaderEntry& Entry(const std::string& keyword, std::size_t words) {
    const HeaderEntry& entry = Entry(keyword);
    if (entry.words.size() != words) {
      throw ReadError::AtLine(
          file_,
          entry.line,
          fmt::format("{} has {} entries for {}", keyword, entry.words.size(), words));
    }
    return entry;
  }

  std::int64_t NumberOf(const std::string& keyword) {
    const HeaderEntry& entry = Entry(keyword, 1);
    return Number(entry.words[0], entry.line, 0, kMostPoints);
  }

  std::int64_t Number(const std::string& word,
                      std::int64_t line,
                      std::int64_t least,
                      std::int64_t most) const {
    std::int64_t number = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (error != std::errc() || end != word.data() + word.size() || number < least ||
        number > most) {
      throw ReadError::AtLine(
          file_,
          line,
          fmt::format("expected a number from {} to {}, found {}", least, most, Quoted(word)));
    }
    return number;
  }

  static constexpr std::array<std::string_view, 11> kKeywords{"VERSION",
                                                              "FIELDS",
                                                              "COLUMNS",
                                                              "SIZE",
                                                              "TYPE",
                                                              "COUNT",
                                                              "WIDTH",
                                                              "HEIGHT",
                                                              "VIEWPOINT",
                                                              "POINTS",
                                                              "DATA"};
  LineReader& lines_;
  const std::string& file_;
  std::map<std::string, HeaderEntry> entries_;
};

// One number of a point: its name and where it stands.
struct PcdElement {
  CloudField field;
  std::size_t text_column;
  BinaryColumn binary;  // in a record
  std::size_t before;   // bytes of a record's fields before, padding counted only if stored
  std::size_t stride;   // between points where fields are stored one after the other
};

bool IsPackedColour(const PcdField& field) {
  return (field.name == "rgb" || field.name == "rgba") && SizeOf(field.type) == 4;
}

// Every number but padding. `padding_stored`: whether padding takes room in the body.
std::vector<PcdElement> Elements(const PcdHeader& header, bool padding_stored) {
  std::vector<PcdElement> elements;
  std::size_t text_column = 0, offset = 0;
  for (const PcdField& field : header.fields) {
    const std::size_t size = SizeOf(field.type);
    const bool packed = IsPackedColour(field);
    for (std::size_t k = 0; k < field.count && !field.padding(); ++k) {
      PcdElement element;
      element.field.name = k == 0 ? field.name : fmt::format("{}[{}]", field.name, k);
      element.field.single_precision = field.type == ScalarType::kFloat32;
      element.field.colour_scale = ColourScale(field.type);
      element.field.packed_in_float =
          packed && field.type == ScalarType::kFloat32 && header.body == PcdBody::kAscii;
      element.text_column = text_column + k;
      element.binary = {offset + k * size, packed ? ScalarType::kUint32 : field.type};
      element.before = offset;
      element.stride = field.bytes();
      elements.push_back(std::move(element));
    }
    text_column += field.count;
    if (!field.padding() || padding_stored) offset += field.bytes();
  }
  return elements;
}

// Refuses a promise of bytes that the rest of the file is too short for.
void RequireBytes(const ByteSource& source, std::int64_t points, std::int64_t bytes) {
  const auto remaining = source.remaining();
  if (remaining && *remaining < bytes) {
    throw ReadError::AtByte(
        source.name(),
        source.position(),
        fmt::format("the header promises {} points, at least {} bytes, but {} follow",
                    points,
                    bytes,
                    *remaining));
  }
}

std::uint32_t ReadSize(ByteSource& source) {
  unsigned char bytes[4];
  if (source.Read(reinterpret_cast<char*>(bytes), 4) != 4) {
    throw ReadError::AtByte(
        source.name(), source.position(), "the file ends before the compressed body");
  }
  return bytes[0] | bytes[1] << 8 | bytes[2] << 16 | static_cast<std::uint32_t>(bytes[3]) << 24;
}

// The decompressed body: all values of the first field, then all of the second, …
// pcl::PCDReader would hold the map of the file, the decompressed body and its copy by points at
// once: three times the points. The decompressor is liblzf's.
std::unique_ptr<char[]> Decompress(ByteSource& source,
                                   const PcdHeader& header,
                                   bool& padding_stored) {
  const std::int64_t start = source.position();
  const std::uint32_t compressed = ReadSize(source), size = ReadSize(source);
  const auto expected = [&](bool with_padding) {
    return header.points * static_cast<std::int64_t>(header.stride(with_padding));
  };
  // PCL leaves padding out; others do not.
  padding_stored = size != expected(false);
  if (size != expected(false) && size != expected(true)) {
    throw ReadError::AtByte(
        source.name(),
        start + 4,
        fmt::format(
            "the body has {} bytes where {} points take {}", size, header.points, expected(false)));
  }
  // Three bytes of LZF stand for at most 264.
  constexpr std::int64_t kMostExpansion = 88;
  RequireBytes(source, header.points, compressed);
  if (size > kMostExpansion * compressed + kMostExpansion) {
    throw ReadError::AtByte(
        source.name(), start, fmt::format("{} bytes can't decompress to {}", compressed, size));
  }
  std::string packed;
  // In steps, because the size of a pipe is not known.
  for (std::size_t left = compressed; left > 0;) {
    const std::string_view bytes = source.Peek(1).substr(0, left);
    if (bytes.empty()) {
      throw ReadError::AtByte(
          source.name(),
          source.position(),
          fmt::format("the file ends {} bytes before its compressed body does", left));
    }
    if (packed.empty() && source.remaining()) packed.reserve(compressed);
    packed.append(bytes);
    left -= bytes.size();
    source.Skip(static_cast<std::int64_t>(bytes.size()));
  }
  auto body = std::make_unique_for_overwrite<char[]>(size);
  if (size > 0 && lzf_decompress(packed.data(), compressed, body.get(), size) != size) {
    throw ReadError::AtByte(source.name(), start + 8, "the compressed body is damaged");
  }
  return body;
}

class PcdBodyReader {
 public:
  PcdBodyReader(LineReader& lines, PcdHeader header, const CloudReadOptions& options)
      : lines_(lines), source_(lines.source()), header_(std::move(header)), options_(options) {}

  FileCloud Read() {
    switch (header_.body) {
      case PcdBody::kAscii:
        return ReadAscii();
      case PcdBody::kBinary:
        return ReadBinary();
      case PcdBody::kCompressed:
        return ReadCompressed();
    }
    return {};
  }

 private:
  CloudFilter Filter(const std::vector<PcdElement>& elements, RowPlace place) const {
    std::vector<CloudField> fields;
    for (const PcdElement& element : elements) fields.push_back(element.field);
    CloudColumns columns =
        ChooseColumns(source_.name(), fields, FieldNaming::kProperties, options_);
    CloudFilter filter(source_.name(), fields, std::move(columns), options_, place);
    if (source_.remaining()) filter.Expect(header_.points);
    return filter;
  }

  // PCL reads ASCII at 70 MB/s, this at more than twice that.
  FileCloud ReadAscii() {
    const std::vector<PcdElement> elements = Elements(header_, true);
    std::int64_t numbers = 0;
    for (const PcdField& field : header_.fields) numbers += static_cast<std::int64_t>(field.count);
    // A digit and a separator each; the last separator may be missing.
    RequireBytes(
        source_, header_.points, std::max<std::int64_t>(0, 2 * header_.points * numbers - 1));
    CloudFilter filter = Filter(elements, RowPlace::kLine);
    std::vector<int> columns;
    for (const int field : filter.columns().fields) {
      columns.push_back(static_cast<int>(elements[field].text_column));
    }
    ReadTextRows(lines_, header_.points, columns, filter);
    return std::move(filter).Finish();
  }

  // pcl::PCDReader keeps the map of the file and a copy of all its fields: four times the points
  // when they come with normals and colours. It also needs a path, and can't be cancelled.
  FileCloud ReadBinary() {
    const std::vector<PcdElement> elements = Elements(header_, true);
    const std::size_t stride = header_.stride();
    RequireBytes(source_, header_.points, header_.points * static_cast<std::int64_t>(stride));
    CloudFilter filter = Filter(elements, RowPlace::kByte);
    std::vector<BinaryColumn> columns;
    for (const int field : filter.columns().fields) columns.push_back(elements[field].binary);
    ReadRecords(source_, header_.points, stride, columns, kSwapped, filter);
    return std::move(filter).Finish();
  }

  FileCloud ReadCompressed() {
    const std::int64_t start = source_.position();
    bool padding_stored = false;
    const std::unique_ptr<char[]> body = Decompress(source_, header_, padding_stored);
    const std::vector<PcdElement> elements = Elements(header_, padding_stored);
    CloudFilter filter = Filter(elements, RowPlace::kByte);
    RowBatch batch(filter.columns().fields.size());
    for (std::int64_t first = 0; first < header_.points; first += RowBatch::kRows) {
      batch.rows =
          static_cast<int>(std::min<std::int64_t>(RowBatch::kRows, header_.points - first));
      for (std::size_t c = 0; c < filter.columns().fields.size(); ++c) {
        const PcdElement& element = elements[filter.columns().fields[c]];
        const char* values = body.get() +
                             static_cast<std::int64_t>(element.before) * header_.points +
                             (element.binary.offset - element.before);
        DecodeColumn(values + first * static_cast<std::int64_t>(element.stride),
                     element.stride,
                     batch.rows,
                     element.binary.type,
                     kSwapped,
                     batch.column(c));
      }
      std::fill_n(batch.places.begin(), batch.rows, start);
      filter.Take(batch);
    }
    return std::move(filter).Finish();
  }

  // PCD bodies are little-endian by custom.
  static constexpr bool kSwapped = std::endian::native == std::endian::big;

  LineReader& lines_;
  ByteSource& source_;
  PcdHeader header_;
  const CloudReadOptions& options_;
};

}  // namespace

FileCloud ReadPcd(ByteSource& source, const CloudReadOptions& options) {
  LineReader lines(source);
  PcdHeader header = PcdHeaderReader(lines).Read();
  return PcdBodyReader(lines, std::move(header), options).Read();
}

}  // namespace batten::internal
