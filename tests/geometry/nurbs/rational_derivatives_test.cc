// SPDX-License-Identifier: MIT
#include "geometry/nurbs/rational_derivatives.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "batten/geometry/spline_basis.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::rational_derivatives_test {

TEST(RationalDerivativesTest, BinomialsFollowPascalsTriangleExactly) {
  for (int n = 1; n <= 2 * kMaxDegree; ++n) {
    EXPECT_EQ(Binomial(n, 0), 1);
    EXPECT_EQ(Binomial(n, n), 1);
    for (int k = 1; k < n; ++k) {
      EXPECT_EQ(Binomial(n, k), Binomial(n - 1, k - 1) + Binomial(n - 1, k)) << n << " over " << k;
    }
  }
}

// With any derivatives of C and w, those of w·C follow from Leibniz' rule; the function must undo
// it.
TEST(RationalDerivativesTest, UndoTheProductRuleOfACurve) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int order = random.Integer(0, 8), dimension = random.Integer(1, 3);
    Eigen::MatrixXd curve(dimension, order + 1), homogeneous(dimension + 1, order + 1);
    Eigen::VectorXd weight(order + 1);
    for (double& x : curve.reshaped()) x = random.Real(-1, 1);
    for (double& w : weight) w = random.Real(-1, 1);
    weight[0] = random.Real(1, 2);
    for (int k = 0; k <= order; ++k) {
      Eigen::VectorXd sum = Eigen::VectorXd::Zero(dimension);
      for (int i = 0; i <= k; ++i) sum += Binomial(k, i) * weight[i] * curve.col(k - i);
      homogeneous.col(k) << sum, weight[k];
    }
    const double size = homogeneous.cwiseAbs().maxCoeff();
    RationalCurveDerivatives(homogeneous);
    // Each order multiplies earlier errors by at most Σ C(k,i)|w_i|/w_0 ≤ 2^k.
    const double bound = kRounding * size * std::pow(2, order);
    EXPECT_NEAR((homogeneous.topRows(dimension) - curve).cwiseAbs().maxCoeff(), 0, bound);
  }
}

TEST(RationalDerivativesTest, UndoTheProductRuleOfASurface) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int order = random.Integer(0, 5), stride = order + 1;
    Eigen::Matrix4Xd all(4, stride * stride);  // rows: S, then w
    for (double& x : all.reshaped()) x = random.Real(-1, 1);
    all(3, 0) = random.Real(1, 2);
    Eigen::Matrix4Xd homogeneous = all;
    for (int k = 0; k <= order; ++k) {
      for (int l = 0; k + l <= order; ++l) {
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        for (int i = 0; i <= k; ++i) {
          for (int j = 0; j <= l; ++j) {
            sum += Binomial(k, i) * Binomial(l, j) * all(3, i * stride + j) *
                   all.col((k - i) * stride + l - j).head<3>();
          }
        }
        homogeneous.col(k * stride + l).head<3>() = sum;
      }
    }
    const double size = homogeneous.cwiseAbs().maxCoeff();
    RationalSurfaceDerivatives(order, homogeneous);
    for (int k = 0; k <= order; ++k) {
      for (int l = 0; k + l <= order; ++l) {
        const Eigen::Index column = k * stride + l;
        EXPECT_NEAR((homogeneous.col(column) - all.col(column)).head<3>().norm(),
                    0,
                    kRounding * size * std::pow(4, k + l))
            << k << ", " << l;
      }
    }
  }
}

}  // namespace batten::internal::rational_derivatives_test
