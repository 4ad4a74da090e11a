// SPDX-License-Identifier: MIT
// batten info: what a file holds.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "batten/fitting/closed_surface.h"
#include "batten/fitting/cloud_parts.h"
#include "batten/fitting/cloud_statistics.h"
#include "batten/fitting/faceted_solid.h"
#include "batten/geometry/classify_shape.h"
#include "batten/io/file_format.h"
#include "batten/io/geometry_file.h"
#include "batten/io/read_cloud.h"
#include "batten/io/read_error.h"
#include "cli/arguments/cloud_arguments.h"
#include "cli/arguments/geometry_output.h"
#include "cli/arguments/geometry_summary.h"
#include "cli/arguments/short_summary.h"
#include "cli/commands/commands.h"
#include "cli/commands/file_kind.h"
#include "cli/terminal/cli11.h"
#include "cli/terminal/common_flags.h"
#include "cli/terminal/exit_codes.h"
#include "cli/terminal/terminal.h"

namespace batten::internal {
namespace {

using Json = nlohmann::ordered_json;

struct InfoArguments {
  std::vector<std::string> paths;
  CloudArguments cloud;
  CommonFlags flags;
  WorkFlags work;
  GeometryInput input;
  bool all = false;
};

Json ToJson(const Eigen::Vector3d& v) { return Json::array({v[0], v[1], v[2]}); }

Json CloudInfo(const InfoArguments& a) {
  BeginReading(a.paths, a.flags.quiet);
  const CloudFile file = ReadCloud(a.paths, ToReadOptions(a.cloud, a.flags.quiet));
  TellRemarks(file, a.flags.quiet);
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
  if (!file.scale.isZero(0)) info["scale"] = ToJson(file.scale);
  info["bounding_box"] =
      Json::array({ToJson(cloud.origin() + cloud.points().rowwise().minCoeff()),
                   ToJson(cloud.origin() + cloud.points().rowwise().maxCoeff())});
  info["origin"] = ToJson(cloud.origin());
  info["spacing"] = statistics.spacing;
  info["noise"] = statistics.noise;
  info["outliers"] = statistics.outlier_count;
  const CloudParts found = FindCloudParts(cloud, pool);
  info["parts"] = Json::array();
  for (const CloudPart& part : found.parts) {
    info["parts"].push_back({{"points", part.points.size()},
                             {"box", Json::array({ToJson(part.box.min()), ToJson(part.box.max())})},
                             {"share", part.share}});
  }
  info["stray"] = found.stray;
  return info;
}

// The faces of a file that may hold some; nothing for points alone.
Json FacesInfo(const std::string& path) {
  Json info = Json::object();
  try {
    const PolygonMesh mesh = FacesIn(path);
    if (mesh.faces.empty()) return nullptr;
    info["faces"] = mesh.faces.size();
    const ClosedSurface closed = CloseSurface(mesh.vertices, mesh.faces);
    info["closed"] = closed.filled == 0;
    if (closed.filled > 0) info["holes"] = closed.filled;
    info["bodies"] = closed.components;
    info["genus"] = closed.genus;
    info["volume"] = VolumeOf(closed.surface).volume;
  } catch (
      const std::exception& refusal) {  // ReadError, RefusedData: the points count all the same
    info["closed"] = false;
    info["reason"] = refusal.what();
  }
  return info;
}

int RunInfo(const InfoArguments& a) {
  Json info;
  if (IsGeometryFormat(InputFormat(a.paths.front(), a.cloud.format))) {
    if (a.paths.size() > 1) {
      throw UsageError(a.paths.front() + " holds geometry: one such file at a time");
    }
    BeginReading(a.paths, a.flags.quiet);
    const GeometryContents contents =
        ReadGeometryContents(a.paths.front(), {.format = a.cloud.format, .strict = a.input.strict});
    TellUnread(a.paths.front(), contents, a.input, a.flags.quiet);
    info = SummaryOf(contents, ClassifyOptions().tolerance);
  } else {
    info = CloudInfo(a);
    const Json faces = a.paths.size() == 1 ? FacesInfo(a.paths.front()) : Json(nullptr);
    if (!faces.is_null()) info["mesh"] = faces;
  }
  ClearProgress();
  if (a.flags.json) {
    fmt::print("{}\n", JsonText(info, 2));
  } else if (!a.flags.quiet) {
    PrintForPeople(info, a.all);
  }
  return kDone;
}

}  // namespace

void AddInfoCommand(CLI::App& app, Action& action) {
  auto a = std::make_shared<InfoArguments>();
  CLI::App& command = *app.add_subcommand("info", "Say what a cloud or geometry file holds");
  command
      .add_option("FILE",
                  a->paths,
                  std::string("Geometry (.json .step .iges .brep), or a cloud (") + kCloudFormats +
                      "); several are one cloud")
      ->required();
  command.add_flag("--all", a->all, "Print every number, too");
  AddCloudArguments(command, a->cloud);
  AddGeometryInput(command, a->input);
  AddWorkFlags(command, a->work);
  AddCommonFlags(command, a->flags);
  command.footer(
      "A short summary; --all adds every number there is, --json has them all.\n"
      "Examples:\n  batten info scan.pcd\n  batten info ground.xyzl --where label=1 --json\n  "
      "batten info tile_1.las tile_2.las --las-class 2,6\n  "
      "batten info part.step --all");
  command.callback([a, &action] { action = [a] { return RunInfo(*a); }; });
}

}  // namespace batten::internal
