// SPDX-License-Identifier: MIT
#include "batten/io/write_uncertainty.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <limits>
#include <vector>

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

Eigen::Vector3d PlaceOf(const Geometry& geometry, double u, double v) {
  if (const auto* surface = std::get_if<NurbsSurface>(&geometry)) return surface->At(u, v);
  if (const auto* curve = std::get_if<NurbsCurve<3>>(&geometry)) return curve->At(u);
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  place.head<2>() = std::get<NurbsCurve<2>>(geometry).At(u);
  return place;
}

void WriteCsv(const UncertaintyMap& map, const Geometry& geometry, AtomicFile& file) {
  const bool surface = std::holds_alternative<NurbsSurface>(geometry);
  file.Write(surface ? "u,v,x,y,z,sigma,bias,support,area\n"
                     : "u,x,y,z,sigma,bias,support,length\n");
  for (size_t k = 0; k < map.places.size(); ++k) {
    const double area = map.areas[static_cast<Eigen::Index>(k)];
    if (!(area > 0)) continue;
    const double u = map.u[k / map.v.size()], v = map.v[k % map.v.size()];
    const Eigen::Vector3d at = PlaceOf(geometry, u, v);
    const PlaceUncertainty& place = map.places[k];
    std::string row = fmt::format("{}", u);
    if (surface) fmt::format_to(std::back_inserter(row), ",{}", v);
    for (const double value :
         {at[0], at[1], at[2], place.deviation, place.bias, place.support, area})
      fmt::format_to(std::back_inserter(row), ",{}", value);
    file.Write(row + '\n');
  }
}

// Blue to red over the deviations of supported places, on the logarithm; grey elsewhere.
Rgb ColourOf(const PlaceUncertainty& place, double low, double high) {
  if (place.support < kLeastSupport) return Rgb(150, 150, 150);
  const double range = std::log(high / low);
  const double share = range > 0 ? std::log(place.deviation / low) / range : 0;
  return DeviationColour(2 * std::clamp(share, 0.0, 1.0) - 1, 1);
}

void WritePly(const UncertaintyMap& map, const Geometry& geometry, AtomicFile& file) {
  double low = HUGE_VAL, high = 0;
  std::vector<std::int32_t> vertex(map.places.size(), -1);
  std::int32_t vertices = 0;
  for (size_t k = 0; k < map.places.size(); ++k) {
    if (!(map.areas[static_cast<Eigen::Index>(k)] > 0)) continue;
    vertex[k] = vertices++;
    if (map.places[k].support < kLeastSupport || !(map.places[k].deviation > 0)) continue;
    low = std::min(low, map.places[k].deviation);
    high = std::max(high, map.places[k].deviation);
  }
  const size_t rows = map.v.size();
  std::string faces;
  int count = 0;
  for (size_t i = 0; i + 1 < map.u.size(); ++i) {
    for (size_t j = 0; j + 1 < rows; ++j) {
      const size_t a = i * rows + j, b = a + rows;
      const std::array<size_t, 4> corners{a, b, b + 1, a + 1};
      if (std::any_of(corners.begin(), corners.end(), [&](size_t k) { return vertex[k] < 0; }))
        continue;
      faces += '\4';
      for (const size_t k : corners) AppendLittleEndian(faces, vertex[k]);
      ++count;
    }
  }
  std::string header = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment written by batten\nelement vertex {}\n",
      vertices);
  for (const char* name : {"x", "y", "z", "sigma", "bias", "support"})
    header += fmt::format("property double {}\n", name);
  for (const char* name : {"red", "green", "blue"})
    header += fmt::format("property uchar {}\n", name);
  file.Write(header + fmt::format("element face {}\nproperty list uchar int vertex_indices\n"
                                  "end_header\n",
                                  count));
  for (size_t k = 0; k < map.places.size(); ++k) {
    if (vertex[k] < 0) continue;
    const PlaceUncertainty& place = map.places[k];
    std::string row;
    for (const double x : PlaceOf(geometry, map.u[k / rows], map.v[k % rows]))
      AppendLittleEndian(row, x);
    for (const double x : {place.deviation, place.bias, place.support}) AppendLittleEndian(row, x);
    for (const std::uint8_t part : ColourOf(place, low, high)) row += static_cast<char>(part);
    file.Write(row);
  }
  file.Write(faces);
}

}  // namespace

void CheckUncertaintyName(const std::string& path, bool curve) {
  const std::string extension = Extension(path);
  if (extension == ".csv" || (extension == ".ply" && !curve)) return;
  throw UsageError("--uncertainty-map " + path +
                   (curve ? ": the map of a curve is a .csv file"
                          : ": a map of uncertainty is a .csv or .ply file"));
}

std::unique_ptr<AtomicFile> WriteUncertainty(const std::string& path,
                                             const UncertaintyMap& map,
                                             const Geometry& geometry) {
  CheckUncertaintyName(path, !std::holds_alternative<NurbsSurface>(geometry));
  auto file = std::make_unique<AtomicFile>(path);
  if (Extension(path) == ".csv") {
    WriteCsv(map, geometry, *file);
  } else {
    WritePly(map, geometry, *file);
  }
  return file;
}

Eigen::VectorXd SigmaAt(const Uncertainty& of, const Eigen::Matrix2Xd& parameters) {
  const std::vector<PlaceUncertainty> places = of.At(parameters);
  Eigen::VectorXd sigma(parameters.cols());
  for (Eigen::Index k = 0; k < sigma.size(); ++k) {
    const PlaceUncertainty& place = places[static_cast<size_t>(k)];
    sigma[k] =
        place.support < kLeastSupport ? std::numeric_limits<double>::quiet_NaN() : place.deviation;
  }
  return sigma;
}

}  // namespace batten
