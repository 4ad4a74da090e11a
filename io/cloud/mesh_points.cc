// SPDX-License-Identifier: MIT
#include "io/cloud/mesh_points.h"

#include <filesystem>
#include <system_error>
#include <utility>

#include "batten/fitting/refused_data.h"
#include "batten/geometry/triangle_samples.h"
#include "batten/io/file_format.h"
#include "batten/io/polygon_reader.h"
#include "batten/io/read_error.h"

namespace batten::internal {
namespace {

void Append(const FaceSurface& more, FaceSurface& all) {
  TriangleSurface& to = all.surface;
  const Eigen::Index vertices = to.vertices.cols(), triangles = to.triangles.cols();
  to.vertices.conservativeResize(3, vertices + more.surface.vertices.cols());
  to.vertices.rightCols(more.surface.vertices.cols()) = more.surface.vertices;
  to.triangles.conservativeResize(3, triangles + more.surface.triangles.cols());
  to.triangles.rightCols(more.surface.triangles.cols()) =
      more.surface.triangles.array() + static_cast<int>(vertices);
  all.joined += more.joined;
  all.dropped += more.dropped;
  all.open_edges += more.open_edges;
  all.crowded_edges += more.crowded_edges;
}

bool IsRegular(const std::string& path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path, error);
}

// Formats of meshes alone; PLY may hold points.
bool HoldsFaces(FileFormat format) {
  return format == FileFormat::kObj || format == FileFormat::kStl || format == FileFormat::kOff ||
         format == FileFormat::kGlb;
}

bool VerticesStandFor(const TriangleSurface& surface) {
  return !IsSparse(surface) && !IsMostlyFlat(surface);
}

// Whether points on the triangles count.
bool TrianglesCount(const TriangleSurface& surface, CloudFaces faces) {
  switch (faces) {
    case CloudFaces::kIgnored:
    case CloudFaces::kKept:
      return false;
    case CloudFaces::kMeasured:
      return true;
    case CloudFaces::kFlat:
      return !VerticesStandFor(surface) && ChordHeight(surface) == 0;
    default:
      return !VerticesStandFor(surface);
  }
}

void Append(const TriangleSamples& more, TriangleSamples& all) {
  const Eigen::Index before = all.points.cols(), count = more.points.cols();
  all.points.conservativeResize(3, before + count);
  all.normals.conservativeResize(3, before + count);
  all.triangles.conservativeResize(before + count);
  all.points.rightCols(count) = more.points;
  all.normals.rightCols(count) = more.normals;
  all.triangles.tail(count) = more.triangles;
}

// The samples inside the box, relative to the origin of the cloud.
TriangleSamples SamplesOf(const FaceSurface& faces,
                          const CloudReadOptions& options,
                          const Eigen::Vector3d& origin) {
  TriangleSurface local = faces.surface;
  local.vertices.colwise() -= origin;
  TriangleSamples samples = SamplesBesideVertices(local);
  if (options.faces == CloudFaces::kMeasured) {
    const bool stands = VerticesStandFor(local);
    if (stands) samples = SampleTriangles(local, SampleSpacing(local, local.vertices.cols()));
    if (!stands) Append(MiddlesWithout(local, samples), samples);
  }
  if (!options.box) return samples;
  std::vector<Eigen::Index> kept;
  for (Eigen::Index k = 0; k < samples.points.cols(); ++k) {
    if (options.box->contains(samples.points.col(k) + origin)) kept.push_back(k);
  }
  samples.points = samples.points(Eigen::all, kept).eval();
  samples.normals = samples.normals(Eigen::all, kept).eval();
  return samples;
}

// The cloud and, after its points, the samples. Attributes of no meaning between vertices go.
PointCloud WithSamples(const PointCloud& cloud, const TriangleSamples& samples) {
  Eigen::Matrix3Xd points(3, cloud.size() + samples.points.cols());
  points << cloud.points(), samples.points;
  PointCloud result(std::move(points), cloud.origin());
  if (cloud.normals().cols() > 0) {
    Eigen::Matrix3Xd normals(3, result.size());
    normals << cloud.normals(), samples.normals;
    result.set_normals(std::move(normals));
  }
  return result;
}

}  // namespace

void TakeFaces(const std::vector<std::string>& paths,
               const std::vector<FileFormat>& formats,
               const CloudReadOptions& options,
               CloudFile& file) {
  constexpr const char* kVertices = ": its vertices count, not what lies between them";
  for (std::size_t k = 0; k < paths.size(); ++k) {
    const std::string& path = paths[k];
    const bool named = FormatOfName(path) == formats[k] && IsRegular(path);
    if (!named && HoldsFaces(formats[k]))
      file.remarks.push_back(path + kVertices + " (faces are read from files named .obj .stl ...)");
    if (!named || !MayHoldFaces(path)) continue;
    if (file.projection_middle) {
      file.remarks.push_back(path + kVertices + ", for its degrees became metres");
      return;
    }
    try {
      const PolygonMesh mesh = ReadPolygons(path);
      if (mesh.faces.empty()) continue;
      FaceSurface faces = SurfaceOfFaces(mesh.vertices, mesh.faces);
      if (!file.mesh) {
        file.mesh = CloudMesh{std::move(faces)};
      } else {
        Append(faces, file.mesh->faces);
      }
    } catch (const ReadError& error) {
      file.remarks.push_back(error.what() + std::string(kVertices));
    } catch (const RefusedData& refusal) {
      file.remarks.push_back(path + ": " + refusal.what() + kVertices);
    }
  }
  if (!file.mesh || file.cloud.dimension() != 3 ||
      !TrianglesCount(file.mesh->faces.surface, options.faces))
    return;
  if (!options.where.empty() || !options.columns.empty() || file.cloud.weights().size() > 0 ||
      file.cloud.parameters().cols() > 0) {
    file.remarks.push_back(paths.front() + kVertices +
                           ", for rows are chosen, or have weights or parameters");
    return;
  }
  const TriangleSamples samples = SamplesOf(file.mesh->faces, options, file.cloud.origin());
  if (samples.points.cols() == 0) return;
  file.blocks.push_back(file.cloud.size());
  file.mesh->sampled = samples.points.cols();
  file.points_in_file += samples.points.cols();
  file.cloud = WithSamples(file.cloud, samples);
}

}  // namespace batten::internal
