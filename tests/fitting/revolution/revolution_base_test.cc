// SPDX-License-Identifier: MIT
#include "fitting/revolution/revolution_base.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "batten/fitting/cloud_statistics.h"
#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/solve_linear.h"
#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/surface_evaluator.h"
#include "bent_sheets.h"
#include "fitting/revolution/revolution_shape.h"
#include "geometry/numeric/constants.h"
#include "round_clouds.h"

namespace batten::internal {

using namespace round_clouds;

namespace {

using ::testing::HasSubstr;

using BaseOf = decltype(RevolutionBaseOf);

RevolutionParameterization Find(BaseOf base_of, const Eigen::Matrix3Xd& points, int threads = 2) {
  ThreadPool pool(threads);
  const NeighbourIndex index(points);
  const CloudStatistics scale = MeasureCloud(points, index, {.find_outliers = false}, pool);
  const RevolutionSamples round = SampleRevolution(points, index, scale.noise, pool);
  const double margin = scale.spacing / 2 + 2 * scale.noise;
  if (!round.ok()) {
    RevolutionParameterization none;
    none.failure_reason = round.failure_reason;
    return none;
  }
  const RevolutionEstimate shape = FindRevolution(round, pool);
  return base_of({points, round, scale.spacing, scale.noise, margin, &shape}, pool);
}

void ExpectInside(const RevolutionParameterization& base) {
  EXPECT_TRUE(base.parameters.allFinite());
  EXPECT_GE(base.parameters.minCoeff(), 0);
  EXPECT_LE(base.parameters.row(0).maxCoeff(), base.length_u);
  EXPECT_LE(base.parameters.row(1).maxCoeff(), base.length_v);
  if (base.periodic_u) {
    EXPECT_LT(base.parameters.row(0).maxCoeff(), base.length_u);
    EXPECT_EQ(base.turn, kTurn);
  }
  if (base.periodic_v) {
    EXPECT_LT(base.parameters.row(1).maxCoeff(), base.length_v);
  }
}

// Closed where the thing is, with a pole at every end that is on the axis.
void ExpectTopology(const RevolutionParameterization& base, const RoundThing& thing) {
  ASSERT_EQ(base.failure_reason, "");
  ExpectInside(base);
  EXPECT_EQ(base.periodic_u, thing.closed_round()) << base.why;
  EXPECT_EQ(base.periodic_v, thing.closed_profile) << base.why;
  EXPECT_EQ(int{base.pole_start} + int{base.pole_end}, int{thing.pole_start} + int{thing.pole_end})
      << base.why;
}

SplineBasis BasisOf(int spans, double length, bool periodic) {
  if (!periodic) return SplineBasis::Uniform(3, spans + 3, 0, length);
  std::vector<double> knots;
  for (int i = -3; i <= spans + 3; ++i) knots.push_back(length * i / spans);
  return SplineBasis::Periodic(3, std::move(knots));
}

struct Places {
  Eigen::Matrix2Xd parameters;
  double length_u, length_v;
  bool periodic_u, periodic_v;
};

// Root mean square of the distances along the normal of points from the spline of least squares
// over places, 12 spans a direction.
double RmsOfFit(const Places& places, const Eigen::Matrix3Xd& points) {
  ThreadPool pool(2);
  auto data = std::make_shared<FittingData>();
  data->parameters = places.parameters;
  data->values = points.colwise() - points.rowwise().mean();
  const FittingProblem problem(BasisOf(12, places.length_u, places.periodic_u),
                               BasisOf(12, places.length_v, places.periodic_v),
                               data,
                               1e-6);
  const Eigen::MatrixXd coefficients = SolveLinear(problem, pool).coefficients;
  const Eigen::MatrixXd off = EvaluateAt(problem, coefficients, pool) - data->values;
  const SurfaceEvaluator surface(NurbsSurface(problem.basis_u(), problem.basis_v(), coefficients));
  double squares = 0;
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    const auto normal = surface.NormalAt(places.parameters(0, k), places.parameters(1, k));
    if (normal) squares += std::pow(normal->dot(off.col(k)), 2);
  }
  return std::sqrt(squares / static_cast<double>(points.cols()));
}

Places PlacesOf(const RevolutionParameterization& base) {
  return {base.parameters, base.length_u, base.length_v, base.periodic_u, base.periodic_v};
}

Places TruePlaces(const RoundThing& thing, const RoundPoints& cloud) {
  constexpr int kTable = 2000;
  std::vector<double> lengths{0};
  for (int i = 1; i <= kTable; ++i) {
    lengths.push_back(lengths.back() +
                      (thing.profile(1.0 * i / kTable) - thing.profile((i - 1.0) / kTable)).norm());
  }
  Places places{
      cloud.truth, thing.turn, lengths.back(), thing.closed_round(), thing.closed_profile};
  for (double& t : places.parameters.row(1)) {
    const int i = std::min(static_cast<int>(t * kTable), kTable - 1);
    t = lengths[i] + (t * kTable - i) * (lengths[i + 1] - lengths[i]);
  }
  return places;
}

std::vector<RoundThing> Things() {
  return {Can(),
          Cone(),
          Cone(20, 0, 0.6),
          Vase(0),
          Vase(),
          Ball(),
          Egg(),
          Tyre(),
          Washer(),
          Cup(),
          Zone(0, 150),
          Zone(20, 140)};
}

void ExpectTopologies(Eigen::Index count, const std::vector<double>& sigmas, unsigned seed) {
  for (const RoundThing& whole : Things()) {
    for (const RoundThing& thing : {whole, whole.Part(270)}) {
      for (const double sigma : sigmas) {
        SCOPED_TRACE(thing.name + ", sigma " + std::to_string(sigma) + ", seed " +
                     std::to_string(seed));
        const RoundPoints cloud =
            PointsOn(thing, {.count = count, .sigma = sigma, .far = 50, .seed = seed});
        const RevolutionParameterization base = Find(RevolutionBaseOf, cloud.points);
        ExpectTopology(base, thing);
        // The ends are blurred by the noise and the margin.
        EXPECT_NEAR(base.turn, thing.turn, 0.3 + 20 * sigma) << base.why;
      }
    }
  }
}

TEST(RevolutionBaseTest, KnowsWhatIsClosedAndWherePolesAre) { ExpectTopologies(6000, {1e-3}, 3); }

TEST(LongRoundBaseTest, KnowsWhatIsClosedAndWherePolesAre) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    ExpectTopologies(10000, {0.0, 1e-3, 1e-2}, seed);
    ExpectTopologies(40000, {1e-3}, seed);
  }
}

