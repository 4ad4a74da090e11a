// SPDX-License-Identifier: MIT
// Curves and surfaces from and to files.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "batten/io/geometry_types.h"

namespace batten {

// Reads a file. STEP and IGES declare a unit, JSON of batten may: coordinates stay in it, or are
// turned into options.unit; those of a file that says none stay as they are, or are taken to be in
// options.undeclared. A unit that is none of length_unit.h becomes mm. The path "-" is standard
// input and needs a format. Throws ReadError for a file that can't be used, UsageError for an
// unknown format, extension or unit.
GeometryContents ReadGeometryContents(const std::string& path,
                                      const GeometryReadOptions& options = {});

// Its curves and surfaces alone, all of them: where one can't be read, the file can't.
std::vector<Geometry> ReadGeometry(const std::string& path,
                                   const GeometryReadOptions& options = {});

// Of the bodies of a STEP, IGES or B-rep file, each in its place among them; none of other files.
// Throws std::runtime_error where OpenCASCADE can't.
std::vector<BodyMeasures> MeasureBodies(const GeometryContents& contents);

// Refuses a path no geometry can be written to for its format. Throws UsageError.
void CheckGeometryFormat(const std::string& path, const std::string& format = "");

// Writes the file whole or not at all. The path "-" is standard output and needs a format. Throws
// WriteError, UsageError, or std::invalid_argument without geometry.
void WriteGeometry(const std::vector<Geometry>& geometry,
                   const std::string& path,
                   const GeometryWriteOptions& options = {});

// The same with names, which every format but B-rep keeps: JSON as "name", STEP as the name of the
// product and of its face or curve, IGES as a name property and, cut to eight characters, as a
// label. STEP and B-rep are sewn as step_writer.h says, and what came of it is returned. Throws
// UsageError where options.sew is above 0 and the format holds no shells.
std::optional<SewingReport> WriteGeometry(const GeometryFile& file,
                                          const GeometryWriteOptions& options = {});

// Writes every file, or none: nothing appears before all are written. What sewing came to, of each.
// Throws as WriteGeometry.
std::vector<std::optional<SewingReport>> WriteGeometryFiles(
    const std::vector<GeometryFile>& files, const GeometryWriteOptions& options = {});

}  // namespace batten
