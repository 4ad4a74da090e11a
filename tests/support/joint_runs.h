// SPDX-License-Identifier: MIT
// The joint stage run on every kind of shape.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include "fitting/joint/joint_optimization.h"
#include "joint_cases.h"

namespace batten::internal {

inline JointResult Solved(const JointCase& c, const JointOptions& options, int threads = 1) {
  ThreadPool pool(threads);
  return OptimizeJointly(c.problem, c.net, c.weights, options, pool);
}

inline JointKind Smooth(JointKind kind) {
  kind.least_degree = 2;
  return kind;
}

// Every kind of shape, with everything free that can be.
inline void ForCases(const std::function<void(RandomSplines&, JointCase&, JointOptions&)>& law,
                     double noise = 0.03,
                     int count = 150) {
  unsigned seed = 0;
  for (JointKind kind : JointKinds()) {
    for (int repeat = 0; repeat < 2; ++repeat) {
      kind = Smooth(kind);
      kind.noise = noise;
      kind.count = count;
      SCOPED_TRACE("seed " + std::to_string(++seed) + ", " + kind.Name());
      RandomSplines random(seed);
      JointCase c = RandomJointCase(random, kind);
      JointOptions options;
      options.free_weights = kind.rational;
      options.free_knots_u = repeat == 1 && !kind.periodic;
      options.free_knots_v = repeat == 1 && !kind.curve;
      options.stop_at_noise = false;
      law(random, c, options);
      if (testing::Test::HasFatalFailure()) return;
    }
  }
}

inline void Perturb(RandomSplines& random, JointCase& c, double distance) {
  for (double& x : c.net.reshaped()) x += random.Real(-distance, distance);
  const SplineBasis& u = c.problem.basis_u();
  if (!u.periodic()) return;
  const Eigen::Index copies = c.net.cols() / u.size() * u.degree();
  c.net.rightCols(copies) = c.net.leftCols(copies).eval();
}

inline bool Ordered(const SplineBasis& basis) {
  return std::is_sorted(basis.knots().begin(), basis.knots().end());
}

inline void ExpectWellFormed(const JointResult& result, const JointCase& c) {
  EXPECT_TRUE(result.control_points.allFinite());
  EXPECT_TRUE(result.weights.allFinite());
  EXPECT_GT(result.weights.minCoeff(), 0);
  EXPECT_TRUE(std::isfinite(result.rms_before) && std::isfinite(result.rms_after));
  EXPECT_TRUE(result.problem.data().parameters.allFinite());
  EXPECT_EQ(result.control_points.cols(), c.net.cols());
  EXPECT_EQ(result.problem.data().values, c.problem.data().values);
  const auto same_domain = [](const SplineBasis& now, const SplineBasis& before) {
    EXPECT_TRUE(Ordered(now));
    EXPECT_EQ(now.size(), before.size());
    EXPECT_EQ(now.lower(), before.lower());
    EXPECT_EQ(now.upper(), before.upper());
  };
  same_domain(result.problem.basis_u(), c.problem.basis_u());
  if (!c.problem.is_curve()) same_domain(result.problem.basis_v(), c.problem.basis_v());
}

}  // namespace batten::internal
