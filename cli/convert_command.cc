// SPDX-License-Identifier: MIT
// batten convert: geometry to geometry, cloud to cloud.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "batten/cli/cloud_arguments.h"
#include "batten/cli/fit_output.h"
#include "batten/cli/program.h"
#include "batten/cli/terminal.h"
#include "batten/io/file_format.h"
#include "batten/io/geometry_file.h"
#include "batten/io/read_error.h"
#include "batten/io/write_cloud.h"

namespace batten {
namespace {

struct Arguments {
  std::string in, out, out_format, unit = "mm";
  CloudArguments cloud;
  CommonFlags flags;
};

int Run(const Arguments& a) {
  const FileFormat from = FormatOf(a.in, a.cloud.format);
  const std::string out_format = !a.out_format.empty() ? a.out_format : a.out == "-" ? a.cloud.format : "";
  const FileFormat to = FormatOf(a.out, out_format);
  if (IsCloudFormat(from) != IsCloudFormat(to)) {
    throw UsageError(IsCloudFormat(from)
                         ? a.in + " is a cloud and " + a.out + " geometry: 'batten fit' makes one from the other"
                         : a.in + " is geometry and " + a.out + " a cloud: 'batten sample' makes one from the other");
  }
  if (!IsWritable(to)) throw UsageError(a.out + ": this format can't be written");
  CheckWritable(a.out);
  nlohmann::ordered_json entry{{"path", a.out}};
  if (IsCloudFormat(from)) {
    const CloudFile file = ReadCloud({a.in}, ToReadOptions(a.cloud, a.flags.quiet));
    WriteCloud(file.cloud, a.out, out_format);
    entry["kind"] = "cloud";
    entry["points"] = file.cloud.size();
    entry["non_finite"] = file.non_finite;
  } else {
    const std::vector<Geometry> geometry = ReadGeometry(a.in, {a.cloud.format});
    WriteGeometry(geometry, a.out, {out_format, a.unit});
    entry["kind"] = std::holds_alternative<NurbsSurface>(geometry.front()) ? "surface" : "curve";
    entry["count"] = geometry.size();
  }
  ClearProgress();
  if (a.flags.json) {
    fmt::print("{}\n", nlohmann::ordered_json{{"files", {entry}}}.dump(2));
  } else if (!a.flags.quiet && a.out != "-") {
    fmt::print("{}: {}\n", a.out, entry["kind"].get<std::string>());
  }
  return kDone;
}

}  // namespace

void AddConvertCommand(CLI::App& app, Action& action) {
  auto a = std::make_shared<Arguments>();
  CLI::App& command = *app.add_subcommand("convert", "Turn geometry into geometry, or a cloud into a cloud");
  command.add_option("IN", a->in, "What to read: .json .step, or .pcd .ply .xyz ...")->required();
  command.add_option("OUT", a->out, "What to write: .json .step, or .ply .pcd .xyz .csv")->required();
  command.add_option("--output-format", a->out_format, "Format of OUT where its name does not tell");
  command.add_option("--unit", a->unit, "Unit of the data, declared in STEP")->capture_default_str()->type_name("UNIT");
  AddCloudArguments(command, a->cloud);
  AddCommonFlags(command, a->flags);
  command.footer(
      "Examples:\n"
      "  batten convert part.json part.step --unit mm\n"
      "  batten convert scan.pcd scan.ply --box 0,0,0,10,10,10\n"
      "  batten convert ground.txt ground.csv --columns x=2,y=3,z=4 --where label=1");
  command.callback([a, &action] { action = [a] { return Run(*a); }; });
}

}  // namespace batten
