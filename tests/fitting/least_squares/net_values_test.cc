// SPDX-License-Identifier: MIT
#include "fitting/least_squares/net_values.h"

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "fitting/least_squares/normal_equations.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::net_values_test {

struct Net {
  SplineBasis outer;
  std::optional<SplineBasis> inner;  // none: a curve
  Eigen::MatrixXd coefficients;
  Eigen::VectorXd u, v;

  const SplineBasis* inner_basis() const { return inner ? &*inner : nullptr; }
  int inner_size() const { return inner ? inner->size() : 1; }
  Eigen::MatrixXd Values(int threads) const {
    ThreadPool pool(threads);
    const Eigen::MatrixXd none(0, u.size());
    return NetValues(outer, inner_basis(), coefficients, RowsOf(u, v, none, {}), pool);
  }
};

SplineBasis AnyBasis(RandomSplines& random, int highest) {
  return random.Basis(random.Integer(1, highest),
                      {.clamped = random.Coin(), .periodic = random.Integer(0, 2) == 0});
}

Net RandomNet(RandomSplines& random, int highest_degree, int most_points) {
  Net net{AnyBasis(random, highest_degree), std::nullopt, {}, {}, {}};
  if (random.Integer(0, 3) > 0) net.inner = AnyBasis(random, highest_degree);
  const int m = random.Integer(0, most_points);
  net.coefficients.resize(random.Integer(1, 3), net.outer.size() * net.inner_size());
  for (double& c : net.coefficients.reshaped()) c = random.Real(-1, 1);
  net.u.resize(m);
  net.v.resize(net.inner ? m : 0);
  for (double& t : net.u) t = random.Parameter(net.outer);
  for (double& t : net.v) t = random.Parameter(*net.inner);
  return net;
}

TEST(NetValuesTest, AreSumsOfBasisFunctionsTimesCoefficients) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const Net net = RandomNet(random, seed % 6 == 0 ? 25 : 5, 200);
    const Eigen::MatrixXd values = net.Values(1);
    ASSERT_EQ(values.rows(), net.coefficients.rows());
    ASSERT_EQ(values.cols(), net.u.size());
    const int p = net.outer.degree(), q = net.inner ? net.inner->degree() : 0;
    std::vector<double> No(p + 1), Ni(q + 1, 1.0);
    for (Eigen::Index k = 0; k < net.u.size(); ++k) {
      const int so = net.outer.Span(net.u[k]), si = net.inner ? net.inner->Span(net.v[k]) : 0;
      net.outer.Values(so, net.u[k], No.data());
      if (net.inner) net.inner->Values(si, net.v[k], Ni.data());
      Eigen::VectorXd sum = Eigen::VectorXd::Zero(values.rows());
      for (int r = 0; r <= p; ++r) {
        for (int s = 0; s <= q; ++s)
          sum += No[r] * Ni[s] * net.coefficients.col((so - p + r) * net.inner_size() + si - q + s);
      }
      // Coefficients are at most one, and the functions sum up to one.
      EXPECT_LE((values.col(k) - sum).cwiseAbs().maxCoeff(), kRounding);
    }
  }
}

TEST(NetValuesTest, AreTheSameBitsForEveryNumberOfThreads) {
  RandomSplines random(1);
  const Net net = RandomNet(random, 4, 20000);
  EXPECT_EQ(net.Values(3), net.Values(1));
}

}  // namespace batten::internal::net_values_test
