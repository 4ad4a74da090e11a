// SPDX-License-Identifier: MIT
#include "cli/arguments/cloud_arguments.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <sstream>
#include <stdexcept>

#include "batten/io/read_error.h"
#include "cli/terminal/cli11.h"
#include "cli/terminal/offered_words.h"
#include "cli/terminal/parse_values.h"
#include "cli/terminal/terminal.h"

namespace batten::internal {
namespace {

constexpr const char* kGeometryWords[] = {"json", "step", "stp", "iges", "igs"};

std::pair<std::string, std::string> SplitAssignment(const std::string& flag,
                                                    const std::string& text) {
  const size_t sign = text.find('=');
  if (sign == std::string::npos || sign == 0 || sign + 1 == text.size()) {
    throw UsageError(flag + ": '" + text + "' is not of the form name=value");
  }
  return {text.substr(0, sign), text.substr(sign + 1)};
}

}  // namespace

void AddCloudArguments(CLI::App& command, CloudArguments& arguments) {
  command
      .add_option("--columns",
                  arguments.columns,
                  "Which column is what, by number or header name: x=2,y=3,z=4 (also u v nx ny nz "
                  "w red green "
                  "blue)")
      ->type_name("x=A,y=B,...");
  command
      .add_option(
          "--where",
          arguments.where,
          "Keep only rows whose column has the value: label=1 or 4=1; given again, all must hold")
      ->type_name("COLUMN=VALUE")
      ->allow_extra_args(false);
  command
      .add_option("--las-class",
                  arguments.las_class,
                  "Keep only points of these classes of a LAS file: 2 (ground) or 2,6")
      ->type_name("N,...");
  command
      .add_option("--box", arguments.box, "Keep only points inside xmin,ymin,zmin,xmax,ymax,zmax")
      ->type_name("NUMBERS");
  command
      .add_option("--projection",
                  arguments.projection,
                  "local: x and y are longitude and latitude in degrees and become metres, as they "
                  "do by themselves where columns are named so, east and north of their middle or "
                  "of LON,LAT; none: they stay")
      ->type_name("local[=LON,LAT]|none");
  command
      .add_option(
          "--format",
          arguments.format,
          "Format of files whose name does not tell, or of '-' (pcd ply las obj stl off glb "
          "text; json step iges brep)")
      ->type_name("FORMAT");
}

void AddPointsFlag(CLI::App& command, std::string& points) {
  Allow(*command
             .add_option("--points",
                         points,
                         "What of a mesh counts: faces, its whole surface, or vertices, as if it "
                         "held nothing else")
             ->capture_default_str()
             ->type_name("WHAT"),
        {"faces", "vertices"});
}

void TellMesh(const CloudFile& file, const std::vector<std::string>& paths, bool quiet) {
  if (quiet || !file.mesh || file.mesh->sampled == 0) return;
  PrintNote(fmt::format("{}: a mesh of {} triangles; {} points on them count beside its vertices",
                        JoinedNames(paths),
                        file.mesh->faces.surface.triangles.cols(),
                        file.mesh->sampled));
}

void TellRemarks(const CloudFile& file, bool quiet) {
  if (quiet) return;
  for (const std::string& remark : file.remarks) PrintWarning(remark);
}

void RequireFixedMiddle(const CloudFile& file,
                        const CloudReadOptions& options,
                        const std::vector<std::string>& paths) {
  if (!file.projection_middle || options.projection_middle) return;
  throw UsageError(fmt::format(
      "{}: its degrees become metres about a middle, which must be that of the geometry: say "
      "--projection local=LON,LAT as the warnings in the report of the fit do (the middle of these "
      "points is {:.5f},{:.5f}), or none where the geometry is in degrees",
      JoinedNames(paths),
      (*file.projection_middle)[0],
      (*file.projection_middle)[1]));
}

std::string JoinedNames(const std::vector<std::string>& paths) {
  if (paths.size() == 1) return paths.front();
  return paths.front() + " and " +
         (paths.size() == 2 ? "1 other" : std::to_string(paths.size() - 1) + " others");
}

bool NamesGeometry(const std::string& word) {
  return std::any_of(std::begin(kGeometryWords), std::end(kGeometryWords), [&](const char* known) {
    return CLI::detail::to_lower(word) == known;
  });
}

CloudReadOptions ToReadOptions(const CloudArguments& arguments, bool quiet) {
  CloudReadOptions options;
  options.format = arguments.format;
  std::stringstream columns(arguments.columns);
  for (std::string entry; std::getline(columns, entry, ',');) {
    const auto [role, column] = SplitAssignment("--columns", entry);
    if (!options.columns.emplace(role, column).second) {
      throw UsageError("--columns: '" + arguments.columns + "' gives " + role + " twice");
    }
  }
  for (const std::string& text : arguments.where) {
    const auto [column, value] = SplitAssignment("--where", text);
    options.where.push_back({column, ParseNumber("--where " + column, value)});
  }
  std::stringstream classes(arguments.las_class);
  for (std::string entry; std::getline(classes, entry, ',');) {
    constexpr int kHighestClass = 255;
    options.las_classes.push_back(
        static_cast<int>(ParseWhole("--las-class", entry, 0, kHighestClass)));
  }
  if (!arguments.projection.empty()) {
    try {
      TakeProjection(arguments.projection, options);
    } catch (const std::invalid_argument& refusal) {
      throw UsageError(std::string("--projection: ") + refusal.what());
    }
  }
  if (!arguments.box.empty()) {
    const std::vector<double> numbers = ParseNumbers("--box", arguments.box);
    if (numbers.size() != 6) {
      throw UsageError("--box: '" + arguments.box +
                       "' is not the 6 numbers xmin,ymin,zmin,xmax,ymax,zmax");
    }
    for (int d = 0; d < 3; ++d) {
      if (numbers[d] > numbers[d + 3])
        throw UsageError("--box: '" + arguments.box + "': a minimum exceeds its maximum");
    }
    options.box = Eigen::AlignedBox3d(Eigen::Vector3d(numbers[0], numbers[1], numbers[2]),
                                      Eigen::Vector3d(numbers[3], numbers[4], numbers[5]));
  }
  const Progress progress = MakeProgress(quiet);
  options.progress = [progress](double fraction) { Report(progress, "read", fraction); };
  return options;
}

}  // namespace batten::internal
