// SPDX-License-Identifier: MIT
// batten fit solid: points of a whole body in, a watertight solid of smooth faces and its report
// out.
#include <fmt/format.h>

#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "batten/fitting/fit_solid.h"
#include "batten/io/polygon_reader.h"
#include "batten/io/read_error.h"
#include "cli/arguments/fit_arguments.h"
#include "cli/arguments/mesh_output.h"
#include "cli/commands/commands.h"
#include "cli/terminal/cli11.h"
#include "cli/terminal/help_format.h"
#include "cli/terminal/offered_words.h"
#include "cli/terminal/parse_values.h"
#include "cli/terminal/terminal.h"

namespace batten::internal {
namespace {

struct FitSolidArguments : FitArguments {
  std::string quads, layout_out;
  bool keep_outliers = false, every_face = false;
};

SolidFitOptions ToFitSolidOptions(const FitSolidArguments& a) {
  SolidFitOptions options;
  options.tolerance = a.tolerance;
  options.smoothing = ToSmoothing(a.smoothing);
  options.keep_outliers = a.keep_outliers;
  options.merge_faces = !a.every_face;
  return WithWork(std::move(options), a);
}

std::string SolidWords(const SolidFit& fit) {
  return fmt::format(
      "a watertight solid of {} faces, {} edges and {} vertices, genus {}; volume {:.6g}, area {:.6g}; faces meet "
      "within {:.2g} and {:.2g}°",
      fit.solid.faces.size(),
      fit.solid.edges.size(),
      fit.solid.vertices.cols(),
      fit.layout.genus,
      fit.audit.volume,
      fit.audit.area,
      fit.audit.gap,
      fit.audit.edge_angle * 180 / std::numbers::pi);
}

int RunFitSolid(const FitSolidArguments& a) {
  if (a.quads.empty()) NotYet("fit solid without --quads LAYOUT");
  SolidFitOptions options = ToFitSolidOptions(a);
  FitFiles files(a, {a.quads});
  if (NamesMesh(a.out, a.out_format)) NotYet("the mesh of a solid as -o");
  if (!a.layout_out.empty()) CheckWritable(a.layout_out);
  const QuadMesh layout = ReadQuadMesh(a.quads);
  const PointCloud& cloud = files.Read(false);
  options.shift = files.shift();
  SolidFit fit = files.Explained([&] { return FitSolid(cloud, layout, options); });
  std::vector<Geometry> faces;
  for (const SolidFace& face : fit.solid.faces) faces.emplace_back(face.surface);
  files.KeepSolid(fit.solid);
  if (!a.layout_out.empty()) WriteQuadMesh(fit.control_mesh, a.layout_out);
  const int code =
      files.Write(faces, fit.residuals, fit.parameters, fit.outliers, fit.report, fit.faces);
  if (!a.flags.quiet) PrintNote(a.out + ": " + SolidWords(fit));
  return code;
}

}  // namespace

void AddFitSolidCommand(CLI::App& fit, Action& action) {
  auto a = std::make_shared<FitSolidArguments>();
  CLI::App& command = *fit.add_subcommand(
      "solid", "Fit a watertight solid of smooth faces to the points of a whole body");
  AddEveryFitsArguments(command,
                        *a,
                        "CLOUD",
                        "auto none; auto leaves out the outliers of the cloud, none takes all points");
  command
      .add_option("--quads",
                  a->quads,
                  "The layout: a closed mesh of quadrilaterals near the points, .obj .off .ply")
      ->type_name("LAYOUT");
  command
      .add_option("--layout-out",
                  a->layout_out,
                  "Where to write the control mesh of the surface, a subdivision mesh: .obj")
      ->type_name("Q.obj");
  Suggest(*command
               .add_option("--smoothing",
                           a->smoothing,
                           "Fairness relative to the data: auto (by points left out) or a number")
               ->capture_default_str()
               ->type_name("L"),
          {"auto"});
  command.add_flag("--keep-outliers", a->keep_outliers, "All points count");
  command.add_flag("--every-face",
                   a->every_face,
                   "A face for each of the layout's; else as few as its extraordinary vertices allow");
  GroupFitFlags(command);
  GroupFlags(command, "Which shape", {"--quads", "--every-face"});
  GroupFlags(command, "What is written", {"--layout-out"});
  command.footer(
      "Examples:\n"
      "  batten fit solid scan.ply -o part.step --quads layout.obj\n"
      "  batten fit solid scan.xyz -o part.step --quads layout.obj --report part-report.json\n"
      "The layout may come from a quadrilateral remesher or be drawn by hand; its vertices need not lie on\n"
      "the points. It is closed, each edge between two faces, faces counter-clockwise seen from outside.\n"
      "One subdivision surface over it is fitted to all points and written as bicubic faces with\n"
      "continuous tangent planes that share their edges: a MANIFOLD_SOLID_BREP. Before the file\n"
      "gets its name the solid is found closed, valid, without folds and the same when it is read back;\n"
      "else nothing is written, and the reason is said.\n"
      "Exit code 3 says the solid is written but the tolerance is not reached.");
  command.callback([a, &action] { action = [a] { return RunFitSolid(*a); }; });
}

}  // namespace batten::internal
