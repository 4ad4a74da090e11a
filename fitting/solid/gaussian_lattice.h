// SPDX-License-Identifier: MIT
// Integer points of the complex plane: lattices of them that keep linear conditions, and those
// nearest to others.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <cstdint>
#include <map>
#include <vector>

namespace batten::internal {

// Complex numbers of integer parts; rows of them by column.
using Gaussian = std::complex<std::int64_t>;
using GaussianRow = std::map<int, Gaussian>;

// i^power.
Gaussian PowerOfI(int power);

// A basis (columns) of all vectors of `size` Gaussian integers that every row sends to zero.
// [Hermite's elimination: Cohen 1993, §2.4, over this Euclidean ring]
std::vector<std::vector<Gaussian>> LatticeOfZeros(const std::vector<GaussianRow>& rows, int size);

// Gaussian integers z near the least (z − centre)* S (z − centre), S positive definite: fixed one
// by one, the surest first, the others moved to where they are best then; at last single steps
// while these help. [Bommes, Zimmer & Kobbelt 2009]
Eigen::VectorXcd RoundedWithin(const Eigen::MatrixXcd& quadratic, const Eigen::VectorXcd& centre);

// The same among those whose real parts, and imaginary parts after them, every row of integers
// sends to zero. Throws RefusedData where these do not determine them.
Eigen::VectorXcd RoundedWithin(const Eigen::MatrixXcd& quadratic,
                               const Eigen::VectorXcd& centre,
                               const std::vector<GaussianRow>& rows);

}  // namespace batten::internal
