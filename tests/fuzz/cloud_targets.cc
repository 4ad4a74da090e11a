// SPDX-License-Identifier: MIT
// The readers of points. A file is read as a file, as a pipe, and with options.
#include <algorithm>
#include <functional>
#include <optional>

#include "batten/io/read_cloud.h"
#include "batten/io/read_error.h"
#include "fuzz_targets.h"
#include "memory_file.h"

namespace batten::internal {
namespace {

void RequireWhole(const CloudFile& file) {
  const PointCloud& cloud = file.cloud;
  RequireLaw(cloud.size() > 0, "a file that is read holds a point");
  RequireLaw(file.points_in_file == cloud.size() + file.non_finite + file.filtered,
             "every row is kept, not finite or filtered");
  RequireLaw(static_cast<Eigen::Index>(file.missing.size()) == file.non_finite,
             "every row that is not finite has its place");
  RequireLaw(!file.fields.empty(), "a file has fields");
  RequireLaw(std::adjacent_find(file.blocks.begin(), file.blocks.end(), std::greater_equal<>()) ==
                     file.blocks.end() &&
                 !file.blocks.empty() && file.blocks.front() == 0 &&
                 file.blocks.back() < cloud.size(),
             "blocks have points");
  RequireLaw(cloud.points().allFinite() && cloud.origin().allFinite(), "points are finite");
  RequireLaw(cloud.normals().allFinite() && cloud.parameters().allFinite(),
             "normals and parameters are finite");
  RequireLaw(cloud.weights().allFinite() && (cloud.weights().array() > 0).all(),
             "weights are positive");
}

bool Same(const CloudFile& a, const CloudFile& b) {
  return a.points_in_file == b.points_in_file && a.missing == b.missing && a.blocks == b.blocks &&
         a.fields == b.fields && a.cloud.points() == b.cloud.points() &&
         a.cloud.origin() == b.cloud.origin() && a.cloud.normals() == b.cloud.normals() &&
         a.cloud.weights() == b.cloud.weights() && a.cloud.parameters() == b.cloud.parameters() &&
         a.cloud.colours() == b.cloud.colours();
}

// None where the file is refused.
std::optional<CloudFile> Read(const std::string& path, const CloudReadOptions& options) {
  try {
    CloudFile file = ReadCloud({path}, options);
    RequireWhole(file);
    return file;
  } catch (const ReadError&) {
    return std::nullopt;
  }
}

void ReadEveryWay(std::string_view bytes, const std::string& format) {
  const MemoryFile memory(bytes);
  CloudReadOptions usual;
  usual.format = format;
  const std::optional<CloudFile> file = Read(memory.path(), usual);
  if (bytes.size() <= MemoryPipe::kMostBytes) {
    const MemoryPipe pipe(bytes);
    const std::optional<CloudFile> piped = Read(pipe.path(), usual);
    if (file) RequireLaw(piped && Same(*file, *piped), "a pipe gives what the file gives");
  }
  if (!file) return;
  CloudReadOptions chosen = usual;
  chosen.parameters = true;
  chosen.projection = CloudProjection::kLocal;
  chosen.columns = {{"x", "2"}, {"y", "1"}};
  chosen.where = {{file->fields.back(), 1}};
  chosen.box = Eigen::AlignedBox3d(Eigen::Vector3d(-1, -1, -1), Eigen::Vector3d(1, 1, 1));
  try {
    Read(memory.path(), chosen);
  } catch (const UsageError&) {
    return;  // fewer columns than asked for
  }
}

}  // namespace

void FuzzPcd(std::string_view bytes) { ReadEveryWay(bytes, "pcd"); }
void FuzzPly(std::string_view bytes) { ReadEveryWay(bytes, "ply"); }
void FuzzText(std::string_view bytes) { ReadEveryWay(bytes, "text"); }
void FuzzLas(std::string_view bytes) { ReadEveryWay(bytes, "las"); }
void FuzzObj(std::string_view bytes) { ReadEveryWay(bytes, "obj"); }
void FuzzStl(std::string_view bytes) { ReadEveryWay(bytes, "stl"); }
void FuzzOff(std::string_view bytes) { ReadEveryWay(bytes, "off"); }

}  // namespace batten::internal
