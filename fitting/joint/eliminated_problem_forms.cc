// SPDX-License-Identifier: MIT
// The quadratic forms of single cells: what their points, fairness, prior and damping say.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "fitting/joint/eliminated_problem.h"
#include "fitting/least_squares/fairness.h"
#include "geometry/numeric/gauss_rule.h"
#include "geometry/nurbs/knot_derivatives.h"

namespace batten::internal {
namespace {

constexpr int kBatch = 48;  // rows of a cell that are multiplied at once

// The fairness form of one cell, in the functions that live on it.
Eigen::MatrixXd CellFairness(
    const SplineBasis& bu, int span_u, const SplineBasis* bv, int span_v, FairnessEnergy energy) {
  const int p = bu.degree(), q = bv ? bv->degree() : 0, f = (p + 1) * (q + 1);
  const std::vector<EnergyTerm> terms = EnergyTerms(energy, p, q);
  const int order = terms.front().outer;
  const GaussRule gu = GaussLegendre(p + 1), gv = GaussLegendre(q + 1);
  const double a = bu.knots()[span_u], b = bu.knots()[span_u + 1];
  const double c = bv ? bv->knots()[span_v] : 0, d = bv ? bv->knots()[span_v + 1] : 1;
  Eigen::MatrixXd form = Eigen::MatrixXd::Zero(f, f);
  std::vector<double> Nu((order + 1) * (p + 1)), Nv((order + 1) * (q + 1), 0.0);
  Nv[0] = 1;
  Eigen::VectorXd row(f);
  for (int i = 0; i <= p; ++i) {
    bu.Derivatives(span_u, a + (b - a) * gu.nodes[i], order, Nu.data());
    for (int j = 0; j <= q; ++j) {
      if (bv) bv->Derivatives(span_v, c + (d - c) * gv.nodes[j], order, Nv.data());
      const double weight = gu.weights[i] * (b - a) * (bv ? gv.weights[j] * (d - c) : 1.0);
      for (const EnergyTerm& term : terms) {
        for (int r = 0; r <= p; ++r) {
          for (int s = 0; s <= q; ++s) {
            row[r * (q + 1) + s] = Nu[term.outer * (p + 1) + r] * Nv[term.inner * (q + 1) + s];
          }
        }
        form.selfadjointView<Eigen::Lower>().rankUpdate(row, weight * term.factor);
      }
    }
  }
  return form.selfadjointView<Eigen::Lower>();
}

}  // namespace

// The factors of the rows of one point.
struct EliminatedProblem::Workspace {
  Eigen::VectorXd R;       // rational functions
  Eigen::MatrixXd corner;  // the cell's control points
  Eigen::MatrixXd toward;  // control points less the point of the shape
  Eigen::MatrixXd knots;   // dimension × local knots: how the point moves with them
};
void EliminatedProblem::MakeFairness() {
  const SplineBasis* bv = shape_.basis_v ? &*shape_.basis_v : nullptr;
  for (Cell& cell : cells_) {
    cell.fairness =
        fairness_unit_ > 0
            ? Eigen::MatrixXd(fairness_unit_ *
                              CellFairness(shape_.basis_u, cell.span_u, bv, cell.span_v, energy_))
            : Eigen::MatrixXd();
  }
}

void EliminatedProblem::Prepare(const Cell& cell, Eigen::Index k, Workspace& work) const {
  const double u = foot_points_.parameters(0, k), v = foot_points_.parameters(1, k);
  shape_.Rational(cell.span_u, cell.span_v, u, v, work.R.data());
  const Eigen::VectorXd point = data_->values.col(k) + foot_points_.difference.col(k);
  work.toward = work.corner.colwise() - point;
  if (local_knots() == 0) return;
  // The shape moves by Σ (∂N/∂t) w (P − S) / Σ N w.
  const int p = shape_.basis_u.degree(), q = shape_.degree_v();
  double Nu[kMaxDegree + 1], Nv[kMaxDegree + 1];
  const KnotDerivativeMatrix Du = KnotDerivatives(shape_.basis_u, cell.span_u, u, Nu);
  KnotDerivativeMatrix Dv;
  Nv[0] = 1;
  if (shape_.basis_v) Dv = KnotDerivatives(*shape_.basis_v, cell.span_v, v, Nv);
  double sum = 0;
  Eigen::VectorXd w(functions_);
  for (int a = 0; a < functions_; ++a) {
    w[a] = shape_.weights[shape_.ControlPoint(cell.span_u, cell.span_v, a)];
    sum += Nu[a / (q + 1)] * Nv[a % (q + 1)] * w[a];
  }
  w /= sum;
  work.knots.setZero();
  int column = 0;
  if (directions_[0].free) {
    for (int r = 0; r <= p; ++r) {
      Eigen::VectorXd across = Eigen::VectorXd::Zero(dimension());
      for (int s = 0; s <= q; ++s) {
        const int a = r * (q + 1) + s;
        across += Nv[s] * w[a] * work.toward.col(a);
      }
      for (int j = 0; j < 2 * p; ++j) work.knots.col(j) += Du(j, r) * across;
    }
    column = 2 * p;
  }
  if (shape_.basis_v && directions_[1].free) {
    for (int s = 0; s <= q; ++s) {
      Eigen::VectorXd across = Eigen::VectorXd::Zero(dimension());
      for (int r = 0; r <= p; ++r) {
        const int a = r * (q + 1) + s;
        across += Nu[r] * w[a] * work.toward.col(a);
      }
      for (int j = 0; j < 2 * q; ++j) work.knots.col(column + j) += Dv(j, s) * across;
    }
  }
}

// scale · direction · ∂S/∂(local unknowns).
void EliminatedProblem::FillRow(const Workspace& work,
                                const Eigen::VectorXd& direction,
                                double scale,
                                double* row) const {
  const int dim = dimension(), f = functions_;
  for (int a = 0; a < f; ++a) {
    const double c = scale * work.R[a];
    for (int d = 0; d < dim; ++d) row[dim * a + d] = c * direction[d];
  }
  double* next = row + dim * f;
  if (options_.free_weights) {
    for (int a = 0; a < f; ++a) *next++ = scale * work.R[a] * direction.dot(work.toward.col(a));
  }
  for (int j = 0; j < local_knots(); ++j) *next++ = scale * direction.dot(work.knots.col(j));
}

EliminatedProblem::Workspace EliminatedProblem::WorkspaceOf(const Cell& cell) const {
  const int dim = dimension(), f = functions_;
  Workspace work{Eigen::VectorXd(f),
                 Eigen::MatrixXd(dim, f),
                 Eigen::MatrixXd(dim, f),
                 Eigen::MatrixXd::Zero(dim, local_knots())};
  for (int a = 0; a < f; ++a)
    work.corner.col(a) = shape_.net.col(shape_.ControlPoint(cell.span_u, cell.span_v, a));
  return work;
}

// [J r]ᵀ[J r] of the cell's points, in the directions that count or in all.
void EliminatedProblem::AddPoints(const Cell& cell,
                                  bool in_all_directions,
                                  Eigen::MatrixXd& form) const {
  const int dim = dimension(), n = local_columns();
  Eigen::MatrixXd rows(n + 1, kBatch);
  int filled = 0;
  const auto flush = [&] {
    if (filled > 0) form.selfadjointView<Eigen::Lower>().rankUpdate(rows.leftCols(filled));
    filled = 0;
  };
  Workspace work = WorkspaceOf(cell);
  Eigen::VectorXd direction(dim);
  for (Eigen::Index i = cell.begin; i < cell.end; ++i) {
    const Eigen::Index k = order_[i];
    const double weight = Weight(k);
    if (weight == 0) continue;
    Prepare(cell, k, work);
    const double root = std::sqrt(weight);
    const int kept = in_all_directions ? 0 : foot_points_.directions[k];
    for (int d = 0; d < (kept == 0 ? dim : kept); ++d) {
      if (kept == 0) {
        direction = Eigen::VectorXd::Unit(dim, d);
      } else {
        direction = d == 0 ? foot_points_.first.col(k) : foot_points_.second.col(k);
      }
      double* row = rows.col(filled).data();
      FillRow(work, direction, root, row);
      row[n] = root * direction.dot(foot_points_.difference.col(k));
      if (++filled == kBatch) flush();
    }
  }
  flush();
}

// The same of the cell's points, fairness, prior and proximal term; its last entry is twice the
// cost.
Eigen::MatrixXd EliminatedProblem::CellForm(const Cell& cell) const {
  const int dim = dimension(), f = functions_, n = local_columns();
  Eigen::MatrixXd form = Eigen::MatrixXd::Zero(n + 1, n + 1);
  if (only_points()) {
    AddSums(cell, form);
  } else {
    AddPoints(cell, false, form);
  }
  double cost = PointsCost(cell);
  const Workspace work = WorkspaceOf(cell);
  if (cell.fairness.size() > 0) {
    const double regularized = cell.regularized;
    const Eigen::MatrixXd pull = regularized * work.corner * cell.fairness;
    for (int a = 0; a < f; ++a) {
      for (int b = 0; b <= a; ++b) {
        for (int d = 0; d < dim; ++d)
          form(dim * a + d, dim * b + d) += regularized * cell.fairness(a, b);
      }
      for (int d = 0; d < dim; ++d) form(n, dim * a + d) += pull(d, a);
    }
    cost += pull.cwiseProduct(work.corner).sum();
  }
  if (options_.free_weights) {
    for (int a = 0; a < f; ++a) {
      const int block = BlockOf(shape_.ControlPoint(cell.span_u, cell.span_v, a));
      const double prior = Prior(block), value = log_weights_[block];
      form(dim * f + a, dim * f + a) += prior;
      form(n, dim * f + a) += prior * value;
      cost += prior * value * value;
    }
  }
  if (only_points()) {
    for (int a = 0; a < f; ++a) {
      for (int b = 0; b <= a; ++b) {
        for (int d = 0; d < dim; ++d)
          form(dim * a + d, dim * b + d) += used_damping_ * cell.proximal(a, b);
      }
    }
  } else {
    form.topLeftCorner(n, n).triangularView<Eigen::Lower>() += used_damping_ * cell.proximal;
  }
  form(n, n) = cost;
  return form;
}

// How far the shape at the accepted parameters moves with the local unknowns: the point-distance
// form.
Eigen::MatrixXd EliminatedProblem::ProximalForm(const Cell& cell) const {
  const int n = local_columns();
  Eigen::MatrixXd form = Eigen::MatrixXd::Zero(n + 1, n + 1);
  AddPoints(cell, true, form);
  return form.topLeftCorner(n, n).selfadjointView<Eigen::Lower>();
}

// Local unknowns less the accepted ones, control points one coordinate a row if they are alone.
Eigen::VectorXd EliminatedProblem::Displacement(const Cell& cell) const {
  const int dim = dimension(), f = functions_;
  Eigen::VectorXd moved(local_columns());
  for (int a = 0; a < f; ++a) {
    const int point = shape_.ControlPoint(cell.span_u, cell.span_v, a);
    moved.segment(dim * a, dim) = shape_.net.col(point) - accepted_.net.col(point);
    if (options_.free_weights) {
      const int block = BlockOf(point);
      moved[dim * f + a] = log_weights_[block] - accepted_log_weights_[block];
    }
  }
  int next = f * (dim + (options_.free_weights ? 1 : 0));
  const auto add_knots = [&](const SplineBasis& now, const SplineBasis& before, int span) {
    for (int j = span - now.degree() + 1; j <= span + now.degree(); ++j)
      moved[next++] = now.knots()[j] - before.knots()[j];
  };
  if (directions_[0].free) add_knots(shape_.basis_u, accepted_.basis_u, cell.span_u);
  if (shape_.basis_v && directions_[1].free)
    add_knots(*shape_.basis_v, *accepted_.basis_v, cell.span_v);
  return moved;
}

double EliminatedProblem::PointsCost(const Cell& cell) const {
  double cost = 0;
  for (Eigen::Index i = cell.begin; i < cell.end; ++i) {
    const Eigen::Index k = order_[i];
    cost += 2 * (data_->weights.size() > 0 ? data_->weights[k] : 1.0) *
            LossValue(options_.loss, Distance(k), options_.loss_scale);
  }
  return cost;
}

// Twice what the cell adds to the cost.
double EliminatedProblem::CellCost(const Cell& cell, double of_damping) const {
  const int dim = dimension(), f = functions_;
  double cost = PointsCost(cell);
  if (cell.fairness.size() > 0) {
    Eigen::MatrixXd corner(dim, f);
    for (int a = 0; a < f; ++a)
      corner.col(a) = shape_.net.col(shape_.ControlPoint(cell.span_u, cell.span_v, a));
    cost += cell.regularized * (corner * cell.fairness).cwiseProduct(corner).sum();
  }
  if (options_.free_weights) {
    for (int a = 0; a < f; ++a) {
      const int block = BlockOf(shape_.ControlPoint(cell.span_u, cell.span_v, a));
      cost += Prior(block) * log_weights_[block] * log_weights_[block];
    }
  }
  const Eigen::VectorXd moved = Displacement(cell);
  if (only_points()) {
    const Eigen::Map<const Eigen::MatrixXd> corner(moved.data(), dim, f);
    cost += of_damping * (corner * cell.proximal).cwiseProduct(corner).sum();
  } else {
    cost += of_damping * moved.dot(cell.proximal * moved);
  }
  return cost;
}

void EliminatedProblem::Linearise() {
  const size_t residuals = static_cast<size_t>(rows()), all = residuals * (columns() + 1);
  linear_.resize(all * cells_.size());
  pool_.For(cells(), 4, [&](std::ptrdiff_t first, std::ptrdiff_t last) {
    for (std::ptrdiff_t c = first; c < last; ++c) {
      double* begin = linear_.data() + all * static_cast<size_t>(c);
      Rows(cells_[static_cast<size_t>(c)], begin, begin + residuals);
    }
  });
}

void EliminatedProblem::Evaluate(int cell, double* residual, double* jacobian) const {
  const auto residuals = static_cast<size_t>(rows()), index = static_cast<size_t>(cell);
  if (jacobian == nullptr) {
    std::fill_n(residual, residuals, 0.0);
    residual[0] = std::sqrt(std::max(0.0, CellCost(cells_[index], used_damping_)));
    return;
  }
  const size_t all = residuals * (columns() + 1);
  const double* begin = linear_.data() + all * index;
  std::copy_n(begin, residuals, residual);
  std::copy_n(begin + residuals, all - residuals, jacobian);
}

void EliminatedProblem::Rows(const Cell& cell, double* residual, double* jacobian) const {
  const int n = local_columns();
  Eigen::Map<Eigen::VectorXd> out(residual, rows());
  // The form is brought to a diagonal of ones, so that unknowns of different kinds and units are
  // judged alike. With PᵀLDLᵀP the scaled form and g the gradient, rows √D·LᵀP and residuals
  // D^(−1/2)·L⁻¹·P·g have the same normal equations; pivots that are rounding are left out.
  Eigen::MatrixXd form = CellForm(cell);
  const Eigen::VectorXd scale =
      (form.diagonal().head(n).array() > 0)
          .select(form.diagonal().head(n).array().max(std::numeric_limits<double>::min()).sqrt(),
                  1.0);
  const Eigen::VectorXd inverse = scale.cwiseInverse();
  Eigen::VectorXd g = inverse.cwiseProduct(form.row(n).head(n).transpose());
  form.topLeftCorner(n, n) = inverse.asDiagonal() * form.topLeftCorner(n, n) * inverse.asDiagonal();
  const Eigen::LDLT<Eigen::MatrixXd> factor(form.topLeftCorner(n, n));
  const Eigen::VectorXd pivots = factor.vectorD();
  const double least = 4 * n * std::numeric_limits<double>::epsilon();
  const Eigen::VectorXd roots =
      (pivots.array() > least).select(pivots.array().max(least).sqrt(), 0.0);
  g = factor.transpositionsP() * g;
  factor.matrixL().solveInPlace(g);
  for (int r = 0; r < n; ++r) out[r] = roots[r] > 0 ? g[r] / roots[r] : 0.0;
  out[n] = std::sqrt(std::max(0.0, form(n, n) - out.head(n).squaredNorm()));
  const Eigen::MatrixXd permutation = factor.transpositionsP() * Eigen::MatrixXd::Identity(n, n);
  const Eigen::MatrixXd whole =
      roots.asDiagonal() * (factor.matrixU() * permutation) * scale.asDiagonal();

  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Eigen::Map<RowMajor> J(jacobian, rows(), columns());
  const int plain = n - local_knots();
  J.topLeftCorner(n, plain) = whole.leftCols(plain);
  J.row(n).setZero();
  int from = plain, to = plain;
  const auto chain = [&](const Direction& direction, int span, int degree) {
    if (!direction.free) return;
    const int count = direction.gaps.groups() + 1;
    J.block(0, to, n, count).setZero();
    for (int j = 0; j < 2 * degree; ++j) {
      const int group = direction.group_of[static_cast<size_t>(span - degree + 1 + j)];
      if (group >= 0)
        J.block(0, to, n, count).noalias() += whole.col(from + j) * direction.chain.row(group);
    }
    from += 2 * degree;
    to += count;
  };
  chain(directions_[0], cell.span_u, shape_.basis_u.degree());
  if (shape_.basis_v) chain(directions_[1], cell.span_v, shape_.degree_v());
}

}  // namespace batten::internal