// A smooth map of the true angle and length: fits over it are as good as over the true ones.
TEST(RevolutionBaseTest, GivesSmoothParameters) {
  for (const RoundThing& whole :
       {Can(), Cone(), Vase(0), Ball(), Egg(), Tyre(), Zone(20, 140), Cup(0.3)}) {
    for (const RoundThing& thing : {whole, whole.Part(270)}) {
      SCOPED_TRACE(thing.name);
      const RoundPoints cloud = PointsOn(thing, {.count = 8000, .seed = 5});
      const RevolutionParameterization base = Find(RevolutionBaseOf, cloud.points);
      ASSERT_EQ(base.failure_reason, "");
      // The angle is swept by the range and a margin, which makes the spans some percent longer;
      // errors of cubics go with the fourth power.
      EXPECT_LE(RmsOfFit(PlacesOf(base), cloud.points),
                1.6 * RmsOfFit(TruePlaces(thing, cloud), cloud.points));
    }
  }
}

TEST(RevolutionBaseTest, MeasuresLengths) {
  for (const RoundThing& thing : {Can(), Vase(0), Ball(), Egg(), Tyre()}) {
    SCOPED_TRACE(thing.name);
    const RoundPoints cloud = PointsOn(thing, {.count = 20000, .sigma = 1e-4, .seed = 2});
    const RevolutionParameterization base = Find(RevolutionBaseOf, cloud.points);
    ASSERT_EQ(base.failure_reason, "");
    const double length = thing.LengthTo(1);
    EXPECT_NEAR(base.length_v, length, 0.02 * length);
    EXPECT_LT(base.misfit, 3e-3);
  }
}

