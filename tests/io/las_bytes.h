// SPDX-License-Identifier: MIT
// LAS files built byte by byte from the tables of the specification, independently of the reader.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cloud_bytes.h"

namespace batten::internal {

struct LasPoint {
  std::int32_t x = 0, y = 0, z = 0;
  std::uint16_t intensity = 0;
  unsigned return_number = 1, number_of_returns = 1;
  unsigned classification = 0;
  bool withheld = false;
  double gps_time = 0;
  std::uint16_t red = 0, green = 0, blue = 0, nir = 0;
};

struct LasShape {
  int minor = 2, format = 0;
  double scale[3]{0.0625, 0.125, 0.25};  // powers of two: products with integers are exact
  double offset[3]{500000, 5400000, -100};
  std::size_t variable_bytes = 0;  // between header and points
  std::size_t extra_bytes = 0;     // at the end of a record
  bool long_count = true;          // in 1.4: fill the count of 64 bits, else that of 32
  std::uint64_t promised = 0;      // points in the header, if more than there are
  unsigned char compression = 0;   // or-ed to the format
};

inline std::size_t LasHeaderSize(int minor) { return minor < 3 ? 227 : minor == 3 ? 235 : 375; }

inline std::string LasRecord(const LasPoint& p, const LasShape& shape) {
  const int format = shape.format;
  std::string bytes = LittleEndian(p.x) + LittleEndian(p.y) + LittleEndian(p.z);
  bytes += LittleEndian(p.intensity);
  const auto byte = [&](unsigned value) { bytes += static_cast<char>(value); };
  const bool extended = format >= 6;
  if (extended) {
    byte(p.return_number | p.number_of_returns << 4);
    byte(p.withheld ? 4 : 0);
    byte(p.classification);
    byte(17);                                                // user data
    bytes += LittleEndian(static_cast<std::int16_t>(-500));  // scan angle: −3 degrees
  } else {
    byte(p.return_number | p.number_of_returns << 3);
    byte(p.classification | (p.withheld ? 0x80 : 0));
    byte(0xfd);  // scan angle −3
    byte(17);
  }
  bytes += LittleEndian(std::uint16_t{9});  // point source
  if (extended || format == 1 || format == 3 || format == 4 || format == 5) {
    bytes += LittleEndian(p.gps_time);
  }
  if (format == 2 || format == 3 || format == 5 || format == 7 || format == 8 || format == 10) {
    bytes += LittleEndian(p.red) + LittleEndian(p.green) + LittleEndian(p.blue);
  }
  if (format == 8 || format == 10) bytes += LittleEndian(p.nir);
  if (format == 4 || format == 5 || format == 9 || format == 10) bytes += std::string(29, 'w');
  return bytes + std::string(shape.extra_bytes, 'e');
}

inline std::string LasBytes(const std::vector<LasPoint>& points, const LasShape& shape = {}) {
  const std::size_t size = LasHeaderSize(shape.minor);
  const std::uint64_t count = shape.promised > 0 ? shape.promised : points.size();
  const bool long_count = shape.minor == 4 && shape.long_count;
  std::string bytes = "LASF";
  bytes += std::string(20, '\0');  // source, encoding, identifier of the project
  bytes += std::string{'\1', static_cast<char>(shape.minor)};
  bytes += std::string(32, 's') + std::string(32, 'g');
  bytes += LittleEndian(std::uint16_t{1}) + LittleEndian(std::uint16_t{2020});
  bytes += LittleEndian(static_cast<std::uint16_t>(size));
  bytes += LittleEndian(static_cast<std::uint32_t>(size + shape.variable_bytes));
  bytes += LittleEndian(std::uint32_t{shape.variable_bytes > 0});
  bytes += static_cast<char>(static_cast<unsigned char>(shape.format) | shape.compression);
  bytes += LittleEndian(static_cast<std::uint16_t>(LasRecord({}, shape).size()));
  bytes += LittleEndian(long_count ? 0u : static_cast<std::uint32_t>(count));
  bytes += std::string(20, '\0');
  for (const double s : shape.scale) bytes += LittleEndian(s);
  for (const double o : shape.offset) bytes += LittleEndian(o);
  bytes += std::string(48, '\0');  // the box, which nobody trusts
  if (shape.minor >= 3) bytes += std::string(8, '\0');
  if (shape.minor == 4) {
    bytes += std::string(12, '\0');
    bytes += LittleEndian(long_count ? count : std::uint64_t{0});
    bytes += std::string(120, '\0');
  }
  if (bytes.size() != size) throw std::logic_error("a LAS header of the wrong size");
  bytes += std::string(shape.variable_bytes, 'v');
  for (const LasPoint& point : points) bytes += LasRecord(point, shape);
  return bytes;
}

inline std::vector<LasPoint> RandomLasPoints(std::mt19937_64& random, std::size_t count) {
  std::vector<LasPoint> points(count);
  for (LasPoint& p : points) {
    for (std::int32_t* x : {&p.x, &p.y, &p.z}) {
      *x = static_cast<std::int32_t>(random() % 2'000'000) - 1'000'000;
    }
    p.intensity = static_cast<std::uint16_t>(random());
    p.number_of_returns = 1 + static_cast<unsigned>(random() % 7);
    p.return_number = 1 + static_cast<unsigned>(random() % p.number_of_returns);
    p.classification = static_cast<unsigned>(random() % 32);
    p.withheld = random() % 5 == 0;
    p.gps_time = static_cast<double>(random() % 1'000'000) / 64;
    for (std::uint16_t* c : {&p.red, &p.green, &p.blue, &p.nir}) {
      *c = static_cast<std::uint16_t>(random());
    }
  }
  return points;
}

inline Eigen::Matrix3Xd WorldOf(const std::vector<LasPoint>& points, const LasShape& shape) {
  Eigen::Matrix3Xd world(3, points.size());
  for (std::size_t k = 0; k < points.size(); ++k) {
    const std::int32_t stored[3]{points[k].x, points[k].y, points[k].z};
    for (int d = 0; d < 3; ++d) {
      world(d, static_cast<Eigen::Index>(k)) = stored[d] * shape.scale[d] + shape.offset[d];
    }
  }
  return world;
}

}  // namespace batten::internal
