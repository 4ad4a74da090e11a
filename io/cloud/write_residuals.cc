// SPDX-License-Identifier: MIT
#include "batten/io/write_residuals.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <stdexcept>

#include "batten/io/deviation_colours.h"
#include "batten/io/read_error.h"
#include "io/base/little_endian.h"

namespace batten {
using namespace internal;
namespace {

std::string Extension(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), [](unsigned char c) {
    return static_cast<char>(std::tolower(c));
  });
  return extension;
}

void WriteCsv(const PointResiduals& r, AtomicFile& file) {
  const bool has_v = r.parameters.rows() > 1;
  std::string row;
  const auto append = [&](const char* separator, double value) {
    fmt::format_to(std::back_inserter(row), "{}{}", separator, value);
  };
  file.Write(std::string(has_v ? "x,y,z,distance,u,v,outlier" : "x,y,z,distance,u,outlier") +
             (r.owners.empty() ? "" : ",index") + (r.deviations.size() > 0 ? ",sigma\n" : "\n"));
  for (Eigen::Index k = 0; k < r.cloud.size(); ++k) {
    const Eigen::Vector3d p = r.cloud.World(k);
    row.clear();
    append("", p[0]);
    append(",", p[1]);
    append(",", p[2]);
    append(",", r.distances[k]);
    append(",", r.parameters(0, k));
    if (has_v) append(",", r.parameters(1, k));
    row += r.outliers[k] ? ",1" : ",0";
    if (!r.owners.empty()) row += "," + std::to_string(r.owners[static_cast<std::size_t>(k)]);
    if (r.deviations.size() > 0) append(",", r.deviations[k]);
    row += '\n';
    file.Write(row);
  }
}

void WritePly(const PointResiduals& r, AtomicFile& file) {
  const bool has_v = r.parameters.rows() > 1;
  std::string row = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment written by batten\nelement vertex {}\n",
      r.cloud.size());
  for (const char* name : {"x", "y", "z", "distance", "u"}) {
    row += fmt::format("property double {}\n", name);
  }
  if (has_v) row += "property double v\n";
  for (const char* name : {"red", "green", "blue", "outlier"}) {
    row += fmt::format("property uchar {}\n", name);
  }
  if (!r.owners.empty()) row += "property int index\n";
  if (r.deviations.size() > 0) row += "property double sigma\n";
  file.Write(row + "end_header\n");
  for (Eigen::Index k = 0; k < r.cloud.size(); ++k) {
    row.clear();
    for (const double coordinate : r.cloud.World(k)) AppendLittleEndian(row, coordinate);
    AppendLittleEndian(row, r.distances[k]);
    AppendLittleEndian(row, r.parameters(0, k));
    if (has_v) AppendLittleEndian(row, r.parameters(1, k));
    for (const std::uint8_t part : DeviationColour(r.distances[k], r.colour_range)) {
      row += static_cast<char>(part);
    }
    row += r.outliers[k] ? '\1' : '\0';
    if (!r.owners.empty())
      AppendLittleEndian<std::int32_t>(row, r.owners[static_cast<std::size_t>(k)]);
    if (r.deviations.size() > 0) AppendLittleEndian(row, r.deviations[k]);
    file.Write(row);
  }
}

}  // namespace

void CheckResidualsName(const std::string& path) {
  const std::string extension = Extension(path);
  if (extension != ".ply" && extension != ".csv") {
    throw UsageError("--residuals " + path + ": residuals are a .ply or .csv file");
  }
}

std::unique_ptr<AtomicFile> WriteResiduals(const std::string& path,
                                           const PointResiduals& residuals) {
  CheckResidualsName(path);
  const Eigen::Index size = residuals.cloud.size();
  if (residuals.distances.size() != size || residuals.parameters.cols() != size ||
      residuals.outliers.size() != size || residuals.parameters.rows() < 1 ||
      (!residuals.owners.empty() && std::ssize(residuals.owners) != size) ||
      (residuals.deviations.size() > 0 && residuals.deviations.size() != size)) {
    throw std::invalid_argument("WriteResiduals: residuals: one of each a point is needed");
  }
  auto file = std::make_unique<AtomicFile>(path);
  if (Extension(path) == ".csv") {
    WriteCsv(residuals, *file);
  } else {
    WritePly(residuals, *file);
  }
  return file;
}

}  // namespace batten
