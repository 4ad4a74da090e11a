// SPDX-License-Identifier: MIT
#include "fitting/constraints/edge_products.h"

#include <vector>

#include "fitting/constraints/local_projection.h"

namespace batten::internal {
namespace {

using Entries = std::array<std::vector<Eigen::Triplet<double>>, 6>;

// Both directions and their derivatives.
struct Directions {
  Eigen::Matrix<double, 6, 1> value, slope;
};

Directions DirectionsAt(const ReadyEdge& edge, double u, double speed) {
  const Eigen::Matrix3Xd field = edge.across->Derivatives(u, 1),
                         curve = edge.curve.Derivatives(u, 2);
  Directions both;
  both.value << field.col(0), curve.col(1) / speed;
  both.slope << field.col(1), curve.col(2) / speed;
  return both;
}

}  // namespace

std::array<Eigen::SparseMatrix<double, Eigen::RowMajor>, 6> EdgeProducts(const SplineBasis& coarse,
                                                                         const SplineBasis& fine,
                                                                         const ReadyEdge& edge,
                                                                         double speed) {
  const LocalProjection projection = ProjectionOnto(fine);
  const int p = coarse.degree();
  const auto count = static_cast<int>(projection.places.size());
  Entries entries;
  std::vector<double> N(2 * (static_cast<size_t>(p) + 1));
  const auto add = [&](int row, int function, const Eigen::Matrix<double, 6, 1>& values) {
    for (size_t d = 0; d < 6; ++d) {
      entries[d].emplace_back(row, function, values[static_cast<Eigen::Index>(d)]);
    }
  };
  for (int k = 0; k < count; ++k) {
    const auto fine_span = static_cast<size_t>(projection.spans[static_cast<size_t>(k)]);
    const int span = coarse.Span((fine.knots()[fine_span] + fine.knots()[fine_span + 1]) / 2);
    const bool at_start = k == 0, at_end = k == count - 1;
    coarse.Derivatives(span, projection.places[k], 1, N.data());
    const Directions both = DirectionsAt(edge, projection.places[k], speed);
    for (int r = 0; r <= p; ++r) {
      const double value = N[static_cast<size_t>(r)], slope = N[static_cast<size_t>(p + 1 + r)];
      add(k, span - p + r, value * both.value);
      if (at_start || at_end) {
        add(count + (at_end ? 1 : 0), span - p + r, slope * both.value + value * both.slope);
      }
    }
  }
  std::array<Eigen::SparseMatrix<double, Eigen::RowMajor>, 6> products;
  for (size_t d = 0; d < 6; ++d) {
    Eigen::SparseMatrix<double, Eigen::RowMajor> samples(count + 2, coarse.size());
    samples.setFromTriplets(entries[d].begin(), entries[d].end());
    products[d] = projection.matrix * samples;
  }
  return products;
}

}  // namespace batten::internal
