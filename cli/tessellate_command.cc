// SPDX-License-Identifier: MIT
// batten tessellate: surfaces as one triangle mesh.
#include <memory>
#include <string>

#include "batten/cli/mesh_output.h"
#include "batten/cli/parse_values.h"
#include "batten/cli/program.h"

namespace batten {

void AddTessellateCommand(CLI::App& app, Action& action) {
  auto a = std::make_shared<MeshRequest>();
  auto word = std::make_shared<std::string>();
  CLI::App& command =
      *app.add_subcommand("tessellate", "Turn surfaces, inside their trims, into a triangle mesh");
  command.add_option("GEOMETRY", a->geometry, "Surfaces: .json .step .iges")->required();
  command.add_option("-o,--output", a->out, "Where to write: .stl .obj .ply")
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
  command.add_option("--format", *word, "Format of files whose name does not tell, or of '-'")
      ->type_name("FORMAT");
  AddCommonFlags(command, a->flags);
  command.footer(
      "Each surface's mesh is closed along its seams and poles and has no cracks inside; meshes "
      "of\n"
      "several surfaces stand side by side in one file. STL keeps single precision only.\n"
      "Examples:\n"
      "  batten tessellate part.step -o part.stl\n"
      "  batten tessellate hull.json -o hull.obj --chord-tolerance 0.01\n"
      "  batten tessellate part.step -o - --format ply > part.ply");
  command.callback([a, word, &action] {
    const bool of_geometry = *word == "json" || *word == "step" || *word == "iges";
    (of_geometry ? a->geometry_format : a->out_format) = *word;
    action = [a] { return WriteMeshOf(*a); };
  });
}

}  // namespace batten
