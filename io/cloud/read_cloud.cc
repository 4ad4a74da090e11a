// SPDX-License-Identifier: MIT
#include "batten/io/read_cloud.h"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

#include "batten/io/file_format.h"
#include "batten/io/read_error.h"
#include "io/cloud/cloud_filter.h"
#include "io/cloud/glb_vertices.h"
#include "io/cloud/las_reader.h"
#include "io/cloud/local_projection.h"
#include "io/cloud/mesh_points.h"
#include "io/cloud/obj_reader.h"
#include "io/cloud/off_reader.h"
#include "io/cloud/pcd_reader.h"
#include "io/cloud/ply_reader.h"
#include "io/cloud/read_part.h"
#include "io/cloud/stl_reader.h"
#include "io/cloud/text_reader.h"

namespace batten {
using namespace internal;
namespace {

FileCloud ReadBody(ByteSource& source, FileFormat format, const CloudReadOptions& options) {
  switch (format) {
    case FileFormat::kPcd:
      return ReadPcd(source, options);
    case FileFormat::kPly:
      return ReadPly(source, options);
    case FileFormat::kLas:
      return ReadLas(source, options);
    case FileFormat::kObj:
      return ReadObj(source, options);
    case FileFormat::kStl:
      return ReadStl(source, options);
    case FileFormat::kOff:
      return ReadOff(source, options);
    case FileFormat::kGlb:
      return ReadGlb(source, options);
    default:
      return ReadText(source, options);
  }
}

}  // namespace

FileCloud internal::ReadPart(const std::string& path,
                             FileFormat format,
                             const CloudReadOptions& options,
                             std::function<void(double)> progress) {
  ByteSource source(path, std::move(progress));
  if (source.Peek(1).empty()) throw ReadError(source.name(), "is empty");
  FileCloud part = ReadBody(source, format, options);
  if (part.rows == 0) throw ReadError(source.name(), "holds no usable point: it has no rows");
  return part;
}

std::vector<FileFormat> internal::CloudFormats(const std::vector<std::string>& paths,
                                               const CloudReadOptions& options) {
  std::vector<FileFormat> formats;
  for (const std::string& path : paths) {
    formats.push_back(InputFormat(path, options.format));
    if (!IsCloudFormat(formats.back())) {
      throw UsageError(path + ": a " + FormatName(formats.back()) +
                       " file holds geometry, not points");
    }
    if (!options.las_classes.empty() && formats.back() != FileFormat::kLas) {
      throw UsageError(path + ": only LAS files have LAS classes; --where keeps rows of others");
    }
  }
  return formats;
}

CloudFile ReadCloud(const std::vector<std::string>& paths, const CloudReadOptions& options) {
  if (paths.empty()) throw std::invalid_argument("ReadCloud: paths must not be empty");
  const std::vector<FileFormat> formats = CloudFormats(paths, options);
  CloudFile file;
  Eigen::Index matched = 0, kept = 0;
  std::vector<FileCloud> parts;
  for (std::size_t k = 0; k < paths.size(); ++k) {
    std::function<void(double)> progress;
    if (options.progress) {
      progress = [&, k](double fraction) {
        options.progress((static_cast<double>(k) + fraction) / static_cast<double>(paths.size()));
      };
    }
    parts.push_back(ReadPart(paths[k], formats[k], options, std::move(progress)));
    for (const Eigen::Index at : parts.back().missing) file.missing.push_back(matched + at);
    matched += parts.back().matched;
    file.points_in_file += parts.back().rows;
    file.non_finite += parts.back().non_finite;
    file.filtered += parts.back().filtered;
    for (const std::string& remark : parts.back().remarks)
      file.remarks.push_back(paths[k] + ": " + remark);
    if (options.take || parts.back().kept() == 0) continue;
    file.blocks.push_back(kept);
    for (const Eigen::Index at : parts.back().blocks)
      if (kept + at > file.blocks.back() && at < parts.back().kept())
        file.blocks.push_back(kept + at);
    kept += parts.back().kept();
  }
  file.fields = parts.front().fields;
  file.scale = parts.front().scale;
  if (file.non_finite + file.filtered == file.points_in_file) {
    throw ReadError(paths.front() == "-" ? "standard input" : paths.front(),
                    fmt::format("{} no usable point ({} rows, {} not finite, {} filtered out)",
                                paths.size() > 1 ? "this and the other files hold" : "holds",
                                file.points_in_file,
                                file.non_finite,
                                file.filtered));
  }
  if (options.take) return file;
  const ProjectedDegrees local = ProjectLocally(options, paths, parts);
  if (!local.remark.empty()) file.remarks.push_back(paths.front() + ": " + local.remark);
  file.projection_middle = local.middle;
  file.cloud = JoinParts(std::move(parts));
  if (options.faces != CloudFaces::kIgnored) TakeFaces(paths, formats, options, file);
  return file;
}

std::optional<InputMesh> MeshIn(const CloudFile& file) {
  if (!file.mesh) return std::nullopt;
  const FaceSurface& faces = file.mesh->faces;
  return InputMesh{.triangles = faces.surface.triangles.cols(),
                   .welded = faces.joined,
                   .open_edges = faces.open_edges,
                   .non_manifold = faces.crowded_edges,
                   .sampled = file.mesh->sampled};
}

}  // namespace batten
