// SPDX-License-Identifier: MIT
#include "fitting/solid/gaussian_lattice.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <random>

#include "tolerances.h"

namespace batten::internal::gaussian_lattice_test {

using Complex = std::complex<double>;

Gaussian Of(const GaussianRow& row, const std::vector<Gaussian>& vector) {
  Gaussian sum = 0;
  for (const auto& [k, factor] : row) sum += factor * vector[std::size_t(k)];
  return sum;
}

TEST(LatticeOfZerosTest, HoldsAllVectorsThatTheRowsSendToZero) {
  // (1 + i) a = b and a + i b + c = 0: all of them are multiples of one.
  const std::vector<GaussianRow> rows = {{{0, {1, 1}}, {1, -1}}, {{0, 1}, {1, {0, 1}}, {2, 1}}};
  const auto basis = LatticeOfZeros(rows, 3);
  ASSERT_EQ(basis.size(), 1u);
  for (const GaussianRow& row : rows) EXPECT_EQ(Of(row, basis[0]), Gaussian(0));
  // The one of a = 1 is in the lattice, so the basis is that vector times a power of i.
  EXPECT_EQ(std::norm(basis[0][0]), 1);
}

TEST(LatticeOfZerosTest, HasAsManyVectorsAsRowsLeaveFree) {
  std::mt19937_64 random(7);
  std::uniform_int_distribution<int> part(-2, 2), place(0, 11);
  std::vector<GaussianRow> rows(5);
  for (GaussianRow& row : rows) {
    for (int k = 0; k < 3; ++k) row[place(random)] = {part(random), part(random)};
  }
  const auto basis = LatticeOfZeros(rows, 12);
  EXPECT_GE(basis.size(), 7u);
  for (const auto& vector : basis) {
    for (const GaussianRow& row : rows) EXPECT_EQ(Of(row, vector), Gaussian(0));
  }
  // More rows of the same kind leave what there is.
  rows.push_back(rows.front());
  EXPECT_EQ(LatticeOfZeros(rows, 12).size(), basis.size());
}

double Cost(const Eigen::MatrixXcd& form, const Eigen::VectorXcd& offset) {
  return std::real(offset.dot(form * offset));
}

TEST(RoundedWithinTest, FindsTheNearestOfTwoByTrial) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 50; ++trial) {
    Eigen::MatrixXcd root(2, 2);
    for (Complex& entry : root.reshaped()) entry = {normal(random), normal(random)};
    const Eigen::MatrixXcd form = root.adjoint() * root + 0.05 * Eigen::MatrixXcd::Identity(2, 2);
    const Eigen::VectorXcd centre = Eigen::VectorXcd::NullaryExpr(
        2, [&](Eigen::Index) { return Complex(normal(random), normal(random)); });
    const Eigen::VectorXcd found = RoundedWithin(form, centre);
    for (const Complex part : found) {
      EXPECT_EQ(part.real(), std::round(part.real()));
      EXPECT_EQ(part.imag(), std::round(part.imag()));
    }
    double least = std::numeric_limits<double>::infinity();
    constexpr int kFar = 6;
    for (int a = -kFar; a <= kFar; ++a) {
      for (int b = -kFar; b <= kFar; ++b) {
        for (int c = -kFar; c <= kFar; ++c) {
          for (int d = -kFar; d <= kFar; ++d) {
            const Eigen::Vector2cd z(Complex(a, b), Complex(c, d));
            least = std::min(least, Cost(form, z - centre));
          }
        }
      }
    }
    // Rounding one by one in a reduced basis of two is within a factor of the nearest.
    // [Babai 1986: 2^(n/2) for the distance, n = 2]
    EXPECT_LE(Cost(form, found - centre), 4 * least + kRounding);
  }
}

// One real condition on two complex numbers: the nearest of those that keep it, by trial.
TEST(RoundedWithinTest, KeepsConditionsOnRealAndImaginaryParts) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  std::uniform_int_distribution<int> factor(-2, 2);
  for (int trial = 0; trial < 30; ++trial) {
    Eigen::MatrixXcd root(2, 2);
    for (Complex& entry : root.reshaped()) entry = {normal(random), normal(random)};
    const Eigen::MatrixXcd form = root.adjoint() * root + 0.1 * Eigen::MatrixXcd::Identity(2, 2);
    const Eigen::VectorXcd centre = Eigen::VectorXcd::NullaryExpr(
        2, [&](Eigen::Index) { return Complex(normal(random), normal(random)); });
    GaussianRow row;  // of Re z₀, Re z₁, Im z₀, Im z₁
    for (int k = 0; k < 4; ++k) row[k] = factor(random);
    row[trial % 4] = 1;
    const auto of = [&](const Eigen::VectorXcd& z) {
      const std::array<double, 4> parts = {z[0].real(), z[1].real(), z[0].imag(), z[1].imag()};
      double sum = 0;
      for (const auto& [k, value] : row) sum += double(value.real()) * parts[std::size_t(k)];
      return sum;
    };
    const Eigen::VectorXcd found = RoundedWithin(form, centre, {row});
    EXPECT_EQ(of(found), 0);
    double least = std::numeric_limits<double>::infinity();
    constexpr int kFar = 6;
    for (int a = -kFar; a <= kFar; ++a) {
      for (int b = -kFar; b <= kFar; ++b) {
        for (int c = -kFar; c <= kFar; ++c) {
          for (int d = -kFar; d <= kFar; ++d) {
            const Eigen::Vector2cd z(Complex(a, b), Complex(c, d));
            if (of(z) == 0) least = std::min(least, Cost(form, z - centre));
          }
        }
      }
    }
    // Of three numbers. [Babai 1986: 2^(n/2) for the distance]
    EXPECT_LE(Cost(form, found - centre), 8 * least + kRounding);
  }
}

}  // namespace batten::internal::gaussian_lattice_test
