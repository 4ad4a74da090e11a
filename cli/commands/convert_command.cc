// SPDX-License-Identifier: MIT
// batten convert: geometry to geometry, cloud to cloud.
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "batten/io/file_format.h"
#include "batten/io/geometry_file.h"
#include "batten/io/read_cloud.h"
#include "batten/io/read_error.h"
#include "batten/io/write_cloud.h"
#include "cli/arguments/cloud_arguments.h"
#include "cli/arguments/fit_output.h"
#include "cli/arguments/geometry_flags.h"
#include "cli/arguments/geometry_output.h"
#include "cli/arguments/mesh_output.h"
#include "cli/commands/commands.h"
#include "cli/terminal/cli11.h"
#include "cli/terminal/common_flags.h"
#include "cli/terminal/exit_codes.h"
#include "cli/terminal/streams.h"
#include "cli/terminal/terminal.h"
#include "cli/terminal/written_format.h"

namespace batten::internal {
namespace {

struct ConvertArguments {
  std::vector<std::string> sources;
  std::string in, out, out_format;
  GeometryOutput output;
  CloudArguments cloud;
  CommonFlags flags;
};

// The format words of IN and OUT. --format is for the file whose name does not tell, IN first.
std::pair<std::string, std::string> FormatWords(const ConvertArguments& a) {
  const std::string& word = a.cloud.format;
  if (!a.out_format.empty()) return {word, a.out_format};
  if (FormatOfName(a.out)) return {word, ""};
  return {FormatOfName(a.in) ? "" : word, word};
}

// ", 3 geometries in mm"
std::string GeometryWords(const nlohmann::ordered_json& entry) {
  const auto count = entry["count"].get<size_t>();
  const std::string many = count > 1 ? fmt::format(", {} geometries", count) : "";
  return many + " in " + entry["unit"].get<std::string>();
}

int RunConvert(const ConvertArguments& a) {
  if (a.flags.json && a.out == "-")
    throw UsageError("OUT of - and --json both want standard output");
  const auto [in_format, out_format] = FormatWords(a);
  const FileFormat from = InputFormat(a.in, in_format);
  if (IsGeometryFormat(from) && a.sources.size() > 1) {
    throw UsageError(a.in + " holds geometry: one such file at a time");
  }
  if (IsGeometryFormat(from) && NamesMesh(a.out, out_format)) {
    if (a.output.sew) throw UsageError("--sew is of STEP and B-rep: a mesh holds no shells");
    return WriteMeshOf({.geometry = a.in,
                        .geometry_format = in_format,
                        .out = a.out,
                        .out_format = out_format,
                        .unit = a.output.unit,
                        .input = a.output.input,
                        .flags = a.flags});
  }
  const FileFormat to = WrittenFormat(
      a.out,
      out_format,
      IsGeometryFormat(from) ? "geometry is written as .json, .step, .iges or .brep, triangles as "
                               ".stl, .obj, .ply or .glb"
                             : "points are written as .ply, .pcd, .xyz or .csv");
  if (IsCloudFormat(from) && !IsCloudFormat(to)) {
    throw UsageError(a.in + " is a cloud and " + a.out +
                     " geometry: 'batten fit' makes one from the other");
  }
  if (IsCloudFormat(to) && !IsCloudFormat(from)) {
    throw UsageError(a.in + " is geometry and " + a.out +
                     " a cloud: 'batten sample' makes points of it, 'batten tessellate' a mesh");
  }
  if (IsCloudFormat(from) && a.output.sew) throw UsageError("--sew is of surfaces, not of points");
  if (!IsWritable(to)) {
    throw UsageError(a.out + ": points are written as .ply, .pcd, .xyz or .csv, not ." +
                     FormatName(to));
  }
  CheckWritable(a.out);
  nlohmann::ordered_json entry{{"path", a.out}};
  std::optional<SewingReport> sewing;
  std::vector<GeometryBody> bodies;
  if (IsCloudFormat(from)) {
    CloudReadOptions read = ToReadOptions(a.cloud, a.flags.quiet);
    read.format = in_format;
    BeginReading(a.sources, a.flags.quiet);
    const CloudFile file = ReadCloud(a.sources, read);
    TellRemarks(file, a.flags.quiet);
    WriteCloud(file.cloud, a.out, out_format);
    entry["kind"] = "cloud";
    entry["points"] = file.cloud.size();
    entry["non_finite"] = file.non_finite;
  } else {
    BeginReading({a.in}, a.flags.quiet);
    const bool keeps_bodies = KeepsBodies(a.out, out_format, a.output);
    const bool as_read = keeps_bodies && !a.output.sew;
    GeometryContents contents = ReadInUnit(a.in,
                                           in_format,
                                           a.output,
                                           a.flags.quiet,
                                           as_read        ? Kept::kShapes
                                           : keeps_bodies ? Kept::kBodies
                                                          : Kept::kGeometry);
    const GeometryWriteOptions options = WriteOptions(out_format, a.output, contents);
    const auto declares = [](FileFormat format) {
      return format == FileFormat::kStep || format == FileFormat::kIges;
    };
    if (contents.unit.empty() && from != FileFormat::kJson && declares(to) && !a.flags.quiet) {
      PrintWarning(a.out + " declares " + options.unit + ": " + a.in +
                   " does not say its unit; say --unit");
    }
    bodies = std::move(contents.bodies);
    const GeometryFile file{
        a.out, std::move(contents.geometry), std::move(contents.names), bodies, contents.shapes};
    sewing = WriteGeometry(file, options);
    const std::vector<Geometry>& geometry = file.geometry;
    const auto surfaces = std::count_if(geometry.begin(), geometry.end(), [](const Geometry& one) {
      return std::holds_alternative<NurbsSurface>(one);
    });
    const bool all = surfaces == static_cast<std::ptrdiff_t>(geometry.size());
    entry["kind"] = all ? "surface" : surfaces == 0 ? "curve" : "mixed";
    entry["count"] = geometry.size();
    entry["unit"] = options.unit;
    if (!contents.unread.empty() && !(as_read && file.shapes.held && file.shapes.whole))
      entry["unread"] = contents.unread;
    if (!contents.unread.empty() && !file.shapes.held) entry["unread"] = contents.unread;
    if (sewing) entry["sewing"] = SewingJson(*sewing);
  }
  ClearProgress();
  if (a.flags.json) {
    PrintFiles(entry);
  } else if (!a.flags.quiet && a.out != "-") {
    PrintResult(fmt::format("{}: {}{}",
                            a.out,
                            entry["kind"].get<std::string>(),
                            entry.contains("points")
                                ? fmt::format(" of {} points", entry["points"].get<Eigen::Index>())
                                : GeometryWords(entry)));
  }
  if (sewing && !a.flags.quiet) TellSewing(a.out, *sewing, bodies);
  return kDone;
}

}  // namespace

void AddConvertCommand(CLI::App& app, Action& action) {
  auto a = std::make_shared<ConvertArguments>();
  CLI::App& command = *app.add_subcommand(
      "convert", "Turn geometry into geometry or a mesh, or a cloud into a cloud");
  command
      .add_option_function<std::vector<std::string>>(
          "FILES",
          [a](const std::vector<std::string>& files) {
            a->sources = {files.begin(), files.end() - 1};
            a->in = files.front();
            a->out = files.back();
          },
          std::string("What to read: .json .step .iges .brep, or ") + kCloudFormats +
              " (several are one cloud); then what to write: .json .step .iges .brep, .stl .obj "
              ".ply .glb, or .ply .pcd .xyz .csv")
      ->required()
      ->expected(2, -1)
      ->type_name("IN... OUT");
  command
      .add_option("--output-format",
                  a->out_format,
                  "Format of OUT where its name does not tell and --format is IN's")
      ->type_name("FORMAT");
  AddGeometryOutput(command, a->output);
  AddSewFlag(command, a->output);
  AddCloudArguments(command, a->cloud);
  AddCommonFlags(command, a->flags);
  command.footer(
      "In STEP curves of the plane stand at z = 0, and periodic shapes are closed ones with "
      "clamped\n"
      "knots; JSON keeps both as they are, bit by bit. Solids and shells of STEP and B-rep\n"
      "files stay sewn in those formats. B-rep is OpenCASCADE's own .brep, which FreeCAD reads: "
      "no\n"
      "names, no unit.\n"
      "Examples:\n"
      "  batten convert part.json part.step --unit mm --step-schema ap242\n"
      "  batten convert part-in-metres.iges part.step --unit mm\n"
      "  batten convert faces.json part.step --sew 0.01\n"
      "  batten convert part.brep part.step --unit mm\n"
      "  batten convert part.step part.stl\n"
      "  batten convert scan.pcd scan.ply --box 0,0,0,10,10,10\n"
      "  batten convert part.step - --format json\n"
      "  batten convert tile_1.las tile_2.las ground.ply --las-class 2\n"
      "  batten convert ground.txt ground.csv --columns x=2,y=3,z=4 --where label=1");
  command.callback([a, &action] { action = [a] { return RunConvert(*a); }; });
}

}  // namespace batten::internal
