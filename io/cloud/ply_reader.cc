// SPDX-License-Identifier: MIT
#include "io/cloud/ply_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "batten/io/read_error.h"
#include "io/cloud/binary_column.h"
#include "io/cloud/text_rows.h"

namespace batten::internal {
namespace {

constexpr std::int64_t kMostItems = std::int64_t{1} << 40;
constexpr std::size_t kMostProperties = 1 << 16;  // in a whole header

enum class PlyBody { kAscii, kLittleEndian, kBigEndian };

struct PlyProperty {
  std::string name;
  ScalarType type = ScalarType::kFloat32;
  std::optional<ScalarType> list_count;  // the type of the count of a list
};

struct PlyElement {
  std::string name;
  std::int64_t count = 0;
  std::vector<PlyProperty> properties;

  bool has_list() const {
    return std::any_of(properties.begin(), properties.end(), [](const PlyProperty& property) {
      return property.list_count.has_value();
    });
  }
  // Bytes of an item; with lists, of an item whose lists are empty.
  std::size_t stride() const {
    std::size_t sum = 0;
    for (const PlyProperty& property : properties)
      sum += SizeOf(property.list_count.value_or(property.type));
    return sum;
  }
};

struct PlyHeader {
  PlyBody body = PlyBody::kAscii;
  std::vector<PlyElement> elements;
};

class PlyHeaderReader {
 public:
  explicit PlyHeaderReader(LineReader& lines) : lines_(lines), file_(lines.source().name()) {}

  PlyHeader Read() {
    std::string_view line;
    if (!lines_.Next(line)) throw ReadError(file_, "is empty");
    if (Trimmed(line) != "ply") Refuse("a PLY file begins with the line ply, not " + Quoted(line));
    for (;;) {
      if (!lines_.Next(line)) Refuse("the header of a PLY file ends without end_header");
      const std::vector<std::string_view> words = SplitFields(line);
      if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
      if (words[0] == "end_header") break;
      Take(words);
    }
    if (!has_format_) Refuse("the PLY header has no format");
    return std::move(header_);
  }

 private:
  static std::string_view Trimmed(std::string_view line) {
    while (!line.empty() && (line.back() == ' ' || line.back() == '\t')) line.remove_suffix(1);
    return line;
  }

  [[noreturn]] void Refuse(const std::string& reason) const {
    throw ReadError::AtLine(file_, lines_.number(), reason);
  }

  void Take(const std::vector<std::string_view>& words) {
    if (words[0] == "format" && words.size() >= 2) {
      header_.body = Body(words[1]);
      has_format_ = true;
    } else if (words[0] == "element" && words.size() == 3) {
      header_.elements.push_back({std::string(words[1]), Count(words[2]), {}});
    } else if (words[0] == "property" && words.size() == 3) {
      Add({std::string(words[2]), Type(words[1]), std::nullopt});
    } else if (words[0] == "property" && words.size() == 5 && words[1] == "list") {
      Add({std::string(words[4]), Type(words[3]), Type(words[2])});
    } else {
      Refuse("expected a line of a PLY header, found " + Quoted(words[0]));
    }
  }

  void Add(PlyProperty property) {
    if (header_.elements.empty()) Refuse("a property comes before the first element");
    if (++properties_ > kMostProperties) Refuse("the PLY header has too many properties");
    if (property.list_count == ScalarType::kFloat32 ||
        property.list_count == ScalarType::kFloat64) {
      Refuse("the count of a list is an integer");
    }
    header_.elements.back().properties.push_back(std::move(property));
  }

  PlyBody Body(std::string_view word) const {
    if (word == "ascii") return PlyBody::kAscii;
    if (word == "binary_little_endian") return PlyBody::kLittleEndian;
    if (word == "binary_big_endian") return PlyBody::kBigEndian;
    Refuse("unknown format " + Quoted(word));
  }

  std::int64_t Count(std::string_view word) const {
    std::int64_t count = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), count);
    if (error != std::errc() || end != word.data() + word.size() || count < 0 ||
        count > kMostItems) {
      Refuse(fmt::format("expected a count up to {}, found {}", kMostItems, Quoted(word)));
    }
    return count;
  }

