// SPDX-License-Identifier: MIT
// batten info: what a file holds.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "batten/cli/cloud_arguments.h"
#include "batten/cli/describe_geometry.h"
#include "batten/cli/program.h"
#include "batten/cli/terminal.h"
#include "batten/fitting/cloud_statistics.h"
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

// Names in files need not be UTF-8; what is not becomes the replacement character.
std::string Text(const Json& json, int indent = -1) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

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

// The lowest order of continuity the knots leave at an interior knot; the degree where there is
// none.
int Continuity(const SplineBasis& basis) {
  int continuity = basis.degree();
  for (const double knot : basis.knots()) {
    if (knot > basis.lower() && knot < basis.upper()) {
      continuity = std::min(continuity, basis.degree() - basis.Multiplicity(knot));
    }
  }
  return continuity;
}

Json BasisInfo(const std::vector<const SplineBasis*>& bases, Json info) {
  for (const char* key :
       {"degree", "control_points", "knots", "domain", "periodic", "continuity"}) {
    info[key] = Json::array();
  }
  for (const SplineBasis* basis : bases) {
    info["degree"].push_back(basis->degree());
    info["control_points"].push_back(basis->size());
    info["knots"].push_back(basis->knots());
    info["domain"].push_back({basis->lower(), basis->upper()});
    info["periodic"].push_back(false);
    info["continuity"].push_back(Continuity(*basis));
  }
  return info;
}

Json Measured(const ShapeMeasures& measures, int dimension, const char* size, Json info) {
  const auto corner = [&](const Eigen::Vector3d& at) {
    Json numbers = Json::array();
    for (int d = 0; d < dimension; ++d) numbers.push_back(at[d]);
    return numbers;
  };
  info["bounding_box"] = Json::array({corner(measures.box.min()), corner(measures.box.max())});
  info[size] = measures.size;
  info["curvature"] = nullptr;
  if (measures.curvature_min <= measures.curvature_max) {
    info["curvature"] = {{"min", measures.curvature_min}, {"max", measures.curvature_max}};
  }
  return info;
}

template <int Dim>
Json GeometryInfo(const NurbsCurve<Dim>& curve) {
  Json info = BasisInfo({&curve.basis()}, {{"kind", "curve"}});
  info["rational"] = curve.rational();
  info["closed"] = ClosedDirections(curve);
  return Measured(Measure(curve), Dim, "length", std::move(info));
}

Json GeometryInfo(const NurbsSurface& surface) {
  Json info = BasisInfo({&surface.basis_u(), &surface.basis_v()}, {{"kind", "surface"}});
  info["rational"] = surface.rational();
  info["closed"] = ClosedDirections(surface);
  return Measured(Measure(surface), 3, "area", std::move(info));
}

int Run(const Arguments& a) {
  Json info;
  if (IsGeometryFormat(FormatOf(a.path, a.cloud.format))) {
    const std::vector<Geometry> geometry = ReadGeometry(a.path, {a.cloud.format});
    for (size_t k = 0; k < geometry.size(); ++k) {
      Json one = std::visit([](const auto& shape) { return GeometryInfo(shape); }, geometry[k]);
      if (geometry.size() == 1) {
        info = std::move(one);
      } else {
        one["index"] = k;
        info["results"].push_back(std::move(one));
      }
    }
  } else {
    info = CloudInfo(a);
  }
  ClearProgress();
  if (a.flags.json) {
    fmt::print("{}\n", Text(info, 2));
  } else if (!a.flags.quiet) {
    const Json list = info.contains("results") ? info["results"] : Json::array({info});
    for (const Json& one : list) {
      for (const auto& [key, value] : one.items()) {
        fmt::print("{:<16} {}\n", key, value.is_string() ? value.get<std::string>() : Text(value));
      }
    }
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
