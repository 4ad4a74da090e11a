// SPDX-License-Identifier: MIT
#include "batten/io/geometry_json.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "batten/io/json_document.h"
#include "batten/io/read_error.h"

namespace batten {
namespace {

using Kind = JsonValue::Kind;

const std::vector<std::string_view> kKnownNames = {"shape",
                                                   "type",
                                                   "count",
                                                   "data",
                                                   "dimension",
                                                   "degree",
                                                   "degree_u",
                                                   "degree_v",
                                                   "knotvector",
                                                   "knotvector_u",
                                                   "knotvector_v",
                                                   "size",
                                                   "size_u",
                                                   "size_v",
                                                   "control_points",
                                                   "points",
                                                   "weights",
                                                   "trims",
                                                   "periodic"};

constexpr double kLargestCoordinate = 1e150;

// A value with its place in the document, which every message names.
class Field {
 public:
  Field(const JsonValue& value, std::string place, const std::string& path)
      : value_(&value), place_(std::move(place)), path_(&path) {}

  [[noreturn]] void Fail(const std::string& reason) const {
    throw ReadError(*path_, place_ + ": " + reason);
  }

  const JsonValue& value() const { return *value_; }
  bool Has(std::string_view name) const { return value_->Find(name) != nullptr; }

  Field Member(std::string_view name) const {
    Expect(Kind::kObject);
    const std::string place = place_.empty() ? std::string(name) : place_ + '.' + std::string(name);
    const JsonValue* member = value_->Find(name);
    if (!member) throw ReadError(*path_, place + ": is missing");
    return Field(*member, place, *path_);
  }

  Field Item(size_t index) const {
    return Field(value_->items[index], place_ + '[' + std::to_string(index) + ']', *path_);
  }

  void Expect(Kind kind) const {
    if (value_->kind == kind) return;
    const std::string what = Name(value_->kind) + std::string(" instead of ") + Name(kind);
    if (place_.empty()) throw ReadError(*path_, what);
    Fail(what);
  }

  int Integer(int low, int high) const {
    Expect(Kind::kNumber);
    const double number = value_->number;
    if (!(number >= low && number <= high) || number != std::floor(number)) {
      Fail(Text(number) + " is not an integer from " + std::to_string(low) + " to " +
           std::to_string(high));
    }
    return static_cast<int>(number);
  }

  const std::vector<double>& Numbers() const {
    Expect(Kind::kNumbers);
    return value_->numbers;
  }

  static std::string Text(double number) {
    char text[40];
    return std::string(text, std::to_chars(text, text + sizeof text, number).ptr);
  }

