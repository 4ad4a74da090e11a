// SPDX-License-Identifier: MIT
// batten project: the nearest point of a geometry to every point of a cloud.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "batten/fitting/distances.h"
#include "batten/geometry/foot_point.h"
#include "batten/io/geometry_file.h"
#include "batten/io/read_cloud.h"
#include "batten/io/read_error.h"
#include "cli/arguments/cloud_arguments.h"
#include "cli/commands/commands.h"
#include "cli/terminal/cli11.h"
#include "cli/terminal/common_flags.h"
#include "cli/terminal/exit_codes.h"
#include "cli/terminal/terminal.h"
#include "geometry/nurbs/placed_curve.h"

namespace batten::internal {
namespace {

struct ProjectArguments {
  std::string geometry, points;
  CloudArguments cloud;
  CommonFlags flags;
  int threads = 0;
};

// One row of the result. The lower bound certifies the distance: nothing of the geometry is nearer.
struct Foot {
  size_t index = 0;  // of the geometry that is nearest
  int parameters = 0;
  double u = 0, v = 0, distance = 0, lower_bound = 0;
  bool certified = false;
  Eigen::Vector3d point;  // on the geometry
};

Foot ToFoot(const CurveFoot& foot, size_t index) {
  return {index, 1, foot.u, 0, foot.distance, foot.lower_bound, foot.certified, foot.point};
}
Foot ToFoot(const SurfaceFoot& foot, size_t index) {
  return {index, 2, foot.u, foot.v, foot.distance, foot.lower_bound, foot.certified, foot.point};
}

// The shape in the cloud's local coordinates.
template <int Dim>
NurbsCurve<Dim> MovedBack(const NurbsCurve<Dim>& curve, const Eigen::Vector3d& shift) {
  if (shift.isZero(0)) return curve;
  return Translated(curve, shift.head<Dim>());
}
NurbsSurface MovedBack(const NurbsSurface& surface, const Eigen::Vector3d& shift) {
  return shift.isZero(0) ? surface : surface.Translated(shift);
}

// The search structures of every geometry, built once.
class FootPointSet {
 public:
  FootPointSet(const std::vector<Geometry>& geometry, const Eigen::Vector3d& origin) {
    for (const Geometry& one : geometry) {
      std::visit([&](const auto& shape) { Add(MovedBack(shape, -origin)); }, one);
    }
  }

  // For each column the nearest foot of all, with the lowest of all bounds.
  std::vector<Foot> Nearest(const Eigen::Matrix3Xd& points, ThreadPool& pool) const {
    std::vector<Foot> nearest;
    for (size_t g = 0; g < searches_.size(); ++g) {
      std::visit(
          [&](const auto& search) {
            const auto feet = search.Nearest(points, pool);
            if (g == 0) nearest.resize(feet.size());
            for (size_t k = 0; k < feet.size(); ++k) {
              const Foot foot = ToFoot(feet[k], g);
              const double bound =
                  g == 0 ? foot.lower_bound : std::min(nearest[k].lower_bound, foot.lower_bound);
              const bool certified = foot.certified && (g == 0 || nearest[k].certified);
              if (g == 0 || foot.distance < nearest[k].distance) nearest[k] = foot;
              nearest[k].lower_bound = bound;
              nearest[k].certified = certified;
            }
          },
          searches_[g]);
    }
    return nearest;
  }

 private:
  template <int Dim>
  void Add(NurbsCurve<Dim> curve) {
    searches_.emplace_back(CurveFootPoints<Dim>(std::move(curve)));
  }
  void Add(NurbsSurface surface) { searches_.emplace_back(SurfaceFootPoints(std::move(surface))); }

