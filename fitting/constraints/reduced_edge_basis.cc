// SPDX-License-Identifier: MIT
#include "fitting/constraints/reduced_edge_basis.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "fitting/constraints/local_projection.h"
#include "fitting/least_squares/fitting_bases.h"
#include "fitting/least_squares/nested_bases.h"

namespace batten::internal {
namespace {

using Sparse = Eigen::SparseMatrix<double, Eigen::RowMajor>;

constexpr double kMostTurn = 6e-7;
constexpr double kAmount = 1e-5;
constexpr int kHalvings = 8;
constexpr int kModest = 400, kModestTimes = 6;  // functions; of the least basis'

// The functions of a basis, or their derivatives of an order, at places, each in the span that
// holds the middle given for it.
Sparse FunctionsAt(const SplineBasis& basis,
                   const Eigen::VectorXd& places,
                   const Eigen::VectorXd& inside,
                   int order = 0) {
  const int p = basis.degree();
  std::vector<Eigen::Triplet<double>> entries;
  std::array<double, 2 * (kMaxDegree + 1)> values;
  for (Eigen::Index k = 0; k < places.size(); ++k) {
    const int span = basis.Span(inside[k]);
    basis.Derivatives(span, places[k], order, values.data());
    for (int r = 0; r <= p; ++r) {
      entries.emplace_back(
          static_cast<int>(k), span - p + r, values[static_cast<size_t>(order * (p + 1) + r)]);
    }
  }
  Sparse functions(places.size(), basis.size());
  functions.setFromTriplets(entries.begin(), entries.end());
  return functions;
}

// Splines over the fine basis to those over another: their local projections.
Sparse Thinning(const SplineBasis& fine, const SplineBasis& thin) {
  const LocalProjection projection = ProjectionOnto(thin);
  // A place at the end of its span belongs to the fine span on this side of it.
  Eigen::VectorXd inside = projection.places;
  const int places = thin.degree() + 1;
  for (Eigen::Index k = 0; k < inside.size(); ++k) {
    const auto span = static_cast<size_t>(projection.spans[static_cast<size_t>(k)]);
    const double length = thin.knots()[span + 1] - thin.knots()[span];
    if (k % places == 0) inside[k] += 1e-6 * length;
    if (k % places == places - 1) inside[k] -= 1e-6 * length;
  }
  const Eigen::Vector2d ends(thin.lower(), thin.upper());
  return Sparse(projection.matrix.leftCols(inside.size())) *
             FunctionsAt(fine, projection.places, inside) +
         Sparse(projection.matrix.rightCols(2)) * FunctionsAt(fine, ends, ends, 1);
}

// Spans where a tangent row would turn away too far.
std::vector<double> PoorMiddles(const EdgeRow& row,
                                const ReadyEdge& edge,
                                const RefinedEdgeBasis& axis,
                                const Eigen::VectorXd& unknowns,
                                const SplineBasis& thin,
                                const Sparse& thinning,
                                double relaxed) {
  const int p = thin.degree();
  Eigen::VectorXd amounts(row.count + 1);
  amounts << unknowns.segment(row.first, row.count), 1;
  Eigen::MatrixXd fine_curve(axis.fine.size(), 3);
  for (int d = 0; d < 3; ++d) fine_curve.col(d) = row.curves[d] * amounts;
  const Eigen::MatrixXd thin_curve = thinning * fine_curve;
  const std::vector<int> spans = thin.Spans();
  const auto checks = static_cast<Eigen::Index>(spans.size()) * (2 * p + 1);
  Eigen::VectorXd places(checks);
  for (size_t s = 0; s < spans.size(); ++s) {
    const double a = thin.knots()[spans[s]], b = thin.knots()[spans[s] + 1];
    for (int k = 0; k <= 2 * p; ++k) {
      places[static_cast<Eigen::Index>(s) * (2 * p + 1) + k] =
          a + (b - a) * (k + 0.5) / (2 * p + 1);
    }
  }
  const Eigen::MatrixXd errors = FunctionsAt(thin, places, places) * thin_curve -
                                 FunctionsAt(axis.fine, places, places) * fine_curve;
  const Eigen::VectorXd fields =
      FunctionsAt(axis.coarse, places, places) * amounts.head(axis.coarse.size());
  std::vector<double> middles;
  for (size_t s = 0; s < spans.size(); ++s) {
    bool poor = false;
    for (int k = 0; k <= 2 * p && !poor; ++k) {
      const Eigen::Index at = static_cast<Eigen::Index>(s) * (2 * p + 1) + k;
      const Eigen::Vector3d direction = edge.curve.Derivatives(places[at], 1).col(1).normalized();
      const Eigen::Vector3d field = edge.across->At(places[at]);
      const Eigen::Vector3d plane = direction.cross(field), error = errors.row(at).transpose();
      const double amount = std::abs(fields[at]) * plane.norm();
      poor = std::abs(error.dot(plane.normalized())) > relaxed * kMostTurn * amount ||
             error.norm() > relaxed * kAmount * amount;
    }
    if (poor) middles.push_back((thin.knots()[spans[s]] + thin.knots()[spans[s] + 1]) / 2);
  }
  return middles;
}

// Refined until no tangent row turns away too far, or no thinner than the fine basis.
SplineBasis ThinBasis(const EdgeRows& edges,
                      bool along_u,
                      const Eigen::VectorXd& unknowns,
                      double relaxed) {
  const RefinedEdgeBasis& axis = along_u ? edges.u : edges.v;
  SplineBasis thin = axis.least;
  for (int halving = 0; halving < kHalvings && thin.size() < axis.fine.size(); ++halving) {
    const Sparse thinning = Thinning(axis.fine, thin);
    std::vector<double> middles;
    for (const EdgeRow& row : edges.rows) {
      if (row.along_u != along_u || row.count == 0) continue;
      const std::vector<double> more = PoorMiddles(
          row, edges.edges[static_cast<size_t>(row.edge)], axis, unknowns, thin, thinning, relaxed);
      middles.insert(middles.end(), more.begin(), more.end());
    }
    if (middles.empty()) break;
    std::sort(middles.begin(), middles.end());
    middles.erase(std::unique(middles.begin(), middles.end()), middles.end());
    thin = WithInnerKnots(thin, middles);
  }
  return thin;
}

}  // namespace

ReducedEdgeBasis Thinned(const EdgeRows& edges, bool along_u, const Eigen::VectorXd& unknowns) {
  const RefinedEdgeBasis& axis = along_u ? edges.u : edges.v;
  const int modest = std::max(kModest, kModestTimes * axis.least.size());
  SplineBasis thin = ThinBasis(edges, along_u, unknowns, 1);
  for (double relaxed = 10; relaxed <= 100 && thin.size() > modest; relaxed *= 10) {
    thin = ThinBasis(edges, along_u, unknowns, relaxed);
  }
  if (thin.size() >= axis.fine.size()) {
    Eigen::SparseMatrix<double> identity(axis.fine.size(), axis.fine.size());
    identity.setIdentity();
    return {axis.fine, axis.raised, std::move(identity)};
  }
  return {thin, KnotInsertion(axis.coarse, thin), Thinning(axis.fine, thin)};
}

}  // namespace batten::internal
