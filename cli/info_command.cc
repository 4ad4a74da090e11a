// SPDX-License-Identifier: MIT
// batten info: what a file holds.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "batten/cli/cloud_arguments.h"
#include "batten/cli/geometry_summary.h"
#include "batten/cli/program.h"
#include "batten/cli/terminal.h"
#include "batten/fitting/cloud_statistics.h"
#include "batten/geometry/classify_shape.h"
#include "batten/io/file_format.h"
#include "batten/io/geometry_file.h"

namespace batten {
namespace {

using Json = nlohmann::ordered_json;

struct Arguments {
  std::string path;
  CloudArguments cloud;
  CommonFlags flags;
  WorkFlags work;
};

Json ToJson(const Eigen::Vector3d& v) { return Json::array({v[0], v[1], v[2]}); }

Json CloudInfo(const Arguments& a) {
  const CloudFile file = ReadCloud({a.path}, ToReadOptions(a.cloud, a.flags.quiet));
  const PointCloud& cloud = file.cloud;
  const MergedCloud merged = MergeDuplicates(cloud);
  ThreadPool pool(a.work.threads);
  CloudStatisticsOptions options;
  options.seed = a.work.seed;
  const CloudStatistics statistics = MeasureCloud(merged.cloud.points(),
                                                  NeighbourIndex(merged.cloud.points()),
                                                  options,
                                                  pool,
                                                  MakeProgress(a.flags.quiet));
  Json info;
  info["kind"] = "cloud";
  info["points"] = file.points_in_file - file.filtered;
  info["non_finite"] = file.non_finite;
  info["duplicates"] = merged.duplicates;
  info["fields"] = file.fields;
  info["bounding_box"] =
      Json::array({ToJson(cloud.origin() + cloud.points().rowwise().minCoeff()),
                   ToJson(cloud.origin() + cloud.points().rowwise().maxCoeff())});
  info["origin"] = ToJson(cloud.origin());
  info["spacing"] = statistics.spacing;
  info["noise"] = statistics.noise;
  info["outliers"] = statistics.outlier_count;
  return info;
}

int Run(const Arguments& a) {
  Json info;
  if (IsGeometryFormat(FormatOf(a.path, a.cloud.format))) {
    info = SummaryOf(ReadGeometryContents(a.path, {a.cloud.format}), ClassifyOptions().tolerance);
  } else {
    info = CloudInfo(a);
  }
  ClearProgress();
  if (a.flags.json) {
    fmt::print("{}\n", JsonText(info, 2));
  } else if (!a.flags.quiet) {
    PrintAligned(info);
  }
  return kDone;
}

}  // namespace

void AddInfoCommand(CLI::App& app, Action& action) {
  auto a = std::make_shared<Arguments>();
  CLI::App& command = *app.add_subcommand("info", "Say what a cloud or geometry file holds");
  command.add_option("FILE", a->path, "A cloud (.pcd .ply .xyz ...) or geometry (.json .step)")
      ->required();
  AddCloudArguments(command, a->cloud);
  AddWorkFlags(command, a->work);
  AddCommonFlags(command, a->flags);
  command.footer(
      "Examples:\n  batten info scan.pcd\n  batten info ground.xyz --where label=1 --json\n  "
      "batten info part.step");
  command.callback([a, &action] { action = [a] { return Run(*a); }; });
}

}  // namespace batten
