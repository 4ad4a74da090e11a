// SPDX-License-Identifier: MIT
#include "geometry/construction/spline_interpolation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "batten/geometry/knot_vectors.h"
#include "batten/geometry/nurbs_curve.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::spline_interpolation_test {

TEST(InterpolatedTest, RecoversSplinesFromValuesAndDerivatives) {
  for (int seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int p = random.Integer(2, 5), n = random.Integer(p + 1, 12);
    std::vector<SplineDatum> data;
    std::vector<double> places;
    double at = 0;
    while (static_cast<int>(data.size()) < n) {
      data.push_back({at});
      places.push_back(at);
      if (random.Coin() && static_cast<int>(data.size()) < n) {
        data.push_back({at, 1});
        places.push_back(at);
      }
      at += random.Real(0.2, 1);
    }
    const SplineBasis basis = AveragedKnots(p, places);
    const NurbsCurve<3> curve(basis, 1e3 * Eigen::Matrix3Xd::Random(3, basis.size()));
    Eigen::MatrixXd values(3, n);
    for (int k = 0; k < n; ++k) values.col(k) = curve.Derivatives(data[k].at, 1).col(data[k].order);
    const Eigen::MatrixXd found = Interpolated(basis, data, values);
    EXPECT_LE((found - curve.control_points()).norm(), 1e3 * kIterated);
  }
}

}  // namespace batten::internal::spline_interpolation_test
