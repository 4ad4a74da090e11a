// SPDX-License-Identifier: MIT
#include "fitting/constraints/edge_energy.h"

#include <algorithm>
#include <vector>

#include "fitting/least_squares/fairness.h"

namespace batten::internal {
namespace {

using ColumnSparse = Eigen::SparseMatrix<double>;

// ∫ N_i^(k) N_j^(k) as a symmetric matrix.
ColumnSparse GramOf(const SplineBasis& basis, int order) {
  const Eigen::MatrixXd band = DerivativeGram(basis, order);
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < band.rows(); ++i) {
    for (int a = 0; a < band.cols() && i + a < band.rows(); ++a) {
      entries.emplace_back(i, i + a, band(i, a));
      if (a > 0) entries.emplace_back(i + a, i, band(i, a));
    }
  }
  ColumnSparse gram(band.rows(), band.rows());
  gram.setFromTriplets(entries.begin(), entries.end());
  return gram;
}

// The factors of every product, one column each: first those of the unknowns, then what is given,
// row by row.
struct Factors {
  std::array<ColumnSparse, 3> u, v;
};

Factors FactorsOf(const EdgeRows& edges) {
  const int columns = edges.unknowns + static_cast<int>(edges.rows.size());
  Factors factors;
  for (int d = 0; d < 3; ++d) {
    std::vector<Eigen::Triplet<double>> u, v;
    for (size_t r = 0; r < edges.rows.size(); ++r) {
      const EdgeRow& row = edges.rows[r];
      const auto place = [&](Eigen::Index c) {
        return c == row.count ? edges.unknowns + static_cast<Eigen::Index>(r) : row.first + c;
      };
      auto& along = row.along_u ? u : v;
      auto& across = row.along_u ? v : u;
      for (Eigen::Index i = 0; i < row.curves[d].rows(); ++i) {
        for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(row.curves[d], i); it;
             ++it) {
          along.emplace_back(i, place(it.col()), it.value());
        }
      }
      const ColumnSparse& raised = (row.along_u ? edges.v : edges.u).raised;
      for (ColumnSparse::InnerIterator it(raised, row.profile); it; ++it) {
        for (int c = 0; c <= row.count; ++c) across.emplace_back(it.row(), place(c), it.value());
      }
    }
    factors.u[d].resize(edges.u.fine.size(), columns);
    factors.v[d].resize(edges.v.fine.size(), columns);
    factors.u[d].setFromTriplets(u.begin(), u.end());
    factors.v[d].setFromTriplets(v.begin(), v.end());
  }
  return factors;
}

}  // namespace

EdgeEnergy EnergyOf(const EdgeRows& edges, FairnessEnergy energy) {
  const Factors factors = FactorsOf(edges);
  const int unknowns = edges.unknowns, columns = static_cast<int>(factors.u[0].cols());
  const int size_u = edges.u.coarse.size(), size_v = edges.v.coarse.size();
  EdgeEnergy result;
  result.edges = Eigen::MatrixXd::Zero(unknowns + 1, unknowns + 1);
  result.inner.fill(Eigen::MatrixXd::Zero(size_u * size_v, unknowns + 1));
  Eigen::MatrixXd pairs = Eigen::MatrixXd::Zero(columns, columns);
  for (const EnergyTerm& term :
       EnergyTerms(energy, edges.u.coarse.degree(), edges.v.coarse.degree())) {
    const ColumnSparse gram_u = GramOf(edges.u.fine, term.outer),
                       gram_v = GramOf(edges.v.fine, term.inner);
    for (int d = 0; d < 3; ++d) {
      const ColumnSparse forced_u = gram_u * factors.u[d], forced_v = gram_v * factors.v[d];
      pairs +=
          term.factor *
          Eigen::MatrixXd(ColumnSparse(factors.u[d].transpose() * forced_u))
              .cwiseProduct(Eigen::MatrixXd(ColumnSparse(factors.v[d].transpose() * forced_v)));
      const ColumnSparse on_u = edges.u.raised.transpose() * forced_u,
                         on_v = edges.v.raised.transpose() * forced_v;
      for (int c = 0; c < columns; ++c) {
        auto inner = result.inner[d].col(std::min(c, unknowns));
        for (ColumnSparse::InnerIterator a(on_u, c); a; ++a) {
          for (ColumnSparse::InnerIterator b(on_v, c); b; ++b) {
            inner[a.row() * size_v + b.row()] += term.factor * a.value() * b.value();
          }
        }
      }
    }
  }
  for (int a = 0; a < columns; ++a) {
    for (int b = 0; b < columns; ++b) {
      result.edges(std::min(a, unknowns), std::min(b, unknowns)) += pairs(a, b);
    }
  }
  return result;
}

}  // namespace batten::internal
