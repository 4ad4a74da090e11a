// SPDX-License-Identifier: MIT
#include "fitting/constraints/polynomial_curve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fitting/constraints/neighbour_tangents.h"
#include "batten/geometry/iso_curve.h"
#include "batten/geometry/make_curve.h"
#include "batten/geometry/make_surface.h"
#include "batten/geometry/reverse.h"

namespace batten::internal::polynomial_curve_test {

double Farthest(const NurbsCurve<3>& a, const NurbsCurve<3>& b) {
  double most = 0;
  for (int k = 0; k <= 2000; ++k) {
    const double u = b.basis().lower() + (b.basis().upper() - b.basis().lower()) * k / 2000;
    most = std::max(most, (a.At(u) - b.At(u)).norm());
  }
  return most;
}

TEST(PolynomialCurveTest, FollowsAnArcWithinTheToleranceAtEqualParameters) {
  const NurbsCurve<3> arc = MakeArc(Frame{}, 2, {0.3, 4});
  ASSERT_TRUE(arc.rational());
  for (const double tolerance : {1e-3, 1e-6, 1e-9}) {
    SCOPED_TRACE(tolerance);
    const NurbsCurve<3> cubics = PolynomialCurve(arc, tolerance);
    EXPECT_FALSE(cubics.rational());
    EXPECT_EQ(cubics.basis().degree(), 3);
    // Between the three places looked at in a part the error is at most a few hundredths greater.
    EXPECT_LT(Farthest(cubics, arc), 1.05 * tolerance);
    EXPECT_EQ(cubics.At(arc.basis().lower()), arc.At(arc.basis().lower()));
    EXPECT_EQ(cubics.At(arc.basis().upper()), arc.At(arc.basis().upper()));
  }
}

TEST(PolynomialCurveTest, KeepsCornersAndLosesKnotsWhereItIsSmooth) {
  const double w = std::sqrt(0.5);
  Eigen::Matrix3Xd points(3, 5);
  points << 1, 1, 0, 0, -1, 0, 1, 1, 2, 2, 0, 0, 0, 0, 0;
  Eigen::VectorXd weights(5);
  weights << 1, w, 1, w, 1;  // two quarters of circles that meet in a cusp
  const NurbsCurve<3> cusp(SplineBasis(2, {0, 0, 0, 1, 1, 2, 2, 2}), points, weights);
  const NurbsCurve<3> cubics = PolynomialCurve(cusp, 1e-8);
  EXPECT_LT(Farthest(cubics, cusp), 1.05e-8);
  EXPECT_EQ(cubics.basis().Multiplicity(1), 3);
  EXPECT_EQ(cubics.basis().Multiplicity(0.5), 2);
}

// What the surface's own derivative across the edge is, out of it.
void ExpectOutward(const NurbsSurface& surface, double angle) {
  for (const Direction direction : {Direction::kU, Direction::kV}) {
    for (const bool upper : {false, true}) {
      const NurbsCurve<3> across = OutwardDerivative({surface, direction, upper});
      const bool along_v = direction == Direction::kU;
      const SplineBasis &basis = along_v ? surface.basis_v() : surface.basis_u(),
                        &other = along_v ? surface.basis_u() : surface.basis_v();
      const double at = upper ? other.upper() : other.lower();
      EXPECT_EQ(across.basis().lower(), basis.lower());
      EXPECT_EQ(across.basis().upper(), basis.upper());
      for (int k = 0; k <= 50; ++k) {
        const double t = basis.lower() + (basis.upper() - basis.lower()) * (k + 0.01) / 50.1;
        const SurfaceJet jet = along_v ? surface.JetAt(at, t) : surface.JetAt(t, at);
        const Eigen::Vector3d out = (upper ? 1 : -1) * (along_v ? jet.du : jet.dv);
        EXPECT_LT((across.At(t) - out).norm(), angle * out.norm());
      }
    }
  }
}

TEST(NeighbourTangentsTest, TheDerivativeAcrossAnEdgeIsTheSurfacesOwn) {
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Random(3, 42);
  for (int k = 0; k < 42; ++k) points.col(k) += Eigen::Vector3d(k / 7, k % 7, 0) * 4;
  const NurbsSurface plain(
      SplineBasis::Uniform(3, 6, 1, 4), SplineBasis::Uniform(2, 7, -1, 1), points);
  ExpectOutward(plain, 1e-12);
  Eigen::VectorXd weights = (Eigen::ArrayXd::Random(42) * 0.3 + 1).matrix();
  ExpectOutward(NurbsSurface(plain.basis_u(), plain.basis_v(), points, weights), 1e-6);
}

}  // namespace batten::internal::polynomial_curve_test
