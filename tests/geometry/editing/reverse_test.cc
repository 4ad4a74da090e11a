// SPDX-License-Identifier: MIT
#include "batten/geometry/reverse.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "batten/geometry/knot_vectors.h"
#include "law_cases.h"
#include "random_splines.h"
#include "same_shape.h"
#include "shape_edits.h"

namespace batten::internal::reverse_test {

// Rounded knots and a rounded parameter: the shape moves by that times its speed, which is at most
// of the order of 2p·extent/span times the ratio of the weights.
double Units(const SplineBasis& basis) { return 64 * DomainExtent(basis) / ShortestSpan(basis); }

double Mirrored(const SplineBasis& basis, double u) { return basis.lower() + (basis.upper() - u); }

TEST(ReversedTest, RunsThroughTheSameCurveBackwards) {
  const auto law = [](const auto& curve, RandomSplines& random) {
    const auto back = Reversed(curve);
    EXPECT_EQ(back.basis().lower(), curve.basis().lower());
    EXPECT_EQ(back.basis().upper(), curve.basis().upper());
    EXPECT_EQ(back.basis().periodic(), curve.basis().periodic());
    EXPECT_EQ(back.basis().clamped(), curve.basis().clamped());
    for (int k = 0; k < kComparedPlaces; ++k) {
      const double u = random.Real(curve.basis().lower(), curve.basis().upper());
      ExpectSameAt(curve,
                   u,
                   back,
                   Mirrored(curve.basis(), u),
                   Units(curve.basis()) * WeightRatio(curve),
                   true);
    }
    EXPECT_EQ(Reversed(back).control_points(), curve.control_points());
    EXPECT_EQ(Reversed(back).weights(), curve.weights());
    const std::vector<double>& U = curve.basis().knots();
    const double largest =
        std::max({DomainExtent(curve.basis()), std::abs(U.front()), std::abs(U.back())});
    EXPECT_TRUE(SameKnots(Reversed(back).basis(), curve.basis(), 4 * kUnitRoundoff * largest));
  };
  ForRandomCurves<2>(law, 10);
  ForRandomCurves<3>(law, 10);
}

TEST(ReversedTest, RunsThroughTheSameSurfaceBackwards) {
  ForRandomSurfaces([](const NurbsSurface& surface, RandomSplines& random) {
    const NurbsSurface in_u = Reversed(surface, Direction::kU);
    const NurbsSurface in_v = Reversed(surface, Direction::kV);
    EXPECT_EQ(in_u.basis_v(), surface.basis_v());
    EXPECT_EQ(in_v.basis_u(), surface.basis_u());
    const double units =
        std::max(Units(surface.basis_u()), Units(surface.basis_v())) * WeightRatio(surface);
    const double bound =
        units * (surface.basis_u().degree() + surface.basis_v().degree() + 1) * kUnitRoundoff;
    for (int k = 0; k < kComparedPlaces; ++k) {
      const double u = random.Parameter(surface.basis_u()), v = random.Parameter(surface.basis_v());
      const Eigen::Vector3d here = surface.At(u, v);
      EXPECT_LE((here - in_u.At(Mirrored(surface.basis_u(), u), v)).cwiseAbs().maxCoeff(), bound);
      EXPECT_LE((here - in_v.At(u, Mirrored(surface.basis_v(), v))).cwiseAbs().maxCoeff(), bound);
    }
  });
}

TEST(ReversedTest, IsExactOverKnotsThatCanBeReflectedExactly) {
  RandomSplines random(4);
  const SplineBasis basis(3, {0, 0, 0, 0, 0.25, 0.5, 0.5, 1, 1, 1, 1});
  const NurbsCurve<3> curve(basis, Eigen::Matrix<double, 3, 7>::Random());
  EXPECT_EQ(Reversed(curve).basis(), SplineBasis(3, {0, 0, 0, 0, 0.5, 0.5, 0.75, 1, 1, 1, 1}));
  EXPECT_EQ(Reversed(Reversed(curve)), curve);
}

TEST(SwappedTest, ExchangesTheParametersExactly) {
  ForRandomSurfaces([](const NurbsSurface& surface, RandomSplines&) {
    const NurbsSurface swapped = Swapped(surface);
    EXPECT_EQ(swapped.basis_u(), surface.basis_v());
    EXPECT_EQ(swapped.basis_v(), surface.basis_u());
    for (int i = 0; i < surface.size_u(); ++i) {
      for (int j = 0; j < surface.size_v(); ++j) {
        EXPECT_EQ(swapped.control_point(j, i), surface.control_point(i, j));
        EXPECT_EQ(swapped.weights()[j * surface.size_u() + i],
                  surface.weights()[i * surface.size_v() + j]);
      }
    }
    EXPECT_EQ(Swapped(swapped), surface);
  });
}

}  // namespace batten::internal::reverse_test
