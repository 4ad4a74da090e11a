// SPDX-License-Identifier: MIT
#include "batten/io/write_cloud.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <string_view>
#include <vector>

#include "batten/io/atomic_file.h"
#include "batten/io/file_format.h"
#include "batten/io/read_error.h"
#include "io/base/little_endian.h"

namespace batten {
using namespace internal;
namespace {

// A number that every point has.
struct OutputColumn {
  enum class Source { kPoint, kNormal, kColour, kPackedColour, kParameter, kWeight };
  enum class Type { kDouble, kByte, kUint32 };

  std::string_view name;
  Source source;
  int row = 0;

  Type type() const {
    return source == Source::kColour         ? Type::kByte
           : source == Source::kPackedColour ? Type::kUint32
                                             : Type::kDouble;
  }
};

using Source = OutputColumn::Source;
using Type = OutputColumn::Type;

std::vector<OutputColumn> Columns(const PointCloud& cloud, FileFormat format) {
  const bool pcd = format == FileFormat::kPcd;
  const bool plane = IsTextFormat(format) && cloud.dimension() == 2;
  std::vector<OutputColumn> columns{{"x", Source::kPoint, 0}, {"y", Source::kPoint, 1}};
  const auto add = [&](bool present, std::initializer_list<OutputColumn> more) {
    if (!present) return;
    for (const OutputColumn& column : more) columns.push_back(column);
  };
  const bool has_normals = cloud.normals().cols() > 0, has_colours = cloud.colours().cols() > 0;
  add(!plane, {{"z", Source::kPoint, 2}});
  add(has_normals,
      {{pcd ? "normal_x" : "nx", Source::kNormal, 0},
       {pcd ? "normal_y" : "ny", Source::kNormal, 1},
       {pcd ? "normal_z" : "nz", Source::kNormal, 2}});
  add(has_colours && pcd, {{"rgb", Source::kPackedColour}});
  add(has_colours && !pcd,
      {{"red", Source::kColour, 0}, {"green", Source::kColour, 1}, {"blue", Source::kColour, 2}});
  add(cloud.parameters().cols() > 0, {{"u", Source::kParameter, 0}, {"v", Source::kParameter, 1}});
  add(cloud.weights().size() > 0, {{"w", Source::kWeight}});
  return columns;
}

double ValueOf(const PointCloud& cloud, const OutputColumn& column, Eigen::Index k) {
  switch (column.source) {
    case Source::kPoint:
      return cloud.origin()[column.row] + cloud.points()(column.row, k);
    case Source::kNormal:
      return cloud.normals()(column.row, k);
    case Source::kColour:
      return cloud.colours()(column.row, k);
    case Source::kPackedColour:
      return cloud.colours()(0, k) * 65536 + cloud.colours()(1, k) * 256 + cloud.colours()(2, k);
    case Source::kParameter:
      return cloud.parameters()(column.row, k);
    case Source::kWeight:
      return cloud.weights()[k];
  }
  return 0;
}

void AppendBinary(std::string& buffer, double value, Type type) {
  switch (type) {
    case Type::kDouble:
      return AppendLittleEndian(buffer, value);
    case Type::kByte:
      return AppendLittleEndian(buffer, static_cast<std::uint8_t>(value));
    case Type::kUint32:
      return AppendLittleEndian(buffer, static_cast<std::uint32_t>(value));
  }
}

// The records of PLY and PCD files.
void WriteRecords(const PointCloud& cloud,
                  const std::vector<OutputColumn>& columns,
                  AtomicFile& file) {
  std::string record;
  for (Eigen::Index k = 0; k < cloud.size(); ++k) {
    record.clear();
    for (const OutputColumn& column : columns) {
      AppendBinary(record, ValueOf(cloud, column, k), column.type());
    }
    file.Write(record);
  }
}

void WriteRows(const PointCloud& cloud,
               const std::vector<OutputColumn>& columns,
               char separator,
               AtomicFile& file) {
  std::string row;
  for (Eigen::Index k = 0; k < cloud.size(); ++k) {
    row.clear();
    for (const OutputColumn& column : columns) {
      char text[32];
      const auto end = std::to_chars(text, text + sizeof text, ValueOf(cloud, column, k)).ptr;
      if (!row.empty()) row.push_back(separator);
      row.append(text, end);
    }
    row.push_back('\n');
    file.Write(row);
  }
}

std::string NamesOf(const std::vector<OutputColumn>& columns, char separator) {
  std::string names;
  for (const OutputColumn& column : columns) {
    if (!names.empty()) names.push_back(separator);
    names += column.name;
  }
  return names;
}

std::string PlyHeaderOf(const PointCloud& cloud, const std::vector<OutputColumn>& columns) {
  std::string header = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment written by batten\nelement vertex {}\n",
      cloud.size());
  for (const OutputColumn& column : columns) {
    header += fmt::format(
        "property {} {}\n", column.type() == Type::kByte ? "uchar" : "double", column.name);
  }
  return header + "end_header\n";
}

std::string PcdHeaderOf(const PointCloud& cloud, const std::vector<OutputColumn>& columns) {
  std::string fields, sizes, types, counts;
  for (const OutputColumn& column : columns) {
    const bool packed = column.type() == Type::kUint32;
    fields += fmt::format(" {}", column.name);
    sizes += packed ? " 4" : " 8";
    types += packed ? " U" : " F";
    counts += " 1";
  }
  return fmt::format(
      "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS{}\nSIZE{}\nTYPE{}\nCOUNT{}\n"
      "WIDTH {}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {}\nDATA binary\n",
      fields,
      sizes,
      types,
      counts,
      cloud.size(),
      cloud.size());
}

}  // namespace

void WriteCloud(const PointCloud& cloud, const std::string& path, const std::string& format) {
  const FileFormat chosen = FormatOf(path, format);
  if (!IsCloudFormat(chosen)) {
    throw UsageError(path + ": a " + FormatName(chosen) + " file holds geometry, not points");
  }
  if (!IsWritable(chosen)) {
    throw UsageError(path + ": points are written as .ply, .pcd, .xyz or .csv, not ." +
                     FormatName(chosen));
  }
  const auto columns = Columns(cloud, chosen);
  AtomicFile file(path);
  switch (chosen) {
    case FileFormat::kPly:
      file.Write(PlyHeaderOf(cloud, columns));
      WriteRecords(cloud, columns, file);
      break;
    case FileFormat::kPcd:
      file.Write(PcdHeaderOf(cloud, columns));
      WriteRecords(cloud, columns, file);
      break;
    case FileFormat::kCsv:
      file.Write(NamesOf(columns, ',') + '\n');
      WriteRows(cloud, columns, ',', file);
      break;
    default:
      if (static_cast<int>(columns.size()) > cloud.dimension()) {
        file.Write("# " + NamesOf(columns, ' ') + '\n');
      }
      WriteRows(cloud, columns, ' ', file);
  }
  file.Commit();
}

}  // namespace batten