  ScalarType Type(std::string_view word) const {
    static const std::map<std::string_view, ScalarType> kTypes{
        {"char", ScalarType::kInt8},
        {"int8", ScalarType::kInt8},
        {"uchar", ScalarType::kUint8},
        {"uint8", ScalarType::kUint8},
        {"short", ScalarType::kInt16},
        {"int16", ScalarType::kInt16},
        {"ushort", ScalarType::kUint16},
        {"uint16", ScalarType::kUint16},
        {"int", ScalarType::kInt32},
        {"int32", ScalarType::kInt32},
        {"uint", ScalarType::kUint32},
        {"uint32", ScalarType::kUint32},
        {"int64", ScalarType::kInt64},
        {"uint64", ScalarType::kUint64},
        {"float", ScalarType::kFloat32},
        {"float32", ScalarType::kFloat32},
        {"double", ScalarType::kFloat64},
        {"float64", ScalarType::kFloat64},
    };
    const auto type = kTypes.find(word);
    if (type == kTypes.end()) Refuse("unknown type " + Quoted(word));
    return type->second;
  }

  LineReader& lines_;
  const std::string& file_;
  PlyHeader header_;
  bool has_format_ = false;
  std::size_t properties_ = 0;
};

class PlyBodyReader {
 public:
  PlyBodyReader(LineReader& lines, PlyHeader header, const CloudReadOptions& options)
      : lines_(lines),
        source_(lines.source()),
        header_(std::move(header)),
        options_(options),
        swapped_((header_.body == PlyBody::kBigEndian) !=
                 (std::endian::native == std::endian::big)) {}

  FileCloud Read() {
    for (const PlyElement& element : header_.elements) {
      RequireBytes(element);
      if (element.name == "vertex") return ReadVertices(element);
      header_.body == PlyBody::kAscii ? SkipLines(element) : SkipItems(element);
    }
    throw ReadError(source_.name(), "the PLY header has no element vertex");
  }

 private:
  // Refuses what can't fit in the rest of the file.
  void RequireBytes(const PlyElement& element) const {
    const bool ascii = header_.body == PlyBody::kAscii;
    const auto item =
        static_cast<std::int64_t>(ascii ? 2 * element.properties.size() : element.stride());
    const std::int64_t bytes = element.count * item - (ascii && element.count * item > 0 ? 1 : 0);
    const auto remaining = source_.remaining();
    if (remaining && *remaining < bytes) {
      throw ReadError::AtByte(
          source_.name(),
          source_.position(),
          fmt::format("the header promises {} of element {}, at least {} bytes, but {} follow",
                      element.count,
                      element.name,
                      bytes,
                      *remaining));
    }
  }

  FileCloud ReadVertices(const PlyElement& vertex) {
    std::vector<CloudField> fields;
    std::vector<BinaryColumn> places;
    std::size_t offset = 0;
    for (const PlyProperty& property : vertex.properties) {
      if (property.list_count) continue;
      fields.push_back({.name = property.name,
                        .single_precision = property.type == ScalarType::kFloat32,
                        .colour_scale = ColourScale(property.type)});
      places.push_back({offset, property.type});
      offset += SizeOf(property.type);
    }
    const bool ascii = header_.body == PlyBody::kAscii;
    CloudFilter filter(source_.name(),
                       fields,
                       ChooseColumns(source_.name(), fields, FieldNaming::kProperties, options_),
                       options_,
                       ascii ? RowPlace::kLine : RowPlace::kByte);
    if (source_.remaining()) filter.Expect(vertex.count);
    if (vertex.has_list()) {
      ReadItems(vertex, filter);
    } else if (ascii) {
      ReadTextRows(lines_, vertex.count, filter.columns().fields, filter);
    } else {
      std::vector<BinaryColumn> columns;
      for (const int field : filter.columns().fields) columns.push_back(places[field]);
      ReadRecords(source_, vertex.count, vertex.stride(), columns, swapped_, filter);
    }
    return std::move(filter).Finish();
  }

  // Vertices with lists have no places that are known before: property by property.
  void ReadItems(const PlyElement& vertex, CloudFilter& filter) {
    const std::vector<int>& wanted = filter.columns().fields;
    std::vector<int> slots;  // of every property: its column of the batch, or −1
    int field = 0;
    for (const PlyProperty& property : vertex.properties) {
      const auto at = std::lower_bound(wanted.begin(), wanted.end(), field);
      const bool taken = !property.list_count && at != wanted.end() && *at == field;
      slots.push_back(taken ? static_cast<int>(at - wanted.begin()) : -1);
      field += property.list_count ? 0 : 1;
    }
    RowBatch batch(wanted.size());
    for (std::int64_t item = 0; item < vertex.count; ++item) {
      header_.body == PlyBody::kAscii ? ReadTextItem(vertex, item, slots, batch)
                                      : ReadBinaryItem(vertex, item, slots, batch);
      if (++batch.rows == RowBatch::kRows) filter.Take(batch);
    }
    filter.Take(batch);
  }

