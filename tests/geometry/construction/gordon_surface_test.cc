// SPDX-License-Identifier: MIT
#include "batten/geometry/gordon_surface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "batten/geometry/closure.h"
#include "batten/geometry/composition.h"
#include "batten/geometry/foot_point.h"
#include "batten/geometry/iso_curve.h"
#include "batten/geometry/make_curve.h"
#include "batten/geometry/make_surface.h"
#include "batten/geometry/reverse.h"
#include "batten/geometry/split.h"
#include "construction_cases.h"
#include "refusal.h"
#include "tolerances.h"

namespace batten::internal::gordon_surface_test {

using ::testing::HasSubstr;
using Curves = std::vector<NurbsCurve<3>>;

struct Network {
  Curves along_u, along_v;
};

// A wavy surface over [0, 10] × [0, 8].
NurbsSurface Wavy(int seed, int p = 3, int q = 3, int m = 7, int n = 6) {
  RandomSplines random(seed);
  Eigen::Matrix3Xd points(3, m * n);
  for (int i = 0; i < m; ++i) {
    for (int j = 0; j < n; ++j) {
      points.col(i * n + j) =
          Eigen::Vector3d(10.0 * i / (m - 1), 8.0 * j / (n - 1), 0) + random.Vector(0.4);
    }
  }
  return NurbsSurface(SplineBasis::Uniform(p, m, 0, 1), SplineBasis::Uniform(q, n, 0, 1), points);
}

Network IsoNetwork(const NurbsSurface& surface,
                   const std::vector<double>& us,
                   const std::vector<double>& vs) {
  Network network;
  for (const double v : vs) network.along_u.push_back(IsoCurve(surface, Direction::kV, v));
  for (const double u : us) network.along_v.push_back(IsoCurve(surface, Direction::kU, u));
  return network;
}

// The largest distance of points of the curves from the surface.
double FarthestFrom(const NurbsSurface& surface, const Network& network) {
  const SurfaceFootPoints feet(surface);
  double worst = 0;
  for (const Curves* curves : {&network.along_u, &network.along_v}) {
    for (const NurbsCurve<3>& curve : *curves) {
      for (int k = 0; k <= 60; ++k) {
        worst = std::max(worst, feet.Nearest(AtShare(curve, k / 60.0)).distance);
      }
    }
  }
  return worst;
}

const std::vector<double> kUs = {0, 0.2, 0.45, 0.8, 1}, kVs = {0, 0.3, 0.6, 1};

TEST(GordonTest, ContainsEveryCurve) {
  for (int seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const NurbsSurface surface = Wavy(seed, 1 + seed % 4, 1 + seed % 3);
    const Network network = IsoNetwork(surface, kUs, kVs);
    const GordonSurface gordon = Gordon(network.along_u, network.along_v, {.tolerance = 1e-6});
    EXPECT_LE(gordon.error, 1e-9);
    for (std::size_t k = 0; k < kVs.size(); ++k) {
      EXPECT_NEAR(gordon.v[k], kVs[k], kIterated);
      EXPECT_LE(DistanceAlong(
                    gordon.surface,
                    [&](double t) { return Eigen::Vector2d(t, gordon.v[k]); },
                    [&](double t) { return network.along_u[k].At(t); }),
                1e-8);
    }
    for (std::size_t l = 0; l < kUs.size(); ++l) {
      EXPECT_LE(DistanceAlong(
                    gordon.surface,
                    [&](double t) { return Eigen::Vector2d(gordon.u[l], t); },
                    [&](double t) { return network.along_v[l].At(t); }),
                1e-8);
    }
  }
}

TEST(GordonTest, ABicubicIsRecovered) {
  const NurbsSurface surface = Wavy(4, 3, 3, 4, 4);
  const Network network = IsoNetwork(surface, {0, 0.3, 0.7, 1}, {0, 0.4, 0.8, 1});
  const GordonSurface gordon = Gordon(network.along_u, network.along_v, {.tolerance = 1e-6});
  EXPECT_LE(LargestDifference(gordon.surface, surface), 1e-8);
}

TEST(GordonTest, OrderDirectionAndOverhangDoNotMatter) {
  const NurbsSurface surface = Wavy(2);
  // Lines inside the domain: every curve overhangs.
  Network network = IsoNetwork(surface, {0.1, 0.4, 0.5, 0.9}, {0.15, 0.5, 0.95});
  std::mt19937 shuffler(7);
  std::ranges::shuffle(network.along_u, shuffler);
  std::ranges::shuffle(network.along_v, shuffler);
  network.along_u[1] = Reversed(network.along_u[1]);
  network.along_v[2] = Reversed(network.along_v[2]);
  network.along_v[0] = Reversed(network.along_v[0]);
  const GordonSurface gordon = Gordon(network.along_u, network.along_v, {.tolerance = 1e-6});
  const auto at = [&](double from, double to, double share) { return from + share * (to - from); };
  const NurbsSurface part = Segment(surface, 0.1, 0.9, 0.15, 0.95);
  Network cut;
  for (const double v : {0.15, 0.5, 0.95}) cut.along_u.push_back(IsoCurve(part, Direction::kV, v));
  for (const double u : {0.1, 0.4, 0.5, 0.9})
    cut.along_v.push_back(IsoCurve(part, Direction::kU, u));
  EXPECT_LE(FarthestFrom(gordon.surface, cut), 1e-7);
  EXPECT_EQ(at(0, 1, 0.5), 0.5);
}

TEST(GordonTest, CurvesThatRunAtOtherPacesAreTracedAnewWithinTheTolerance) {
  for (int seed = 0; seed < 10; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsSurface surface = Wavy(seed);
    Network network = IsoNetwork(surface, kUs, kVs);
    for (Curves* curves : {&network.along_u, &network.along_v}) {
      for (NurbsCurve<3>& curve : *curves) {
        const double bend = random.Real(0.25, 0.75);
        curve = Composed(
            curve, ScalarSpline{SplineBasis::Uniform(2, 3, 0, 1), Eigen::Vector3d(0, bend, 1)});
      }
    }
    const GordonSurface gordon = Gordon(network.along_u, network.along_v, {.tolerance = 1e-5});
    EXPECT_GT(gordon.error, 0);
    EXPECT_LE(gordon.error, 1e-5);
    EXPECT_LE(FarthestFrom(gordon.surface, network), 1e-5);
    EXPECT_LE(gordon.surface.size_u() * gordon.surface.size_v(), 200 * 200);
  }
}

TEST(GordonTest, CurvesWithWeightsKeepTheTolerance) {
  // Quarter circles over a quarter of a torus.
  const NurbsSurface torus = MakeTorus(Frame(), 5, 2, {0, 1.5}, {-1, 2});
  const Network network = IsoNetwork(torus, {0, 0.5, 1}, {0, 0.4, 1});
  const GordonSurface gordon = Gordon(network.along_u, network.along_v, {.tolerance = 1e-6});
  EXPECT_FALSE(gordon.surface.rational());
  EXPECT_LE(FarthestFrom(gordon.surface, network), 1e-6);
}

TEST(GordonTest, ClosedNetworksAreSmoothAtTheSeam) {
  const NurbsSurface torus = MakeTorus(Frame(), 5, 2);
  std::vector<double> places;
  for (int k = 0; k < 8; ++k) places.push_back(k / 8.0);
  Network network = IsoNetwork(torus, places, places);
  network.along_u[3] = Reversed(network.along_u[3]);
  // Seams anywhere.
  network.along_v[2] = MakeArc(Frame({0, 5, 0}, {-1, 0, 0}, {0, -1, 2}), 2);
  const GordonSurface gordon = Gordon(network.along_u, network.along_v, {.tolerance = 1e-5});
  EXPECT_TRUE(Closed(gordon.surface, Direction::kU, 1e-7));
  EXPECT_TRUE(Closed(gordon.surface, Direction::kV, 1e-7));
  EXPECT_GE(SeamContinuity(gordon.surface, Direction::kU, 1e-5).value_or(-1), 1);
  EXPECT_GE(SeamContinuity(gordon.surface, Direction::kV, 1e-5).value_or(-1), 1);
  EXPECT_LE(FarthestFrom(gordon.surface, network), 1e-5);
}

TEST(GordonTest, FarAwayAndTiny) {
  for (const Eigen::Matrix4d& map : {Translation({5e6, 4e6, 100}), Scaling(1e-6)}) {
    const double scale = map(0, 0);
    const NurbsSurface surface = Transformed(Wavy(6), map);
    const Network network = IsoNetwork(surface, kUs, kVs);
    const GordonSurface gordon =
        Gordon(network.along_u, network.along_v, {.tolerance = 1e-5 * scale});
    EXPECT_LE(FarthestFrom(gordon.surface, network), 1e-6 * scale);
  }
}

TEST(GordonTest, Refusals) {
  const NurbsSurface surface = Wavy(1);
  Network network = IsoNetwork(surface, kUs, kVs);
  network.along_v[2] = Transformed(network.along_v[2], Translation({0, 0, 0.3}));
  const std::string apart =
      RefusalOf([&] { Gordon(network.along_u, network.along_v, {.tolerance = 0.001}); });
  EXPECT_THAT(apart, HasSubstr("curve 1 along u and curve 3 along v do not meet: they are 0."));
  EXPECT_THAT(apart, HasSubstr("above the tolerance 0.001"));
  network = IsoNetwork(surface, kUs, kVs);
  EXPECT_THAT(
      RefusalOf([&] { Gordon({network.along_u[0]}, network.along_v, {.tolerance = 0.001}); }),
      HasSubstr("at least two"));
  EXPECT_THAT(RefusalOf([&] { Gordon(network.along_u, network.along_v, {}); }),
              HasSubstr("tolerance"));
  // Two curves along v that cross.
  Network crossed;
  crossed.along_u = {MakeLine<3>({0, 0, 0}, {4, 0, 0}), MakeLine<3>({0, 4, 0}, {4, 4, 0})};
  crossed.along_v = {MakeLine<3>({0, 0, 0}, {4, 4, 0}), MakeLine<3>({4, 0, 0}, {0, 4, 0})};
  EXPECT_THAT(RefusalOf([&] { Gordon(crossed.along_u, crossed.along_v, {.tolerance = 0.001}); }),
              HasSubstr("curves of one direction are not to meet"));
  crossed.along_u.insert(crossed.along_u.begin() + 1, MakeLine<3>({0, 2, 0}, {4, 2, 0}));
  EXPECT_THAT(RefusalOf([&] { Gordon(crossed.along_u, crossed.along_v, {.tolerance = 0.001}); }),
              HasSubstr("curves of one direction are not to meet"));
  // A circle meets a line twice.
  const Curves twice = {MakeArc(Frame(), 1), MakeArc(Frame({0, 0, 1}, {0, 0, 1}), 1)};
  EXPECT_THAT(RefusalOf([&] {
                Gordon({MakeLine<3>({-2, 0, 0}, {2, 0, 0}), MakeLine<3>({-2, 0, 1}, {2, 0, 1})},
                       twice,
                       {.tolerance = 0.001});
              }),
              HasSubstr("two curves cross them"));
}

}  // namespace batten::internal::gordon_surface_test
