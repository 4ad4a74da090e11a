// SPDX-License-Identifier: MIT
#include "cli/commands/file_kind.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <random>
#include <stdexcept>
#include <system_error>
#include <utility>
#include <vector>

#include "batten/fitting/closed_surface.h"
#include "batten/fitting/cloud_parts.h"
#include "batten/fitting/cloud_statistics.h"
#include "batten/fitting/curve_order.h"
#include "batten/fitting/refused_data.h"
#include "batten/fitting/statistics.h"
#include "batten/io/file_format.h"
#include "batten/io/polygon_reader.h"
#include "batten/io/read_cloud.h"
#include "batten/io/read_error.h"
#include "cli/terminal/shell_words.h"
#include "fitting/core/point_rank.h"
#include "fitting/flattening/poisson_disk_samples.h"
#include "fitting/ordering/curve_sequence.h"
#include "geometry/mesh/point_numbers.h"

namespace batten::internal {
namespace {

constexpr std::array kUses = {FileUse::kCurve,
                              FileUse::kSurface,
                              FileUse::kPrimitive,
                              FileUse::kParts,
                              FileUse::kSolid,
                              FileUse::kInfo};

std::vector<FileUse> AllBut(FileUse use) {
  std::vector<FileUse> others;
  std::copy_if(kUses.begin(), kUses.end(), std::back_inserter(others), [&](FileUse other) {
    return other != use && other != FileUse::kInfo;
  });
  return others;
}

// Of the points: the rest is left out by FitCurve, which then takes the cloud for one curve.
constexpr double kNearlyAll = 0.95;

// At most so many points, one from each of as many stretches of the cloud: at even steps rows of a
// grid would become columns.
PointCloud SpreadSample(const PointCloud& cloud) {
  constexpr Eigen::Index kMost = 20000;  // looked at in 0.3 s
  const Eigen::Index size = cloud.size(), count = std::min(size, kMost);
  if (count == size) return cloud;
  std::mt19937_64 random(1);
  std::vector<Eigen::Index> kept;
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::Index begin = k * size / count, end = (k + 1) * size / count;
    kept.push_back(begin + static_cast<Eigen::Index>(random() % std::uint64_t(end - begin)));
  }
  return cloud.Picked(kept);
}

// Median distance in the file of points that follow one another along the path; the file is a ring.
double StepInFile(const CurvePath& path, Eigen::Index size) {
  std::vector<double> steps;
  for (size_t k = 1; k < path.points.size(); ++k) {
    const Eigen::Index apart = std::abs(path.points[k] - path.points[k - 1]);
    steps.push_back(static_cast<double>(std::min(apart, size - apart)));
  }
  return steps.empty() ? 0 : Median(std::move(steps));
}

// Whether the points are nearer to a surface than to the path. Points of a curve scatter alike in
// all directions across it: both noises are then the same, to a few per cent.
bool ASurfaceIsNearer(double noise_of_surface, const CurvePath& path, const PointCloud& cloud) {
  constexpr Eigen::Index kFewestForNoise = 20;  // CloudStatistics
  return cloud.size() >= kFewestForNoise && PointRank(cloud.points()) == 3 &&
         noise_of_surface < path.noise / 2;
}

// How many lines the points lie along; 0 where they spread over a surface.
size_t LinesOf(const PointCloud& all, ThreadPool& pool) {
  const PointCloud cloud = MergeDuplicates(SpreadSample(all)).cloud;
  const bool in_order = FollowsCurve(cloud.points());
  CurveOrder order;
  try {
    order = OrderAlongCurves(cloud, {}, pool);
  } catch (const std::invalid_argument&) {
    return 0;  // branches, crossings or scatter
  }
  if (!order.evident) return 0;
  const CurvePath& longest = order.paths.front();
  const NeighbourIndex index(cloud.points(), pool);
  CloudStatisticsOptions statistics;
  statistics.find_outliers = false;
  const double noise = MeasureCloud(cloud.points(), index, statistics, pool).noise;
  if (ASurfaceIsNearer(noise, longest, cloud)) return 0;
  const auto share = static_cast<double>(longest.points.size()) / static_cast<double>(cloud.size());
  // Points nearer to one another than their noise need not follow one another in the file.
  const bool blurred = 2 * longest.noise > longest.spacing;
  constexpr double kMost = 0.5;  // others are outliers: FitCurve's
  if (in_order && share >= kMost && (blurred || StepInFile(longest, cloud.size()) <= 1)) return 1;
  if (!SamplePoissonDisk(cloud.points(), index, noise, {}, pool).LieAlongLines()) return 0;
  if (share >= kNearlyAll) return 1;
  // Lines one beside the other are sections of a surface, unless that is a plane.
  return PointRank(cloud.points()) <= 2 ? order.paths.size() : 0;
}

// Curves that `fit curve` tells apart in the plane.
size_t PlaneCurvesOf(const PointCloud& all, ThreadPool& pool) {
  const PointCloud cloud = SpreadSample(all);
  if (FollowsCurve(cloud.points())) return 1;
  try {
    const CurveOrder order = OrderAlongCurves(cloud, {}, pool);
    const bool one = static_cast<double>(order.paths.front().points.size()) >=
                     kNearlyAll * static_cast<double>(cloud.size());
    return one ? 1 : order.paths.size();
  } catch (const std::invalid_argument&) {
    return 1;  // the fit says why
  }
}

std::string Counted(size_t count, const char* one, const char* many) {
  return count == 1 ? std::string("a ") + one : fmt::format("{} {}", count, many);
}

// Whether faces, their corners joined where they are one place, have an edge that no other has.
bool HasOpenEdges(const PolygonMesh& mesh) {
  PointNumbers places;
  std::vector<int> place;
  for (const auto vertex : mesh.vertices.colwise()) place.push_back(places.NumberOf(vertex.data()));
  std::vector<std::pair<int, int>> edges;
  for (const std::vector<int>& face : mesh.faces) {
    for (size_t k = 0; k < face.size(); ++k) {
      edges.push_back(std::minmax({place[static_cast<size_t>(face[k])],
                                   place[static_cast<size_t>(face[(k + 1) % face.size()])]}));
    }
  }
  std::sort(edges.begin(), edges.end());
  for (size_t first = 0, last; first < edges.size(); first = last) {
    for (last = first + 1; last < edges.size() && edges[last] == edges[first];) ++last;
    if (last == first + 1) return true;
  }
  return false;
}

// Holes that a solid would close, and bodies that none can be made of, are told by the fit.
FileKind KindOfMesh(const PolygonMesh& mesh) {
  const std::string faces = fmt::format("mesh of {} faces", mesh.faces.size());
  const FileKind body{FileUse::kSolid, "a closed " + faces, {}, "", AllBut(FileUse::kSolid)};
  try {
    const ClosedSurface closed = CloseSurface(mesh.vertices, mesh.faces);
    FileKind kind = body;
    if (closed.filled > 0) {
      kind.why = fmt::format(
          "a {}, closed but for {:.2g} % of its area", faces, 100 * closed.filled_share);
    } else if (closed.components > 1) {
      kind.why += fmt::format(", {} bodies", closed.components);
    }
    return kind;
  } catch (const RefusedData& refusal) {
    if (refusal.remedy() != Remedy::kLeaveOpen && !HasOpenEdges(mesh)) return body;
  }
  return {FileUse::kSurface, "an open " + faces, {}, "", AllBut(FileUse::kSurface)};
}

// Whether to read a file of this size only to see what it holds.
bool IsSoonRead(const std::string& path) {
  constexpr std::uintmax_t kMost = 8 << 20;  // bytes: some 300 000 rows, read in 0.1 s
  std::error_code error;
  return std::filesystem::file_size(path, error) <= kMost && !error;
}

}  // namespace

