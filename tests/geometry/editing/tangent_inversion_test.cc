// SPDX-License-Identifier: MIT
#include "batten/geometry/tangent_inversion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "exact_shapes.h"
#include "law_cases.h"
#include "shape_edits.h"
#include "tolerances.h"

namespace batten::internal::tangent_inversion_test {

// The bound of the header: some ε over sin² of the angle between S_u and S_v.
double BoundOf(const SurfaceJet& jet) {
  const double sine = jet.du.normalized().cross(jet.dv.normalized()).norm();
  return 32 * kUnitRoundoff / (sine * sine);
}

TEST(TangentInversionTest, FindsTheVelocityThatMadeATangent) {
  ForRandomSurfaces([](const NurbsSurface& unit, RandomSplines& random) {
    for (const double scale : kCoordinateScales) {
      const NurbsSurface surface = Enlarged(unit, scale);
      const double u = random.Parameter(surface.basis_u()), v = random.Parameter(surface.basis_v());
      const SurfaceJet jet = surface.JetAt(u, v);
      const double du = random.Real(-2, 2), dv = random.Real(-2, 2);
      const Eigen::Vector3d tangent = du * jet.du + dv * jet.dv;
      const auto found = InvertTangent(surface, u, v, tangent);
      ASSERT_EQ(found.has_value(), UnitNormal(jet).has_value());
      if (!found) continue;
      const double size = std::abs(du) * jet.du.norm() + std::abs(dv) * jet.dv.norm();
      EXPECT_LE(std::abs(found->du - du) * jet.du.norm(), BoundOf(jet) * size);
      EXPECT_LE(std::abs(found->dv - dv) * jet.dv.norm(), BoundOf(jet) * size);
      EXPECT_LE(found->residual, 32 * kUnitRoundoff * size);
    }
  });
}

// A part along the normal is left over, whole, and changes nothing else.
TEST(TangentInversionTest, LeavesThePartAlongTheNormal) {
  ForRandomSurfaces([](const NurbsSurface& surface, RandomSplines& random) {
    const double u = random.Parameter(surface.basis_u()), v = random.Parameter(surface.basis_v());
    const SurfaceJet jet = surface.JetAt(u, v);
    const auto normal = UnitNormal(jet);
    if (!normal) return;
    const double du = random.Real(-2, 2), dv = random.Real(-2, 2), height = random.Real(-5, 5);
    const auto found = InvertTangent(jet, du * jet.du + dv * jet.dv + height * *normal);
    ASSERT_TRUE(found);
    const double size =
        std::abs(du) * jet.du.norm() + std::abs(dv) * jet.dv.norm() + std::abs(height);
    EXPECT_LE(std::abs(found->du - du) * jet.du.norm(), BoundOf(jet) * size);
    EXPECT_LE(std::abs(found->dv - dv) * jet.dv.norm(), BoundOf(jet) * size);
    EXPECT_NEAR(found->residual, std::abs(height), BoundOf(jet) * size);
  });
}

TEST(TangentInversionTest, NoOtherVelocityComesNearer) {
  ForRandomSurfaces([](const NurbsSurface& surface, RandomSplines& random) {
    const double u = random.Parameter(surface.basis_u()), v = random.Parameter(surface.basis_v());
    const SurfaceJet jet = surface.JetAt(u, v);
    const Eigen::Vector3d vector = random.Vector(3);
    const auto found = InvertTangent(jet, vector);
    if (!found) return;
    for (int trial = 0; trial < 20; ++trial) {
      const double du = found->du + random.Real(-1, 1) / jet.du.norm();
      const double dv = found->dv + random.Real(-1, 1) / jet.dv.norm();
      EXPECT_GE((du * jet.du + dv * jet.dv - vector).norm(), found->residual * (1 - kRounding));
    }
  });
}

TEST(TangentInversionTest, HasNoAnswerWhereThereIsNoTangentPlane) {
  EXPECT_FALSE(InvertTangent(Sphere(1), 0.3, 1, {1, 0, 0}));  // the pole
  EXPECT_FALSE(InvertTangent(Cone(1, 2), 0.3, 0, {1, 0, 0}));
  const NurbsSurface point(SplineBasis::Uniform(1, 2, 0, 1),
                           SplineBasis::Uniform(1, 2, 0, 1),
                           Eigen::Matrix3Xd::Constant(3, 4, 2.5));
  EXPECT_FALSE(InvertTangent(point, 0.5, 0.5, {1, 0, 0}));
}

TEST(TangentInversionTest, RefusesVectorsThatAreNotFinite) {
  EXPECT_THAT(RefusalOf([] {
                InvertTangent(Sphere(1), 0.3, 0.4, {NAN, 0, 0});
              }),
              testing::HasSubstr("the tangent vector is not finite"));
}

}  // namespace batten::internal::tangent_inversion_test
