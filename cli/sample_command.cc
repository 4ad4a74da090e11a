// SPDX-License-Identifier: MIT
// batten sample: points measured, as it were, from a geometry.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "batten/cli/fit_output.h"
#include "batten/cli/program.h"
#include "batten/fitting/sample_geometry.h"
#include "batten/io/file_format.h"
#include "batten/io/geometry_file.h"
#include "batten/io/read_error.h"
#include "batten/io/write_cloud.h"

namespace batten {
namespace {

struct Arguments {
  std::string geometry, out, format;
  SampleOptions sample;
  CommonFlags flags;
};

int Run(const Arguments& a) {
  const bool word_is_geometry = a.format == "json" || a.format == "step";
  const std::string out_format = word_is_geometry ? "" : a.format;
  if (!IsCloudFormat(FormatOf(a.out, out_format))) throw UsageError("-o " + a.out + ": points are written as .ply .pcd .xyz .csv");
  constexpr Eigen::Index kMostPoints = 1000000000;
  if (a.sample.count < 1 || a.sample.count > kMostPoints) throw UsageError("--count must be from 1 to a thousand million");
  if (!(a.sample.noise >= 0)) throw UsageError("--noise must not be negative");
  if (!(a.sample.outliers >= 0 && a.sample.outliers <= 1)) throw UsageError("--outliers is a fraction from 0 to 1");
  CheckWritable(a.out);
  const std::vector<Geometry> geometry = ReadGeometry(a.geometry, {word_is_geometry ? a.format : ""});
  if (geometry.size() != 1) {
    throw ReadError(a.geometry, "holds " + std::to_string(geometry.size()) + " geometries; one can be sampled");
  }
  const PointCloud cloud =
      std::visit([&](const auto& shape) { return SampleGeometry(shape, a.sample); }, geometry.front());
  WriteCloud(cloud, a.out, out_format);
  if (a.flags.json) {
    const nlohmann::ordered_json file{{"path", a.out}, {"kind", "cloud"}, {"points", cloud.size()}};
    fmt::print("{}\n", nlohmann::ordered_json{{"files", {file}}}.dump(2));
  } else if (!a.flags.quiet && a.out != "-") {
    fmt::print("{}: {} points\n", a.out, cloud.size());
  }
  return kDone;
}

}  // namespace

void AddSampleCommand(CLI::App& app, Action& action) {
  auto a = std::make_shared<Arguments>();
  CLI::App& command = *app.add_subcommand("sample", "Scatter points over a curve or surface, with noise and outliers");
  command.add_option("GEOMETRY", a->geometry, "A curve or surface: .json .step")->required();
  command.add_option("-o,--output", a->out, "Where to write: .ply .pcd .xyz .csv")->required()->type_name("CLOUD");
  command.add_option("--count", a->sample.count, "Number of points")->required()->type_name("N");
  command.add_option("--noise", a->sample.noise, "Standard deviation in every coordinate")->capture_default_str()->type_name("S");
  command.add_option("--outliers", a->sample.outliers, "Fraction of points put anywhere in the bounding box")->capture_default_str()
      ->type_name("F");
  command.add_option("--seed", a->sample.seed, "Same seed, same points")->capture_default_str()->type_name("N");
  command.add_option("--format", a->format, "Format of files whose name does not tell, or of '-'")->type_name("FORMAT");
  AddCommonFlags(command, a->flags);
  command.footer("Examples:\n  batten sample part.step -o cloud.ply --count 20000 --noise 0.01 --outliers 0.02 --seed 7");
  command.callback([a, &action] { action = [a] { return Run(*a); }; });
}

}  // namespace batten