  std::vector<std::variant<CurveFootPoints<2>, CurveFootPoints<3>, SurfaceFootPoints>> searches_;
};

// The dimension that results are in. Points of the plane belong to plane curves; points in space at
// height zero may stand for them.
int Dimension(const ProjectArguments& a,
              const std::vector<Geometry>& geometry,
              const PointCloud& cloud) {
  const auto plane = std::count_if(geometry.begin(), geometry.end(), [](const Geometry& one) {
    return std::holds_alternative<NurbsCurve<2>>(one);
  });
  if (plane == 0) {
    if (cloud.dimension() == 3) return 3;
    throw ReadError(a.points == "-" ? "standard input" : a.points,
                    "holds points of two coordinates, but " + a.geometry +
                        " is geometry in space; three are needed");
  }
  if (plane != static_cast<std::ptrdiff_t>(geometry.size())) {
    throw ReadError(a.geometry, "holds plane curves beside geometry in space");
  }
  for (Eigen::Index k = 0; k < cloud.size(); ++k) {
    if (cloud.World(k).z() == 0) continue;
    throw ReadError(a.points == "-" ? "standard input" : a.points,
                    fmt::format("point {} has z = {}, but {} is a plane curve; two coordinates, or "
                                "z = 0, are needed",
                                k,
                                cloud.World(k).z(),
                                a.geometry));
  }
  return 2;
}

using Text = fmt::memory_buffer;

void AppendList(Text& text, const double* numbers, int count) {
  for (int k = 0; k < count; ++k) {
    fmt::format_to(std::back_inserter(text), "{}{}", k > 0 ? ", " : "[", numbers[k]);
  }
  text.push_back(']');
}

void AppendJson(
    Text& text, const Eigen::Vector3d& point, const Foot& foot, int dimension, bool indexed) {
  const double at[2] = {foot.u, foot.v};
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "{{\"point\": ");
  AppendList(text, point.data(), dimension);
  fmt::format_to(out, ", \"at\": ");
  AppendList(text, at, foot.parameters);
  fmt::format_to(out, ", \"foot\": ");
  AppendList(text, foot.point.data(), dimension);
  fmt::format_to(out,
                 ", \"distance\": {}, \"lower_bound\": {}, \"certified\": {}",
                 foot.distance,
                 foot.lower_bound,
                 foot.certified);
  if (indexed) fmt::format_to(out, ", \"index\": {}", foot.index);
  text.push_back('}');
}

// Aligned columns that begin with a line of names: batten reads them as a cloud again.
class Table {
 public:
  Table(int dimension, int parameters, bool indexed)
      : dimension_(dimension), parameters_(parameters), indexed_(indexed) {}

  void AppendNames(Text& text) const {
    for (int k = 0; k < dimension_; ++k) Append(text, std::string(1, "xyz"[k]));
    for (int k = 0; k < parameters_; ++k) Append(text, std::string(1, "uv"[k]));
    for (int k = 0; k < dimension_; ++k) Append(text, std::string("foot_") + "xyz"[k]);
    for (const char* name : {"distance", "lower_bound"}) Append(text, name);
    if (indexed_) Append(text, "index");
    text.push_back('\n');
  }

  // A curve's row among surfaces' has no v.
  void AppendRow(Text& text, const Eigen::Vector3d& point, const Foot& foot) const {
    for (int k = 0; k < dimension_; ++k) Append(text, point[k]);
    Append(text, foot.u);
    if (parameters_ == 2 && foot.parameters == 2) Append(text, foot.v);
    if (parameters_ == 2 && foot.parameters == 1) Append(text, "nan");
    for (int k = 0; k < dimension_; ++k) Append(text, foot.point[k]);
    Append(text, foot.distance);
    Append(text, foot.lower_bound);
    if (indexed_) Append(text, foot.index);
    text.push_back('\n');
  }

 private:
  template <typename Value>
  static void Append(Text& text, const Value& value) {
    fmt::format_to(std::back_inserter(text), " {:>22}", value);
  }

