// SPDX-License-Identifier: MIT
#include "batten/io/geometry_file.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <memory>

#include "batten/io/atomic_file.h"
#include "batten/io/geometry_json.h"
#include "batten/io/iges_reader.h"
#include "batten/io/iges_writer.h"
#include "batten/io/read_error.h"
#include "batten/io/step_reader.h"
#include "batten/io/step_writer.h"
#include "batten/io/whole_file.h"

namespace batten {
namespace {

enum class Format { kJson, kStep, kIges };

// From the format word, or else the extension.
Format FormatOf(const std::string& path, const std::string& word) {
  std::string name = word;
  if (word.empty()) {
    if (path == "-") throw UsageError("-: a format (json, step or iges) must be named");
    const std::string extension = std::filesystem::path(path).extension().string();
    if (extension.size() > 1) name = extension.substr(1);
  }
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) {
    return static_cast<char>(std::tolower(c));
  });
  if (name == "json") return Format::kJson;
  if (name == "step" || name == "stp") return Format::kStep;
  if (name == "iges" || name == "igs") return Format::kIges;
  const std::string what =
      word.empty() ? (name.empty() ? "a name without an extension" : "the extension ." + name)
                   : "the format \"" + word + "\"";
  throw UsageError(path + ": " + what + " is not one of geometry; use .json, .step or .iges");
}

}  // namespace

std::vector<Geometry> ReadGeometry(const std::string& path, const GeometryReadOptions& options) {
  switch (FormatOf(path, options.format)) {
    case Format::kJson:
      return ParseGeometryJson(ReadWholeFile(path), path == "-" ? "standard input" : path);
    case Format::kStep:
      return ReadStep(path);
    case Format::kIges:
      return ReadIges(path);
  }
  return {};
}

void CheckGeometryFormat(const std::string& path, const std::string& format) {
  FormatOf(path, format);
}

void WriteGeometry(const std::vector<Geometry>& geometry,
                   const std::string& path,
                   const GeometryWriteOptions& options) {
  switch (FormatOf(path, options.format)) {
    case Format::kJson: {
      const std::string text = ToGeometryJson(geometry);
      AtomicFile file(path);
      file.Write(text);
      file.Commit();
      return;
    }
    case Format::kStep:
      return WriteStep(geometry, path, options.unit);
    case Format::kIges:
      return WriteIges(geometry, path, options.unit);
  }
}

void WriteGeometryFiles(const std::vector<GeometryFile>& files,
                        const GeometryWriteOptions& options) {
  if (files.size() == 1) return WriteGeometry(files[0].geometry, files[0].path, options);
  // Each is written whole under its temporary name; what is left for the end are renames.
  std::vector<std::unique_ptr<AtomicFile>> targets;
  for (const GeometryFile& file : files) {
    const AtomicFile& target = *targets.emplace_back(std::make_unique<AtomicFile>(file.path));
    const std::string& temporary = target.temporary_path();
    if (temporary.empty()) throw WriteError(file.path, "is not a file that can be replaced");
    try {
      WriteGeometry(file.geometry, temporary, options);
    } catch (const WriteError& error) {
      const std::string what = error.what(), prefix = temporary + ": ";
      throw WriteError(file.path, what.substr(what.find(prefix) == 0 ? prefix.size() : 0));
    }
  }
  for (const auto& target : targets) target->Commit();
}

}  // namespace batten
