// SPDX-License-Identifier: MIT
#include "batten/io/geometry_json.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "batten/geometry/trim_loops.h"
#include "batten/io/length_unit.h"
#include "batten/io/read_error.h"
#include "io/base/json_document.h"
#include "io/base/json_field.h"
#include "io/exchange/geometry_names.h"
#include "io/exchange/json_numbers.h"
#include "io/exchange/json_powers.h"
#include "io/exchange/json_splines.h"
#include "io/exchange/json_trims.h"

namespace batten {
using namespace internal;
namespace {

using EntryKind = JsonValue::Kind;

const std::vector<std::string_view> kKnownNames = {
    "shape",    "type",     "count",          "data",         "dimension",    "degree",
    "degree_u", "degree_v", "knotvector",     "knotvector_u", "knotvector_v", "size",
    "size_u",   "size_v",   "control_points", "points",       "weights",      "trims",
    "periodic", "name",     "unit",           "reversed",     "form",         "breaks",
    "breaks_u", "breaks_v", "coefficients"};

Geometry ReadEntry(const JsonField& entry, const std::string& shape) {
  entry.Expect(EntryKind::kObject);
  if (entry.Has("type")) {
    const JsonField type = entry.Member("type");
    type.Expect(EntryKind::kText);
    if (type.value().text != "spline") {
      type.Fail("\"" + type.value().text + "\" is not known; \"spline\" is");
    }
  }
  const bool surface = shape == "surface" || (shape == "mixed" && entry.Has("degree_u"));
  try {
    if (IsPower(entry)) return ReadJsonPower(entry, surface);
    if (surface) return ReadTrimmed(entry, ReadJsonSurface(entry));
    if (entry.Member("dimension").Integer(2, 3) == 2) return ReadJsonCurve<2>(entry);
    return ReadJsonCurve<3>(entry);
  } catch (const std::invalid_argument& error) {
    entry.Fail(error.what());
  }
}

// What users call the entry.
std::string NameOf(const JsonField& entry) {
  if (!entry.Has("name") || entry.Member("name").value().kind == EntryKind::kNull) return "";
  const JsonField name = entry.Member("name");
  name.Expect(EntryKind::kText);
  return CleanName(name.value().text);
}

// Of the coordinates; empty where the file does not say.
std::string UnitOf(const JsonField& shape) {
  if (!shape.Has("unit")) return "";
  const JsonField unit = shape.Member("unit");
  unit.Expect(EntryKind::kText);
  try {
    return LengthUnitOf(unit.value().text).name;
  } catch (const UsageError& error) {
    unit.Fail(error.what());
  }
}

// What curves and surfaces have in common: type, rational, dimension, and which directions are
// periodic where one is.
void AppendHead(std::string& text,
                bool rational,
                int dimension,
                const std::vector<bool>& periodic) {
  text += R"({"type": "spline", "rational": )";
  text += rational ? "true" : "false";
  text += R"(, "dimension": )" + std::to_string(dimension);
  if (std::find(periodic.begin(), periodic.end(), true) == periodic.end()) return;
  text += R"(, "periodic": [)";
  for (size_t i = 0; i < periodic.size(); ++i) {
    text += std::string(i > 0 ? ", " : "") + (periodic[i] ? "true" : "false");
  }
  text += ']';
}

void AppendBasis(std::string& text, const SplineBasis& basis, const std::string& suffix) {
  text += ",\n  \"degree" + suffix + "\": " + std::to_string(basis.degree());
  text += ", \"knotvector" + suffix + "\": ";
  AppendList(text, basis.knots());
}

template <typename Points>
void AppendControlPoints(std::string& text, const Points& points, const Eigen::VectorXd& weights) {
  text += ",\n  \"control_points\": {\"points\": [\n   ";
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    if (i > 0) text += ",\n   ";
    AppendList(text, points.col(i));
  }
  text += "],\n   \"weights\": ";
  AppendList(text, weights);
  text += "}}";
}

template <int Dim>
void AppendEntry(std::string& text, const NurbsCurve<Dim>& curve) {
  AppendHead(text, curve.rational(), Dim, {curve.basis().periodic()});
  AppendBasis(text, curve.basis(), "");
  AppendControlPoints(text, curve.control_points(), curve.weights());
}

// NURBS-Python cuts away what is inside a loop, or, where it is `reversed`, what is outside: outer
// loops, which run counter-clockwise, are.
void AppendTrims(std::string& text, const std::vector<NurbsCurve<2>>& loops) {
  text += ",\n  \"trims\": {\"count\": " + std::to_string(loops.size()) + ", \"data\": [";
  for (size_t i = 0; i < loops.size(); ++i) {
    text += i > 0 ? ",\n  " : "\n  ";
    AppendEntry(text, loops[i]);
    const bool outer = SignedArea(loops[i]) > 0;
    text.insert(text.size() - 1, outer ? ", \"reversed\": 1" : ", \"reversed\": 0");
  }
  text += "]}";
}

void AppendEntry(std::string& text, const NurbsSurface& surface) {
  AppendHead(
      text, surface.rational(), 3, {surface.basis_u().periodic(), surface.basis_v().periodic()});
  AppendBasis(text, surface.basis_u(), "_u");
  AppendBasis(text, surface.basis_v(), "_v");
  text += ",\n  \"size_u\": " + std::to_string(surface.size_u());
  text += ", \"size_v\": " + std::to_string(surface.size_v());
  AppendControlPoints(text, surface.control_points(), surface.weights());
  if (surface.trimmed()) {
    text.pop_back();
    AppendTrims(text, surface.trims());
    text += '}';
  }
}

}  // namespace

