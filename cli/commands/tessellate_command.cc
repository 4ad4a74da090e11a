// SPDX-License-Identifier: MIT
// batten tessellate: surfaces as triangle meshes.
#include <memory>
#include <string>
#include <utility>

#include "cli/arguments/cloud_arguments.h"
#include "cli/arguments/fit_output.h"
#include "cli/arguments/geometry_flags.h"
#include "cli/arguments/mesh_output.h"
#include "cli/commands/commands.h"
#include "cli/terminal/cli11.h"
#include "cli/terminal/common_flags.h"
#include "cli/terminal/offered_words.h"
#include "cli/terminal/parse_values.h"

namespace batten::internal {

void AddTessellateCommand(CLI::App& app, Action& action) {
  auto a = std::make_shared<MeshRequest>();
  CLI::App& command =
      *app.add_subcommand("tessellate", "Turn surfaces, inside their trims, into a triangle mesh");
  command.add_option("GEOMETRY", a->geometry, "Surfaces: .json .step .iges .brep")->required();
  command.add_option("-o,--output", a->out, "Where to write: .stl .obj .ply .glb")
      ->required()
      ->type_name("MESH");
  command
      .add_option_function<std::string>(
          "--chord-tolerance",
          [a](const std::string& text) {
            a->chord_tolerance = ParseNumber("--chord-tolerance", text, Sign::kPositive);
          },
          "How far triangles may be from the surface, in its unit [1e-3 of its size]")
      ->type_name("T");
  command
      .add_option("--deviation",
                  a->cloud_path,
                  "Colour vertices by how far the points near them stand off the surface")
      ->type_name("CLOUD");
  command
      .add_option_function<std::string>(
          "--deviation-range",
          [a](const std::string& text) {
            a->deviation_range = ParseNumber("--deviation-range", text, Sign::kPositive);
          },
          "What is that far off is all blue or red, and beyond dark [chosen, a round number]")
      ->type_name("R");
  CLI::Option& unit =
      *command
           .add_option(
               "--unit",
               a->unit,
               "Unit of the mesh: coordinates of a file in another are turned into it; .glb "
               "is in metres\nalways [the file's own, mm where it says none]")
           ->type_name("UNIT");
  Suggest(unit, Units());
  auto out_format = std::make_shared<std::string>();
  Suggest(*command
               .add_option("--output-format",
                           *out_format,
                           "Format of the mesh where --format is that of GEOMETRY or CLOUD")
               ->type_name("FORMAT"),
          {"stl", "obj", "ply", "glb"});
  AddCloudArguments(command, a->cloud);
  AddThreadsFlag(command, a->threads);
  AddGeometryInput(command, a->input);
  AddCommonFlags(command, a->flags);
  command.footer(
      "The mesh is watertight over each surface, its seams and poles, and across the edges that\n"
      "faces of a solid or shell share in .step and .brep; the line says watertight where no edge\n"
      "is open. Several surfaces stand in one file, in .obj and .glb as objects of their own, in\n"
      ".obj and .ply with one vertex for all that meet. Triangles turn outwards as faces do.\n"
      "STL keeps single precision only, and neither colours nor normals of the surface.\n"
      "--columns, --where and --box are of the points of --deviation.\n"
      "Examples:\n"
      "  batten tessellate part.step -o part.stl\n"
      "  batten tessellate hull.json -o hull.obj --chord-tolerance 0.01\n"
      "  batten tessellate part.step -o part.glb --deviation scan.ply --deviation-range 0.1\n"
      "  batten tessellate part.step -o - --format ply > part.ply\n"
      "  cat part.json | batten tessellate - -o - --format json --output-format glb > part.glb");
  command.callback([a, out_format, &action] {
    // The word is of the mesh where it names one and nothing else does, of the geometry or else of
    // the points.
    std::string& word = a->cloud.format;
    if (!out_format->empty()) {
      a->out_format = *out_format;
      if (NamesGeometry(word)) a->geometry_format = std::exchange(word, "");
      if (!word.empty() && a->cloud_path.empty()) {
        throw UsageError("--format " + word + " and --output-format " + *out_format +
                         " are both of the mesh");
      }
    } else if (NamesMesh("", word)) {
      a->out_format = std::exchange(word, "");
    } else if (NamesGeometry(word)) {
      a->geometry_format = std::exchange(word, "");
    }
    action = [a] { return WriteMeshOf(*a); };
  });
}

}  // namespace batten::internal