PolygonMesh FacesIn(const std::string& path) {
  std::error_code error;
  const bool some = std::filesystem::is_regular_file(path, error) && MayHoldFaces(path);
  return some ? ReadPolygons(path) : PolygonMesh();
}

const char* NameOf(FileUse use) {
  switch (use) {
    case FileUse::kCurve:
      return "curve";
    case FileUse::kSurface:
      return "surface";
    case FileUse::kPrimitive:
      return "primitive";
    case FileUse::kParts:
      return "parts";
    case FileUse::kSolid:
      return "solid";
    case FileUse::kInfo:
      return "info";
  }
  return "";
}

FileUse UseNamed(const std::string& word) {
  std::string words;
  for (const FileUse use : kUses) {
    if (word == NameOf(use)) return use;
    words += std::string(words.empty() ? "" : ", ") + NameOf(use);
  }
  throw UsageError("--as: '" + word + "' is none of " + words);
}

std::vector<std::string> CommandOf(FileUse use) {
  if (use == FileUse::kInfo) return {"info"};
  return {"fit", NameOf(use)};
}

FileKind KindOf(const PointCloud& cloud) {
  ThreadPool pool(0);
  const bool plane = cloud.dimension() == 2;
  const size_t lines = plane ? PlaneCurvesOf(cloud, pool) : LinesOf(cloud, pool);
  FileKind kind;
  kind.why = fmt::format("{} points{}", cloud.size(), plane ? " of the plane" : "");
  if (lines > 0) {
    kind.use = FileUse::kCurve;
    kind.why += " along " + Counted(lines, "line", "lines");
    if (lines > 1) {
      kind.flags = {"--component", "all"};
      kind.pick = "--component K takes one of them";
    }
    kind.others = plane ? std::vector{FileUse::kPrimitive} : AllBut(kind.use);
    return kind;
  }
  kind.others = AllBut(kind.use);
  const size_t parts = FindCloudParts(cloud, pool).parts.size();
  kind.why += parts > 1 ? fmt::format(" over {} separate parts", parts) : " over a surface";
  if (parts > 1) kind.pick = "one surface for all, --part K takes one of them, --part all each";
  return kind;
}

