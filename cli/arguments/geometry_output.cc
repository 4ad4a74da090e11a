// SPDX-License-Identifier: MIT
#include "cli/arguments/geometry_output.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <stdexcept>
#include <variant>

#include "batten/io/file_format.h"
#include "batten/io/geometry_file.h"
#include "batten/io/read_error.h"
#include "cli/arguments/geometry_flags.h"
#include "cli/terminal/cli11.h"
#include "cli/terminal/offered_words.h"
#include "cli/terminal/parse_values.h"
#include "cli/terminal/terminal.h"
#include "cli/terminal/this_run.h"

namespace batten::internal {

void AddStepSchemaFlag(CLI::App& command, std::string& schema) {
  Allow(
      *command.add_option("--step-schema", schema, "Application protocol of STEP: ap214, or ap242")
           ->capture_default_str()
           ->type_name("SCHEMA"),
      {"ap214", "ap242"});
}

void AddGeometryInput(CLI::App& command, GeometryInput& input) {
  command.add_flag(
      "--strict",
      input.strict,
      "Refuse a file of which a face or curve can't be read [the rest is read, and the "
      "exit code 4]");
  command.add_flag(
      "--accept-doubt", input.accept_doubt, "End with 0 though a part could not be read");
}

void TellUnread(const std::string& path,
                const GeometryContents& contents,
                const GeometryInput& input,
                bool quiet) {
  if (contents.unread.empty()) return;
  if (!input.accept_doubt) NoteDoubt();
  if (quiet) return;
  PrintWarning(
      fmt::format("{}: {} of its {} faces and curves can't be read; the rest is taken "
                  "(--strict refuses the file)",
                  path,
                  contents.unread.size(),
                  contents.unread.size() + contents.geometry.size()));
  for (const std::string& why : contents.unread) PrintWarning(path + ": " + why);
}

void AddGeometryOutput(CLI::App& command, GeometryOutput& output) {
  AddGeometryInput(command, output.input);
  CLI::Option& unit = *command
                           .add_option_function<std::string>(
                               "--unit",
                               [&output](const std::string& text) {
                                 CheckUnit(text);
                                 output.unit = text;
                               },
                               "Unit of what is written, declared in STEP and IGES: coordinates of "
                               "a file in another\n"
                               "are turned into it [the file's own, mm where it says none]")
                           ->type_name("UNIT");
  Suggest(unit, Units());
  AddStepSchemaFlag(command, output.step_schema);
}

void AddSewFlag(CLI::App& command, GeometryOutput& output) {
  command
      .add_option_function<std::string>(
          "--sew",
          [&output](const std::string& text) {
            output.sew = ParseNumber("--sew", text, Sign::kNotNegative);
          },
          "STEP and B-rep: surfaces whose edges are within T become shells, closed ones solids; 0: "
          "none do [what shares edges in GEOMETRY stays sewn, within its own tolerance]")
      ->type_name("T");
}

// Squares of lengths must stay numbers for whoever reads the file.
void RequireSensible(const std::vector<Geometry>& geometry) {
  constexpr double kLargest = 1e100;
  for (const Geometry& one : geometry) {
    const double largest =
        std::visit([](const auto& g) { return g.control_points().cwiseAbs().maxCoeff(); }, one);
    if (largest > kLargest) {
      throw std::invalid_argument("coordinates beyond 1e100 are of no use to any CAD system");
    }
  }
}

bool KeepsBodies(const std::string& path, const std::string& format, const GeometryOutput& output) {
  const FileFormat to = FormatOf(path, format);
  return (to == FileFormat::kStep || to == FileFormat::kBrep) && output.sew != 0.0;
}

GeometryContents ReadInUnit(const std::string& path,
                            const std::string& format,
                            const GeometryOutput& output,
                            bool quiet,
                            Kept kept) {
  GeometryContents contents =
      ReadGeometryContents(path, {format, output.unit, output.undeclared, output.input.strict});
  if (kept != Kept::kShapes || !contents.shapes.held || !contents.shapes.whole)
    TellUnread(path, contents, output.input, quiet);
  if (!quiet) {
    for (const std::string& remark : contents.remarks) PrintWarning(path + ": " + remark);
    if (kept == Kept::kGeometry && !contents.flattened.empty()) {
      PrintWarning(path + ": " + contents.flattened);
    }
  }
  return contents;
}

nlohmann::ordered_json SewingJson(const SewingReport& report) {
  return {{"surfaces", report.surfaces},
          {"solids", report.solids},
          {"shells", report.shells},
          {"loose", report.loose},
          {"invalid", report.invalid},
          {"shared_edges", report.shared_edges},
          {"free_edges", report.free_edges},
          {"largest_gap", report.largest_gap},
          {"nearest_gap",
           report.nearest_gap ? nlohmann::ordered_json(*report.nearest_gap)
                              : nlohmann::ordered_json(nullptr)},
          {"watertight", report.watertight()}};
}

namespace {

// "2 solids", or what one is; empty for none.
std::string Counted(size_t count, const std::string& one, const std::string& many) {
  return count == 0 ? "" : count == 1 ? one : fmt::format("{} {}", count, many);
}

}  // namespace

void TellSewing(const std::string& path,
                const SewingReport& report,
                const std::vector<GeometryBody>& read) {
  std::string made;
  for (const std::string& some :
       {Counted(report.solids, "a solid", "solids"),
        Counted(report.shells, "an open shell", "open shells"),
        Counted(report.loose, "a surface by itself", "surfaces by themselves")}) {
    if (!some.empty()) made += (made.empty() ? "" : ", ") + some;
  }
  std::string text = fmt::format(
      "{}: {} sewn into {}", path, Counted(report.surfaces, "a surface", "surfaces"), made);
  if (report.shared_edges > 0) {
    text += fmt::format(
        "; {} shared edges, the largest gap {:.3g}", report.shared_edges, report.largest_gap);
  }
  if (report.watertight()) return PrintNote(text + "; watertight");
  if (report.invalid > 0) {
    text += fmt::format("; {} of them would make no valid shape", report.invalid);
  }
  if (report.free_edges > 0)
    text += fmt::format("; {} free edges: not watertight", report.free_edges);
  if (report.nearest_gap && *report.nearest_gap > 0) {
    text += fmt::format("; the nearest two are {:.3g} apart", *report.nearest_gap);
  }
  size_t free_before = 0;
  for (const GeometryBody& body : read) free_before += body.free_edges.size();
  if (report.free_edges > free_before) {
    PrintWarning(text);
  } else {
    PrintNote(text);
  }
}

NamedSurfaces SurfacesAlone(const std::string& path,
                            const GeometryContents& contents,
                            const std::string& why,
                            bool quiet) {
  NamedSurfaces found;
  std::vector<size_t> places(contents.geometry.size());
  for (size_t k = 0; k < contents.geometry.size(); ++k) {
    const auto* surface = std::get_if<NurbsSurface>(&contents.geometry[k]);
    if (surface == nullptr) continue;
    places[k] = found.surfaces.size();
    found.surfaces.push_back(*surface);
    found.names.push_back(contents.names[k]);
  }
  if (found.surfaces.empty()) throw ReadError(path, "holds no surface, only curves");
  for (GeometryBody body : contents.bodies) {
    for (size_t& surface : body.surfaces) surface = places[surface];
    body.free_edges.clear();
    found.bodies.push_back(std::move(body));
  }
  const size_t curves = contents.geometry.size() - found.surfaces.size();
  if (curves > 0 && !quiet) {
    PrintWarning(fmt::format("{}: {} left out: {}",
                             path,
                             curves == 1 ? "a curve is" : fmt::format("{} curves are", curves),
                             why));
  }
  return found;
}

GeometryWriteOptions WriteOptions(const std::string& format,
                                  const GeometryOutput& output,
                                  const GeometryContents& read) {
  GeometryWriteOptions options;
  options.format = format;
  if (!read.unit.empty()) options.unit = read.unit;
  options.step_schema = output.step_schema;
  options.sew = output.sew;
  return options;
}

}  // namespace batten::internal
