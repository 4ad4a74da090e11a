// SPDX-License-Identifier: MIT
#include "io/exchange/json_splines.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "geometry/editing/control_forms.h"

namespace batten::internal {
namespace {

using Field = JsonField;
using Kind = JsonValue::Kind;

constexpr double kLargestCoordinate = 1e150;

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

}  // namespace

Eigen::Matrix2Xd ReadJsonPoints(const JsonField& entry) { return ReadPoints<2>(entry, -1); }

NurbsSurface ReadJsonSurface(const Field& entry) {
  if (entry.Has("dimension")) entry.Member("dimension").Integer(3, 3);
  const int size_u = entry.Member("size_u").Integer(2, 1'000'000'000);
  const int size_v = entry.Member("size_v").Integer(2, 1'000'000'000);
  const Field control_points = entry.Member("control_points");
  const auto periodic = ReadPeriodic(entry, 2);
  SplineBasis basis_u = ReadBasis(entry, "_u", size_u, periodic[0]);
  SplineBasis basis_v = ReadBasis(entry, "_v", size_v, periodic[1]);
  Eigen::Matrix3Xd points = ReadPoints<3>(control_points, std::int64_t{size_u} * size_v);
  Eigen::VectorXd weights = ReadWeights(control_points, points.cols());
  CloseNet(control_points,
           {size_u, DistinctPoints(basis_u)},
           {size_v, DistinctPoints(basis_v)},
           points,
           weights);
  return NurbsSurface(
      std::move(basis_u), std::move(basis_v), std::move(points), std::move(weights));
}

template <int Dim>
NurbsCurve<Dim> ReadJsonCurve(const Field& entry) {
  const Field control_points = entry.Member("control_points");
  auto points = ReadPoints<Dim>(control_points, -1);
  const int size = static_cast<int>(points.cols());
  if (entry.Has("size") && entry.Member("size").Integer(0, 1'000'000'000) != size) {
    entry.Member("size").Fail("is not the number of control points, " + std::to_string(size));
  }
  SplineBasis basis = ReadBasis(entry, "", size, ReadPeriodic(entry, 1)[0]);
  Eigen::VectorXd weights = ReadWeights(control_points, points.cols());
  CloseNet(control_points, {size, DistinctPoints(basis)}, {1, 1}, points, weights);
  return NurbsCurve<Dim>(std::move(basis), std::move(points), std::move(weights));
}

template NurbsCurve<2> ReadJsonCurve(const JsonField&);
template NurbsCurve<3> ReadJsonCurve(const JsonField&);

}  // namespace batten::internal
