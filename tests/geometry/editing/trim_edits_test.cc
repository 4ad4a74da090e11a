// SPDX-License-Identifier: MIT
// Edits of trimmed surfaces leave the same points of space inside.
#include <gtest/gtest.h>

#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "batten/geometry/bezier_surface.h"
#include "batten/geometry/clamp.h"
#include "batten/geometry/composition.h"
#include "batten/geometry/degree_elevation.h"
#include "batten/geometry/degree_reduction.h"
#include "batten/geometry/insert_knots.h"
#include "batten/geometry/join.h"
#include "batten/geometry/make_surface.h"
#include "batten/geometry/modify_shape.h"
#include "batten/geometry/remove_knots.h"
#include "batten/geometry/reparameterize.h"
#include "batten/geometry/reverse.h"
#include "batten/geometry/split.h"
#include "batten/geometry/transform.h"
#include "tolerances.h"
#include "trim_cases.h"

namespace batten::internal::trim_edits_test {

using Place = Eigen::Vector2d;

NurbsSurface RandomSurface(RandomSplines& random) {
  const BasisKind kind{true, 4, 2};
  SplineBasis u = random.Basis(random.Integer(1, 3), kind);
  SplineBasis v = random.Basis(random.Integer(1, 4), kind);
  Eigen::Matrix3Xd points(3, u.size() * v.size());
  for (int i = 0; i < u.size(); ++i) {
    for (int j = 0; j < v.size(); ++j) {
      points.col(i * v.size() + j) = Eigen::Vector3d(3 * u.Greville(i), v.Greville(j), 0);
      points(2, i * v.size() + j) = random.Real(-1, 1);
    }
  }
  return NurbsSurface(u, v, points, random.Weights(points.cols(), 0.5, 2));
}

// Calls law(surface, random) for every case of loops.
void ForTrimmedSurfaces(const std::function<void(const NurbsSurface&, RandomSplines&)>& law) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    for (const LoopCase& loops : LoopCases(seed)) {
      SCOPED_TRACE(loops.name + ", seed " + std::to_string(seed));
      RandomSplines random(seed);
      law(Trimmed(RandomSurface(random), loops), random);
    }
  }
}

// At the image of a place the edited surface has the same point, and counts it likewise.
void ExpectSamePart(const NurbsSurface& before,
                    const NurbsSurface& after,
                    const std::function<Place(const Place&)>& image,
                    RandomSplines& random,
                    bool same_points = true) {
  ASSERT_NO_THROW(CheckTrims(after));
  const TrimRegion old_part(before), new_part(after);
  for (int k = 0; k < 400; ++k) {
    const double u = random.Parameter(before.basis_u()), v = random.Parameter(before.basis_v());
    if (NearLoop(old_part, before, u, v)) continue;
    const Place to = image({u, v});
    ASSERT_EQ(old_part.Contains(u, v), new_part.Contains(to[0], to[1])) << u << ' ' << v;
    if (!same_points) continue;
    ASSERT_LE((before.At(u, v) - after.At(to[0], to[1])).norm(), kIterated);
  }
}

Place Same(const Place& place) { return place; }

TEST(TrimEditsTest, ThatKeepTheDomainKeepTheLoops) {
  ForTrimmedSurfaces([](const NurbsSurface& surface, RandomSplines& random) {
    const double middle = (surface.basis_u().lower() + surface.basis_u().upper()) / 2 + 1e-3;
    const auto expect_loops = [&](const NurbsSurface& edited) {
      EXPECT_EQ(edited.trims(), surface.trims());
      ExpectSamePart(surface, edited, Same, random, false);
    };
    const NurbsSurface inserted = InsertKnot(surface, Direction::kU, middle);
    expect_loops(inserted);
    expect_loops(RefineKnots(surface, Direction::kU, std::vector<double>{middle}));
    expect_loops(RemoveKnots(inserted, 1e-9).shape);
    expect_loops(RemoveKnot(inserted, Direction::kU, middle, 1, 1e-9).shape);
    const NurbsSurface elevated = Elevated(surface, Direction::kV, 2);
    expect_loops(elevated);
    expect_loops(Reduced(elevated, Direction::kV, 2, 1e-9).shape);
    const NurbsSurface unclamped = Unclamped(surface, Direction::kU);
    expect_loops(unclamped);
    expect_loops(Clamped(unclamped, Direction::kU));
    expect_loops(Transformed(surface, Scaling(2)));
    expect_loops(surface.Translated({1, 2, 3}));
    expect_loops(WithWeight(surface, 0, 1, 3));
    expect_loops(MovedPoint(surface, middle, surface.basis_v().lower(), {0, 0, 5}));
  });
}

TEST(TrimEditsTest, PeriodicFormsKeepTheLoops) {
  const NurbsSurface tube = Trimmed(MakeCylinder({}, 1, {0, 2}), {RectangleLoop(0, 1, 0.2, 0.7)});
  for (const Direction direction : {Direction::kU, Direction::kV}) {
    NurbsSurface closed = tube;
    try {
      closed = Periodic(tube, direction, 1e-9);
    } catch (const std::invalid_argument&) {
      continue;  // the direction along the axis is not closed
    }
    EXPECT_EQ(closed.trims(), tube.trims());
    EXPECT_EQ(Clamped(closed, direction).trims(), tube.trims());
  }
}

