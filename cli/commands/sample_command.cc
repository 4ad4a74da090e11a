// SPDX-License-Identifier: MIT
// batten sample: points measured, as it were, from a geometry.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "batten/fitting/sample_geometry.h"
#include "batten/io/file_format.h"
#include "batten/io/geometry_file.h"
#include "batten/io/read_error.h"
#include "batten/io/write_cloud.h"
#include "cli/arguments/cloud_arguments.h"
#include "cli/arguments/fit_output.h"
#include "cli/commands/commands.h"
#include "cli/terminal/cli11.h"
#include "cli/terminal/common_flags.h"
#include "cli/terminal/exit_codes.h"
#include "cli/terminal/offered_words.h"
#include "cli/terminal/parse_values.h"
#include "cli/terminal/streams.h"
#include "cli/terminal/terminal.h"
#include "cli/terminal/written_format.h"

namespace batten::internal {
namespace {

struct SampleArguments {
  std::string geometry, out, format, out_format;
  SampleOptions sample;
  CommonFlags flags;
};

int RunSample(const SampleArguments& a) {
  const bool word_is_geometry = NamesGeometry(a.format);
  const std::string out_format = !a.out_format.empty() ? a.out_format
                                 : word_is_geometry    ? ""
                                                       : a.format;
  const char* const written = "points are written as .ply .pcd .xyz .csv";
  const FileFormat format = WrittenFormat(a.out, out_format, written);
  if (!IsCloudFormat(format) || !IsWritable(format))
    throw UsageError("-o " + a.out + ": " + written);
  if (!word_is_geometry && !a.format.empty() && !a.out_format.empty() && a.format != a.out_format) {
    throw UsageError("--format " + a.format + " and --output-format " + a.out_format +
                     " are both of the points");
  }
  CheckDistinct({a.out}, a.flags.json, {a.geometry});
  CheckWritable(a.out);
  BeginReading({a.geometry}, a.flags.quiet);
  const std::vector<Geometry> geometry =
      ReadGeometry(a.geometry, {word_is_geometry ? a.format : ""});
  if (geometry.size() != 1) {
    throw ReadError(a.geometry,
                    "holds " + std::to_string(geometry.size()) + " geometries; one can be sampled");
  }
  const PointCloud cloud = std::visit(
      [&](const auto& shape) { return SampleGeometry(shape, a.sample); }, geometry.front());
  WriteCloud(cloud, a.out, out_format);
  ClearProgress();
  if (a.flags.json) {
    const nlohmann::ordered_json file{{"path", a.out}, {"kind", "cloud"}, {"points", cloud.size()}};
    PrintFiles(file);
  } else if (!a.flags.quiet && a.out != "-") {
    PrintResult(fmt::format("{}: {} points", a.out, cloud.size()));
  }
  return kDone;
}

}  // namespace

void AddSampleCommand(CLI::App& app, Action& action) {
  auto a = std::make_shared<SampleArguments>();
  CLI::App& command = *app.add_subcommand(
      "sample", "Scatter points over a curve or surface, with noise and outliers");
  command.add_option("GEOMETRY", a->geometry, "A curve or surface: .json .step .iges .brep")
      ->required();
  command.add_option("-o,--output", a->out, "Where to write: .ply .pcd .xyz .csv")
      ->required()
      ->type_name("CLOUD");
  constexpr std::uint64_t kMostPoints = 1000000000;
  const auto add_number = [&command](
                              const std::string& flag, const std::string& what, auto&& take) {
    return command.add_option_function<std::string>(flag, take, what);
  };
  add_number("--count",
             "Number of points",
             [a](const std::string& text) {
               a->sample.count =
                   static_cast<Eigen::Index>(ParseWhole("--count", text, 1, kMostPoints));
             })
      ->required()
      ->type_name("N");
  add_number("--noise",
             "Standard deviation in every coordinate",
             [a](const std::string& text) {
               a->sample.noise = ParseNumber("--noise", text, Sign::kNotNegative);
             })
      ->default_str("0")
      ->type_name("S");
  add_number("--outliers",
             "Fraction of points put anywhere in the bounding box",
             [a](const std::string& text) {
               a->sample.outliers = ParseNumber("--outliers", text, Sign::kNotNegative);
               if (a->sample.outliers > 1)
                 throw UsageError("--outliers: '" + text + "' is not a fraction from 0 to 1");
             })
      ->default_str("0")
      ->type_name("F");
  AddSeedFlag(command, a->sample.seed, "Same seed, same points");
  command.add_option("--format", a->format, "Format of files whose name does not tell, or of '-'")
      ->type_name("FORMAT");
  Suggest(*command
               .add_option("--output-format",
                           a->out_format,
                           "Format of the points where --format is that of GEOMETRY")
               ->type_name("FORMAT"),
          {"ply", "pcd", "xyz", "csv"});
  AddCommonFlags(command, a->flags);
  command.footer(
      "Examples:\n  batten sample part.step -o cloud.ply --count 20000 --noise 0.01 --outliers "
      "0.02 --seed 7");
  command.callback([a, &action] { action = [a] { return RunSample(*a); }; });
}

}  // namespace batten::internal
