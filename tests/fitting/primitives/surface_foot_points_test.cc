// SPDX-License-Identifier: MIT
#include "fitting/primitives/surface_patch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "batten/fitting/fit_primitive.h"
#include "fitting/primitives/surface_primitive.h"
#include "geometry/numeric/constants.h"
#include "primitive_clouds.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::surface_foot_points_test {

Eigen::Vector3d At(const ExactTorus& torus, double round, double tube) {
  const double out = torus.major + torus.minor * std::cos(tube);
  return torus.frame.At(out * std::cos(round), out * std::sin(round), torus.minor * std::sin(tube));
}

// Places of the whole patch, edges too.
struct Dense {
  static constexpr int kSteps = 240;
  std::vector<Eigen::Vector3d> places;
  double area = 0;

  explicit Dense(const ExactTorus& torus) {
    const double step_u = torus.round.sweep / kSteps, step_v = torus.tube.sweep / kSteps;
    for (int i = 0; i <= kSteps; ++i) {
      for (int j = 0; j <= kSteps; ++j) {
        places.push_back(At(torus, torus.round.start + i * step_u, torus.tube.start + j * step_v));
      }
    }
    for (int j = 0; j < kSteps; ++j) {
      const double tube = torus.tube.start + (j + 0.5) * step_v;
      area += std::abs(torus.major + torus.minor * std::cos(tube)) * torus.round.sweep *
              torus.minor * step_v;
    }
  }

  double DistanceFrom(const Eigen::Vector3d& p) const {
    double least = std::numeric_limits<double>::infinity();
    for (const Eigen::Vector3d& place : places) least = std::min(least, (p - place).norm());
    return least;
  }
};

// The inner arc, the outer arc, both, and a part of both, of a torus that passes its axis.
ExactTorus RandomSpindle(int trial, RandomSplines& random) {
  const double minor = random.Real(0.5, 1), major = random.Real(0.1, 0.9) * minor;
  const double axis = std::acos(major / minor);  // from the middle of the inner arc
  constexpr double kHalf = std::numbers::pi;
  const Frame frame(random.Vector(1), random.Orthogonal().col(0));
  const AngleRange inner{kHalf - axis, 2 * axis}, outer{axis - kHalf, 2 * (kHalf - axis)};
  const AngleRange both{0, kTurn}, part{kHalf / 2, kHalf};
  return {frame,
          major,
          minor,
          trial % 3 == 0 ? AngleRange{random.Real(0, 6), random.Real(1, 3)} : AngleRange{0, kTurn},
          std::array{inner, outer, both, part}[static_cast<size_t>(trial % 4)]};
}

// Of points up to `off` from places that keep the share `margin` of each angle from its ends.
void ExpectNoPlaceNearer(const ExactTorus& torus,
                         const Dense& dense,
                         double margin,
                         double off,
                         RandomSplines& random,
                         ThreadPool& pool) {
  const NurbsSurface surface = ToNurbs(torus);
  Eigen::Matrix3Xd points(3, 60);
  for (auto p : points.colwise()) {
    p = At(torus,
           torus.round.start + random.Real(margin, 1 - margin) * torus.round.sweep,
           torus.tube.start + random.Real(margin, 1 - margin) * torus.tube.sweep) +
        random.Vector(off);
  }
  const Eigen::Matrix2Xd feet = FootPointsOn(torus, points, pool);
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    const double distance = (points.col(k) - surface.At(feet(0, k), feet(1, k))).norm();
    EXPECT_LE(distance, dense.DistanceFrom(points.col(k)) + kRounding) << k;
  }
}

TEST(SurfaceFootPointsTest, OfASpindleNoPlaceIsNearer) {
  RandomSplines random(5);
  ThreadPool pool(1);
  for (int trial = 0; trial < 24; ++trial) {
    SCOPED_TRACE("seed 5, trial " + std::to_string(trial));
    const ExactTorus torus = RandomSpindle(trial, random);
    const Dense dense(torus);
    ExpectNoPlaceNearer(torus, dense, 0.1, 0.02, random, pool);
    const double of_steps = 2.0 / Dense::kSteps;  // midpoints beside the kinks at the axis
    EXPECT_NEAR(AreaOf(torus), dense.area, of_steps * dense.area);
  }
}

// Also beside the ends of its angles, where the feet are on its edges.
TEST(SurfaceFootPointsTest, OfAPieceOfARingNoPlaceIsNearer) {
  RandomSplines random(7);
  ThreadPool pool(1);
  for (int trial = 0; trial < 24; ++trial) {
    SCOPED_TRACE("seed 7, trial " + std::to_string(trial));
    const ExactTorus torus{Frame(random.Vector(1), random.Orthogonal().col(0)),
                           1,
                           random.Real(0.1, 0.9),
                           {random.Real(0, 6), random.Real(0.5, 3)},
                           {random.Real(0, 6), random.Real(0.5, 4)}};
    ExpectNoPlaceNearer(torus, Dense(torus), -0.1, 0.1, random, pool);
  }
}

// Fitted to either arc, the patch has its feet, signs and spacing there.
TEST(SurfaceFootPointsTest, OfAFittedSpindleAreOnTheArcOfThePoints) {
  RandomSplines random(6);
  for (int trial = 0; trial < 12; ++trial) {
    SCOPED_TRACE("seed 6, trial " + std::to_string(trial));
    ExactTorus torus = RandomSpindle(trial % 2, random);
    torus.major = torus.minor * random.Real(0.3, 0.8);
    const double axis = std::acos(torus.major / torus.minor), pi = std::numbers::pi;
    torus.round = {0, kTurn};
    torus.tube =
        trial % 2 == 0 ? AngleRange{pi - axis, 2 * axis} : AngleRange{axis - pi, 2 * (pi - axis)};
    Eigen::Matrix3Xd points(3, 800);
    for (auto p : points.colwise()) {
      p = At(torus,
             random.Real(0, kTurn),
             torus.tube.start + random.Real(0.1, 0.9) * torus.tube.sweep) +
          random.Vector(1e-3);
    }
    const PrimitiveFit fit = FitPrimitive(Cloud(points, false), Options(PrimitiveKind::kTorus));
    const NurbsSurface& surface = std::get<NurbsSurface>(fit.geometry);
    EXPECT_NEAR(std::get<TorusShape>(fit.shape).major_radius, torus.major, 0.01);
    EXPECT_NEAR(std::get<TorusShape>(fit.shape).minor_radius, torus.minor, 0.01);
    for (Eigen::Index k = 0; k < points.cols(); ++k) {
      const double u = fit.parameters(0, k), v = fit.parameters(1, k);
      const Eigen::Vector3d from = points.col(k) - surface.At(u, v);
      ASSERT_NEAR(from.norm(), std::abs(fit.residuals[k]), 1e-11) << k;
      ASSERT_NEAR(from.dot(surface.NormalAt(u, v).value()), fit.residuals[k], 1e-11) << k;
    }
    const double spacing = std::sqrt(0.8 * Dense(torus).area / 800);
    EXPECT_NEAR(fit.report.input.spacing, spacing, 0.2 * spacing);
  }
}

}  // namespace batten::internal::surface_foot_points_test
