// SPDX-License-Identifier: MIT
#include "io/exchange/json_powers.h"

#include <cmath>
#include <cstdint>
#include <variant>

#include "batten/geometry/power_form.h"
#include "io/exchange/json_numbers.h"

namespace batten::internal {
namespace {

using Kind = JsonValue::Kind;

// (w·C, w) of `dimension` + 1 rows.
Eigen::MatrixXd ReadCoefficients(const JsonField& entry,
                                 int dimension,
                                 int powers,
                                 bool* rational) {
  const JsonField all = entry.Member("coefficients"), points = all.Member("points");
  points.Expect(Kind::kTable);
  const JsonValue& table = points.value();
  if (table.columns != dimension) {
    points.Fail("coefficients of " + std::to_string(table.columns) +
                " numbers, but the dimension is " + std::to_string(dimension));
  }
  if (table.rows % powers != 0) {
    points.Fail(std::to_string(table.rows) + " coefficients are not a multiple of " +
                std::to_string(powers) + ", the powers of a piece");
  }
  constexpr double kLargest = 1e150;
  for (const double x : table.numbers) {
    if (!(std::abs(x) <= kLargest)) points.Fail("a coefficient is above 1e150 in magnitude");
  }
  Eigen::MatrixXd columns(dimension + 1, table.rows);
  columns.topRows(dimension) =
      Eigen::Map<const Eigen::MatrixXd>(table.numbers.data(), dimension, table.rows);
  *rational = all.Has("weights");
  if (!*rational) {
    for (Eigen::Index k = 0; k < columns.cols(); ++k) columns(dimension, k) = k % powers == 0;
    return columns;
  }
  const std::vector<double>& weights = all.Member("weights").Numbers();
  if (std::ssize(weights) != table.rows) {
    all.Member("weights").Fail(std::to_string(weights.size()) + " weights, but " +
                               std::to_string(table.rows) + " coefficients");
  }
  columns.row(dimension) = Eigen::Map<const Eigen::RowVectorXd>(weights.data(), table.rows);
  return columns;
}

template <int Dim>
Geometry ReadPowerCurve(const JsonField& entry) {
  PowerCurve<Dim> power;
  power.degree = entry.Member("degree").Integer(1, kMaxDegree);
  power.breaks = entry.Member("breaks").Numbers();
  power.coefficients = ReadCoefficients(entry, Dim, power.degree + 1, &power.rational);
  return FromPower(power);
}

Geometry ReadPowerSurface(const JsonField& entry) {
  PowerSurface power;
  power.degree_u = entry.Member("degree_u").Integer(1, kMaxDegree);
  power.degree_v = entry.Member("degree_v").Integer(1, kMaxDegree);
  power.breaks_u = entry.Member("breaks_u").Numbers();
  power.breaks_v = entry.Member("breaks_v").Numbers();
  power.coefficients =
      ReadCoefficients(entry, 3, (power.degree_u + 1) * (power.degree_v + 1), &power.rational);
  return FromPower(power);
}

void AppendCoefficients(std::string& text, const Eigen::MatrixXd& columns, bool rational) {
  const Eigen::Index dimension = columns.rows() - 1;
  text += ",\n  \"coefficients\": {\"points\": [\n   ";
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    if (k > 0) text += ",\n   ";
    AppendList(text, columns.col(k).head(dimension));
  }
  text += "]";
  if (rational) {
    text += ",\n   \"weights\": ";
    AppendList(text, columns.row(dimension));
  }
  text += "}}";
}

std::string Head(bool rational, Eigen::Index dimension) {
  return std::string(R"({"type": "spline", "form": "power", "rational": )") +
         (rational ? "true" : "false") + R"(, "dimension": )" + std::to_string(dimension);
}

void AppendBreaks(std::string& text,
                  const std::string& suffix,
                  int degree,
                  const std::vector<double>& breaks) {
  text +=
      ",\n  \"degree" + suffix + "\": " + std::to_string(degree) + ", \"breaks" + suffix + "\": ";
  AppendList(text, breaks);
}

template <int Dim>
std::string Entry(const NurbsCurve<Dim>& curve) {
  const PowerCurve<Dim> power = ToPower(curve);
  std::string text = Head(power.rational, Dim);
  AppendBreaks(text, "", power.degree, power.breaks);
  AppendCoefficients(text, power.coefficients, power.rational);
  return text;
}

std::string Entry(const NurbsSurface& surface) {
  const PowerSurface power = ToPower(surface);
  std::string text = Head(power.rational, 3);
  AppendBreaks(text, "_u", power.degree_u, power.breaks_u);
  AppendBreaks(text, "_v", power.degree_v, power.breaks_v);
  AppendCoefficients(text, power.coefficients, power.rational);
  return text;
}

}  // namespace

bool IsPower(const JsonField& entry) {
  if (!entry.Has("form")) return false;
  const JsonField form = entry.Member("form");
  form.Expect(Kind::kText);
  if (form.value().text == "power") return true;
  if (form.value().text == "bspline") return false;
  form.Fail("\"" + form.value().text + "\" is not known; \"bspline\" and \"power\" are");
}

Geometry ReadJsonPower(const JsonField& entry, bool surface) {
  if (surface) return ReadPowerSurface(entry);
  if (entry.Member("dimension").Integer(2, 3) == 2) return ReadPowerCurve<2>(entry);
  return ReadPowerCurve<3>(entry);
}

std::string PowerEntry(const Geometry& geometry) {
  return std::visit([](const auto& shape) { return Entry(shape); }, geometry);
}

}  // namespace batten::internal
