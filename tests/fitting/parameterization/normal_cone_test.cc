// SPDX-License-Identifier: MIT
#include "fitting/parameterization/normal_cone.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "batten/fitting/statistics.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::normal_cone_test {

using std::numbers::pi;

// Evenly over the cap of half an angle about an axis.
Eigen::Matrix3Xd Cap(RandomSplines& random, const Eigen::Matrix3d& frame, double half, int count) {
  Eigen::Matrix3Xd normals(3, count);
  for (int k = 0; k < count; ++k) {
    const double z = random.Real(std::cos(half), 1), r = std::sqrt(1 - z * z),
                 angle = random.Real(0, 2 * pi);
    normals.col(k) = frame * Eigen::Vector3d(r * std::cos(angle), r * std::sin(angle), z);
  }
  return normals;
}

// What the axis makes as great as can be.
double LowCosine(const Eigen::Matrix3Xd& normals,
                 const Eigen::Vector3d& axis,
                 const NormalConeOptions& options) {
  Eigen::VectorXd cosines = normals.transpose() * axis;
  if (!options.one_sided) cosines = cosines.cwiseAbs();
  return Quantile({cosines.begin(), cosines.end()}, options.share);
}

TEST(NormalConeTest, IsTheAxisOfACapOfNormals) {
  RandomSplines random(1);
  for (const double half : {0.2, 0.7, 1.2}) {
    for (const bool one_sided : {false, true}) {
      SCOPED_TRACE(testing::Message() << half << (one_sided ? " one-sided" : ""));
      const Eigen::Matrix3d frame = random.Orthogonal();
      Eigen::Matrix3Xd normals = Cap(random, frame, half, 4000);
      for (Eigen::Index k = 0; !one_sided && k < normals.cols(); k += 2) normals.col(k) *= -1;
      const Eigen::Vector3d start = (frame * Eigen::Vector3d(0.3, -0.2, 1)).normalized();
      const Eigen::Vector3d axis =
          NormalCone(normals, start, {.one_sided = one_sided, .rounds = 200});
      EXPECT_NEAR(axis.norm(), 1, kRounding);
      // 200 of 4000 lie beyond the quantile: its edge is known to some hundredths.
      EXPECT_GT(std::abs(axis.dot(frame.col(2))), std::cos(0.05));
    }
  }
}

TEST(NormalConeTest, IsNoWorseThanTheStart) {
  RandomSplines random(2);
  for (int round = 0; round < 30; ++round) {
    SCOPED_TRACE(round);
    const Eigen::Matrix3Xd normals =
        Cap(random, random.Orthogonal(), random.Real(0.1, pi), random.Integer(1, 500));
    const NormalConeOptions options{
        .share = random.Real(0, 0.3), .one_sided = random.Coin(), .rounds = random.Integer(0, 80)};
    const Eigen::Vector3d start = random.Orthogonal().col(0);
    const Eigen::Vector3d axis = NormalCone(normals, start, options);
    EXPECT_GE(LowCosine(normals, axis, options), LowCosine(normals, start, options) - kRounding);
  }
}

TEST(NormalConeTest, DoesNotLookAtSignsOfLines) {
  RandomSplines random(3);
  const Eigen::Matrix3d frame = random.Orthogonal();
  const Eigen::Matrix3Xd normals = Cap(random, frame, 0.8, 1000);
  Eigen::Matrix3Xd flipped = normals;
  for (Eigen::Index k = 0; k < flipped.cols(); ++k)
    if (random.Coin()) flipped.col(k) *= -1;
  const Eigen::Vector3d start = frame.col(2);
  EXPECT_EQ(NormalCone(normals, start, {}), NormalCone(flipped, start, {}));
}

}  // namespace batten::internal::normal_cone_test