TEST(TrimEditsTest, ReversedAndSwappedLoopsAreTurnedAgain) {
  ForTrimmedSurfaces([](const NurbsSurface& surface, RandomSplines& random) {
    const SplineBasis &u = surface.basis_u(), &v = surface.basis_v();
    ExpectSamePart(
        surface,
        Reversed(surface, Direction::kU),
        [&](const Place& at) { return Place(u.lower() + (u.upper() - at[0]), at[1]); },
        random);
    ExpectSamePart(
        surface,
        Reversed(surface, Direction::kV),
        [&](const Place& at) { return Place(at[0], v.lower() + (v.upper() - at[1])); },
        random);
    ExpectSamePart(
        surface, Swapped(surface), [](const Place& at) { return Place(at[1], at[0]); }, random);
    EXPECT_EQ(Swapped(Swapped(surface)).trims().size(), surface.trims().size());
  });
}

TEST(TrimEditsTest, LoopsFollowALinearChangeOfParameter) {
  ForTrimmedSurfaces([](const NurbsSurface& surface, RandomSplines& random) {
    const SplineBasis& v = surface.basis_v();
    ExpectSamePart(
        surface,
        Reparameterized(surface, Direction::kV, -7, 20),
        [&](const Place& at) {
          return Place(at[0], -7 + 27 * (at[1] - v.lower()) / (v.upper() - v.lower()));
        },
        random);
  });
}

TEST(TrimEditsTest, LoopsFollowAMobiusMapExactly) {
  ForTrimmedSurfaces([](const NurbsSurface& surface, RandomSplines& random) {
    const SplineBasis& u = surface.basis_u();
    for (const double ratio : {0.05, 0.4, 3.0, 40.0}) {
      SCOPED_TRACE("ratio " + std::to_string(ratio));
      // s = ρτ / (1 − τ + ρτ) with τ = (u − lower) / length: u = lower + length s / (ρ − (ρ−1) s).
      const double length = u.upper() - u.lower();
      const NurbsSurface image = MobiusReparameterized(surface,
                                                       Direction::kU,
                                                       length - u.lower() * (ratio - 1),
                                                       u.lower() * ratio,
                                                       1 - ratio,
                                                       ratio);
      const auto map = [&](const Place& at) {
        const double t = (at[0] - u.lower()) / length;
        return Place(ratio * t / (1 - t + ratio * t), at[1]);
      };
      ExpectSamePart(surface, image, map, random);
      for (size_t k = 0; k < surface.trims().size(); ++k) {
        const NurbsCurve<2>&loop = surface.trims()[k], &mapped = image.trims()[k];
        EXPECT_LE(mapped.basis().degree(), 2 * loop.basis().degree());
        for (int i = 0; i < 50; ++i) {
          const double s = random.Real(loop.basis().lower(), loop.basis().upper());
          EXPECT_LE((mapped.At(s) - map(loop.At(s))).norm(), kIterated);
        }
      }
    }
  });
}

TEST(TrimEditsTest, AMobiusMapKeepsTheContinuityOfALoop) {
  RandomSplines random(5);
  const NurbsSurface plane = MakeBilinear({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0});
  const NurbsSurface surface = Trimmed(plane, {WavyLoop(random, {0.5, 0.5}, 0.45, 8, false)});
  const NurbsSurface image = MobiusReparameterized(surface, Direction::kU, 1, 0, -0.5, 1.5);
  const SplineBasis& basis = image.trims()[0].basis();
  EXPECT_EQ(basis.degree(), 6);
  EXPECT_EQ(basis.Multiplicity(1), 4);  // C² of degree 6
}

TEST(TrimEditsTest, WhatWouldLoseLoopsIsRefused) {
  const NurbsSurface plane = MakeBilinear({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0});
  const NurbsSurface next = MakeBilinear({1, 0, 0}, {2, 0, 0}, {1, 1, 0}, {2, 1, 0});
  const NurbsSurface disc = Trimmed(plane, {Circle({0.5, 0.5}, 0.3)});
  EXPECT_THROW(Join(disc, next, Direction::kU, 1e-9), std::invalid_argument);
  EXPECT_THROW(Join(plane, Trimmed(next, {Circle({0.5, 0.5}, 0.3)}), Direction::kU, 1e-9),
               std::invalid_argument);
  EXPECT_NO_THROW(Join(plane, next, Direction::kU, 1e-9));
  EXPECT_THROW(ToBezier(disc), std::invalid_argument);
  const ScalarSpline f{SplineBasis::Uniform(2, 3, 0, 1), Eigen::Vector3d(0, 0.3, 1)};
  EXPECT_THROW(Composed(disc, Direction::kU, f), std::invalid_argument);
}

}  // namespace batten::internal::trim_edits_test