GeometryContents ParseJsonContents(std::string_view text, const std::string& path) {
  const JsonValue document = ParseJson(text, kKnownNames, path);
  const JsonField shape = JsonField(document, "", path).Member("shape");
  const JsonField type = shape.Member("type");
  type.Expect(EntryKind::kText);
  const std::string& kind = type.value().text;
  if (kind != "curve" && kind != "surface" && kind != "mixed") {
    type.Fail("\"" + kind + "\" is not known; \"curve\", \"surface\" and \"mixed\" are");
  }

  const JsonField data = shape.Member("data");
  GeometryContents contents;
  contents.unit = UnitOf(shape);
  std::vector<Geometry>& result = contents.geometry;
  const auto add = [&](const JsonField& entry) {
    result.push_back(ReadEntry(entry, kind));
    contents.names.push_back(NameOf(entry));
  };
  if (data.value().kind == EntryKind::kObject) {
    add(data);
  } else {
    if (data.value().kind != EntryKind::kNumbers || !data.value().numbers.empty()) {
      data.Expect(EntryKind::kList);
    }
    for (size_t i = 0; i < data.value().items.size(); ++i) {
      add(data.Item(i));
    }
  }
  if (result.empty()) data.Fail("holds no geometry");
  if (shape.Has("count")) {
    const JsonField count = shape.Member("count");
    if (count.Integer(0, 1'000'000'000) != static_cast<int>(result.size())) {
      count.Fail("is not the number of entries in data, " + std::to_string(result.size()));
    }
  }
  return contents;
}

std::vector<Geometry> ParseGeometryJson(std::string_view text, const std::string& path) {
  return ParseJsonContents(text, path).geometry;
}

std::string ToGeometryJson(const std::vector<Geometry>& geometry) {
  return ToGeometryJson(GeometryFile{"", geometry});
}

std::string ToGeometryJson(const GeometryFile& file, const std::string& unit, bool powers) {
  const std::vector<Geometry>& geometry = file.geometry;
  if (geometry.empty()) throw std::invalid_argument("ToGeometryJson: there is no geometry");
  const auto surfaces = std::count_if(geometry.begin(), geometry.end(), [](const Geometry& one) {
    return std::holds_alternative<NurbsSurface>(one);
  });
  const bool all = surfaces == static_cast<std::ptrdiff_t>(geometry.size());
  std::string text = R"({"shape": {"type": ")";
  text += all ? "surface" : surfaces == 0 ? "curve" : "mixed";
  text += "\", \"count\": " + std::to_string(geometry.size());
  if (unit != "mm") text += ", \"unit\": " + ToJsonText(unit);
  text += ", \"data\": [\n ";
  for (size_t i = 0; i < geometry.size(); ++i) {
    if (i > 0) text += ",\n ";
    const size_t begin = text.size();
    if (powers) {
      text += PowerEntry(geometry[i]);
    } else {
      std::visit([&](const auto& one) { AppendEntry(text, one); }, geometry[i]);
    }
    const std::string name = i < file.names.size() ? CleanName(file.names[i]) : "";
    if (!name.empty()) text.insert(begin + 1, "\"name\": " + ToJsonText(name) + ", ");
  }
  text += "]}}\n";
  return text;
}

}  // namespace batten