FileKind KindOf(const std::string& path, const CloudArguments& arguments) {
  FileKind unknown;
  unknown.others = AllBut(unknown.use);
  std::error_code error;  // what can't be looked at is not there
  const bool there = std::filesystem::exists(path, error);
  if (IsGeometryFormat(InputFormat(path, arguments.format)))
    return {FileUse::kInfo, there ? "geometry" : "", {}, "", {}};
  // What a pipe gives is read once, by the command.
  const bool regular = std::filesystem::is_regular_file(path, error);
  if (path == "-" || (there && !regular && !std::filesystem::is_directory(path, error))) {
    unknown.why = "points not looked at first";
    return unknown;
  }
  if (!regular) return unknown;  // its command says why
  try {
    if (arguments.format.empty()) {
      const PolygonMesh mesh = FacesIn(path);
      if (!mesh.faces.empty()) return KindOfMesh(mesh);
    }
  } catch (const std::exception&) {  // its points may count nevertheless
  }
  try {
    if (IsSoonRead(path)) return KindOf(ReadCloud({path}, ToReadOptions(arguments, true)).cloud);
    unknown.why = "points not looked at first, for there are many";
  } catch (const std::exception&) {  // its command says why
  }
  return unknown;
}

std::string OtherCommand(const PointCloud& cloud, FileUse use, const std::string& path) {
  constexpr Eigen::Index kFewest = 4;  // that a surface needs
  if (cloud.size() < kFewest) return "";
  const FileKind kind = KindOf(cloud);
  if (kind.use == use) return "";
  std::string command = "batten";
  for (const std::string& word : CommandOf(kind.use)) command += " " + word;
  return "; '" + command + " " + ShellWord(path) + "' takes " + kind.why;
}

}  // namespace batten::internal
