// SPDX-License-Identifier: MIT
// Flags that say which columns and rows of a cloud file are wanted.
#pragma once

#include <string>
#include <vector>

#include "batten/io/read_cloud.h"
#include "cli/terminal/cli11_forward.h"

namespace batten::internal {

struct CloudArguments {
  std::string columns, box;
  std::vector<std::string> where;
  std::string las_class;
  std::string projection;
  std::string format;  // for clouds whose name does not tell
};
void AddCloudArguments(CLI::App& command, CloudArguments& arguments);

// --points: what of a mesh counts, faces or vertices.
void AddPointsFlag(CLI::App& command, std::string& points);

// Tells that points on the triangles of a mesh count.
void TellMesh(const CloudFile& file, const std::vector<std::string>& paths, bool quiet);

// The extensions of clouds, for help.
inline constexpr const char* kCloudFormats =
    ".pcd .ply .las .obj .stl .off .glb, text .xyz .txt .csv ...";

// Tells how the points were understood where that is not plain (CloudFile::remarks).
void TellRemarks(const CloudFile& file, bool quiet);

// Throws UsageError where degrees became metres about a middle that the points themselves decided:
// they are to be held against a geometry, which has a place. The message says what to type.
void RequireFixedMiddle(const CloudFile& file,
                        const CloudReadOptions& options,
                        const std::vector<std::string>& paths);

// "a.ply", or "a.ply and 2 others".
std::string JoinedNames(const std::vector<std::string>& paths);

// Whether a format word is one of geometry: it then belongs to the geometry of a command that takes
// both.
bool NamesGeometry(const std::string& word);

// Throws UsageError naming the flag and what is wrong with its value.
CloudReadOptions ToReadOptions(const CloudArguments& arguments, bool quiet);

}  // namespace batten::internal
