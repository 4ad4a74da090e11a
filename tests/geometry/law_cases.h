// SPDX-License-Identifier: MIT
// The random cases over which laws are tested: every degree from 1 to 11, clamped, unclamped and
// periodic, interior knots of every multiplicity, weights in [1e-2, 1e2].
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "random_splines.h"

namespace batten::internal {

inline constexpr int kHighestDegree = 11;
inline constexpr int kBasisKinds = 3;

// Clamped, unclamped or periodic.
inline BasisKind KindOfBasis(int kind, int most_spans = 5) {
  return {.clamped = kind == 0, .most_spans = most_spans, .periodic = kind == 2};
}

// Calls law(basis, random).
template <typename Law>
void ForRandomBases(const Law& law, unsigned seeds = 6, int highest_degree = kHighestDegree) {
  for (int degree = 1; degree <= highest_degree; ++degree) {
    for (int kind = 0; kind < kBasisKinds; ++kind) {
      for (unsigned seed = 0; seed < seeds; ++seed) {
        SCOPED_TRACE("basis: degree " + std::to_string(degree) + ", kind " + std::to_string(kind) +
                     ", seed " + std::to_string(seed));
        RandomSplines random(10000 * kind + 100 * degree + seed);
        law(random.Basis(degree, KindOfBasis(kind, 7)), random);
        if (testing::Test::HasFailure()) return;
      }
    }
  }
}

// Calls law(curve, random); every second one is rational.
template <int Dim, typename Law>
void ForRandomCurves(const Law& law, unsigned seeds = 4, int highest_degree = kHighestDegree) {
  for (int degree = 1; degree <= highest_degree; ++degree) {
    for (int kind = 0; kind < kBasisKinds; ++kind) {
      for (unsigned seed = 0; seed < seeds; ++seed) {
        SCOPED_TRACE("curve: dimension " + std::to_string(Dim) + ", degree " +
                     std::to_string(degree) + ", kind " + std::to_string(kind) + ", seed " +
                     std::to_string(seed));
        RandomSplines random(10000 * kind + 100 * degree + seed);
        law(random.Curve<Dim>(degree, seed % 2 == 1, KindOfBasis(kind)), random);
        if (testing::Test::HasFailure()) return;
      }
    }
  }
}

// Calls law(surface, random); every second one is rational, all pairs of kinds take turns.
template <typename Law>
void ForRandomSurfaces(const Law& law, unsigned seeds = 120) {
  for (unsigned seed = 0; seed < seeds; ++seed) {
    SCOPED_TRACE("surface: seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int degree_u = 1 + static_cast<int>(seed) % kHighestDegree;
    const int degree_v = random.Integer(1, 7), kinds = static_cast<int>(seed / 2) % 9;
    law(random.Surface(degree_u,
                       degree_v,
                       seed % 2 == 1,
                       KindOfBasis(kinds % 3, 3),
                       KindOfBasis(kinds / 3, 3)),
        random);
    if (testing::Test::HasFailure()) return;
  }
}

// A random element.
template <typename Values>
auto AnyOf(const Values& values, RandomSplines& random) {
  return values[static_cast<size_t>(random.Integer(0, static_cast<int>(values.size()) - 1))];
}

}  // namespace batten::internal
