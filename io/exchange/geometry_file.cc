// SPDX-License-Identifier: MIT
#include "batten/io/geometry_file.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <utility>

#include "batten/io/atomic_file.h"
#include "batten/io/brep_reader.h"
#include "batten/io/brep_writer.h"
#include "batten/io/geometry_json.h"
#include "batten/io/iges_reader.h"
#include "batten/io/iges_writer.h"
#include "batten/io/length_unit.h"
#include "batten/io/read_error.h"
#include "batten/io/step_reader.h"
#include "batten/io/step_writer.h"
#include "io/base/whole_file.h"
#include "io/exchange/opencascade_functions.h"

namespace batten {
using namespace internal;
namespace {

constexpr const char* kPowerJson = "json-power";  // geometry_json.h

enum class Format { kJson, kStep, kIges, kBrep };

// From the format word, or else the extension.
Format FormatOf(const std::string& path, const std::string& word) {
  std::string name = word;
  if (word.empty()) {
    if (path == "-") throw UsageError("-: a format (json, step, iges or brep) must be named");
    const std::string extension = std::filesystem::path(path).extension().string();
    if (extension.size() > 1) name = extension.substr(1);
  }
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) {
    return static_cast<char>(std::tolower(c));
  });
  if (name == "json" || name == kPowerJson) return Format::kJson;
  if (name == "step" || name == "stp") return Format::kStep;
  if (name == "iges" || name == "igs") return Format::kIges;
  if (name == "brep" || name == "brp" || name == "rle") return Format::kBrep;
  const std::string what =
      word.empty() ? (name.empty() ? "a name without an extension" : "the extension ." + name)
                   : "the format \"" + word + "\"";
  throw UsageError(path + ": " + what +
                   " is not one of geometry; use .json, .step, .iges or .brep");
}

GeometryContents ReadAny(const std::string& path, Format format) {
  switch (format) {
    case Format::kJson:
      return ParseJsonContents(ReadWholeFile(path), path == "-" ? "standard input" : path);
    case Format::kStep:
      return ReadStepContents(path);
    case Format::kIges:
      return ReadIgesContents(path);
    case Format::kBrep:
      return ReadBrepContents(path);
  }
  return {};
}

Geometry Scaled(const NurbsSurface& surface, double times, double over) {
  return NurbsSurface(surface.basis_u(),
                      surface.basis_v(),
                      surface.control_points() * times / over,
                      surface.weights())
      .WithTrims(surface.trims());
}
template <int Dim>
Geometry Scaled(const NurbsCurve<Dim>& curve, double times, double over) {
  return NurbsCurve<Dim>(curve.basis(), curve.control_points() * times / over, curve.weights());
}

// Either factor is 1, so that a coordinate is rounded once, and not at all from m to mm.
void ChangeUnit(GeometryContents& contents, const std::string& unit) {
  if (contents.unit.empty()) {
    contents.unit = unit;
    return;
  }
  const double from = LengthUnitOf(contents.unit).millimetres;
  const double to = LengthUnitOf(unit).millimetres;
  contents.unit = unit;
  if (from == to) return;
  const double times = from > to ? from / to : 1, over = from > to ? 1 : to / from;
  for (Geometry& one : contents.geometry) {
    one = std::visit([&](const auto& shape) { return Scaled(shape, times, over); }, one);
  }
  contents.shapes.times *= times;
  contents.shapes.over *= over;
  for (GeometryBody& body : contents.bodies) {
    body.tolerance *= times / over;
    for (FreeEdge& edge : body.free_edges) {
      edge.from *= times / over;
      edge.to *= times / over;
    }
  }
}

}  // namespace

GeometryContents ReadGeometryContents(const std::string& path, const GeometryReadOptions& options) {
  for (const std::string& unit : {options.unit, options.undeclared}) {
    if (!unit.empty()) LengthUnitOf(unit);
  }
  GeometryContents contents = ReadAny(path, FormatOf(path, options.format));
  if (options.strict && !contents.unread.empty()) throw ReadError(path, contents.unread[0]);
  if (contents.unit.empty()) contents.unit = options.undeclared;
  if (!options.unit.empty()) ChangeUnit(contents, options.unit);
  return contents;
}

std::vector<Geometry> ReadGeometry(const std::string& path, const GeometryReadOptions& options) {
  GeometryReadOptions all = options;
  all.strict = true;
  return ReadGeometryContents(path, all).geometry;
}

std::vector<BodyMeasures> MeasureBodies(const GeometryContents& contents) {
  if (!contents.shapes.held) return {};
  return OpenCascade().measure_bodies(contents.shapes);
}

void CheckGeometryFormat(const std::string& path, const std::string& format) {
  FormatOf(path, format);
}

void WriteGeometry(const std::vector<Geometry>& geometry,
                   const std::string& path,
                   const GeometryWriteOptions& options) {
  WriteGeometry(GeometryFile{path, geometry}, options);
}

std::optional<SewingReport> WriteGeometry(const GeometryFile& file,
                                          const GeometryWriteOptions& options) {
  LengthUnitOf(options.unit);
  if (!file.names.empty() && file.names.size() != file.geometry.size()) {
    throw std::invalid_argument("WriteGeometry: there must be a name for every geometry, or none");
  }
  const Format format = FormatOf(file.path, options.format);
  const bool holds_shells = format == Format::kStep || format == Format::kBrep;
  if (options.sew.value_or(0) > 0 && !holds_shells) {
    throw UsageError(file.path + ": only .step and .brep hold surfaces that are sewn together");
  }
  switch (format) {
    case Format::kJson: {
      const std::string text = ToGeometryJson(file, options.unit, options.format == kPowerJson);
      AtomicFile target(file.path);
      target.Write(text);
      target.Commit();
      break;
    }
    case Format::kStep:
      return WriteStep(file, options);
    case Format::kIges:
      WriteIges(file, options);
      break;
    case Format::kBrep:
      return WriteBrep(file, options);
  }
  return std::nullopt;
}

std::vector<std::optional<SewingReport>> WriteGeometryFiles(const std::vector<GeometryFile>& files,
                                                            const GeometryWriteOptions& options) {
  if (files.size() == 1) return {WriteGeometry(files[0], options)};
  std::vector<std::optional<SewingReport>> reports;
  // Each is written whole under its temporary name; what is left for the end are renames.
  std::vector<std::unique_ptr<AtomicFile>> targets;
  for (const GeometryFile& file : files) {
    const AtomicFile& target = *targets.emplace_back(std::make_unique<AtomicFile>(file.path));
    const std::string& temporary = target.temporary_path();
    if (temporary.empty()) throw WriteError(file.path, "is not a file that can be replaced");
    try {
      reports.push_back(
          WriteGeometry({temporary, file.geometry, file.names, file.bodies, file.shapes}, options));
    } catch (const WriteError& error) {
      const std::string what = error.what(), prefix = temporary + ": ";
      throw WriteError(file.path, what.substr(what.find(prefix) == 0 ? prefix.size() : 0));
    }
  }
  for (const auto& target : targets) target->Commit();
  return reports;
}

}  // namespace batten
