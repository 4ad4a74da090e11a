// SPDX-License-Identifier: MIT
#include "fitting/solid/gaussian_lattice.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "batten/fitting/refused_data.h"
#include "fitting/core/rounding.h"

namespace batten::internal {
namespace {

std::complex<double> Rounded(std::complex<double> z) {
  return {std::round(z.real()), std::round(z.imag())};
}

Gaussian Quotient(Gaussian a, Gaussian b) {
  const std::complex<double> q = std::complex<double>(double(a.real()), double(a.imag())) /
                                 std::complex<double>(double(b.real()), double(b.imag()));
  return {std::llround(q.real()), std::llround(q.imag())};
}

}  // namespace

Gaussian PowerOfI(int power) {
  constexpr std::array<std::array<int, 2>, 4> kPowers = {{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};
  const auto& parts = kPowers[std::size_t(power & 3)];
  return {parts[0], parts[1]};
}

std::vector<std::vector<Gaussian>> LatticeOfZeros(const std::vector<GaussianRow>& rows, int size) {
  std::vector<std::vector<Gaussian>> basis;
  for (int k = 0; k < size; ++k) {
    basis.emplace_back(std::size_t(size), Gaussian(0));
    basis.back()[std::size_t(k)] = 1;
  }
  for (const GaussianRow& row : rows) {
    // What the row makes of each vector of the basis; one by one they are brought to zero.
    std::vector<std::pair<std::size_t, Gaussian>> left;
    for (std::size_t c = 0; c < basis.size(); ++c) {
      Gaussian value = 0;
      for (const auto& [k, factor] : row) value += factor * basis[c][std::size_t(k)];
      if (value != Gaussian(0)) left.emplace_back(c, value);
    }
    while (left.size() > 1) {
      const auto least =
          std::min_element(left.begin(), left.end(), [](const auto& one, const auto& other) {
            return std::norm(one.second) < std::norm(other.second);
          });
      std::swap(*least, left.front());
      const auto [pivot, divisor] = left.front();
      for (std::size_t k = 1; k < left.size(); ++k) {
        const Gaussian q = Quotient(left[k].second, divisor);
        left[k].second -= q * divisor;
        std::vector<Gaussian>& vector = basis[left[k].first];
        for (std::size_t j = 0; j < vector.size(); ++j) vector[j] -= q * basis[pivot][j];
      }
      std::erase_if(left, [](const auto& one) { return one.second == Gaussian(0); });
    }
    if (left.size() == 1) basis.erase(basis.begin() + std::ptrdiff_t(left.front().first));
  }
  return basis;
}

namespace {

// The problem in a basis of short vectors, by the length that the quadratic form gives them, found
// two by two. [Gauss's reduction: Nguyen & Stehlé 2009, §2]
struct ReducedLattice {
  ReducedLattice(const Eigen::MatrixXcd& form, const Eigen::VectorXcd& whole)
      : quadratic(form),
        centre(whole),
        basis(Eigen::MatrixXcd::Identity(whole.size(), whole.size())) {
    constexpr int kSweeps = 50;
    for (int sweep = 0; sweep < kSweeps && Sweep(); ++sweep) {
    }
  }

  bool Sweep() {
    bool changed = false;
    for (Eigen::Index i = 0; i < centre.size(); ++i) {
      for (Eigen::Index j = 0; j < centre.size(); ++j) {
        if (i == j) continue;
        const std::complex<double> part = Rounded(quadratic(i, j) / std::real(quadratic(i, i)));
        if (part == std::complex<double>(0)) continue;
        basis.col(j) -= part * basis.col(i);
        centre[i] += part * centre[j];
        quadratic.col(j) -= part * quadratic.col(i);
        quadratic.row(j) -= std::conj(part) * quadratic.row(i);
        changed = true;
      }
    }
    return changed;
  }

  Eigen::MatrixXcd quadratic;
  Eigen::VectorXcd centre;
  Eigen::MatrixXcd basis;  // columns of Gaussian integers
};

// One by one, the surest first.
Eigen::VectorXcd RoundedInTurn(const ReducedLattice& lattice) {
  const Eigen::Index count = lattice.centre.size();
  Eigen::MatrixXcd spread =
      lattice.quadratic.ldlt().solve(Eigen::MatrixXcd::Identity(count, count));
  Eigen::VectorXcd z = lattice.centre;
  std::vector<char> fixed(std::size_t(count), 0);
  for (Eigen::Index round = 0; round < count; ++round) {
    Eigen::Index surest = -1;
    double least = 0;
    for (Eigen::Index k = 0; k < count; ++k) {
      if (fixed[std::size_t(k)]) continue;
      const double cost = std::norm(Rounded(z[k]) - z[k]) / std::real(spread(k, k));
      if (surest >= 0 && !(cost < least)) continue;
      surest = k;
      least = cost;
    }
    const std::complex<double> move = Rounded(z[surest]) - z[surest];
    const double variance = std::real(spread(surest, surest));
    const Eigen::VectorXcd column = spread.col(surest) / variance;
    z += move * column;
    spread -= variance * column * column.adjoint();
    z[surest] = Rounded(z[surest]);
    fixed[std::size_t(surest)] = 1;
  }
  return z.unaryExpr([](std::complex<double> part) { return Rounded(part); });
}

}  // namespace

Eigen::VectorXcd RoundedWithin(const Eigen::MatrixXcd& quadratic, const Eigen::VectorXcd& centre) {
  const ReducedLattice lattice(quadratic, centre);
  Eigen::VectorXcd z = RoundedInTurn(lattice);
  Eigen::VectorXcd pull = lattice.quadratic * (z - lattice.centre);
  for (bool moved = true; moved;) {
    moved = false;
    for (Eigen::Index k = 0; k < z.size(); ++k) {
      const double stiff = std::real(lattice.quadratic(k, k));
      const std::complex<double> step = -Rounded(pull[k] / stiff);
      const double gain = 2 * std::real(std::conj(step) * pull[k]) + std::norm(step) * stiff;
      if (!(gain < -kRelativelyEqual * stiff)) continue;  // of a step's own cost
      z[k] += step;
      pull += step * lattice.quadratic.col(k);
      moved = true;
    }
  }
  return lattice.basis * z;
}

Eigen::VectorXcd RoundedWithin(const Eigen::MatrixXcd& quadratic,
                               const Eigen::VectorXcd& centre,
                               const std::vector<GaussianRow>& rows) {
  if (rows.empty()) return RoundedWithin(quadratic, centre);
  const Eigen::Index m = centre.size();
  const std::vector<std::vector<Gaussian>> lattice = LatticeOfZeros(rows, int(2 * m));
  Eigen::MatrixXd basis(2 * m, Eigen::Index(lattice.size()));
  for (Eigen::Index k = 0; k < basis.cols(); ++k) {
    for (Eigen::Index j = 0; j < 2 * m; ++j) {
      basis(j, k) = double(lattice[std::size_t(k)][std::size_t(j)].real());
    }
  }
  Eigen::MatrixXd parts(2 * m, 2 * m);
  parts << quadratic.real(), -quadratic.imag(), quadratic.imag(), quadratic.real();
  Eigen::VectorXd middle(2 * m);
  middle << centre.real(), centre.imag();
  const Eigen::MatrixXd form = basis.transpose() * parts * basis;
  const Eigen::VectorXd within = form.ldlt().solve(basis.transpose() * (parts * middle));
  if (!within.allFinite()) throw RefusedData("the integers are not determined");
  const Eigen::VectorXcd rounded =
      RoundedWithin(form.cast<std::complex<double>>(), within.cast<std::complex<double>>());
  const Eigen::VectorXd whole = basis * rounded.real();
  Eigen::VectorXcd integers(m);
  integers.real() = whole.head(m);
  integers.imag() = whole.tail(m);
  return integers;
}

}  // namespace batten::internal
