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
#include <utility>
#include <vector>

#include "batten/io/deviation_colours.h"
#include "batten/io/read_error.h"
#include "io/base/little_endian.h"
#include "io/mesh/glb_writer.h"

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

// The places inside the trims as a mesh of quadrilaterals.
struct Net {
  std::vector<size_t> places;                      // of the map, by vertex
  std::vector<std::array<std::int32_t, 4>> faces;  // of vertices
  RgbColumns colours;                              // of vertices
};

RgbColumns ColoursOf(const UncertaintyMap& map, const std::vector<size_t>& places) {
  double low = HUGE_VAL, high = 0;
  for (const size_t k : places) {
    const PlaceUncertainty& place = map.places[k];
    if (place.support < kLeastSupport || !(place.deviation > 0)) continue;
    low = std::min(low, place.deviation);
    high = std::max(high, place.deviation);
  }
  RgbColumns colours(3, std::ssize(places));
  for (size_t k = 0; k < places.size(); ++k)
    colours.col(static_cast<Eigen::Index>(k)) = ColourOf(map.places[places[k]], low, high);
  return colours;
}

Net NetOf(const UncertaintyMap& map) {
  Net net;
  std::vector<std::int32_t> vertex(map.places.size(), -1);
  for (size_t k = 0; k < map.places.size(); ++k) {
    if (!(map.areas[static_cast<Eigen::Index>(k)] > 0)) continue;
    vertex[k] = static_cast<std::int32_t>(net.places.size());
    net.places.push_back(k);
  }
  const size_t rows = map.v.size();
  for (size_t i = 0; i + 1 < map.u.size(); ++i) {
    for (size_t j = 0; j + 1 < rows; ++j) {
      const size_t a = i * rows + j, b = a + rows;
      const std::array face{vertex[a], vertex[b], vertex[b + 1], vertex[a + 1]};
      if (*std::min_element(face.begin(), face.end()) >= 0) net.faces.push_back(face);
    }
  }
  net.colours = ColoursOf(map, net.places);
  return net;
}

void WritePly(const UncertaintyMap& map, const NurbsSurface& surface, AtomicFile& file) {
  const Net net = NetOf(map);
  std::string header = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment written by batten\nelement vertex {}\n",
      net.places.size());
  for (const char* name : {"x", "y", "z", "sigma", "bias", "support"})
    header += fmt::format("property double {}\n", name);
  for (const char* name : {"red", "green", "blue"})
    header += fmt::format("property uchar {}\n", name);
  file.Write(header + fmt::format("element face {}\nproperty list uchar int vertex_indices\n"
                                  "end_header\n",
                                  net.faces.size()));
  for (size_t vertex = 0; vertex < net.places.size(); ++vertex) {
    const size_t k = net.places[vertex];
    const PlaceUncertainty& place = map.places[k];
    std::string row;
    for (const double x : surface.At(map.u[k / map.v.size()], map.v[k % map.v.size()]))
      AppendLittleEndian(row, x);
    for (const double x : {place.deviation, place.bias, place.support}) AppendLittleEndian(row, x);
    for (const std::uint8_t part : net.colours.col(static_cast<Eigen::Index>(vertex)))
      row += static_cast<char>(part);
    file.Write(row);
  }
  std::string faces;
  for (const auto& face : net.faces) {
    faces += '\4';
    for (const std::int32_t k : face) AppendLittleEndian(faces, k);
  }
  file.Write(faces);
}

void WriteGlb(const UncertaintyMap& map,
              const NurbsSurface& surface,
              double metres,
              AtomicFile& file) {
  const Net net = NetOf(map);
  const auto vertices = std::ssize(net.places);
  TriangleMesh mesh{Eigen::Matrix3Xd(3, vertices),
                    Eigen::Matrix2Xd(2, vertices),
                    Eigen::Matrix3Xd(3, vertices),
                    Eigen::Matrix3Xi(3, 2 * std::ssize(net.faces))};
  for (Eigen::Index vertex = 0; vertex < vertices; ++vertex) {
    const size_t k = net.places[static_cast<size_t>(vertex)];
    const double u = map.u[k / map.v.size()], v = map.v[k % map.v.size()];
    mesh.parameters.col(vertex) << u, v;
    mesh.vertices.col(vertex) = surface.At(u, v);
    mesh.normals.col(vertex) = surface.NormalAt(u, v).value_or(Eigen::Vector3d::UnitZ());
  }
  for (size_t k = 0; k < net.faces.size(); ++k) {
    const auto& [a, b, c, d] = net.faces[k];
    mesh.triangles.middleCols<2>(2 * static_cast<Eigen::Index>(k)) << a, a, b, c, c, d;
  }
  const SurfaceMesh named{std::move(mesh), "sigma"};
  internal::WriteGlb({{named, named.name, net.colours}}, metres, file);
}

}  // namespace

void CheckUncertaintyName(const std::string& path, bool curve) {
  const std::string extension = Extension(path);
  if (extension == ".csv" || (!curve && (extension == ".ply" || extension == ".glb"))) return;
  throw UsageError("--uncertainty-map " + path +
                   (curve ? ": the map of a curve is a .csv file"
                          : ": a map of uncertainty is a .csv, .ply or .glb file"));
}

std::unique_ptr<AtomicFile> WriteUncertainty(const std::string& path,
                                             const UncertaintyMap& map,
                                             const Geometry& geometry,
                                             double metres) {
  const auto* surface = std::get_if<NurbsSurface>(&geometry);
  CheckUncertaintyName(path, !surface);
  auto file = std::make_unique<AtomicFile>(path);
  const std::string extension = Extension(path);
  if (extension == ".csv") WriteCsv(map, geometry, *file);
  if (extension == ".ply") WritePly(map, *surface, *file);
  if (extension == ".glb") WriteGlb(map, *surface, metres, *file);
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