  void ReadBinaryItem(const PlyElement& vertex,
                      std::int64_t item,
                      const std::vector<int>& slots,
                      RowBatch& batch) {
    batch.places[batch.rows] = source_.position();
    for (std::size_t p = 0; p < slots.size(); ++p) {
      const PlyProperty& property = vertex.properties[p];
      const std::size_t size = SizeOf(property.type);
      const std::int64_t count =
          property.list_count ? ListCount(vertex, item, *property.list_count) : 1;
      if (slots[p] >= 0) {
        const std::string_view bytes = source_.Peek(size);
        if (bytes.size() < size) RefuseEnd(vertex, item);
        DecodeColumn(
            bytes.data(), 0, 1, property.type, swapped_, batch.column(slots[p]) + batch.rows);
      }
      if (!source_.Skip(count * static_cast<std::int64_t>(size))) RefuseEnd(vertex, item);
    }
  }

  void ReadTextItem(const PlyElement& vertex,
                    std::int64_t item,
                    const std::vector<int>& slots,
                    RowBatch& batch) {
    std::string_view line;
    do {
      if (!lines_.Next(line)) RefuseEnd(vertex, item);
    } while (!HoldsContent(line));
    batch.places[batch.rows] = lines_.number();
    RefuseDecimalCommas(source_.name(), line, lines_.number());
    const std::vector<std::string_view> words = SplitFields(line);
    std::size_t at = 0;
    for (std::size_t p = 0; p < slots.size(); ++p, ++at) {
      const PlyProperty& property = vertex.properties[p];
      if (at >= words.size()) RefuseLine("ends before the property " + Quoted(property.name));
      double number = 0;
      if (slots[p] >= 0 || property.list_count) {
        const char* const end = words[at].data() + words[at].size();
        if (words[at].empty() || ParseNumber(words[at].data(), end, number) != end) {
          RefuseLine("expected a number, found " + Quoted(words[at]));
        }
      }
      if (slots[p] >= 0) batch.column(slots[p])[batch.rows] = number;
      if (!property.list_count) continue;
      if (!(number >= 0 && number < static_cast<double>(words.size() - at) &&
            number == std::floor(number))) {
        RefuseLine(fmt::format(
            "a list can't have {} entries where {} follow", number, words.size() - at - 1));
      }
      at += static_cast<std::size_t>(number);
    }
  }

  void SkipLines(const PlyElement& element) {
    if (element.properties.empty()) return;
    std::string_view line;
    for (std::int64_t item = 0; item < element.count;) {
      if (!lines_.Next(line)) RefuseEnd(element, item);
      if (HoldsContent(line)) ++item;
    }
  }

  void SkipItems(const PlyElement& element) {
    if (!element.has_list()) {
      if (!source_.Skip(element.count * static_cast<std::int64_t>(element.stride()))) {
        RefuseEnd(element, 0);
      }
      return;
    }
    for (std::int64_t item = 0; item < element.count; ++item) {
      for (const PlyProperty& property : element.properties) {
        const std::int64_t count =
            property.list_count ? ListCount(element, item, *property.list_count) : 1;
        if (!source_.Skip(count * static_cast<std::int64_t>(SizeOf(property.type)))) {
          RefuseEnd(element, item);
        }
      }
    }
  }

  std::int64_t ListCount(const PlyElement& element, std::int64_t item, ScalarType type) {
    const std::string_view bytes = source_.Peek(SizeOf(type));
    if (bytes.size() < SizeOf(type)) RefuseEnd(element, item);
    double count = 0;
    DecodeColumn(bytes.data(), 0, 1, type, swapped_, &count);
    if (!(count >= 0 && count <= static_cast<double>(kMostItems))) {
      throw ReadError::AtByte(
          source_.name(), source_.position(), fmt::format("a list can't have {} entries", count));
    }
    source_.Skip(static_cast<std::int64_t>(SizeOf(type)));
    return static_cast<std::int64_t>(count);
  }

  [[noreturn]] void RefuseLine(const std::string& reason) const {
    throw ReadError::AtLine(source_.name(), lines_.number(), reason);
  }

  [[noreturn]] void RefuseEnd(const PlyElement& element, std::int64_t item) const {
    throw ReadError::AtByte(
        source_.name(),
        source_.position(),
        fmt::format(
            "the file ends after {} of {} of element {}", item, element.count, element.name));
  }

  LineReader& lines_;
  ByteSource& source_;
  PlyHeader header_;
  const CloudReadOptions& options_;
  bool swapped_;
};

}  // namespace

FileCloud ReadPly(ByteSource& source, const CloudReadOptions& options) {
  LineReader lines(source);
  PlyHeader header = PlyHeaderReader(lines).Read();
  return PlyBodyReader(lines, std::move(header), options).Read();
}

}  // namespace batten::internal
