// SPDX-License-Identifier: MIT
#include "batten/io/write_labels.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <optional>
#include <stdexcept>

#include "batten/io/atomic_file.h"
#include "batten/io/file_format.h"
#include "batten/io/read_error.h"
#include "io/base/little_endian.h"

namespace batten {
using namespace internal;
namespace {

// Hues a golden angle apart, at three depths: neighbours in number never look alike.
std::array<std::uint8_t, 3> ColourOf(int label) {
  constexpr std::uint8_t kGrey = 160;
  if (label < 0) return {kGrey, kGrey, kGrey};
  constexpr double kGolden = 0.6180339887498949, kSaturation = 0.65;
  constexpr std::array kValues{0.95, 0.75, 0.55};
  const double hue = 6 * std::fmod(kGolden * label, 1.0);
  const double value = kValues[static_cast<std::size_t>(label) % kValues.size()];
  const auto part = [&](double at) {
    const double turn = std::fmod(hue + at, 6.0);
    const double share = std::clamp(std::abs(turn - 3) - 1, 0.0, 1.0);
    return static_cast<std::uint8_t>(
        std::lround(255 * value * (1 - kSaturation + kSaturation * share)));
  };
  return {part(0), part(4), part(2)};
}

}  // namespace

void CheckLabelsName(const std::string& path) {
  const std::optional<FileFormat> format = FormatOfName(path);
  if (format != FileFormat::kPly && format != FileFormat::kCsv) {
    throw UsageError("--labels " + path + ": labels are a .ply or .csv file");
  }
}

void WriteLabels(const PointCloud& cloud, const std::vector<int>& labels, const std::string& path) {
  CheckLabelsName(path);
  if (std::ssize(labels) != cloud.size()) {
    throw std::invalid_argument("WriteLabels: labels: one a point is needed");
  }
  const bool text = FormatOfName(path) == FileFormat::kCsv;
  AtomicFile file(path);
  file.Write(text ? std::string("x,y,z,red,green,blue,label\n")
                  : fmt::format("ply\nformat binary_little_endian 1.0\ncomment written by batten\n"
                                "element vertex {}\nproperty double x\nproperty double y\n"
                                "property double z\nproperty uchar red\nproperty uchar green\n"
                                "property uchar blue\nproperty int label\nend_header\n",
                                cloud.size()));
  std::string row;
  for (Eigen::Index k = 0; k < cloud.size(); ++k) {
    const Eigen::Vector3d p = cloud.World(k);
    const int label = labels[static_cast<std::size_t>(k)];
    const auto colour = ColourOf(label);
    row.clear();
    if (text) {
      fmt::format_to(std::back_inserter(row), "{},{},{},", p[0], p[1], p[2]);
      fmt::format_to(
          std::back_inserter(row), "{},{},{},{}\n", colour[0], colour[1], colour[2], label);
    } else {
      for (const double coordinate : p) AppendLittleEndian(row, coordinate);
      for (const std::uint8_t value : colour) row += static_cast<char>(value);
      AppendLittleEndian<std::int32_t>(row, label);
    }
    file.Write(row);
  }
  file.Commit();
}

}  // namespace batten
