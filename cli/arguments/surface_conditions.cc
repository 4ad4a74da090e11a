// SPDX-License-Identifier: MIT
#include "cli/arguments/surface_conditions.h"

#include <utility>
#include <variant>

#include "batten/io/geometry_file.h"
#include "batten/io/read_cloud.h"
#include "batten/io/read_error.h"
#include "cli/terminal/cli11.h"
#include "cli/terminal/parse_values.h"

namespace batten::internal {
namespace {

void ReadBoundary(const std::string& path, std::vector<BoundaryCondition>& boundary) {
  const std::vector<Geometry> shapes = ReadGeometry(path);
  for (size_t k = 0; k < shapes.size(); ++k) {
    const std::string name = shapes.size() > 1 ? path + " (" + std::to_string(k + 1) + ")" : path;
    if (const auto* curve = std::get_if<NurbsCurve<3>>(&shapes[k])) {
      boundary.push_back({*curve, name});
    } else if (const auto* surface = std::get_if<NurbsSurface>(&shapes[k])) {
      boundary.push_back({*surface, name});
    } else {
      throw ReadError(path,
                      "a boundary is a curve in space, or a neighbouring surface; this curve "
                      "is in the plane");
    }
  }
}

}  // namespace

void AddConditionArguments(CLI::App& command, ConditionArguments& a) {
  const auto add = [&](const char* flag, std::string& value, const char* help, const char* type) {
    command.add_option(flag, value, help)->type_name(type);
  };
  command
      .add_option(
          "--boundary",
          a.boundary,
          "A curve that an edge of the surface is to be; or a neighbouring surface, to be "
          "joined with its tangent planes along the edge that runs beside the points. Up to "
          "four")
      ->type_name("FILE")
      ->allow_extra_args(false);
  add("--boundary-tolerance",
      a.boundary_tolerance,
      "How far edges may be from their curves, for fewer control points [0: exactly]",
      "T");
  add("--meet", a.meet, "Points to be met exactly; with normals, tangent planes too", "CLOUD");
  add("--symmetric",
      a.symmetric,
      "The surface mirrors itself: x y z (that coordinate is 0) or a,b,c,d (ax + by + cz + d = 0)",
      "PLANE");
  add("--domain",
      a.domain,
      "The domain's corners: coordinates along the base plane's axes (x and y where it lies so; "
      "the report names them), lengths on a sheet",
      "X0,Y0,X1,Y1");
}

MirrorPlane ParsePlane(const std::string& flag, const std::string& text) {
  if (text == "x") return {Eigen::Vector3d::UnitX(), 0};
  if (text == "y") return {Eigen::Vector3d::UnitY(), 0};
  if (text == "z") return {Eigen::Vector3d::UnitZ(), 0};
  if (text.find_first_of("0123456789") == std::string::npos)
    CheckChoice(flag, text, {"x", "y", "z", "a,b,c,d"});
  const std::vector<double> numbers = ParseNumbers(flag, text);
  if (numbers.size() != 4)
    throw UsageError(flag + ": '" + text + "' is not x, y, z or four numbers a,b,c,d");
  const MirrorPlane plane{{numbers[0], numbers[1], numbers[2]}, -numbers[3]};
  if (!(plane.normal.norm() > 0)) throw UsageError(flag + ": '" + text + "' has no normal a,b,c");
  return plane;
}

void TakeConditions(const ConditionArguments& a, SurfaceFitOptions& options) {
  for (const std::string& path : a.boundary) ReadBoundary(path, options.boundary);
  options.boundary_tolerance =
      ParseNumber("--boundary-tolerance", a.boundary_tolerance, Sign::kNotNegative);
  if (!a.meet.empty()) options.meet = ReadCloud({a.meet}).cloud;
  if (!a.symmetric.empty()) options.symmetric = ParsePlane("--symmetric", a.symmetric);
  if (a.domain.empty()) return;
  const std::vector<double> numbers = ParseNumbers("--domain", a.domain);
  if (numbers.size() != 4 || !(numbers[0] < numbers[2]) || !(numbers[1] < numbers[3])) {
    throw UsageError("--domain: '" + a.domain + "' is not x0,y0,x1,y1 with x0 < x1 and y0 < y1");
  }
  options.domain = DomainBox{numbers[0], numbers[1], numbers[2], numbers[3]};
}

}  // namespace batten::internal
