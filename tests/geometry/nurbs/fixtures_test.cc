// SPDX-License-Identifier: MIT
// Cases computed by independent implementations (data/README.md), each checked to its own
// tolerance.
#include <gtest/gtest.h>

#include <vector>

#include "batten/geometry/curvature.h"
#include "batten/geometry/foot_point.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"
#include "fixtures.h"

namespace batten::internal::fixtures_test {

using namespace fixtures;

void CheckBasis(const Json& input, const Json& expected, double tolerance) {
  const SplineBasis basis(input.at("degree"), input.at("knots"));
  const double u = input.at("u");
  const int order = input.at("order"), p = basis.degree(), span = basis.Span(u);
  EXPECT_EQ(span, expected.at("span").get<int>());
  if (expected.contains("first_index")) {
    EXPECT_EQ(span - p, expected.at("first_index").get<int>());
  }
  Eigen::MatrixXd derivatives(p + 1, order + 1);
  basis.Derivatives(span, u, order, derivatives.data());
  ExpectClose(derivatives, Columns(expected.at("ders")), tolerance);
  Eigen::VectorXd values(p + 1);
  basis.Values(span, u, values.data());
  ExpectClose(values, Vector(expected.at("ders").at(0)), tolerance);
}

template <int Dim>
void CheckCurve(const Json& input, const Json& expected, double tolerance) {
  const auto curve = Curve<Dim>(input.at("curve"));
  const double u = input.at("u");
  if (expected.contains("ders")) {
    ExpectClose(curve.Derivatives(u, input.at("order")), Columns(expected.at("ders")), tolerance);
    ExpectClose(curve.At(u), Vector(expected.at("ders").at(0)), tolerance);
  } else if (expected.contains("point")) {
    ExpectClose(curve.At(u), Vector(expected.at("point")), tolerance);
  } else {
    Eigen::Matrix3Xd d = Eigen::Matrix3Xd::Zero(3, 4);
    d.topRows<Dim>() = curve.Derivatives(u, 3);
    const auto curvature = CurvatureOf(d.col(1), d.col(2), d.col(3));
    ASSERT_TRUE(curvature);
    ExpectClose(curvature->curvature, expected.at("curvature"), tolerance);
    if (!expected.at("torsion").is_null()) {
      ExpectClose(curvature->torsion, expected.at("torsion"), tolerance);
    }
  }
}

void CheckCurve(const Json& input, const Json& expected, double tolerance) {
  if (InPlane(input.at("curve"))) {
    CheckCurve<2>(input, expected, tolerance);
  } else {
    CheckCurve<3>(input, expected, tolerance);
  }
}

void CheckSurface(const Json& input, const Json& expected, double tolerance) {
  const NurbsSurface surface = Surface(input.at("surface"));
  const double u = input.at("u"), v = input.at("v");
  if (expected.contains("point")) {
    ExpectClose(surface.At(u, v), Vector(expected.at("point")), tolerance);
  } else if (expected.contains("gaussian")) {
    const auto curvature = CurvatureOf(surface.JetAt(u, v));
    ASSERT_TRUE(curvature);
    ExpectClose(curvature->gaussian, expected.at("gaussian"), tolerance);
    ExpectClose(curvature->mean, expected.at("mean"), tolerance);
    ExpectClose(Eigen::Vector2d(curvature->principal_low, curvature->principal_high),
                Vector(expected.at("principal")),
                tolerance);
    const auto normal = surface.NormalAt(u, v);
    ASSERT_TRUE(normal);
    ExpectClose(*normal, Vector(expected.at("normal")), tolerance);
  } else {
    const Json& table = expected.at("derivs");
    const int order = input.at("order");
    const SurfaceDerivatives derivatives = surface.Derivatives(u, v, order);
    // One scale for the whole table, as the files say.
    std::vector<double> got, wanted;
    for (int k = 0; k <= order; ++k) {
      for (int l = 0; k + l <= order; ++l) {
        const Eigen::Vector3d a = derivatives(k, l), b = Vector(table.at(k).at(l));
        got.insert(got.end(), a.begin(), a.end());
        wanted.insert(wanted.end(), b.begin(), b.end());
      }
    }
    const auto count = static_cast<Eigen::Index>(got.size());
    ExpectClose(Eigen::Map<Eigen::VectorXd>(got.data(), count),
                Eigen::Map<Eigen::VectorXd>(wanted.data(), count),
                tolerance);
    if (order >= 2) {
      const SurfaceJet jet = surface.JetAt(u, v);
      ExpectClose(jet.duv, Vector(table.at(1).at(1)), tolerance);
      ExpectClose(jet.duu, Vector(table.at(2).at(0)), tolerance);
      ExpectClose(jet.dvv, Vector(table.at(0).at(2)), tolerance);
    }
  }
}

template <int Dim>
void CheckCurveFoot(const Json& input, const Json& expected, double tolerance) {
  const CurveFootPoints<Dim> curve(Curve<Dim>(input.at("curve")));
  const CurveFoot foot = curve.Nearest(InSpace(Vector(input.at("point"))));
  ExpectClose(foot.distance, expected.at("distance"), tolerance);
  ExpectClose(foot.point, InSpace(Vector(expected.at("closest"))), tolerance);
  ExpectClose(curve.curve().At(foot.u), Vector(expected.at("closest")), tolerance);
}

void CheckSurfaceFoot(const Json& input, const Json& expected, double tolerance) {
  const SurfaceFootPoints surface(Surface(input.at("surface")));
  const SurfaceFoot foot = surface.Nearest(InSpace(Vector(input.at("point"))));
  ExpectClose(foot.distance, expected.at("distance"), tolerance);
  ExpectClose(foot.point, Vector(expected.at("closest")), tolerance);
  ExpectClose(surface.surface().At(foot.u, foot.v), Vector(expected.at("closest")), tolerance);
}

TEST(FixturesTest, BasisFunctionsAgreeWithOtherImplementations) {
  CheckAll("basis_functions.json", CheckBasis);
}

TEST(FixturesTest, CurvesAgreeWithOtherImplementations) {
  CheckAll("curve_eval.json", [](const Json& input, const Json& expected, double tolerance) {
    CheckCurve(input, expected, tolerance);
  });
}

TEST(FixturesTest, SurfacesAgreeWithOtherImplementations) {
  CheckAll("surface_eval.json", CheckSurface);
}

TEST(FixturesTest, WorkedExamplesOfTheBookComeOutAsPrinted) {
  CheckAll("worked_examples.json", [](const Json& input, const Json& expected, double tolerance) {
    if (input.contains("op")) return;  // editing: not evaluation
    if (input.contains("curve")) {
      CheckCurve(input, expected, tolerance);
    } else if (input.contains("surface")) {
      CheckSurface(input, expected, tolerance);
    } else {
      CheckBasis(input, expected, tolerance);
    }
  });
}

TEST(FixturesTest, FootPointsAgreeWithOtherImplementations) {
  CheckAll("projection.json", [](const Json& input, const Json& expected, double tolerance) {
    if (input.contains("surface")) {
      CheckSurfaceFoot(input, expected, tolerance);
    } else if (InPlane(input.at("curve"))) {
      CheckCurveFoot<2>(input, expected, tolerance);
    } else {
      CheckCurveFoot<3>(input, expected, tolerance);
    }
  });
}

TEST(FixturesTest, CurvaturesAgreeWithOtherImplementations) {
  CheckAll("measures_curvature.json",
           [](const Json& input, const Json& expected, double tolerance) {
             if (expected.contains("length") || expected.contains("area")) return;
             if (input.contains("curve")) {
               CheckCurve(input, expected, tolerance);
             } else {
               CheckSurface(input, expected, tolerance);
             }
           });
}

}  // namespace batten::internal::fixtures_test
