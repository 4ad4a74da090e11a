// SPDX-License-Identifier: MIT
// batten edit: operations on curves and surfaces, one after the other.
#include <fmt/format.h>
#include <sys/resource.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <filesystem>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "batten/io/file_format.h"
#include "batten/io/geometry_file.h"
#include "batten/io/read_error.h"
#include "cli/arguments/edit_operations.h"
#include "cli/arguments/edit_syntax.h"
#include "cli/arguments/file_entry.h"
#include "cli/arguments/fit_output.h"
#include "cli/arguments/geometry_flags.h"
#include "cli/arguments/geometry_output.h"
#include "cli/arguments/shared_unit.h"
#include "cli/commands/commands.h"
#include "cli/terminal/cli11.h"
#include "cli/terminal/common_flags.h"
#include "cli/terminal/exit_codes.h"
#include "cli/terminal/offered_words.h"
#include "cli/terminal/streams.h"
#include "cli/terminal/terminal.h"

namespace batten::internal {
namespace {

using Json = nlohmann::ordered_json;

struct EditArguments {
  std::string geometry, out, format, out_format;
  std::vector<std::string> operations;
  GeometryOutput output;
  CommonFlags flags;
};

struct Edited {
  std::vector<Geometry> shapes;
  std::vector<std::string> names;  // pieces keep that of what they are cut from
  std::vector<std::string> shortfalls;
  bool pieces = false;  // some shape has become several, or a curve
};

// Every operation on every shape there is by then.
Edited EditAll(const std::vector<EditOperation>& operations,
               std::vector<Geometry> shapes,
               std::vector<std::string> names,
               const Progress& progress) {
  Edited edited{std::move(shapes), std::move(names), {}};
  for (size_t k = 0; k < operations.size(); ++k) {
    if (TakesAll(operations[k])) {
      edited.shapes = {ApplyToAll(operations[k], edited.shapes)};
      edited.names.resize(1);
      continue;
    }
    std::vector<Geometry> next;
    std::vector<std::string> next_names;
    for (size_t i = 0; i < edited.shapes.size(); ++i) {
      Report(progress, "edit", static_cast<double>(k) / static_cast<double>(operations.size()));
      const std::string which =
          edited.shapes.size() > 1 ? fmt::format(" (geometry of index {})", i) : "";
      try {
        EditOutcome outcome = ApplyEdit(operations[k], edited.shapes[i]);
        edited.pieces = edited.pieces || outcome.pieces.size() != 1 ||
                        outcome.pieces[0].index() != edited.shapes[i].index();
        std::move(outcome.pieces.begin(), outcome.pieces.end(), std::back_inserter(next));
        next_names.resize(next.size(), edited.names[i]);
        if (!outcome.shortfall.empty()) edited.shortfalls.push_back(outcome.shortfall + which);
      } catch (const UsageError& error) {
        throw UsageError(error.what() + which);
      }
    }
    edited.shapes = std::move(next);
    edited.names = std::move(next_names);
  }
  return edited;
}

// part.json becomes part-1.json, part-2.json, …
std::string Numbered(const std::string& path, size_t number) {
  const std::filesystem::path whole(path);
  const std::string name =
      whole.stem().string() + '-' + std::to_string(number) + whole.extension().string();
  return (whole.parent_path() / name).string();
}

// The files to write: OUT, or one for each piece where an operation cuts.
std::vector<GeometryFile> Outputs(const std::string& out,
                                  bool pieces,
                                  std::vector<Geometry> shapes,
                                  std::vector<std::string> names,
                                  std::vector<GeometryBody> bodies) {
  if (!pieces || out == "-") {
    return {{out, std::move(shapes), std::move(names), std::move(bodies)}};
  }
  std::vector<GeometryFile> files;
  for (size_t i = 0; i < shapes.size(); ++i) {
    files.push_back({Numbered(out, i + 1), {std::move(shapes[i])}, {std::move(names[i])}});
  }
  return files;
}

// The bodies of what was read, for what has become of it: their tolerance grows with it.
std::vector<GeometryBody> BodiesAfter(const std::vector<Geometry>& before,
                                      const Edited& after,
                                      std::vector<GeometryBody> bodies) {
  if (after.pieces) return {};
  const auto size = [](const std::vector<Geometry>& shapes, const std::vector<size_t>& which) {
    Eigen::AlignedBox3d box;
    for (const size_t k : which) {
      const Eigen::Matrix3Xd& net = std::get<NurbsSurface>(shapes[k]).control_points();
      box.extend(net.rowwise().minCoeff()).extend(net.rowwise().maxCoeff());
    }
    return box.diagonal().norm();
  };
  for (GeometryBody& body : bodies) {
    const double was = size(before, body.surfaces);
    if (was > 0) body.tolerance *= std::max(1.0, size(after.shapes, body.surfaces) / was);
  }
  return bodies;
}

// Files written together are open together; the system's usual limit is a thousand.
void MakeRoom(size_t files) {
  constexpr rlim_t kOthers = 64;
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0 || files + kOthers <= limit.rlim_cur) return;
  if (files + kOthers > limit.rlim_max) {
    throw UsageError(fmt::format("edit: {} pieces are more files than this system lets be open, {}",
                                 files,
                                 limit.rlim_max - kOthers));
  }
  limit.rlim_cur = files + kOthers;
  setrlimit(RLIMIT_NOFILE, &limit);
}

int RunEdit(const EditArguments& a) {
  CheckDistinct({a.out}, a.flags.json);
  std::vector<EditOperation> operations;
  for (const std::string& text : a.operations) operations.push_back(ParseEditOperation(text));
  const auto powers = std::find_if(
      operations.begin(), operations.end(), [](const auto& one) { return one.name == "to-power"; });
  if (powers != operations.end() && powers + 1 != operations.end()) {
    powers->Refuse("it must be the last operation");
  }
  const std::string& out_format = a.out_format.empty() && a.out == "-" ? a.format : a.out_format;
  CheckGeometryFormat(a.out, out_format);
  if (powers != operations.end() && FormatOf(a.out, out_format) != FileFormat::kJson) {
    powers->Refuse("only .json holds powers of the parameter");
  }
  const bool pieces = std::any_of(operations.begin(), operations.end(), CutsIntoPieces);
  CheckWritable(pieces && a.out != "-" ? Numbered(a.out, 1) : a.out);

  const Progress progress = MakeProgress(a.flags.quiet);
  BeginReading({a.geometry}, a.flags.quiet);
  const bool keeps_bodies = !pieces && KeepsBodies(a.out, out_format, a.output);
  const GeometryContents read = ReadInUnit(a.geometry,
                                           a.format,
                                           a.output,
                                           a.flags.quiet,
                                           keeps_bodies ? Kept::kBodies : Kept::kGeometry);
  for (EditOperation& one : operations) one.others = ReadBeside(a.output.unit, read.unit);
  Edited edited = EditAll(operations, read.geometry, read.names, progress);
  if (keeps_bodies && edited.pieces && !a.flags.quiet && !read.flattened.empty()) {
    PrintWarning(a.geometry + ": " + read.flattened);
  }
  std::vector<GeometryBody> bodies = BodiesAfter(read.geometry, edited, read.bodies);
  const std::vector<GeometryFile> files =
      Outputs(a.out, pieces, std::move(edited.shapes), std::move(edited.names), std::move(bodies));
  MakeRoom(files.size());
  Report(progress, "write", 1);
  GeometryWriteOptions options = WriteOptions(out_format, a.output, read);
  if (powers != operations.end()) options.format = "json-power";
  const std::vector<std::optional<SewingReport>> sewing = WriteGeometryFiles(files, options);
  ClearProgress();

  Json list = Json::array();
  for (size_t k = 0; k < files.size(); ++k) {
    list.push_back(FileEntry(files[k]));
    if (sewing[k]) list.back()["sewing"] = SewingJson(*sewing[k]);
    if (sewing[k] && !a.flags.quiet) TellSewing(files[k].path, *sewing[k], read.bodies);
  }
  if (a.flags.json) {
    fmt::print("{}\n", Json{{"files", list}}.dump(2, ' ', false, Json::error_handler_t::replace));
  } else if (!a.flags.quiet && a.out != "-") {
    for (const Json& entry : list) PrintResult(FileLine(entry));
  }
  if (!a.flags.quiet) {
    for (const std::string& shortfall : edited.shortfalls) PrintWarning(shortfall);
  }
  return edited.shortfalls.empty() ? kDone : kToleranceMissed;
}

}  // namespace

