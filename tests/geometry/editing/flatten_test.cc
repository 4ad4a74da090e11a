// SPDX-License-Identifier: MIT
#include "batten/geometry/flatten.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "batten/geometry/closure.h"
#include "law_cases.h"
#include "shape_edits.h"
#include "tolerances.h"

namespace batten::internal::flatten_test {

constexpr double kMoved = 1e2 * kRounding;

ParameterRange Inside(const SplineBasis& basis, RandomSplines& random) {
  const double length = basis.upper() - basis.lower(), from = random.Real(0, 0.6);
  return {basis.lower() + from * length, basis.lower() + (from + random.Real(0.1, 0.4)) * length};
}

enum class Where { kInside, kBetween, kOutside };

// Whether u is in the range, its transition or beyond, once round for periodic ones.
Where PlaceOf(const SplineBasis& basis, const ParameterRange& range, double transition, double u) {
  const double slack = transition * (range.to - range.from), period = basis.upper() - basis.lower();
  Where where = Where::kOutside;
  for (const double shift : {-period, 0.0, period}) {
    if (shift != 0 && !basis.periodic()) continue;
    const double x = u + shift;
    if (x >= range.from && x <= range.to) return Where::kInside;
    if (x >= range.from - slack && x <= range.to + slack) where = Where::kBetween;
  }
  return where;
}

template <int Dim>
void CheckCurves() {
  ForRandomCurves<Dim>([](const NurbsCurve<Dim>& curve, RandomSplines& random) {
    const SplineBasis& basis = curve.basis();
    const ParameterRange range = Inside(basis, random);
    FlattenOptions<Dim> options;
    options.normal = random.Vector(1).template head<Dim>();
    options.offset = random.Real(-1, 1);
    options.along =
        (options.normal.normalized() + 0.5 * random.Vector(1).template head<Dim>()).eval();
    if (std::abs(options.along->dot(options.normal.normalized())) < 0.1) return;
    const NurbsCurve<Dim> flat = Flattened<Dim>(curve, range, options);
    const double length = options.normal.norm(), size = 1e2 * ExtentOf(flat);
    for (int k = 0; k <= 60; ++k) {
      const double u = basis.lower() + (basis.upper() - basis.lower()) * k / 60;
      const Where where = PlaceOf(basis, range, options.transition, u);
      const Eigen::Matrix<double, Dim, 1> moved = flat.At(u) - curve.At(u);
      if (where == Where::kInside) {
        EXPECT_NEAR(
            (options.normal.dot(flat.At(u)) - options.offset) / length, 0, kRounding * size);
        EXPECT_LE(
            (moved - *options.along * moved.dot(*options.along) / options.along->squaredNorm())
                .norm(),
            kRounding * size);
      } else if (where == Where::kOutside) {
        EXPECT_LE(moved.norm(), kMoved) << "u = " << u;
      }
    }
    // As smooth as before: inserted knots are simple.
    for (const double knot : flat.basis().knots()) {
      EXPECT_LE(flat.basis().Multiplicity(knot), std::max(1, basis.Multiplicity(knot)));
    }
  });
}

TEST(FlattenTest, CurvesLieInThePlaneInTheRegionAndStayBeyondTheTransition) {
  CheckCurves<2>();
  CheckCurves<3>();
}

TEST(FlattenTest, SurfacesLieInThePlaneInTheRegionAndStayBeyondTheTransition) {
  ForRandomSurfaces(
      [](const NurbsSurface& surface, RandomSplines& random) {
        if (CollapsedEdges(surface) != CollapsedEdgeSet{}) return;  // points move as a whole
        const SplineBasis &bu = surface.basis_u(), &bv = surface.basis_v();
        ParameterRegion region{Inside(bu, random), Inside(bv, random)};
        if (random.Integer(0, 1) == 1) region.v.reset();
        FlattenOptions<3> options;
        options.normal = random.Vector(1);
        options.offset = 0.3;
        const NurbsSurface flat = Flattened(surface, region, options);
        const double length = options.normal.norm(), size = 1e2 * ExtentOf(flat);
        for (int k = 0; k < 60; ++k) {
          const double u = random.Real(bu.lower(), bu.upper()),
                       v = random.Real(bv.lower(), bv.upper());
          const Where at_u = PlaceOf(bu, *region.u, options.transition, u);
          const Where at_v =
              region.v ? PlaceOf(bv, *region.v, options.transition, v) : Where::kInside;
          if (at_u == Where::kInside && at_v == Where::kInside) {
            EXPECT_NEAR(
                (options.normal.dot(flat.At(u, v)) - options.offset) / length, 0, kRounding * size);
          } else if (at_u == Where::kOutside || at_v == Where::kOutside) {
            EXPECT_LE((flat.At(u, v) - surface.At(u, v)).norm(), kMoved);
          }
        }
      },
      60);
}

TEST(FlattenTest, RefusesWhatItCannotDo) {
  const NurbsCurve<2> curve(SplineBasis::Uniform(2, 5, 0, 1), Eigen::Matrix2Xd::Random(2, 5));
  const auto refusal = [&](ParameterRange range, const FlattenOptions<2>& options) {
    return RefusalOf([&] { Flattened<2>(curve, range, options); });
  };
  EXPECT_THAT(refusal({0.2, 0.1}, {}), testing::HasSubstr("the range [0.2, 0.1] of u is empty"));
  EXPECT_THAT(refusal({0.2, 0.5}, {.normal = {0, 0}}), testing::HasSubstr("has no normal"));
  EXPECT_THAT(refusal({0.2, 0.5}, {.along = Eigen::Vector2d(1, 0)}),
              testing::HasSubstr("lies in the plane"));
  EXPECT_THAT(refusal({0.2, 0.5}, {.transition = 0}), testing::HasSubstr("transition 0 is not"));
}

}  // namespace batten::internal::flatten_test