TEST(RevolutionBaseTest, FollowsUnevenDensity) {
  for (const RoundThing& thing : {Can(), Vase(0), Ball(), Cone(20, 0, 0.6)}) {
    SCOPED_TRACE(thing.name);
    const RoundPoints cloud =
        PointsOn(thing, {.count = 20000, .sigma = 1e-3, .density = 10, .seed = 4});
    ExpectTopology(Find(RevolutionBaseOf, cloud.points), thing);
  }
}

TEST(RevolutionBaseTest, PassesOverStrays) {
  for (const RoundThing& thing : {Can(), Vase(), Ball().Part(270), Tyre()}) {
    SCOPED_TRACE(thing.name);
    RoundPoints cloud = PointsOn(thing, {.count = 10000, .sigma = 1e-3, .seed = 8});
    const Eigen::Vector3d low = cloud.points.rowwise().minCoeff(),
                          high = cloud.points.rowwise().maxCoeff();
    std::mt19937_64 engine(8);
    std::uniform_real_distribution<double> uniform(-0.2, 1.2);
    for (auto p : cloud.points.leftCols(10).colwise()) {
      for (int d = 0; d < 3; ++d) p[d] = low[d] + uniform(engine) * (high[d] - low[d]);
    }
    const RevolutionParameterization base = Find(RevolutionBaseOf, cloud.points);
    ExpectTopology(base, thing);
    EXPECT_NEAR(base.length_v, thing.LengthTo(1), 0.1 * thing.LengthTo(1));
  }
}

TEST(RevolutionBaseTest, StaysClosedWithPatchesMissing) {
  const RoundThing can = Can();
  const auto inside = [](double angle, double t) {
    return !(std::hypot(angle - 1, 2 * (t - 0.3)) < 0.4 || std::hypot(angle - 4, t - 0.9) < 0.3 ||
             (angle > 2.5 && angle < 2.9 && t < 0.4));
  };
  const RoundPoints cloud =
      PointsOn(can, {.count = 10000, .sigma = 1e-3, .seed = 6, .inside = inside});
  ExpectTopology(Find(RevolutionBaseOf, cloud.points), can);
}

TEST(RevolutionBaseTest, TellsAHoleFromAPole) {
  for (const double spacings : {0.0, 2.0, 5.0, 10.0}) {
    SCOPED_TRACE(std::to_string(spacings) + " spacings");
    const Eigen::Index count = 20000;
    const double spacing = std::sqrt(2 * kTurn / static_cast<double>(count));
    const auto inside = [&](double, double t) {
      return std::sin(std::numbers::pi * t) > spacings * spacing || t < 0.5;
    };
    const RoundPoints cloud =
        PointsOn(Ball(), {.count = count, .sigma = 1e-3, .seed = 7, .inside = inside});
    for (BaseOf* base_of : {RevolutionBaseOf, SphereBaseOf}) {
      const RevolutionParameterization base = Find(base_of, cloud.points);
      ASSERT_EQ(base.failure_reason, "");
      // A small hole is none; a larger one draws an axis to it and opens one end.
      EXPECT_EQ(int{base.pole_start} + int{base.pole_end}, spacings > 3 ? 1 : 2) << base.why;
      EXPECT_TRUE(base.periodic_u);
    }
  }
}

// A spiral has no gap in its angles, but no way round it closes.
TEST(RevolutionBaseTest, DoesNotCloseASpiral) {
  for (const double apart : {0.1, 0.15, 0.25}) {
    const BentSheet roll = Roll(1.5, apart, 0.6);
    const SheetPoints cloud = PointsOn(roll, {.count = 10000, .sigma = 1e-3, .isotropic = true});
    const RevolutionParameterization base = Find(RevolutionBaseOf, cloud.points);
    EXPECT_FALSE(base.ok() && base.periodic_u) << base.why;
    if (base.ok()) ExpectInside(base);
  }
}

