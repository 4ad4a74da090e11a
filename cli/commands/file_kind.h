// SPDX-License-Identifier: MIT
// What a file is taken for where no command says it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "batten/fitting/point_cloud.h"
#include "batten/io/polygon_reader.h"
#include "cli/arguments/cloud_arguments.h"

namespace batten::internal {

// What can be made of a file.
enum class FileUse { kCurve, kSurface, kPrimitive, kParts, kSolid, kInfo };

// The word for it: curve surface primitive parts solid info.
const char* NameOf(FileUse use);
// Throws UsageError listing the words where it is none of them.
FileUse UseNamed(const std::string& word);
// Its command: "fit", "curve".
std::vector<std::string> CommandOf(FileUse use);

struct FileKind {
  FileUse use = FileUse::kSurface;
  std::string why;                 // "200 points along a line"; empty: it could not be looked at
  std::vector<std::string> flags;  // that its command needs to take all there is
  std::string pick;                // of separate objects: which flags take one or each of them
  std::vector<FileUse> others;     // that can be made of it too
};

// Of points: those of the plane are curves. Those in space are one where they follow one another
// along it or lie along a single line, and no surface is nearer to them; or several, in one plane.
// All others are a surface. Of more than some 20 000 points so many, spread over the file, are
// looked at.
FileKind KindOf(const PointCloud& cloud);

// Of a file: geometry by its name, a mesh by whether it closes, a cloud by its points, unless the
// file is too large to be read for that alone. What can't be read is a surface, and its command
// says why.
FileKind KindOf(const std::string& path, const CloudArguments& arguments);

// The faces of a file; none where it holds points alone, or is no file that can be read twice.
// Throws ReadError as ReadPolygons.
PolygonMesh FacesIn(const std::string& path);

// For the end of a refusal by the command of `use`: "; 'batten fit surface scan.xyz' takes ...", as
// the points are; empty where they are taken for what was refused.
std::string OtherCommand(const PointCloud& cloud, FileUse use, const std::string& path);

}  // namespace batten::internal