 private:
  const JsonValue* value_;
  std::string place_;
  const std::string* path_;
};

// The basis of `size` functions of one direction; `suffix` is "", "_u" or "_v", `periodic` the flag
// that says so.
SplineBasis ReadBasis(const Field& entry,
                      const std::string& suffix,
                      int size,
                      const std::optional<Field>& periodic) {
  const int degree = entry.Member("degree" + suffix).Integer(1, kMaxDegree);
  const Field field = entry.Member("knotvector" + suffix);
  const std::vector<double>& knots = field.Numbers();
  const auto count = static_cast<std::int64_t>(knots.size());
  if (count != std::int64_t{size} + degree + 1) {
    field.Fail(std::to_string(count) + " knots, but " +
               (suffix.empty() ? "the number of control points " : "size" + suffix + " ") +
               std::to_string(size) + " + degree" + suffix + " " + std::to_string(degree) +
               " + 1 = " + std::to_string(std::int64_t{size} + degree + 1) + " are needed");
  }
  for (size_t i = 0; i < knots.size(); ++i) {
    if (!(std::abs(knots[i]) <= kLargestCoordinate)) {
      field.Fail("knot " + std::to_string(i) + " is " + Field::Text(knots[i]) +
                 ", above 1e150 in magnitude");
    }
  }
  try {
    SplineBasis basis(degree, knots);
    if (!periodic) return basis;
    if (basis.clamped()) {
      periodic->Fail("is true, but knotvector" + suffix +
                     " is clamped; the knots of a periodic direction go on past its ends");
    }
    return SplineBasis::Periodic(degree, knots);
  } catch (const std::invalid_argument& error) {
    field.Fail(error.what());
  }
}

// The control points, Dim × n. Throws unless there are `needed` (negative: any number).
template <int Dim>
Eigen::Matrix<double, Dim, Eigen::Dynamic> ReadPoints(const Field& control_points,
                                                      std::int64_t needed) {
  const Field field = control_points.Member("points");
  field.Expect(Kind::kTable);
  const JsonValue& table = field.value();
  if (table.columns != Dim) {
    field.Fail("points of " + std::to_string(table.columns) + " numbers, but the dimension is " +
               std::to_string(Dim));
  }
  if (needed >= 0 && table.rows != needed) {
    field.Fail(std::to_string(table.rows) +
               " points, but size_u x size_v = " + std::to_string(needed) + " are needed");
  }
  for (size_t i = 0; i < table.numbers.size(); ++i) {
    if (!(std::abs(table.numbers[i]) <= kLargestCoordinate)) {
      field.Fail("point " + std::to_string(i / Dim) + " has the coordinate " +
                 Field::Text(table.numbers[i]) + ", above 1e150 in magnitude");
    }
  }
  return Eigen::Map<const Eigen::Matrix<double, Dim, Eigen::Dynamic>>(
      table.numbers.data(), Dim, table.rows);
}

// The weights of `count` control points; none when they are absent.
Eigen::VectorXd ReadWeights(const Field& control_points, Eigen::Index count) {
  if (!control_points.Has("weights")) return {};
  const Field field = control_points.Member("weights");
  const std::vector<double>& weights = field.Numbers();
  if (static_cast<Eigen::Index>(weights.size()) != count) {
    field.Fail(std::to_string(weights.size()) + " weights, but " + std::to_string(count) +
               " control points");
  }
  for (size_t i = 0; i < weights.size(); ++i) {
    if (!(weights[i] > 0 && weights[i] <= kLargestCoordinate)) {
      field.Fail("weight " + std::to_string(i) + " is " + Field::Text(weights[i]) +
                 "; weights are positive and at most 1e150");
    }
  }
  return Eigen::Map<const Eigen::VectorXd>(weights.data(), count);
}

// For each of `count` directions, the flag that says it is periodic; none where it is not.
std::vector<std::optional<Field>> ReadPeriodic(const Field& entry, size_t count) {
  std::vector<std::optional<Field>> flags(count);
  if (!entry.Has("periodic")) return flags;
  const Field field = entry.Member("periodic");
  const JsonValue& value = field.value();
  const bool single = value.kind == Kind::kBoolean && count == 1;
  if (!single && (value.kind != Kind::kList || value.items.size() != count)) {
    field.Fail("must be a list of " + std::to_string(count) + " times true or false");
  }
  for (size_t i = 0; i < count; ++i) {
    const Field flag = single ? field : field.Item(i);
    flag.Expect(Kind::kBoolean);
    if (flag.value().boolean) flags[i] = flag;
  }
  return flags;
}

// After how many control points a direction begins again.
int Round(const SplineBasis& basis) {
  return basis.periodic() ? basis.size() - basis.degree() : basis.size();
}

// Makes the control points of a net of rows × columns repeat exactly after `round_rows` and
// `round_columns` of them. What rounding to decimals explains is forgiven, 1e-12 of the size and a
// few units in the last place; more is refused.
template <typename Points>
void CloseNet(const Field& control_points,
              std::pair<int, int> rows_round,
              std::pair<int, int> columns_round,
              Points& points,
              Eigen::VectorXd& weights) {
  const auto [rows, round_rows] = rows_round;
  const auto [columns, round_columns] = columns_round;
  if (rows == round_rows && columns == round_columns) return;
  constexpr double kForgiven = 1e-12, kRounding = 4 * std::numeric_limits<double>::epsilon();
  const double allowed =
      kForgiven * (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm() +
      kRounding * points.cwiseAbs().maxCoeff();
  const auto fail = [&](const char* name, const char* what, Eigen::Index to, Eigen::Index from) {
    control_points.Member(name).Fail(std::string(what) + ' ' + std::to_string(to) + " must be " +
                                     what + ' ' + std::to_string(from) +
                                     " again, for the shape is said to be periodic");
  };
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const Eigen::Index to = Eigen::Index{i} * columns + j;
      const Eigen::Index from = Eigen::Index{i % round_rows} * columns + j % round_columns;
      if (to == from) continue;
      if (!((points.col(to) - points.col(from)).cwiseAbs().maxCoeff() <= allowed)) {
        fail("points", "point", to, from);
      }
      if (points.col(to) != points.col(from)) points.col(to) = points.col(from).eval();
      if (weights.size() == 0) continue;
      if (!(std::abs(weights[to] - weights[from]) <= kForgiven * weights[from])) {
        fail("weights", "weight", to, from);
      }
      weights[to] = weights[from];
    }
  }
}

void RefuseTrims(const Field& entry) {
  if (!entry.Has("trims")) return;
  const Field trims = entry.Member("trims");
  trims.Expect(Kind::kObject);
  const JsonValue* data = trims.value().Find("data");
  const bool counted = trims.Has("count") && trims.Member("count").Integer(0, 1'000'000'000) > 0;
  const bool listed = data && (!data->items.empty() || !data->numbers.empty() ||
                               data->kind == Kind::kObject || data->kind == Kind::kTable);
  if (counted || listed) trims.Fail("trimmed surfaces are not in this version");
}

NurbsSurface ReadSurface(const Field& entry) {
  if (entry.Has("dimension")) entry.Member("dimension").Integer(3, 3);
  RefuseTrims(entry);
  const int size_u = entry.Member("size_u").Integer(2, 1'000'000'000);
  const int size_v = entry.Member("size_v").Integer(2, 1'000'000'000);
  const Field control_points = entry.Member("control_points");
  const auto periodic = ReadPeriodic(entry, 2);
  SplineBasis basis_u = ReadBasis(entry, "_u", size_u, periodic[0]);
  SplineBasis basis_v = ReadBasis(entry, "_v", size_v, periodic[1]);
  Eigen::Matrix3Xd points = ReadPoints<3>(control_points, std::int64_t{size_u} * size_v);
  Eigen::VectorXd weights = ReadWeights(control_points, points.cols());
  CloseNet(control_points, {size_u, Round(basis_u)}, {size_v, Round(basis_v)}, points, weights);
  return NurbsSurface(
      std::move(basis_u), std::move(basis_v), std::move(points), std::move(weights));
}

template <int Dim>
NurbsCurve<Dim> ReadCurve(const Field& entry) {
  const Field control_points = entry.Member("control_points");
  auto points = ReadPoints<Dim>(control_points, -1);
  const int size = static_cast<int>(points.cols());
  if (entry.Has("size") && entry.Member("size").Integer(0, 1'000'000'000) != size) {
    entry.Member("size").Fail("is not the number of control points, " + std::to_string(size));
  }
  SplineBasis basis = ReadBasis(entry, "", size, ReadPeriodic(entry, 1)[0]);
  Eigen::VectorXd weights = ReadWeights(control_points, points.cols());
  CloseNet(control_points, {size, Round(basis)}, {1, 1}, points, weights);
  return NurbsCurve<Dim>(std::move(basis), std::move(points), std::move(weights));
}

Geometry ReadEntry(const Field& entry, const std::string& shape) {
  entry.Expect(Kind::kObject);
  if (entry.Has("type")) {
    const Field type = entry.Member("type");
    type.Expect(Kind::kText);
    if (type.value().text != "spline") {
      type.Fail("\"" + type.value().text + "\" is not known; \"spline\" is");
    }
  }
  const bool surface = shape == "surface" || (shape == "mixed" && entry.Has("degree_u"));
  try {
    if (surface) return ReadSurface(entry);
    if (entry.Member("dimension").Integer(2, 3) == 2) return ReadCurve<2>(entry);
    return ReadCurve<3>(entry);
  } catch (const std::invalid_argument& error) {
    entry.Fail(error.what());
  }
}

void Append(std::string& text, double number) {
  char digits[40];
  text.append(digits, std::to_chars(digits, digits + sizeof digits, number).ptr);
  if (number == 0 && std::signbit(number)) text += ".0";  // "-0" would be read as the integer 0
}

template <typename Numbers>
void AppendList(std::string& text, const Numbers& numbers) {
  text += '[';
  bool first = true;
  for (const double number : numbers) {
    if (!std::exchange(first, false)) text += ", ";
    Append(text, number);
  }
  text += ']';
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

void AppendEntry(std::string& text, const NurbsSurface& surface) {
  AppendHead(
      text, surface.rational(), 3, {surface.basis_u().periodic(), surface.basis_v().periodic()});
  AppendBasis(text, surface.basis_u(), "_u");
  AppendBasis(text, surface.basis_v(), "_v");
  text += ",\n  \"size_u\": " + std::to_string(surface.size_u());
  text += ", \"size_v\": " + std::to_string(surface.size_v());
  AppendControlPoints(text, surface.control_points(), surface.weights());
}

}  // namespace

std::vector<Geometry> ParseGeometryJson(std::string_view text, const std::string& path) {
  const JsonValue document = ParseJson(text, kKnownNames, path);
  const Field shape = Field(document, "", path).Member("shape");
  const Field type = shape.Member("type");
  type.Expect(Kind::kText);
  const std::string& kind = type.value().text;
  if (kind != "curve" && kind != "surface" && kind != "mixed") {
    type.Fail("\"" + kind + "\" is not known; \"curve\", \"surface\" and \"mixed\" are");
  }

  const Field data = shape.Member("data");
  std::vector<Geometry> result;
  if (data.value().kind == Kind::kObject) {
    result.push_back(ReadEntry(data, kind));
  } else {
    if (data.value().kind != Kind::kNumbers || !data.value().numbers.empty()) {
      data.Expect(Kind::kList);
    }
    for (size_t i = 0; i < data.value().items.size(); ++i) {
      result.push_back(ReadEntry(data.Item(i), kind));
    }
  }
  if (result.empty()) data.Fail("holds no geometry");
  if (shape.Has("count")) {
    const Field count = shape.Member("count");
    if (count.Integer(0, 1'000'000'000) != static_cast<int>(result.size())) {
      count.Fail("is not the number of entries in data, " + std::to_string(result.size()));
    }
  }
  return result;
}

std::string ToGeometryJson(const std::vector<Geometry>& geometry) {
  if (geometry.empty()) throw std::invalid_argument("ToGeometryJson: there is no geometry");
  const auto surfaces = std::count_if(geometry.begin(), geometry.end(), [](const Geometry& one) {
    return std::holds_alternative<NurbsSurface>(one);
  });
  const bool all = surfaces == static_cast<std::ptrdiff_t>(geometry.size());
  std::string text = R"({"shape": {"type": ")";
  text += all ? "surface" : surfaces == 0 ? "curve" : "mixed";
  text += "\", \"count\": " + std::to_string(geometry.size()) + ", \"data\": [\n ";
  for (size_t i = 0; i < geometry.size(); ++i) {
    if (i > 0) text += ",\n ";
    std::visit([&](const auto& one) { AppendEntry(text, one); }, geometry[i]);
  }
  text += "]}}\n";
  return text;
}

}  // namespace batten