TEST(RevolutionBaseTest, RefusesWhatHasNoAxis) {
  for (const BentSheet& sheet : {FlatSheet(), TwistedBand(2)}) {
    SCOPED_TRACE(sheet.name);
    const RevolutionParameterization base =
        Find(RevolutionBaseOf, PointsOn(sheet, {.count = 6000, .sigma = 1e-3}).points);
    EXPECT_NE(base.failure_reason, "");
  }
  std::mt19937_64 engine(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Eigen::Matrix3Xd cube(3, 12000);
  for (Eigen::Index k = 0; k < cube.cols(); ++k) {
    for (double& x : cube.col(k)) x = uniform(engine);
    cube(k % 3, k) = k % 2 == 0 ? 1 : -1;
  }
  const RevolutionParameterization base = Find(RevolutionBaseOf, cube);
  EXPECT_NE(base.failure_reason, "") << base.why << base.misfit;
  EXPECT_NE(Find(SphereBaseOf, cube).failure_reason, "");
  EXPECT_NE(Find(TorusBaseOf, cube).failure_reason, "");
}

// As flat as a sheet, but its normals lie along the plane it is near.
TEST(RevolutionBaseTest, FindsNarrowHoops) {
  for (const double height : {0.1, 0.02}) {
    const RoundThing hoop = Can(0.5, height);
    for (const RoundThing& thing : {hoop, hoop.Part(200)}) {
      SCOPED_TRACE(thing.name + ", height " + std::to_string(height));
      ExpectTopology(Find(RevolutionBaseOf, PointsOn(thing, {.count = 6000, .sigma = 2e-4}).points),
                     thing);
    }
  }
}

TEST(SphereBaseTest, FindsSpheresWholeAndInPart) {
  for (const RoundThing& whole : {Ball(), Zone(0, 100), Zone(20, 140)}) {
    for (const RoundThing& thing : {whole, whole.Part(270)}) {
      for (const double sigma : {0.0, 1e-2}) {
        SCOPED_TRACE(thing.name + ", sigma " + std::to_string(sigma));
        const RoundPoints cloud = PointsOn(thing, {.count = 5000, .sigma = sigma, .seed = 9});
        const RevolutionParameterization base = Find(SphereBaseOf, cloud.points);
        ExpectTopology(base, thing);
        EXPECT_LE(base.misfit, sigma + 1e-4);
      }
    }
  }
}

TEST(TorusBaseTest, FindsToriWholeAndInPart) {
  for (const double tube : {0.1, 0.35, 0.7}) {
    for (const RoundThing& thing :
         {Tyre(1, tube), Tyre(1, tube).Part(270), Tyre(1, tube).Part(120)}) {
      for (const double sigma : {0.0, 1e-2}) {
        SCOPED_TRACE(thing.name + ", sigma " + std::to_string(sigma));
        const RoundPoints cloud = PointsOn(thing, {.count = 8000, .sigma = sigma, .seed = 9});
        const RevolutionParameterization base = Find(TorusBaseOf, cloud.points);
        ExpectTopology(base, thing);
        // Quadrics around nodes are wrong to the fourth order of the reach.
        EXPECT_LE(base.misfit, sigma + 3e-4);
      }
    }
  }
}

TEST(TorusBaseTest, RefusesOtherShapesOfRevolution) {
  for (const RoundThing& thing : {Can(), Cone(), Ball(), Cup()}) {
    SCOPED_TRACE(thing.name);
    EXPECT_NE(
        Find(TorusBaseOf, PointsOn(thing, {.count = 5000, .sigma = 1e-3}).points).failure_reason,
        "");
  }
}

TEST(RevolutionParameterizationTest, ScalesWithTheUnitAndStandsFarAway) {
  for (const RoundThing& thing : {Can(), Ball(), Tyre()}) {
    SCOPED_TRACE(thing.name);
    const RevolutionParameterization base =
        Find(RevolutionBaseOf, PointsOn(thing, {.count = 5000, .sigma = 1e-3}).points);
    for (const double unit : {1e-6, 1e6}) {
      const RevolutionParameterization other = Find(
          RevolutionBaseOf, PointsOn(thing, {.count = 5000, .sigma = 1e-3, .unit = unit}).points);
      // Which points are nodes depends on the coordinates: the mean radius of 600 of them, which
      // vary by a third of it on a sphere, is right to 0.014.
      EXPECT_NEAR(other.length_u, unit * base.length_u, 0.04 * unit * base.length_u);
      EXPECT_NEAR(other.length_v, unit * base.length_v, 0.01 * unit * base.length_v);
    }
    ExpectTopology(
        Find(RevolutionBaseOf, PointsOn(thing, {.count = 5000, .sigma = 1e-3, .far = 5e6}).points),
        thing);
  }
}

TEST(RevolutionParameterizationTest, GivesTheSameBitsForEveryNumberOfThreads) {
  for (BaseOf* base_of : {RevolutionBaseOf, SphereBaseOf, TorusBaseOf}) {
    for (const RoundThing& thing : {Ball(), Tyre(), Vase()}) {
      const Eigen::Matrix3Xd points = PointsOn(thing, {.count = 6000, .sigma = 1e-3}).points;
      const RevolutionParameterization one = Find(base_of, points, 1),
                                       three = Find(base_of, points, 3);
      EXPECT_EQ(one.parameters, three.parameters);
      EXPECT_EQ(one.misfit, three.misfit);
      EXPECT_EQ(one.why, three.why);
      EXPECT_EQ(one.failure_reason, three.failure_reason);
    }
  }
}

// Both poles may be sought among the same points.
TEST(RevolutionParameterizationTest, FewRoughPointsHaveTheirEndsInOrder) {
  int found = 0;
  for (const Eigen::Index count : {40, 60, 90, 120}) {
    for (const double sigma : {0.03, 0.1, 0.2}) {
      for (const double part : {0.5, 0.7, 1.0}) {
        for (unsigned seed = 1; seed <= 12; ++seed) {
          SCOPED_TRACE(testing::Message() << count << " points, sigma " << sigma << ", part "
                                          << part << ", seed " << seed);
          const auto inside = [&](double, double t) { return t <= part; };
          const RoundPoints cloud =
              PointsOn(Ball(), {.count = count, .sigma = sigma, .seed = seed, .inside = inside});
          for (BaseOf* base_of : {RevolutionBaseOf, SphereBaseOf}) {
            const RevolutionParameterization base = Find(base_of, cloud.points);
            if (!base.ok()) continue;
            ++found;
            EXPECT_GT(base.length_u, 0);
            EXPECT_GT(base.length_v, 0);
            ExpectInside(base);
          }
        }
      }
    }
  }
  EXPECT_GT(found, 0);
}

TEST(RevolutionParameterizationTest, SurvivesAnyCloud) {
  std::mt19937_64 engine(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int round = 0; round < 24; ++round) {
    SCOPED_TRACE("round " + std::to_string(round));
    Eigen::Matrix3Xd points(3, 1 + 97 * round);
    for (double& x : points.reshaped()) x = uniform(engine);
    if (round % 4 == 1) points.row(2) *= 1e-9;
    if (round % 4 == 2) points = (points * 4).array().round().matrix().eval();
    if (round % 4 == 3) points.bottomRows(2).setZero();
    for (BaseOf* base_of : {RevolutionBaseOf, SphereBaseOf, TorusBaseOf}) {
      const RevolutionParameterization base = Find(base_of, points);
      if (!base.ok()) continue;
      EXPECT_EQ(base.parameters.cols(), points.cols());
      ExpectInside(base);
    }
  }
}

}  // namespace
}  // namespace batten::internal