  int dimension_, parameters_;
  bool indexed_;
};

void Flush(Text& text) {
  std::fwrite(text.data(), 1, text.size(), stdout);
  text.clear();
}

int RunProject(const ProjectArguments& a) {
  const bool word_is_geometry = NamesGeometry(a.cloud.format);
  if (a.geometry == "-" && a.points == "-") {
    throw UsageError("GEOMETRY and POINTS can't both be standard input");
  }
  BeginReading({a.geometry}, a.flags.quiet);
  const std::vector<Geometry> geometry =
      ReadGeometry(a.geometry, {word_is_geometry ? a.cloud.format : ""});
  CloudReadOptions read = ToReadOptions(a.cloud, a.flags.quiet);
  if (word_is_geometry) read.format.clear();
  BeginReading({a.points}, a.flags.quiet);
  const CloudFile file = ReadCloud({a.points}, read);
  RequireFixedMiddle(file, read, {a.points == "-" ? "standard input" : a.points});
  const PointCloud& cloud = file.cloud;
  const int dimension = Dimension(a, geometry, cloud);
  TellRemarks(file, a.flags.quiet);
  if (file.non_finite > 0 && !a.flags.quiet) {
    PrintWarning(fmt::format("{} of {} points are not finite and have no result",
                             file.non_finite,
                             file.points_in_file - file.filtered));
  }

  ThreadPool pool(a.threads);
  const FootPointSet feet(geometry, cloud.origin());
  const bool indexed = geometry.size() > 1;
  const bool surfaces = std::any_of(geometry.begin(), geometry.end(), [](const Geometry& one) {
    return std::holds_alternative<NurbsSurface>(one);
  });
  const Table table(dimension, surfaces ? 2 : 1, indexed);
  const bool printed = a.flags.json || !a.flags.quiet;
  const Progress progress = MakeProgress(a.flags.quiet);
  TellAmount("project", static_cast<double>(cloud.size()), "points", a.flags.quiet);
  Text text;
  Eigen::Index uncertified = 0;
  if (a.flags.json) {
    fmt::format_to(std::back_inserter(text), "{{\"results\": [");
  } else {
    table.AppendNames(text);
  }
  constexpr Eigen::Index kRows = 16384;  // printed at a time
  for (Eigen::Index begin = 0; begin < cloud.size() && printed; begin += kRows) {
    Report(progress, "project", static_cast<double>(begin) / static_cast<double>(cloud.size()));
    const Eigen::Index rows = std::min(kRows, cloud.size() - begin);
    const std::vector<Foot> rows_foot_points =
        feet.Nearest(cloud.points().middleCols(begin, rows), pool);
    for (Eigen::Index k = 0; k < rows; ++k) {
      Foot foot = rows_foot_points[static_cast<size_t>(k)];
      foot.point += cloud.origin();
      if (!foot.certified) ++uncertified;
      const Eigen::Vector3d point = cloud.World(begin + k);
      if (a.flags.json) {
        fmt::format_to(std::back_inserter(text), "{}\n  ", begin + k > 0 ? "," : "");
        AppendJson(text, point, foot, dimension, indexed);
      } else {
        table.AppendRow(text, point, foot);
      }
    }
    ClearProgress();
    Flush(text);
  }
  if (a.flags.json) fmt::format_to(std::back_inserter(text), "\n]}}\n");
  if (printed) Flush(text);
  if (uncertified > 0 && !a.flags.quiet) PrintWarning(UncertifiedText(uncertified));
  return kDone;
}

}  // namespace

void AddProjectCommand(CLI::App& app, Action& action) {
  auto a = std::make_shared<ProjectArguments>();
  CLI::App& command = *app.add_subcommand(
      "project", "Find the nearest point of a curve or surface to every point of a cloud");
  command.add_option("GEOMETRY", a->geometry, "Curves or surfaces: .json .step .iges .brep")
      ->required();
  command
      .add_option("POINTS",
                  a->points,
                  std::string("Points: ") + kCloudFormats + "; two columns for curves of the plane")
      ->required();
  AddCloudArguments(command, a->cloud);
  AddThreadsFlag(command, a->threads);
  AddCommonFlags(command, a->flags);
  command.footer(
      "One row for each point, in order: its parameters on the geometry, the foot point, the\n"
      "distance, and a lower bound that certifies it: no point of the geometry is nearer than "
      "that.\n"
      "Where the bound stays below the distance, \"certified\" is false and a warning counts "
      "them.\n"
      "Of a trimmed surface only the part inside its loops counts.\n"
      "Of several geometries in a file the nearest is taken, and its index given.\n"
      "Examples:\n"
      "  batten project part.step scan.ply\n"
      "  batten project part.json points.csv --json\n"
      "  batten project outline.json flat.xy            a plane curve and points of two columns\n"
      "  cat scan.xyz | batten project part.json - --format text");
  command.callback([a, &action] { action = [a] { return RunProject(*a); }; });
}

}  // namespace batten::internal
