// SPDX-License-Identifier: MIT
#include "batten/geometry/warp.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "law_cases.h"
#include "shape_edits.h"
#include "tolerances.h"

namespace batten::internal::warp_test {

constexpr WarpShape kShapes[] = {WarpShape::kBump, WarpShape::kTent, WarpShape::kPlateau};

ParameterRange Inside(const SplineBasis& basis, RandomSplines& random) {
  const double length = basis.upper() - basis.lower(), from = random.Real(0, 0.6);
  return {basis.lower() + from * length, basis.lower() + (from + random.Real(0.1, 0.4)) * length};
}

// Rounding of the insertion, for weights of very different size.
constexpr double kMoved = 1e2 * kRounding;

template <int Dim>
void CheckCurves() {
  ForRandomCurves<Dim>([](const NurbsCurve<Dim>& curve, RandomSplines& random) {
    const ParameterRange range = Inside(curve.basis(), random);
    const Eigen::Matrix<double, Dim, 1> by = random.Vector(1).template head<Dim>();
    for (const WarpShape shape : kShapes) {
      const NurbsCurve<Dim> warped = Warped<Dim>(curve, range, by, {.shape = shape});
      const auto move = [&](double u) -> Eigen::Matrix<double, Dim, 1> {
        return warped.At(u) - curve.At(u);
      };
      EXPECT_LE((move((range.from + range.to) / 2) - by).norm(), kMoved);
      for (int k = 0; k <= 40; ++k) {
        const double u =
            curve.basis().lower() + (curve.basis().upper() - curve.basis().lower()) * k / 40;
        const Eigen::Matrix<double, Dim, 1> moved = move(u);
        if (u <= range.from || u >= range.to) {
          EXPECT_LE(moved.norm(), kMoved) << "outside, u = " << u;
        } else {  // along `by`, forwards
          EXPECT_LE((moved - by * moved.dot(by) / by.squaredNorm()).norm(), kMoved);
          EXPECT_GE(moved.dot(by), -kMoved);
        }
      }
    }
  });
}

TEST(WarpTest, CurvesMoveAlongTheDirectionInTheRegionOnlyAndByItAllInTheMiddle) {
  CheckCurves<2>();
  CheckCurves<3>();
}

TEST(WarpTest, SurfacesMoveAlongTheDirectionInTheRegionOnlyAndByItAllInTheMiddle) {
  ForRandomSurfaces(
      [](const NurbsSurface& surface, RandomSplines& random) {
        const SplineBasis &bu = surface.basis_u(), &bv = surface.basis_v();
        ParameterRegion region{Inside(bu, random), Inside(bv, random)};
        const int strip = random.Integer(0, 2);
        if (strip == 1) region.u.reset();
        if (strip == 2) region.v.reset();
        const Eigen::Vector3d by = random.Vector(1);
        const NurbsSurface warped = Warped(surface, region, by, {.spans = 6});
        const auto middle = [](const SplineBasis& basis, const auto& range) {
          return range ? (range->from + range->to) / 2 : (basis.lower() + basis.upper()) / 2;
        };
        const double u = middle(bu, region.u), v = middle(bv, region.v);
        EXPECT_LE((warped.At(u, v) - surface.At(u, v) - by).norm(), kMoved);
        for (int k = 0; k < 30; ++k) {
          const double s = random.Parameter(bu), t = random.Parameter(bv);
          const Eigen::Vector3d moved = warped.At(s, t) - surface.At(s, t);
          const auto outside = [](const auto& range, double x) {
            return range && (x <= range->from || x >= range->to);
          };
          if (outside(region.u, s) || outside(region.v, t)) {
            EXPECT_LE(moved.norm(), kMoved);
          }
          EXPECT_LE((moved - by * moved.dot(by) / by.squaredNorm()).norm(), kMoved);
        }
      },
      60);
}

// The move of a line is the spline with the shape's heights at the abscissae: it tends to the shape
// with the square of the knots' distance.
TEST(WarpTest, MovesTendToTheShapeWithTheSquareOfTheSpans) {
  const NurbsCurve<2> line(SplineBasis::Uniform(3, 4, 0, 1),
                           Eigen::Matrix2Xd{{0, 1. / 3, 2. / 3, 1}, {0, 0, 0, 0}});
  const auto bump = [](double x) {  // the cubic B-spline over four spans of 1/4, 1 in the middle
    const double t = 2 - 4 * std::abs(x - 0.5);
    return t < 1 ? t * t * t / 4 : 1 - 1.5 * (2 - t) * (2 - t) * (1 - (2 - t) / 2);
  };
  const auto error = [&](int spans) {
    const NurbsCurve<2> warped = Warped<2>(line, {0, 1}, {0, 1}, {.spans = spans});
    double worst = 0;
    for (int k = 0; k <= 200; ++k)
      worst = std::max(worst, std::abs(warped.At(k / 200.).y() - bump(k / 200.)));
    return worst;
  };
  EXPECT_LT(error(40), 0.01);
  EXPECT_NEAR(error(40) / error(80), 4, 1);
}

TEST(WarpTest, RefusesWhatItCannotDo) {
  const NurbsCurve<2> line(SplineBasis::Uniform(1, 2, 0, 1), Eigen::Matrix2Xd::Random(2, 2));
  const auto refusal = [&](ParameterRange range, Eigen::Vector2d by, int spans = 16) {
    return RefusalOf([&] { Warped<2>(line, range, by, {.spans = spans}); });
  };
  EXPECT_EQ(refusal({0.5, 0.5}, {1, 0}), "Warped: the range [0.5, 0.5] of u is empty");
  EXPECT_EQ(refusal({0.5, 1.5}, {1, 0}),
            "Warped: the range [0.5, 1.5] of u leaves the domain [0, 1]");
  EXPECT_THAT(refusal({NAN, 1}, {1, 0}), testing::HasSubstr("is empty"));
  EXPECT_THAT(refusal({0, 1}, {INFINITY, 0}), testing::HasSubstr("by is not finite"));
  EXPECT_THAT(refusal({0, 1}, {1, 0}, 3), testing::HasSubstr("spans = 3 is not between 4 and"));
}

}  // namespace batten::internal::warp_test
