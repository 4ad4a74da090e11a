// SPDX-License-Identifier: MIT
// Random clouds, and files of points built byte by byte, independently of batten's writer.
#pragma once

#include <sys/resource.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <random>
#include <string>
#include <string_view>

#include "batten/fitting/point_cloud.h"
#include "batten/io/read_cloud.h"
#include "temporary_folder.h"

namespace batten::internal {

template <class T>
std::string LittleEndian(T value) {
  std::array<char, sizeof(T)> bytes;
  std::memcpy(bytes.data(), &value, sizeof(T));
  if (std::endian::native == std::endian::big) std::reverse(bytes.begin(), bytes.end());
  return {bytes.begin(), bytes.end()};
}

template <class T>
std::string BigEndian(T value) {
  std::string bytes = LittleEndian(value);
  std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

// The header of a PLY file whose vertices have the given property lines.
inline std::string PlyHeader(std::string_view format, long vertices, std::string_view properties) {
  return "ply\nformat " + std::string(format) + " 1.0\ncomment a test\nelement vertex " +
         std::to_string(vertices) + "\n" + std::string(properties) + "end_header\n";
}

inline constexpr std::string_view kPlyDoubles =
    "property double x\nproperty double y\nproperty double z\n";

// The header of a PCD file; `entries` are its lines FIELDS, SIZE, TYPE and COUNT.
inline std::string PcdHeader(std::string_view entries, long points, std::string_view data) {
  const std::string count = std::to_string(points);
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n" + std::string(entries) +
         "WIDTH " + count + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + count + "\nDATA " +
         std::string(data) + "\n";
}

inline constexpr std::string_view kPcdDoubles =
    "FIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nCOUNT 1 1 1\n";

// LZF that stores everything literally: legal, if larger than its input.
inline std::string LzfLiteral(std::string_view data) {
  std::string packed;
  for (std::size_t at = 0; at < data.size(); at += 32) {
    const std::string_view run = data.substr(at, 32);
    packed.push_back(static_cast<char>(run.size() - 1));
    packed += run;
  }
  return packed;
}

// The body of a compressed PCD file.
inline std::string CompressedBody(std::string_view data) {
  const std::string packed = LzfLiteral(data);
  return LittleEndian(static_cast<std::uint32_t>(packed.size())) +
         LittleEndian(static_cast<std::uint32_t>(data.size())) + packed;
}

// Points spread over `scale` about `centre`, with all bits of their mantissas.
inline Eigen::Matrix3Xd RandomPoints(std::mt19937_64& random,
                                     Eigen::Index count,
                                     double scale,
                                     const Eigen::Vector3d& centre = Eigen::Vector3d::Zero()) {
  std::uniform_real_distribution<double> unit(-1, 1);
  Eigen::Matrix3Xd points(3, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    for (int d = 0; d < 3; ++d) points(d, k) = centre[d] + scale * unit(random);
  }
  return points;
}

// A cloud with every attribute there is.
inline PointCloud RandomCloud(std::mt19937_64& random, Eigen::Matrix3Xd points) {
  PointCloud cloud = PointCloud::FromWorld(std::move(points));
  std::uniform_real_distribution<double> unit(0.125, 1);
  const Eigen::Index m = cloud.size();
  cloud.set_normals(RandomPoints(random, m, 1).colwise().normalized());
  cloud.set_weights(Eigen::VectorXd::NullaryExpr(m, [&] { return unit(random); }));
  cloud.set_parameters(Eigen::Matrix2Xd::NullaryExpr(2, m, [&] { return unit(random); }));
  cloud.set_colours(PointCloud::Colours::NullaryExpr(
      3, m, [&] { return static_cast<std::uint8_t>(random() & 0xff); }));
  return cloud;
}

inline Eigen::Matrix3Xd World(const PointCloud& cloud) {
  return cloud.points().colwise() + cloud.origin();
}

// Reads a text as a file of the name.
inline CloudFile ReadBytes(const std::string& name,
                           std::string_view bytes,
                           const CloudReadOptions& options = {}) {
  const TemporaryFolder folder;
  return ReadCloud({folder.With(name, bytes)}, options);
}

// The message with which reading fails; empty when it does not.
inline std::string FailureOf(const std::string& name,
                             std::string_view bytes,
                             const CloudReadOptions& options = {}) {
  try {
    ReadBytes(name, bytes, options);
    return {};
  } catch (const std::runtime_error& error) {
    return error.what();
  }
}

// The most memory that the process has had, in bytes.
inline double PeakMemory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) * 1024;
}

}  // namespace batten::internal
