// SPDX-License-Identifier: MIT
#include "io/cloud/las_reader.h"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cmath>
#include <string_view>
#include <utility>

#include "batten/io/read_error.h"
#include "io/base/little_endian.h"
#include "io/cloud/binary_column.h"

namespace batten::internal {
namespace {

// What the public header block says of the points.
struct LasHeader {
  int minor = 0;  // of the version 1.minor
  int format = 0;
  std::size_t header_size = 0;
  std::int64_t points_at = 0;  // the byte of the first
  std::size_t stride = 0;
  std::int64_t points = 0;
  std::array<double, 3> scale{}, offset{};
};

constexpr int kFormats = 11;
constexpr std::array<std::size_t, kFormats> kRecordSizes{
    20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

// Sizes of the header block of 1.0 to 1.4.
constexpr std::array<std::size_t, 5> kHeaderSizes{227, 227, 227, 235, 375};

bool HasColours(int format) {
  return format == 2 || format == 3 || format == 5 || format == 7 || format == 8 || format == 10;
}

LasHeader ReadHeader(ByteSource& source) {
  constexpr std::size_t kVersionAt = 24, kSizeAt = 94, kPointsAt = 96, kFormatAt = 104,
                        kStrideAt = 105, kCountAt = 107, kScaleAt = 131, kOffsetAt = 155,
                        kLongCountAt = 247;
  const auto refuse = [&](std::size_t byte, const std::string& reason) -> void {
    throw ReadError::AtByte(source.name(), static_cast<std::int64_t>(byte), reason);
  };
  const std::string_view bytes = source.Peek(kHeaderSizes.back());
  if (!bytes.starts_with("LASF")) refuse(0, "a LAS file begins with LASF; this is none");
  if (bytes.size() < kHeaderSizes[0]) {
    refuse(bytes.size(), fmt::format("the file ends in its header of {} bytes", kHeaderSizes[0]));
  }
  const int major = LoadLittleEndian<std::uint8_t>(bytes, kVersionAt);
  LasHeader header;
  header.minor = LoadLittleEndian<std::uint8_t>(bytes, kVersionAt + 1);
  if (major != 1 || header.minor >= static_cast<int>(kHeaderSizes.size())) {
    refuse(kVersionAt, fmt::format("LAS {}.{} is not known; 1.0 to 1.4 are", major, header.minor));
  }
  const std::size_t needed = kHeaderSizes[static_cast<std::size_t>(header.minor)];
  header.header_size = LoadLittleEndian<std::uint16_t>(bytes, kSizeAt);
  if (header.header_size < needed) {
    refuse(kSizeAt,
           fmt::format("the header of LAS 1.{} has {} bytes, not {}",
                       header.minor,
                       needed,
                       header.header_size));
  }
  if (bytes.size() < needed) {
    refuse(bytes.size(), fmt::format("the file ends in its header of {} bytes", needed));
  }
  // Bit 7 marks LASzip's records, bit 6 those of its first versions.
  const unsigned format = LoadLittleEndian<std::uint8_t>(bytes, kFormatAt);
  if ((format & 0xc0u) != 0) {
    refuse(kFormatAt,
           "the points are compressed (LAZ): decompress them, as with `laszip -i scan.laz -o "
           "scan.las`");
  }
  if (format >= kFormats) refuse(kFormatAt, fmt::format("point format {} is not known", format));
  header.format = static_cast<int>(format);
  header.stride = LoadLittleEndian<std::uint16_t>(bytes, kStrideAt);
  if (header.stride < kRecordSizes[format]) {
    refuse(kStrideAt,
           fmt::format("a point of format {} takes {} bytes, not {}",
                       format,
                       kRecordSizes[format],
                       header.stride));
  }
  header.points_at = LoadLittleEndian<std::uint32_t>(bytes, kPointsAt);
  if (header.points_at < static_cast<std::int64_t>(header.header_size)) {
    refuse(kPointsAt,
           fmt::format("the points begin at byte {}, inside the header", header.points_at));
  }
  // The count of 64 bits holds in 1.4; some writers leave it empty.
  header.points = LoadLittleEndian<std::uint32_t>(bytes, kCountAt);
  if (header.minor >= 4) {
    const auto count = LoadLittleEndian<std::uint64_t>(bytes, kLongCountAt);
    constexpr std::uint64_t kMostPoints = std::uint64_t{1} << 40;
    if (count > kMostPoints) {
      refuse(kLongCountAt, fmt::format("{} points are not possible", count));
    }
    if (count > 0) header.points = static_cast<std::int64_t>(count);
  }
  for (std::size_t d = 0; d < 3; ++d) {
    header.scale[d] = LoadLittleEndian<double>(bytes, kScaleAt + 8 * d);
    header.offset[d] = LoadLittleEndian<double>(bytes, kOffsetAt + 8 * d);
    if (!std::isfinite(header.scale[d]) || header.scale[d] == 0) {
      refuse(kScaleAt + 8 * d, fmt::format("the scale {} is not possible", header.scale[d]));
    }
    if (!std::isfinite(header.offset[d])) {
      refuse(kOffsetAt + 8 * d, fmt::format("the offset {} is not possible", header.offset[d]));
    }
  }
  return header;
}

// The fields of a record with their places.
class LasFields {
 public:
  explicit LasFields(const LasHeader& header) {
    for (std::size_t d = 0; d < 3; ++d) {
      Add(std::string(1, static_cast<char>('x' + d)),
          {.offset = 4 * d,
           .type = ScalarType::kInt32,
           .scale = header.scale[d],
           .add = header.offset[d]});
    }
    Add("intensity", {.offset = 12, .type = ScalarType::kUint16});
    header.format < 6 ? AddFirst(header) : AddExtended();
    const std::size_t core = header.format < 6 ? 20 : 30;
    const bool time_after = header.format == 1 || (header.format >= 3 && header.format <= 5);
    if (time_after) Add("gps_time", {.offset = core, .type = ScalarType::kFloat64});
    if (!HasColours(header.format)) return;
    const std::size_t at = core + (time_after ? 8 : 0);
    for (std::size_t d = 0; d < 3; ++d) {
      constexpr std::array<const char*, 3> kNames{"red", "green", "blue"};
      Add(kNames[d], {.offset = at + 2 * d, .type = ScalarType::kUint16});
      fields.back().colour_limit = 255;
      fields.back().wide_colour_scale = ColourScale(ScalarType::kUint16);
    }
    if (header.format == 8 || header.format == 10) {
      Add("nir", {.offset = at + 6, .type = ScalarType::kUint16});
    }
  }

  std::vector<CloudField> fields;
  std::vector<BinaryColumn> places;

 private:
  void Add(std::string name, const BinaryColumn& place) {
    fields.push_back({.name = std::move(name)});
    places.push_back(place);
  }

  void AddBits(std::string name, std::size_t offset, unsigned shift, unsigned bits) {
    Add(std::move(name),
        {.offset = offset, .type = ScalarType::kUint8, .shift = shift, .mask = (1u << bits) - 1});
  }

  // Formats 0 to 5.
  void AddFirst(const LasHeader& header) {
    AddBits("return_number", 14, 0, 3);
    AddBits("number_of_returns", 14, 3, 3);
    AddBits("scan_direction", 14, 6, 1);
    AddBits("edge_of_flight_line", 14, 7, 1);
    // 1.0 gives the whole byte to the class.
    AddBits("classification", 15, 0, header.minor == 0 ? 8 : 5);
    if (header.minor > 0) {
      AddBits("synthetic", 15, 5, 1);
      AddBits("key_point", 15, 6, 1);
      AddBits("withheld", 15, 7, 1);
    }
    Add("scan_angle", {.offset = 16, .type = ScalarType::kInt8});
    Add("user_data", {.offset = 17, .type = ScalarType::kUint8});
    Add("point_source", {.offset = 18, .type = ScalarType::kUint16});
  }

  // Formats 6 to 10.
  void AddExtended() {
    AddBits("return_number", 14, 0, 4);
    AddBits("number_of_returns", 14, 4, 4);
    AddBits("synthetic", 15, 0, 1);
    AddBits("key_point", 15, 1, 1);
    AddBits("withheld", 15, 2, 1);
    AddBits("overlap", 15, 3, 1);
    AddBits("scanner_channel", 15, 4, 2);
    AddBits("scan_direction", 15, 6, 1);
    AddBits("edge_of_flight_line", 15, 7, 1);
    Add("classification", {.offset = 16, .type = ScalarType::kUint8});
    Add("user_data", {.offset = 17, .type = ScalarType::kUint8});
    constexpr double kDegreesPerStep = 0.006;
    Add("scan_angle",
        {.offset = 18, .type = ScalarType::kInt16, .scale = kDegreesPerStep, .add = 0});
    Add("point_source", {.offset = 20, .type = ScalarType::kUint16});
    Add("gps_time", {.offset = 22, .type = ScalarType::kFloat64});
  }
};

}  // namespace

FileCloud ReadLas(ByteSource& source, const CloudReadOptions& options) {
  const LasHeader header = ReadHeader(source);
  const auto remaining = source.remaining();
  const std::int64_t bytes = header.points * static_cast<std::int64_t>(header.stride);
  if (remaining && *remaining - header.points_at < bytes) {
    throw ReadError::AtByte(
        source.name(),
        source.position(),
        fmt::format(
            "the header promises {} points, {} bytes from byte {} on, but the file ends at byte {}",
            header.points,
            bytes,
            header.points_at,
            *remaining));
  }
  if (!source.Skip(header.points_at)) {
    throw ReadError::AtByte(source.name(), source.position(), "the file ends before its points");
  }
  const LasFields known(header);
  CloudFilter filter(source.name(),
                     known.fields,
                     ChooseColumns(source.name(), known.fields, FieldNaming::kProperties, options),
                     options,
                     RowPlace::kByte);
  if (remaining) filter.Expect(header.points);
  std::vector<BinaryColumn> columns;
  for (const int field : filter.columns().fields) columns.push_back(known.places[field]);
  ReadRecords(source,
              header.points,
              header.stride,
              columns,
              std::endian::native == std::endian::big,
              filter);
  FileCloud part = std::move(filter).Finish();
  part.scale = {header.scale[0], header.scale[1], header.scale[2]};
  return part;
}

}  // namespace batten::internal