void AddEditCommand(CLI::App& app, Action& action) {
  auto a = std::make_shared<EditArguments>();
  CLI::App& command = *app.add_subcommand(
      "edit", "Change curves and surfaces: knots, degree, pieces, place, shape, extent");
  command.add_option("GEOMETRY", a->geometry, "Curves or surfaces: .json .step .iges .brep")
      ->required();
  CLI::Option& operations =
      *command.add_option("OP", a->operations, "Operations, applied in order (below)")->required();
  SuggestFor(operations, CompleteEditOperation);
  command.add_option("-o,--output", a->out, "Where to write: .step .iges .brep .json")
      ->required()
      ->type_name("OUT");
  AddGeometryFormatFlag(
      command,
      a->format,
      "Format of GEOMETRY where its name does not tell, or of '-': json step iges brep");
  AddOutputFormatFlag(command, a->out_format);
  AddGeometryOutput(command, a->output);
  AddSewFlag(command, a->output);
  AddCommonFlags(command, a->flags);
  command.footer(
      "Operations are written name:key=value,key=value; lists are separated by ';' or ','. On\n"
      "surfaces say dir=u or dir=v where a direction is meant; 'u' is another name of 'at'.\n" +
      EditOperationsHelp() +
      "After split, decompose or cut the pieces of NAME.json are NAME-1.json, NAME-2.json, ..., "
      "and\n"
      "what follows is done to each; cut with keep=above or below, and trim, write all pieces "
      "into\n"
      "OUT. Files appear all or none. Exit code 3 says that a removal or\n"
      "reduction could not go as far as asked within its tolerance; what it could is written.\n"
      "Examples:\n"
      "  batten edit curve.json -o finer.json insert-knot:at=0.3,times=2 elevate:by=1\n"
      "  batten edit part.step -o half.json split:dir=u,at=0.5\n"
      "  batten edit part.json -o moved.step rotate:axis=0,0,1,angle=90 translate:10,0,0\n"
      "  batten edit part.json -o lighter.json remove-knot:dir=v,at=0.5,tolerance=0.01\n"
      "  batten edit part.json -o edge.json iso:dir=u,at=0\n"
      "  batten edit part.json -o longer.json extend:dir=u,end=upper,by=5\n"
      "  batten edit part.json -o dented.json move:at=0.2,0.3,0.7,0.6,to=1,2,3,4,5,6\n"
      "  batten edit part.json -o domed.json warp:region=0.2,0.8,0.2,0.8,by=0,0,5\n"
      "  batten edit part.json -o rolled.json bend:from=5,0,0,center=0,0,0,length=6\n"
      "  batten edit part.json -o half.step cut:plane=0,0,1,25,keep=below\n"
      "  batten edit part.json -o holed.json trim:curve=hole.json,keep=outside\n"
      "  batten edit line.json -o outline.step unify:with=arc.json\n"
      "  batten edit curve.json -o powers.json to-power");
  command.callback([a, &action] { action = [a] { return RunEdit(*a); }; });
}

}  // namespace batten::internal
