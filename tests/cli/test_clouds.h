// SPDX-License-Identifier: MIT
// Clouds made from formulas, and JSON as the program writes it.
#pragma once

#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "run_program.h"

namespace batten::internal {

using Json = nlohmann::json;
using Row = std::vector<double>;

inline std::string Shortest(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

inline std::string ToText(const std::vector<Row>& rows, const std::string& header = "") {
  std::string text = header;
  for (const Row& row : rows) {
    for (std::size_t k = 0; k < row.size(); ++k)
      text.append(k > 0 ? " " : "").append(Shortest(row[k]));
    text += '\n';
  }
  return text;
}

// A wavy sheet over [0, 10] × [0, 6] with normal noise of deviation 0.005. Coordinates are
// multiples of 2⁻²⁰, so that moving them by whole numbers up to 2³² is exact.
inline std::vector<Row> WavySheet(int points, std::uint64_t seed = 1) {
  constexpr double kNoise = 0.005;
  std::mt19937_64 engine(seed);
  const auto uniform = [&] { return static_cast<double>(engine() >> 11) * 0x1p-53; };
  const auto rounded = [](double value) { return std::round(value * 0x1p20) * 0x1p-20; };
  std::vector<Row> rows;
  for (int k = 0; k < points; ++k) {
    const double x = 10 * uniform(), y = 6 * uniform();
    const double normal =
        std::sqrt(-2 * std::log(1 - uniform())) * std::cos(2 * std::numbers::pi * uniform());
    const double z = std::sin(0.7 * x) + 0.5 * std::cos(0.9 * y) + kNoise * normal;
    rows.push_back({rounded(x), rounded(y), rounded(z)});
  }
  return rows;
}

// The one entry of a geometry file.
inline Json Entry(const std::string& geometry_json) {
  return Json::parse(geometry_json)["shape"]["data"][0];
}

// The largest difference of numbers in two JSON values of the same form; infinite where the form
// differs.
inline double Difference(const Json& a, const Json& b) {
  if (a.is_number() && b.is_number()) return std::abs(a.get<double>() - b.get<double>());
  if (a.size() != b.size() || a.is_structured() != b.is_structured()) return HUGE_VAL;
  if (!a.is_structured()) return a == b ? 0 : HUGE_VAL;
  double most = 0;
  for (auto i = a.begin(), j = b.begin(); i != a.end(); ++i, ++j) {
    if (a.is_object() && i.key() != j.key()) return HUGE_VAL;
    most = std::max(most, Difference(*i, *j));
  }
  return most;
}

// A curved patch of degree 2 with unequal weights.
inline const char* const kRationalPatch =
    R"({"shape": {"type": "surface", "count": 1, "data": [{"type": "spline", "rational": true, "dimension": 3,
    "degree_u": 2, "degree_v": 2, "knotvector_u": [0,0,0,1,2,2,2], "knotvector_v": [0,0,0,1,1,1],
    "size_u": 4, "size_v": 3, "control_points": {"points": [[0,0,0],[0,1,1],[0,2,0],[1,0,1],[1,1,2],[1,2,1],
    [2,0,1],[2,1,2],[2,2,1],[3,0,0],[3,1,1],[3,2,0.1]], "weights": [1,0.7,1,1,2,1,0.9,1,1,1,0.7,1]}}]}})";

// The parabola y = x (2 − x).
inline const char* const kParabola =
    R"({"shape": {"type": "curve", "count": 1, "data": [{"type": "spline", "rational": false, "dimension": 2,
    "degree": 2, "knotvector": [0,0,0,1,1,1], "control_points": {"points": [[0,0],[1,2],[2,0]]}}]}})";

}  // namespace batten::internal
