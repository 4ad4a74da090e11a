// SPDX-License-Identifier: MIT
#include "batten/geometry/conic.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <string>

#include "random_splines.h"
#include "refusal.h"
#include "tolerances.h"

namespace batten::internal::conic_test {

Eigen::Vector2d Flat(const Eigen::Vector3d& v) { return v.head<2>(); }

// The product of two lines n·x = h.
ImplicitConic Product(const Eigen::Vector2d& n, double h, const Eigen::Vector2d& m, double g) {
  return {n[0] * m[0],
          n[0] * m[1] + n[1] * m[0],
          n[1] * m[1],
          -g * n[0] - h * m[0],
          -g * n[1] - h * m[1],
          h * g};
}

// λ (x·e)² + μ (x·f)² + along (x·f) + constant, turned by an angle and moved to `centre`, scaled.
ImplicitConic Turned(double lambda,
                     double mu,
                     double along,
                     double constant,
                     double angle,
                     const Eigen::Vector2d& centre,
                     double factor) {
  const Eigen::Matrix2d R = Eigen::Rotation2Dd(angle).toRotationMatrix();
  const Eigen::Matrix2d M = R * Eigen::Vector2d(lambda, mu).asDiagonal() * R.transpose();
  const Eigen::Vector2d l = along * R.col(1);
  const ImplicitConic own{M(0, 0), 2 * M(0, 1), M(1, 1), l[0], l[1], constant};
  const ImplicitConic moved = own.From(-centre);
  return {factor * moved.a,
          factor * moved.b,
          factor * moved.c,
          factor * moved.d,
          factor * moved.e,
          factor * moved.f};
}

class ConicTest : public ::testing::Test {
 protected:
  RandomSplines random_{31};
  double angle_ = 0, factor_ = 1;
  Eigen::Vector2d centre_ = Eigen::Vector2d::Zero();
  void Draw() {
    angle_ = random_.Real(-4, 4);
    factor_ = (random_.Coin() ? 1 : -1) * random_.Logarithmic(1e-6, 1e6);
    centre_ = random_.Vector(3).head<2>();
  }
};

TEST_F(ConicTest, ProperConicsAreRecovered) {
  for (int k = 0; k < 500; ++k) {
    SCOPED_TRACE(k);
    Draw();
    const double a = random_.Real(1, 3), b = random_.Real(0.3, 0.95) * a;
    const auto ellipse = std::get<EllipseShape>(
        ClassifyConic(Turned(1 / (a * a), 1 / (b * b), 0, -1, angle_, centre_, factor_)));
    EXPECT_NEAR(ellipse.major_radius, a, kIterated);
    EXPECT_NEAR(ellipse.minor_radius, b, kIterated);
    EXPECT_LE((Flat(ellipse.center) - centre_).norm(), kIterated);
    EXPECT_NEAR(std::abs(ellipse.major_axis[0]), std::abs(std::cos(angle_)), kIterated);

    const auto circle =
        std::get<CircleShape>(ClassifyConic({factor_,
                                             0,
                                             factor_,
                                             -2 * factor_ * centre_[0],
                                             -2 * factor_ * centre_[1],
                                             factor_ * (centre_.squaredNorm() - a * a)}));
    EXPECT_NEAR(circle.radius, a, kIterated);

    const auto hyperbola = std::get<HyperbolaShape>(
        ClassifyConic(Turned(1 / (a * a), -1 / (b * b), 0, -1, angle_, centre_, factor_)));
    EXPECT_NEAR(hyperbola.transverse_radius, a, kIterated);
    EXPECT_NEAR(hyperbola.conjugate_radius, b, kIterated);
    EXPECT_NEAR(std::abs(hyperbola.transverse_axis[0]), std::abs(std::cos(angle_)), kIterated);

    const auto parabola =
        std::get<ParabolaShape>(ClassifyConic(Turned(1, 0, -4 * b, 0, angle_, centre_, factor_)));
    EXPECT_NEAR(parabola.focal_length, b, kIterated);
    EXPECT_LE((Flat(parabola.vertex) - centre_).norm(), kIterated);
    EXPECT_NEAR(parabola.axis[0], -std::sin(angle_), kIterated);
  }
}

TEST_F(ConicTest, DegenerateConicsAreNamed) {
  for (int k = 0; k < 500; ++k) {
    SCOPED_TRACE(k);
    Draw();
    const Eigen::Vector2d n(std::cos(angle_), std::sin(angle_)),
        m(std::cos(angle_ + 1), std::sin(angle_ + 1));
    const double h = random_.Real(-3, 3);
    const auto cross = std::get<CrossingLines>(
        ClassifyConic(Product(factor_ * n, factor_ * n.dot(centre_), m, m.dot(centre_))));
    EXPECT_LE((cross.point - centre_).norm(), kIterated);
    const double onto[] = {std::abs(cross.directions[0].dot(n)),
                           std::abs(cross.directions[1].dot(n))};
    EXPECT_NEAR(std::min(onto[0], onto[1]), 0, kIterated);
    const auto parallel =
        std::get<ParallelLines>(ClassifyConic(Product(factor_ * n, factor_ * h, n, h + 1)));
    EXPECT_NEAR((parallel.points[0] - parallel.points[1]).norm(), 1, kIterated);
    EXPECT_NEAR(parallel.direction.dot(n), 0, kIterated);
    const auto twice = std::get<DoubleLine>(ClassifyConic(Product(factor_ * n, factor_ * h, n, h)));
    // Half of the digits: a discriminant that vanishes to rounding.
    EXPECT_NEAR(twice.point.dot(n), h, kHalfDigits);
    const auto point = std::get<SinglePoint>(
        ClassifyConic(Turned(1, random_.Real(0.2, 1), 0, 0, angle_, centre_, factor_)));
    EXPECT_LE((point.point - centre_).norm(), kIterated);
    EXPECT_EQ(NameOf(ClassifyConic(Turned(1, 0.5, 0, 1, angle_, centre_, factor_))), "empty");
    EXPECT_EQ(NameOf(ClassifyConic(Turned(1, 0, 0, 1, angle_, centre_, factor_))), "empty");
    const auto line =
        std::get<LineShape>(ClassifyConic({0, 0, 0, factor_ * n[0], factor_ * n[1], -factor_ * h}));
    EXPECT_NEAR(Flat(line.point).dot(n), h, kIterated);
  }
  EXPECT_EQ(NameOf(ClassifyConic({0, 0, 0, 0, 0, 3})), "empty");
  EXPECT_EQ(NameOf(ClassifyConic({})), "the whole plane");
  EXPECT_EQ(NameOf(ClassifyConic({.a = 1, .c = 1e-20, .f = -1})), "two parallel lines");
  EXPECT_EQ(NameOf(ClassifyConic({.b = 1, .f = -1})), "hyperbola");
  EXPECT_NE(RefusalOf([] { ClassifyConic({.a = NAN}); }), "accepted");
}

// What the kind is does not depend on the unit.
TEST_F(ConicTest, UnitsDoNotMatter) {
  for (const double unit : {1e-9, 1e-3, 1.0, 1e5, 1e9}) {
    const double u = 1 / unit;
    const auto scaled = [&](const ImplicitConic& conic) {
      return ImplicitConic{
          conic.a * u * u, conic.b * u * u, conic.c * u * u, conic.d * u, conic.e * u, conic.f};
    };
    EXPECT_NEAR(
        std::get<EllipseShape>(ClassifyConic(scaled({1, 0, 4, -2, 0, -3}))).major_radius / unit,
        2,
        kIterated);
    EXPECT_EQ(NameOf(ClassifyConic(scaled({1, 0, 0, 0, -1, 0}))), "parabola");
    EXPECT_EQ(NameOf(ClassifyConic(scaled({1, 0, -1, -2, 0, 1}))), "two crossing lines");
  }
}

}  // namespace batten::internal::conic_test
