// SPDX-License-Identifier: MIT
#include "fitting/least_squares/fitting_bases.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "fitting/linear/coefficient_order.h"
#include "batten/geometry/knot_vectors.h"
#include "tolerances.h"

namespace batten::internal::fitting_bases_test {

constexpr double kLow = -1.3, kHigh = 4.1;

struct Kind {
  int degree, cells;
  bool round;
  std::string name() const {
    return "degree " + std::to_string(degree) + ", " + std::to_string(cells) + " cells" +
           (round ? ", round" : "");
  }
  SplineBasis Basis() const {
    return round ? PeriodicUniformKnots(degree, cells, kLow, kHigh)
                 : FittingBasis(degree, cells, kLow, kHigh);
  }
};

std::vector<Kind> Kinds() {
  std::vector<Kind> kinds;
  for (int degree = 1; degree <= 5; ++degree) {
    for (const int cells : {degree + 1, degree + 2, 11}) {
      kinds.push_back({degree, cells, true});
      kinds.push_back({degree, cells, false});
    }
  }
  return kinds;
}

// The knots in the domain, both ends once.
std::vector<double> InDomain(const SplineBasis& basis) {
  std::vector<double> knots;
  for (const double knot : basis.knots()) {
    if (knot >= basis.lower() && knot <= basis.upper()) knots.push_back(knot);
  }
  knots.erase(std::unique(knots.begin(), knots.end()), knots.end());
  return knots;
}

// Values of the coefficients that differ, row by row at many places.
Eigen::MatrixXd Values(const SplineBasis& basis) {
  constexpr int kPlaces = 301;
  const int degree = basis.degree();
  Eigen::MatrixXd values = Eigen::MatrixXd::Zero(kPlaces, DistinctCount(basis));
  std::vector<double> local(static_cast<size_t>(degree) + 1);
  for (int k = 0; k < kPlaces; ++k) {
    const double x = basis.lower() + (basis.upper() - basis.lower()) * k / (kPlaces - 1);
    const int span = basis.Span(x);
    basis.Values(span, x, local.data());
    for (int i = 0; i <= degree; ++i) {
      values(k, DistinctIndex(basis, span - degree + i)) += local[static_cast<size_t>(i)];
    }
  }
  return values;
}

// How far the splines of one basis are from those of the other.
double Outside(const SplineBasis& of, const SplineBasis& in) {
  const Eigen::MatrixXd values = Values(of), space = Values(in);
  return (space * space.colPivHouseholderQr().solve(values) - values).cwiseAbs().maxCoeff();
}

TEST(FittingBasesTest, HaveWideEndsAndEqualCellsBetween) {
  for (const int degree : {1, 3, 5}) {
    for (const int cells : {1, 2, 3, 4, 20}) {
      SCOPED_TRACE((Kind{degree, cells, false}.name()));
      const SplineBasis basis = FittingBasis(degree, cells, kLow, kHigh);
      const std::vector<double> knots = InDomain(basis);
      ASSERT_EQ(knots.size(), static_cast<size_t>(cells) + 1);
      EXPECT_EQ(basis.size(), cells + degree);
      EXPECT_EQ(basis.lower(), kLow);
      EXPECT_EQ(basis.upper(), kHigh);
      const double inner = (kHigh - kLow) / (cells >= 3 ? cells + 1.2 : cells);
      for (size_t k = 0; k + 1 < knots.size(); ++k) {
        const bool end = k == 0 || k + 2 == knots.size();
        EXPECT_NEAR(knots[k + 1] - knots[k], (end && cells >= 3 ? 1.6 : 1) * inner, kRounding);
      }
    }
  }
}

TEST(FittingBasesTest, AreLikeAnotherOnItsDomainAndHaveTheFreedomSaid) {
  for (const Kind& kind : Kinds()) {
    SCOPED_TRACE(kind.name());
    const SplineBasis like = kind.Basis();
    for (int degree = 1; degree <= 5; ++degree) {
      EXPECT_EQ(LeastCells(like, degree), kind.round ? degree + 1 : 1);
      for (const int cells : {1, 2, degree, degree + 1, degree + 2, 17}) {
        const SplineBasis basis = FittingBasisLike(like, degree, cells);
        EXPECT_EQ(basis.degree(), degree);
        EXPECT_EQ(basis.periodic(), kind.round);
        EXPECT_EQ(basis.lower(), like.lower());
        EXPECT_EQ(basis.upper(), like.upper());
        EXPECT_EQ(DistinctCount(basis), FreedomOfCells(like, degree, cells));
        const int spans = std::max(cells, LeastCells(like, degree));
        EXPECT_EQ(InDomain(basis).size(), static_cast<size_t>(spans) + 1);
      }
    }
  }
}

// Knots come and go; the domain, the seam and the degree stay, and every spline over the fewer
// knots is one over the more.
TEST(FittingBasesTest, KeepTheirKindWithInnerKnotsAddedAndRemoved) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> place(kLow, kHigh);
  for (const Kind& kind : Kinds()) {
    SCOPED_TRACE(kind.name());
    const SplineBasis basis = kind.Basis();
    for (const size_t count : {1, 3, 8}) {
      std::vector<double> more(count);
      for (double& knot : more) knot = place(random);
      const SplineBasis finer = WithInnerKnots(basis, more);
      EXPECT_EQ(finer.periodic(), kind.round);
      EXPECT_EQ(finer.degree(), kind.degree);
      EXPECT_EQ(finer.lower(), basis.lower());
      EXPECT_EQ(finer.upper(), basis.upper());
      EXPECT_EQ(DistinctCount(finer), DistinctCount(basis) + static_cast<int>(count));
      EXPECT_LE(Outside(basis, finer), kHalfDigits);
      std::vector<double> expected = InDomain(basis);
      expected.insert(expected.end(), more.begin(), more.end());
      std::sort(expected.begin(), expected.end());
      EXPECT_EQ(InDomain(finer), expected);
      const SplineBasis back = WithoutInnerKnots(finer, more);
      EXPECT_EQ(back.periodic(), kind.round);
      EXPECT_EQ(InDomain(back), InDomain(basis));
      EXPECT_EQ(DistinctCount(back), DistinctCount(basis));
      EXPECT_LE(Outside(basis, back), kHalfDigits);
      EXPECT_GE(Outside(finer, basis), 1e-6);  // it was more
    }
    EXPECT_EQ(WithInnerKnots(basis, {}).knots(), basis.knots());
    EXPECT_EQ(WithoutInnerKnots(basis, {}).knots(), basis.knots());
  }
}

// The second of a row of removals starts from the first one's basis.
TEST(FittingBasesTest, LoseOneKnotAfterAnother) {
  for (const bool round : {true, false}) {
    SplineBasis basis = Kind{3, 12, round}.Basis();
    while (DistinctCount(basis) > 5) {
      const std::vector<double> knots = InDomain(basis);
      const SplineBasis coarser = WithoutInnerKnots(basis, {knots[knots.size() / 2]});
      ASSERT_EQ(DistinctCount(coarser), DistinctCount(basis) - 1);
      EXPECT_EQ(coarser.periodic(), round);
      EXPECT_EQ(coarser.lower(), kLow);
      EXPECT_EQ(coarser.upper(), kHigh);
      EXPECT_LE(Outside(coarser, basis), kHalfDigits);
      basis = coarser;
    }
  }
}

}  // namespace batten::internal::fitting_bases_test
