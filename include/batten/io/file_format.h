// SPDX-License-Identifier: MIT
// Which format a file has, by its name or by a word.
#pragma once

#include <optional>
#include <string>

namespace batten {

enum class FileFormat {
  kPcd,   // .pcd
  kPly,   // .ply
  kText,  // .txt .asc .pts .xy .dat, and .xyzl .xyzi .xyzn .xyzrgb .uvxyz: numbers in rows
  kXyz,   // .xyz: the same
  kCsv,   // .csv: the same; written with commas and a header line
  kLas,   // .las: laser scans; read only
  kObj,   // .obj: the vertices of a mesh; read only
  kStl,   // .stl: the same
  kOff,   // .off: the same
  kGlb,   // .glb: the same, glTF 2.0 in binary form
  kJson,  // .json: geometry
  kStep,  // .step .stp: geometry
  kIges,  // .iges .igs: geometry
  kBrep,  // .brep .brp: geometry, as OpenCASCADE writes its shapes
};

// The format named by the word `format` (pcd, ply, las, obj, stl, off, glb, text, xyz, csv, json,
// step, iges, brep; any case) or, when that is empty, by the extension of the path. Throws
// UsageError saying what to do where the word or extension is unknown or known but not supported,
// and where the path
// "-" comes without a word.
FileFormat FormatOf(const std::string& path, const std::string& format = "");

// The format that the extension of a path stands for, if it is one of those above.
std::optional<FileFormat> FormatOfName(const std::string& path);

// Whether the extension is of a format that is known but not supported.
bool IsUnsupportedName(const std::string& path);

// The word that names the format.
const char* FormatName(FileFormat format);

// What files of the format hold: points, or curves and surfaces. Each is one or the other.
bool IsCloudFormat(FileFormat format);
bool IsGeometryFormat(FileFormat format);

// Rows of numbers as text, whatever the extension.
bool IsTextFormat(FileFormat format);

// What this version reads and writes as points or geometry (meshes: mesh_writer.h).
bool IsReadable(FileFormat format);
bool IsWritable(FileFormat format);

}  // namespace batten
