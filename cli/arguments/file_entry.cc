// SPDX-License-Identifier: MIT
#include "cli/arguments/file_entry.h"

#include <fmt/format.h>

#include <variant>

namespace batten::internal {
namespace {

using Json = nlohmann::ordered_json;

Json Degrees(const Geometry& shape) {
  if (const auto* surface = std::get_if<NurbsSurface>(&shape)) {
    return {surface->basis_u().degree(), surface->basis_v().degree()};
  }
  if (const auto* plane = std::get_if<NurbsCurve<2>>(&shape)) {
    return Json::array({plane->basis().degree()});
  }
  return Json::array({std::get<NurbsCurve<3>>(shape).basis().degree()});
}

Json Sizes(const Geometry& shape) {
  if (const auto* surface = std::get_if<NurbsSurface>(&shape)) {
    return {surface->size_u(), surface->size_v()};
  }
  if (const auto* plane = std::get_if<NurbsCurve<2>>(&shape)) {
    return Json::array({plane->basis().size()});
  }
  return Json::array({std::get<NurbsCurve<3>>(shape).basis().size()});
}

const char* Kind(const Geometry& shape) {
  return std::holds_alternative<NurbsSurface>(shape) ? "surface" : "curve";
}

std::string Joined(const Json& numbers, const char* between) {
  std::string text;
  for (const Json& number : numbers) text += (text.empty() ? "" : between) + number.dump();
  return text;
}

}  // namespace

Json FileEntry(const GeometryFile& file) {
  Json entry{{"path", file.path}, {"kind", Kind(file.geometry.front())}};
  if (file.geometry.size() == 1) {
    entry["degree"] = Degrees(file.geometry.front());
    entry["control_points"] = Sizes(file.geometry.front());
  }
  for (const Geometry& shape : file.geometry) {
    if (entry["kind"] != Kind(shape)) entry["kind"] = "mixed";
  }
  entry["count"] = file.geometry.size();
  return entry;
}

std::string ShapeWords(const Json& entry) {
  return fmt::format("{} of degree {}, {} control points",
                     entry["kind"].get<std::string>(),
                     Joined(entry["degree"], ","),
                     Joined(entry["control_points"], " x "));
}

std::string FileLine(const Json& entry) {
  const auto path = entry["path"].get<std::string>();
  if (entry.contains("degree")) return path + ": " + ShapeWords(entry);
  return fmt::format("{}: {}, {} geometries",
                     path,
                     entry["kind"].get<std::string>(),
                     entry["count"].get<size_t>());
}

}  // namespace batten::internal
