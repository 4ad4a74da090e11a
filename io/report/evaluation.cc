// SPDX-License-Identifier: MIT
#include "io/report/evaluation.h"

#include <fmt/format.h>

#include <variant>

#include "batten/geometry/curvature.h"
#include "batten/geometry/tangent_inversion.h"

namespace batten::internal {
namespace {

using Json = nlohmann::ordered_json;

template <typename Vector>
Json ToJson(const Vector& v) {
  Json array = Json::array();
  for (Eigen::Index k = 0; k < v.size(); ++k) array.push_back(v[k]);
  return array;
}

template <int Dim>
Json Evaluate(const NurbsCurve<Dim>& curve,
              const TrimRegion*,
              const std::vector<double>& at,
              const EvaluationQuestion& question) {
  const int order = question.order;
  const auto derivatives = curve.Derivatives(at[0], order);
  Json result{{"at", at}, {"point", ToJson(derivatives.col(0))}, {"derivatives", Json::array()}};
  for (int k = 0; k <= order; ++k) result["derivatives"].push_back(ToJson(derivatives.col(k)));
  if (order >= 2) {
    result["curvature"] = nullptr;
    if (const auto c = CurvatureAt(curve, at[0])) {
      result["curvature"] = {{"curvature", c->curvature}, {"torsion", c->torsion}};
    }
  }
  return result;
}

Json Evaluate(const NurbsSurface& surface,
              const TrimRegion* region,
              const std::vector<double>& at,
              const EvaluationQuestion& question) {
  const int order = question.order;
  const SurfaceDerivatives derivatives = surface.Derivatives(at[0], at[1], order);
  Json result{{"at", at}, {"point", ToJson(derivatives(0, 0))}};
  if (region != nullptr) result["inside"] = region->Contains(at[0], at[1]);
  result["derivatives"] = Json::array();
  for (int k = 0; k <= order; ++k) {
    Json row = Json::array();
    for (int l = 0; k + l <= order; ++l) row.push_back(ToJson(derivatives(k, l)));
    result["derivatives"].push_back(row);
  }
  const auto normal = surface.NormalAt(at[0], at[1]);
  result["normal"] = normal ? ToJson(*normal) : Json(nullptr);
  if (order >= 2) {
    result["curvature"] = nullptr;
    if (const auto c = CurvatureAt(surface, at[0], at[1])) {
      result["curvature"] = {{"gaussian", c->gaussian},
                             {"mean", c->mean},
                             {"principal", {c->principal_low, c->principal_high}}};
    }
  }
  if (question.along) {
    result["along"] = nullptr;
    if (const auto found = InvertTangent(surface, at[0], at[1], *question.along))
      result["along"] = {{"du", found->du}, {"dv", found->dv}, {"residual", found->residual}};
  }
  return result;
}

// "C", "C'", …, "C^(4)" for a curve's derivatives.
std::string CurveLabel(size_t k) {
  constexpr size_t kPrimes = 3;
  return k <= kPrimes ? "C" + std::string(k, '\'') : fmt::format("C^({})", k);
}

// "S", "S_u", "S_uv", … for a surface's.
std::string SurfaceLabel(size_t k, size_t l) {
  return k + l == 0 ? "S" : "S_" + std::string(k, 'u') + std::string(l, 'v');
}

// A name and its numbers in columns.
void AddRow(const std::string& name, const Json& value, std::string& text) {
  std::string row = fmt::format("{:<14}", name);
  for (const Json& number : value.is_array() ? value : Json::array({value})) {
    row += fmt::format(" {:<22}", number.is_null() ? "none" : number.dump());
  }
  row.erase(row.find_last_not_of(' ') + 1);
  text += row + "\n";
}

}  // namespace

nlohmann::ordered_json Evaluation(const Geometry& geometry,
                                  const TrimRegion* region,
                                  const std::vector<double>& at,
                                  const EvaluationQuestion& question) {
  return std::visit([&](const auto& shape) { return Evaluate(shape, region, at, question); },
                    geometry);
}

std::string EvaluationText(const nlohmann::ordered_json& evaluation) {
  std::string text;
  for (const auto& [key, value] : evaluation.items()) {
    if (key == "derivatives") {
      for (size_t k = 0; k < value.size(); ++k) {
        if (!value[k].at(0).is_array()) {
          AddRow("  " + CurveLabel(k), value[k], text);
          continue;
        }
        for (size_t l = 0; l < value[k].size(); ++l) {
          AddRow("  " + SurfaceLabel(k, l), value[k][l], text);
        }
      }
    } else if (value.is_object()) {
      for (const auto& [name, number] : value.items()) AddRow("  " + name, number, text);
    } else {
      AddRow(key, value, text);
    }
  }
  return text;
}

}  // namespace batten::internal
