// SPDX-License-Identifier: MIT
#include "geometry/nurbs/knot_derivatives.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::knot_derivatives_test {

struct Place {
  SplineBasis basis;
  int span;
  double u;
};

void ForRandomPlaces(int count, const std::function<void(RandomSplines&, const Place&)>& law) {
  for (int seed = 0; seed < count; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(static_cast<unsigned>(seed));
    const SplineBasis basis = random.Basis(random.Integer(1, 7));
    const std::vector<int> spans = basis.Spans();
    const int span =
        spans[static_cast<size_t>(random.Integer(0, static_cast<int>(spans.size()) - 1))];
    const double a = basis.knots()[span], b = basis.knots()[span + 1];
    law(random, {basis, span, a + random.Real(0.1, 0.9) * (b - a)});
    if (testing::Test::HasFailure()) return;
  }
}

TEST(KnotDerivativesTest, GiveTheFunctionsThemselvesToo) {
  ForRandomPlaces(200, [](RandomSplines&, const Place& at) {
    double values[kMaxDegree + 1], expected[kMaxDegree + 1];
    KnotDerivatives(at.basis, at.span, at.u, values);
    at.basis.Values(at.span, at.u, expected);
    for (int r = 0; r <= at.basis.degree(); ++r)
      EXPECT_NEAR(values[r], expected[r], 8 * at.basis.degree() * kRounding);
  });
}

// The functions sum to one, and Σ Greville_l N_l is u, wherever the knots are.
TEST(KnotDerivativesTest, KeepThePartitionOfUnityAndLinearPrecision) {
  ForRandomPlaces(200, [](RandomSplines&, const Place& at) {
    const int p = at.basis.degree();
    double values[kMaxDegree + 1];
    const KnotDerivativeMatrix D = KnotDerivatives(at.basis, at.span, at.u, values);
    const double size = std::max(1e-300, D.cwiseAbs().maxCoeff());
    const double reach = at.basis.knots()[at.span + p] - at.basis.knots()[at.span - p + 1];
    for (int j = 0; j < 2 * p; ++j) {
      EXPECT_NEAR(D.row(j).sum(), 0, 1e-12 * size);
      double drift = 0;  // d/du_j of Σ (Greville_l − u) N_l; Greville's own motion is N_l/p
      for (int r = 0; r <= p; ++r) {
        const int l = at.span - p + r, knot = at.span - p + 1 + j;
        drift += D(j, r) * (at.basis.Greville(l) - at.u);
        if (knot >= l + 1 && knot <= l + p) drift += values[r] / p;
      }
      EXPECT_NEAR(drift, 0, 1e-12 * (size * reach + 1)) << "knot " << j;
    }
  });
}

TEST(KnotDerivativesTest, AreWhatDifferencesFind) {
  ForRandomPlaces(200, [](RandomSplines&, const Place& at) {
    const int p = at.basis.degree();
    double values[kMaxDegree + 1], above[kMaxDegree + 1], below[kMaxDegree + 1];
    const KnotDerivativeMatrix D = KnotDerivatives(at.basis, at.span, at.u, values);
    const double width = at.basis.knots()[at.span + 1] - at.basis.knots()[at.span];
    const double step = 1e-5 * width;
    for (int j = 0; j < 2 * p; ++j) {
      const size_t knot = static_cast<size_t>(at.span - p + 1 + j);
      // Both sides keep the order only where the knot stands alone.
      const std::vector<double>& U = at.basis.knots();
      if (U[knot] - U[knot - 1] < 2 * step || U[knot + 1] - U[knot] < 2 * step) continue;
      const auto moved = [&](double by, double* result) {
        std::vector<double> knots = U;
        knots[knot] += by;
        SplineBasis(p, knots).Values(at.span, at.u, result);
      };
      moved(step, above);
      moved(-step, below);
      for (int r = 0; r <= p; ++r) {
        EXPECT_NEAR(D(j, r) * width, (above[r] - below[r]) / (2 * step) * width, 1e-7)
            << "knot " << j << " function " << r;
      }
    }
  });
}

}  // namespace batten::internal::knot_derivatives_test
