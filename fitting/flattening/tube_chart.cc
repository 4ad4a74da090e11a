// SPDX-License-Identifier: MIT
#include "fitting/flattening/tube_chart.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/Sparse>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "batten/geometry/knot_vectors.h"
#include "batten/geometry/surface_evaluator.h"
#include "fitting/linear/coefficient_order.h"
#include "geometry/numeric/dense_solvers.h"
#include "geometry/numeric/gauss_rule.h"

namespace batten::internal {
namespace {

constexpr int kDegree = 3;
constexpr int kCellsRound = 16;
constexpr int kLeastCells = 6, kMostCells = 400;
constexpr int kLineCellsRound = 12;
constexpr int kNodes = 3;  // of Gauss' rule in each direction of a cell

int CellsAlong(const NurbsSurface& surface) {
  const SplineBasis &u = surface.basis_u(), &v = surface.basis_v();
  const double ratio = (v.upper() - v.lower()) / (u.upper() - u.lower());
  return static_cast<int>(std::clamp(kCellsRound * ratio, 1.0 * kLeastCells, 1.0 * kMostCells));
}

// The functions that do not vanish at a place, and their first derivatives.
struct Local {
  int first;
  std::array<double, 2 * (kDegree + 1)> values;
  Local(const SplineBasis& basis, double t) {
    const int span = basis.Span(t);
    first = span - kDegree;
    basis.Derivatives(span, t, 1, values.data());
  }
  double value(int k) const { return values[k]; }
  double slope(int k) const { return values[kDegree + 1 + k]; }
};

// A place of the quadrature: parameters, area and metric of the surface there.
struct Sample {
  Eigen::Vector2d at;
  double area;
  Eigen::Matrix2d inverse_metric;
};

std::vector<double> Places(const SplineBasis& basis, std::vector<double>& weights) {
  const GaussRule rule = GaussLegendre(kNodes);
  std::vector<double> places;
  for (const int span : basis.Spans()) {
    const double from = basis.knots()[span], length = basis.knots()[span + 1] - from;
    for (int k = 0; k < kNodes; ++k) {
      places.push_back(from + rule.nodes[k] * length);
      weights.push_back(rule.weights[k] * length);
    }
  }
  return places;
}

std::vector<Sample> SamplesOf(const NurbsSurface& surface,
                              const SplineBasis& basis_u,
                              const SplineBasis& basis_v) {
  std::vector<double> weights_u, weights_v;
  const std::vector<double> us = Places(basis_u, weights_u), vs = Places(basis_v, weights_v);
  Eigen::Matrix2Xd places(2, static_cast<Eigen::Index>(us.size() * vs.size()));
  Eigen::Index next = 0;
  for (const double u : us) {
    for (const double v : vs) places.col(next++) << u, v;
  }
  std::vector<SurfaceJet> jets;
  SurfaceEvaluator(surface).Jets(places, jets);
  std::vector<Sample> samples;
  samples.reserve(jets.size());
  for (size_t k = 0; k < jets.size(); ++k) {
    const double e = jets[k].du.squaredNorm(), f = jets[k].du.dot(jets[k].dv),
                 g = jets[k].dv.squaredNorm();
    const double determinant = jets[k].du.cross(jets[k].dv).squaredNorm();
    Eigen::Matrix2d inverse;
    inverse << g, -f, -f, e;
    samples.push_back({places.col(static_cast<Eigen::Index>(k)),
                       weights_u[k / vs.size()] * weights_v[k % vs.size()] * std::sqrt(determinant),
                       inverse / determinant});
  }
  return samples;
}

// Σ area ∇f·∇f over the different coefficients, v fastest, and the work of u's own gradient.
struct Dirichlet {
  Eigen::SparseMatrix<double> matrix;
  Eigen::VectorXd of_u;
};

Dirichlet DirichletOf(const std::vector<Sample>& samples,
                      const SplineBasis& basis_u,
                      const SplineBasis& basis_v) {
  constexpr int kOrder = kDegree + 1, kLocal = kOrder * kOrder;
  const std::vector<int> distinct = DistinctIndices(&basis_u);
  const int size_v = basis_v.size(), size = DistinctCount(basis_u) * size_v;
  // Samples of a cell follow each other in v only: entries are gathered by pairs of functions.
  std::vector<Eigen::Triplet<double>> entries;
  Dirichlet result{Eigen::SparseMatrix<double>(size, size), Eigen::VectorXd::Zero(size)};
  using Block = Eigen::Matrix<double, kLocal, kLocal>;
  const size_t spans_u = basis_u.Spans().size(), spans_v = basis_v.Spans().size();
  const size_t row = spans_v * kNodes;
  for (size_t cu = 0; cu < spans_u; ++cu) {
    for (size_t cv = 0; cv < spans_v; ++cv) {
      Block block = Block::Zero();
      Eigen::Matrix<double, kLocal, 1> work = Eigen::Matrix<double, kLocal, 1>::Zero();
      std::array<int, kLocal> index{};
      for (int node = 0; node < kNodes * kNodes; ++node) {
        const Sample& s =
            samples[(cu * kNodes + node / kNodes) * row + cv * kNodes + node % kNodes];
        const Local lu(basis_u, s.at[0]), lv(basis_v, s.at[1]);
        Eigen::Matrix<double, 2, kLocal> gradients;
        for (int k = 0; k < kLocal; ++k) {
          const int i = k / kOrder, j = k % kOrder;
          gradients.col(k) << lu.slope(i) * lv.value(j), lu.value(i) * lv.slope(j);
          index[k] = distinct[lu.first + i] * size_v + lv.first + j;
        }
        const Eigen::Matrix<double, 2, kLocal> flux = s.area * s.inverse_metric * gradients;
        block.noalias() += gradients.transpose() * flux;
        work += flux.row(0).transpose();
      }
      for (int a = 0; a < kLocal; ++a) {
        result.of_u[index[a]] += work[a];
        for (int b = 0; b < kLocal; ++b) entries.emplace_back(index[a], index[b], block(a, b));
      }
    }
  }
  result.matrix.setFromTriplets(entries.begin(), entries.end());
  return result;
}

using Solver = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>;

// Periodic part, added to u / period, of the harmonic function that grows by one round the surface.
Eigen::VectorXd RoundPart(const Dirichlet& energy, double period) {
  Eigen::SparseMatrix<double> matrix = energy.matrix;
  matrix.coeffRef(0, 0) *= 2;  // holds the constant
  return Solver(matrix).solve(-energy.of_u / period);
}

// The harmonic function that is 0 at the lower and 1 at the upper end.
Eigen::VectorXd AlongPart(const Dirichlet& energy, int size_v) {
  const auto size = energy.matrix.rows();
  const auto held = [&](Eigen::Index k) { return k % size_v == 0 || k % size_v == size_v - 1; };
  Eigen::VectorXd ends = Eigen::VectorXd::Zero(size);
  for (Eigen::Index k = size_v - 1; k < size; k += size_v) ends[k] = 1;
  Eigen::VectorXd rhs = -(energy.matrix * ends);
  Eigen::SparseMatrix<double> matrix = energy.matrix;
  matrix.prune(
      [&](Eigen::Index i, Eigen::Index j, double) { return i == j || (!held(i) && !held(j)); });
  for (Eigen::Index k = 0; k < size; ++k) {
    if (held(k)) rhs[k] = 0;
  }
  return Solver(matrix).solve(rhs) + ends;
}

// Values, gradients and their lengths of a function over the samples.
struct Growth {
  std::vector<double> value, slope;
  std::vector<Eigen::Vector2d> gradient;  // by u and v
};

Growth GrowthOf(const std::vector<Sample>& samples,
                const SplineBasis& basis_u,
                const SplineBasis& basis_v,
                const Eigen::VectorXd& coefficients,
                double slope_u) {
  const std::vector<int> distinct = DistinctIndices(&basis_u);
  Growth growth;
  for (const Sample& s : samples) {
    const Local lu(basis_u, s.at[0]), lv(basis_v, s.at[1]);
    double value = slope_u * s.at[0];
    Eigen::Vector2d gradient(slope_u, 0);
    for (int i = 0; i <= kDegree; ++i) {
      for (int j = 0; j <= kDegree; ++j) {
        const double c = coefficients[distinct[lu.first + i] * basis_v.size() + lv.first + j];
        value += c * lu.value(i) * lv.value(j);
        gradient += c * Eigen::Vector2d(lu.slope(i) * lv.value(j), lu.value(i) * lv.slope(j));
      }
    }
    growth.value.push_back(value);
    growth.gradient.push_back(gradient);
    growth.slope.push_back(std::sqrt(gradient.dot(s.inverse_metric * gradient)));
  }
  return growth;
}

// Coefficients of the g that minimises Σ area (g'(value) slope − 1)², g(0) = 0. Over a periodic
// basis the last one is what g grows by in one period, the others those of the rest.
Eigen::VectorXd LengthsOver(const std::vector<Sample>& samples,
                            const Growth& growth,
                            const SplineBasis& basis) {
  const std::vector<int> distinct = DistinctIndices(&basis);
  const int count = DistinctCount(basis), size = basis.periodic() ? count + 1 : count;
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd rhs = Eigen::VectorXd::Zero(size);
  for (size_t k = 0; k < growth.value.size(); ++k) {
    const Local local(basis, basis.Clamp(growth.value[k]));
    std::array<int, kDegree + 2> index{};
    std::array<double, kDegree + 2> slope{};
    for (int i = 0; i <= kDegree; ++i) {
      index[i] = distinct[local.first + i];
      slope[i] = local.slope(i) * growth.slope[k];
    }
    index[kDegree + 1] = count;
    slope[kDegree + 1] = growth.slope[k];
    const int terms = basis.periodic() ? kDegree + 2 : kDegree + 1;
    for (int a = 0; a < terms; ++a) {
      rhs[index[a]] += samples[k].area * slope[a];
      for (int b = 0; b < terms; ++b)
        gram(index[a], index[b]) += samples[k].area * slope[a] * slope[b];
    }
  }
  constexpr double kSteady = 1e-12;
  gram.diagonal().array() += kSteady * gram.trace() / size;
  gram(0, 0) *= 2;  // holds the constant
  Eigen::VectorXd lengths = SymmetricSolution(gram, rhs);
  if (!basis.periodic()) lengths.array() -= lengths[0];
  return lengths;
}

// Derivative g' at t.
double SlopeOf(const SplineBasis& basis, const Eigen::VectorXd& coefficients, double t) {
  const Local local(basis, basis.Clamp(t));
  double slope = basis.periodic() ? coefficients[DistinctCount(basis)] : 0.0;
  for (int i = 0; i <= kDegree; ++i) {
    slope += local.slope(i) * coefficients[DistinctIndex(basis, local.first + i)];
  }
  return slope;
}

double ValueOf(const SplineBasis& basis, const Eigen::VectorXd& coefficients, double t) {
  const double inside = basis.Clamp(t);
  const Local local(basis, inside);
  double value = 0;
  for (int i = 0; i <= kDegree; ++i) {
    value += local.value(i) * coefficients[DistinctIndex(basis, local.first + i)];
  }
  return basis.periodic() ? value + inside * coefficients[DistinctCount(basis)] : value;
}

}  // namespace

TubeChart::TubeChart(const NurbsSurface& surface)
    : basis_u_(PeriodicUniformKnots(
          kDegree, kCellsRound, surface.basis_u().lower(), surface.basis_u().upper())),
      basis_v_(SplineBasis::Uniform(kDegree,
                                    CellsAlong(surface) + kDegree,
                                    surface.basis_v().lower(),
                                    surface.basis_v().upper())),
      round_basis_(PeriodicUniformKnots(kDegree, kLineCellsRound, 0, 1)),
      along_basis_(SplineBasis::Uniform(kDegree, CellsAlong(surface) / 2 + kDegree, 0, 1)) {
  const double period = basis_u_.upper() - basis_u_.lower();
  const std::vector<Sample> samples = SamplesOf(surface, basis_u_, basis_v_);
  const Dirichlet energy = DirichletOf(samples, basis_u_, basis_v_);
  round_ = RoundPart(energy, period);
  along_ = AlongPart(energy, basis_v_.size());
  const Growth round = GrowthOf(samples, basis_u_, basis_v_, round_, 1 / period);
  const Growth along = GrowthOf(samples, basis_u_, basis_v_, along_, 0);
  round_scale_ = LengthsOver(samples, round, round_basis_);
  along_scale_ = LengthsOver(samples, along, along_basis_);
  length_round_ = round_scale_[round_scale_.size() - 1];
  length_along_ = along_scale_[along_scale_.size() - 1];
  double area = 0, squares = 0, folded = 0;
  for (size_t k = 0; k < samples.size(); ++k) {
    const double a = SlopeOf(round_basis_, round_scale_, round.value[k]);
    const double b = SlopeOf(along_basis_, along_scale_, along.value[k]);
    const double turn =
        round.gradient[k][0] * along.gradient[k][1] - round.gradient[k][1] * along.gradient[k][0];
    area += samples[k].area;
    squares += samples[k].area *
               (std::pow(a * round.slope[k] - 1, 2) + std::pow(b * along.slope[k] - 1, 2)) / 2;
    if (!(a * b * turn > 0)) folded += samples[k].area;
  }
  distortion_ = std::sqrt(squares / area);
  folded_ = folded / area;
}

Eigen::Matrix2Xd TubeChart::At(const Eigen::Matrix2Xd& parameters, ThreadPool& pool) const {
  const double period = basis_u_.upper() - basis_u_.lower();
  Eigen::Matrix2Xd result(2, parameters.cols());
  pool.For(parameters.cols(), 1024, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (auto k = begin; k < end; ++k) {
      const double u = basis_u_.Clamp(parameters(0, k)), v = basis_v_.Clamp(parameters(1, k));
      const Local lu(basis_u_, u), lv(basis_v_, v);
      double round = u / period, along = 0;
      for (int i = 0; i <= kDegree; ++i) {
        const int first = DistinctIndex(basis_u_, lu.first + i) * basis_v_.size() + lv.first;
        for (int j = 0; j <= kDegree; ++j) {
          round += round_[first + j] * lu.value(i) * lv.value(j);
          along += along_[first + j] * lu.value(i) * lv.value(j);
        }
      }
      const double length = ValueOf(round_basis_, round_scale_, round);
      const double rest = length - length_round_ * std::floor(length / length_round_);
      result(0, k) = rest < length_round_ ? rest : 0.0;
      result(1, k) = std::clamp(ValueOf(along_basis_, along_scale_, along), 0.0, length_along_);
    }
  });
  return result;
}

}  // namespace batten::internal
