// SPDX-License-Identifier: MIT
// Cases computed by independent implementations: tests/geometry/data/README.md says which and how.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten::internal::fixtures {

using Json = nlohmann::json;

// The cases of a file of data/, or of the folder named by BATTEN_GEOMETRY_FIXTURES.
inline Json Cases(const std::string& name) {
  const char* elsewhere = std::getenv("BATTEN_GEOMETRY_FIXTURES");
  const std::string path = (elsewhere ? elsewhere : BATTEN_TEST_DATA) + ("/" + name);
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path);
  return Json::parse(file).at("cases");
}

inline Eigen::VectorXd Vector(const Json& json) {
  const auto values = json.get<std::vector<double>>();
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

inline Eigen::Vector3d InSpace(const Eigen::VectorXd& point) {
  Eigen::Vector3d result = Eigen::Vector3d::Zero();
  result.head(point.size()) = point;
  return result;
}

inline Eigen::MatrixXd Columns(const Json& json) {
  Eigen::MatrixXd result(json.at(0).size(), json.size());
  for (size_t k = 0; k < json.size(); ++k)
    result.col(static_cast<Eigen::Index>(k)) = Vector(json[k]);
  return result;
}

template <int Dim>
NurbsCurve<Dim> Curve(const Json& json) {
  return NurbsCurve<Dim>(
      SplineBasis(json.at("degree"), json.at("knots")),
      Columns(json.at("points")),
      json.at("weights").is_null() ? Eigen::VectorXd() : Vector(json.at("weights")));
}

inline NurbsSurface Surface(const Json& json) {
  const Json& rows = json.at("points");
  Json points = Json::array(), weights = Json::array();
  for (const Json& row : rows) points.insert(points.end(), row.begin(), row.end());
  const bool rational = !json.at("weights").is_null();
  if (rational) {
    for (const Json& row : json.at("weights"))
      weights.insert(weights.end(), row.begin(), row.end());
  }
  return NurbsSurface(SplineBasis(json.at("degree_u"), json.at("knots_u")),
                      SplineBasis(json.at("degree_v"), json.at("knots_v")),
                      Columns(points),
                      rational ? Vector(weights) : Eigen::VectorXd());
}

inline bool InPlane(const Json& curve) { return curve.at("points").at(0).size() == 2; }

// |got − expected| ≤ tol · max(1, max |expected|), the rule of the files.
inline void ExpectClose(const Eigen::MatrixXd& got,
                        const Eigen::MatrixXd& expected,
                        double tolerance) {
  ASSERT_EQ(got.rows(), expected.rows());
  ASSERT_EQ(got.cols(), expected.cols());
  const double allowed = tolerance * std::max(1.0, expected.cwiseAbs().maxCoeff());
  EXPECT_LE((got - expected).cwiseAbs().maxCoeff(), allowed) << "got\n"
                                                             << got << "\nexpected\n"
                                                             << expected;
}

inline void ExpectClose(double got, double expected, double tolerance) {
  EXPECT_NEAR(got, expected, tolerance * std::max(1.0, std::abs(expected)));
}

// Calls check(input, expected, tol) for every case of a file.
template <typename Check>
void CheckAll(const std::string& file, const Check& check) {
  const Json cases = Cases(file);
  ASSERT_FALSE(cases.empty());
  for (const Json& c : cases) {
    SCOPED_TRACE(file + ", " + c.at("name").get<std::string>());
    check(c.at("input"), c.at("expected"), c.at("tol").get<double>());
  }
}

}  // namespace batten::internal::fixtures
