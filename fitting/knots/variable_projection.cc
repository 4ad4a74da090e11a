// SPDX-License-Identifier: MIT
#include "fitting/knots/variable_projection.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "fitting/least_squares/normal_equations.h"
#include "fitting/least_squares/penalised_system.h"
#include "fitting/linear/block_banded_matrix.h"
#include "geometry/nurbs/knot_derivatives.h"

namespace batten::internal {
namespace {

// Sums of squares below this share of the data's are taken point by point: sums of products then
// keep fewer than twelve digits.
constexpr double kCancelled = 1e-4;

// Columns of the free knots that act on one span: entry j is that of knot span − p + 1 + j, or −1.
void ColumnsOnSpan(
    const std::vector<int>& group_of, int degree, int span, int first, int* columns) {
  for (int j = 0; j < 2 * degree; ++j) {
    const int group = group_of[span - degree + 1 + j];
    columns[j] = group < 0 ? -1 : first + group;
  }
}

}  // namespace

VariableProjection::VariableProjection(const FittingProblem& problem)
    : u_(problem.data().parameters.row(0)),
      v_(problem.data().parameters.row(1)),
      values_(problem.data().values),
      weights_(problem.data().weights),
      energy_(problem.energy()),
      smoothing_(problem.smoothing()) {
  if (u_.size() == 0) return;
  values_.colwise() -= Eigen::VectorXd(values_.rowwise().mean());
  const Eigen::VectorXd norms = values_.colwise().squaredNorm();
  squares_ = weights_.size() > 0 ? weights_.dot(norms) : norms.sum();
}

VariableProjection VariableProjection::Thinned(Eigen::Index count) const {
  const Eigen::Index m = size(),
                     step = std::max<Eigen::Index>(1, m / std::max<Eigen::Index>(1, count));
  std::vector<Eigen::Index> order(static_cast<size_t>(m));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
    return u_[a] != u_[b] ? u_[a] < u_[b] : v_[a] < v_[b];
  });
  VariableProjection thinned = *this;
  const Eigen::Index kept = (m + step - 1) / step;
  thinned.u_.resize(kept);
  thinned.v_.resize(kept);
  thinned.values_.resize(values_.rows(), kept);
  if (weights_.size() > 0) thinned.weights_.resize(kept);
  thinned.squares_ = 0;
  for (Eigen::Index k = 0; k < kept; ++k) {
    // One of every `step`, at an irregular place among them, lest rows of a grid repeat.
    const double place = static_cast<double>(k) * (std::numbers::phi - 1);
    const auto offset =
        static_cast<Eigen::Index>((place - std::floor(place)) * static_cast<double>(step));
    const Eigen::Index from = order[std::min(m - 1, k * step + offset)];
    thinned.u_[k] = u_[from];
    thinned.v_[k] = v_[from];
    thinned.values_.col(k) = values_.col(from);
    if (weights_.size() > 0) thinned.weights_[k] = weights_[from];
    thinned.squares_ +=
        (weights_.size() > 0 ? weights_[from] : 1.0) * values_.col(from).squaredNorm();
  }
  return thinned;
}

// The linear problem at one set of knots: everything that its parts share.
struct VariableProjection::Solved {
  const SplineBasis *outer, *inner;  // inner null for a curve
  const Eigen::VectorXd *outer_parameters, *inner_parameters;
  bool u_outside;
  CellOrder order;
  BlockBandedMatrix factor;
  Eigen::MatrixXd coefficients;  // n × d, inner fastest
  double cost, squares;

  int inner_size() const { return inner ? inner->size() : 1; }
  int inner_degree() const { return inner ? inner->degree() : 0; }
  Eigen::Index Row(const CellOrder::Cell& cell, int r) const {
    return Eigen::Index{cell.outer_span - outer->degree() + r} * inner_size() + cell.inner_span -
           inner_degree();
  }

  // Calls body(cell, point, residual of its d values) for every point.
  template <class Body>
  void ForResiduals(const Eigen::MatrixXd& values, ThreadPool& pool, const Body& body) const {
    const int p = outer->degree(), q = inner_degree();
    pool.For(static_cast<std::ptrdiff_t>(order.cells().size()),
             8,
             [&](std::ptrdiff_t first, std::ptrdiff_t last) {
               double No[kMaxDegree + 1], Ni[kMaxDegree + 1] = {1};
               Eigen::VectorXd residual(values.rows());
               for (std::ptrdiff_t c = first; c < last; ++c) {
                 const CellOrder::Cell& cell = order.cells()[c];
                 for (Eigen::Index i = cell.begin; i < cell.end; ++i) {
                   const Eigen::Index k = order.points()[i];
                   outer->Values(cell.outer_span, (*outer_parameters)[k], No);
                   if (inner) inner->Values(cell.inner_span, (*inner_parameters)[k], Ni);
                   residual = -values.col(k);
                   for (int r = 0; r <= p; ++r) {
                     for (int s = 0; s <= q; ++s) {
                       residual += No[r] * Ni[s] * coefficients.row(Row(cell, r) + s).transpose();
                     }
                   }
                   body(c, k, residual);
                 }
               }
             });
  }
};

std::optional<VariableProjection::Solved> VariableProjection::Solve(const MovingKnots& knots,
                                                                    ThreadPool& pool) const {
  if (size() == 0) return std::nullopt;
  const bool u_outside = !knots.v || knots.u.basis().size() >= knots.v->basis().size();
  const SplineBasis* outer = u_outside ? &knots.u.basis() : &knots.v->basis();
  const SplineBasis* inner = !knots.v ? nullptr : u_outside ? &knots.v->basis() : &knots.u.basis();
  const Eigen::VectorXd& outer_parameters = u_outside ? u_ : v_;
  const Eigen::VectorXd& inner_parameters = u_outside ? v_ : u_;
  const PenalisedSystem system(knots.u.basis(),
                               knots.v ? &knots.v->basis() : nullptr,
                               u_,
                               v_,
                               values_,
                               weights_,
                               energy_,
                               pool);
  BlockBandedMatrix matrix = system.Matrix(smoothing_, 1);
  if (!matrix.Factor()) return std::nullopt;
  // With a margin of two, so that problems accepted here are accepted by SolveLinear too.
  if (!system.Determines(smoothing_, matrix.SmallestPivot(), 2)) return std::nullopt;
  Eigen::MatrixXd coefficients = system.rhs();
  matrix.Solve(coefficients);
  if (!coefficients.allFinite()) return std::nullopt;

  // (A + λP)c = b: Φ = zᵀz − cᵀb, of which λ cᵀPc is fairness.
  const double energy =
      smoothing_ > 0 ? system.Lambda(smoothing_) * system.Roughness(coefficients) : 0;
  const double cost = system.squares() - coefficients.cwiseProduct(system.rhs()).sum();
  Solved solved{outer,
                inner,
                &outer_parameters,
                &inner_parameters,
                u_outside,
                CellOrder(*outer, inner, outer_parameters, inner_parameters),
                std::move(matrix),
                std::move(coefficients),
                cost,
                cost - energy};
  if (!(solved.squares > kCancelled * squares_)) {
    std::vector<double> sums(solved.order.cells().size(), 0.0);
    solved.ForResiduals(
        values_, pool, [&](std::ptrdiff_t c, Eigen::Index k, const Eigen::VectorXd& residual) {
          sums[c] += (weights_.size() > 0 ? weights_[k] : 1.0) * residual.squaredNorm();
        });
    solved.squares = std::accumulate(sums.begin(), sums.end(), 0.0);
    solved.cost = solved.squares + energy;
  }
  if (!std::isfinite(solved.cost)) return std::nullopt;
  return solved;
}

std::optional<ProjectedSquares> VariableProjection::Evaluate(const MovingKnots& knots,
                                                             ThreadPool& pool) const {
  const auto solved = Solve(knots, pool);
  if (!solved) return std::nullopt;
  ProjectedSquares result;
  result.cost = solved->cost;
  result.squares = solved->squares;
  return result;
}

namespace {

// The sums of the points of one cell for the knots that act on it, with D = (∂B/∂t)c.
struct CellSums {
  Eigen::MatrixXd products;  // Σ w D Dᵀ, active × active
  Eigen::VectorXd gradient;  // Σ w D r
  Eigen::MatrixXd mixed;     // Σ w b Dᵀ, functions × (active · d), component outermost

  CellSums() = default;
  CellSums(int functions, int active, int d)
      : products(Eigen::MatrixXd::Zero(active, active)),
        gradient(Eigen::VectorXd::Zero(active)),
        mixed(Eigen::MatrixXd::Zero(functions, Eigen::Index{active} * d)) {}

  void Add(double w, double r, const double* D, const double* b, int component) {
    const auto active = static_cast<int>(gradient.size());
    const auto functions = static_cast<int>(mixed.rows());
    for (int j = 0; j < active; ++j) {
      const double wD = w * D[j];
      double* column = products.data() + static_cast<size_t>(j) * active;
      for (int l = 0; l < active; ++l) column[l] += wD * D[l];
      gradient[j] += wD * r;
      double* mix = mixed.data() + (static_cast<size_t>(component) * active + j) * functions;
      for (int f = 0; f < functions; ++f) mix[f] += wD * b[f];
    }
  }
};

// d[j] = Σ_r matrix(j, r) x[r]
void Apply(const KnotDerivativeMatrix& matrix, const double* x, double* d) {
  for (Eigen::Index j = 0; j < matrix.rows(); ++j) {
    double sum = 0;
    for (Eigen::Index r = 0; r < matrix.cols(); ++r) sum += matrix(j, r) * x[r];
    d[j] = sum;
  }
}

}  // namespace

// With (A + λP)X = BᵀWD:  JᵀJ = DᵀWD − (BᵀWD)ᵀX,  Jᵀr = DᵀWr.
std::optional<ProjectedSquares> VariableProjection::Linearise(const MovingKnots& knots,
                                                              ThreadPool& pool) const {
  const auto solved = Solve(knots, pool);
  if (!solved) return std::nullopt;
  if (knots.free() == 0) return ProjectedSquares{solved->cost, solved->squares, {}, {}};
  const SplineBasis& outer = *solved->outer;
  const SplineBasis* inner = solved->inner;
  const int p = outer.degree(), q = solved->inner_degree(), functions = (p + 1) * (q + 1);
  const bool move_outer = solved->u_outside ? knots.free_u() > 0 : knots.free_v() > 0;
  const bool move_inner = inner && (solved->u_outside ? knots.free_v() > 0 : knots.free_u() > 0);
  const int first_outer = solved->u_outside ? 0 : knots.free_u();
  const int first_inner = solved->u_outside ? knots.free_u() : 0;
  const int active_outer = move_outer ? 2 * p : 0, active = active_outer + (move_inner ? 2 * q : 0);
  const auto d = static_cast<int>(values_.rows());
  const auto& cells = solved->order.cells();
  std::vector<CellSums> sums(cells.size());

  pool.For(
      static_cast<std::ptrdiff_t>(cells.size()), 8, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
        double No[kMaxDegree + 1], Ni[kMaxDegree + 1] = {1}, D[4 * kMaxDegree];
        double across[kMaxDegree + 1],
            along[kMaxDegree + 1];  // the net contracted with Ni, with No
        KnotDerivativeMatrix Do, Di;
        std::vector<double> b(static_cast<size_t>(functions)),
            net(static_cast<size_t>(functions) * d);
        for (std::ptrdiff_t c = begin; c < end; ++c) {
          const CellOrder::Cell& cell = cells[c];
          CellSums sum(functions, active, d);
          for (int e = 0; e < d; ++e) {
            for (int f = 0; f < functions; ++f) {
              net[e * functions + f] =
                  solved->coefficients(solved->Row(cell, f / (q + 1)) + f % (q + 1), e);
            }
          }
          for (Eigen::Index i = cell.begin; i < cell.end; ++i) {
            const Eigen::Index k = solved->order.points()[i];
            const double w = weights_.size() > 0 ? weights_[k] : 1.0;
            if (w == 0) continue;
            const double to = (*solved->outer_parameters)[k], ti = (*solved->inner_parameters)[k];
            if (move_outer) {
              Do = KnotDerivatives(outer, cell.outer_span, to, No);
            } else {
              outer.Values(cell.outer_span, to, No);
            }
            if (move_inner) {
              Di = KnotDerivatives(*inner, cell.inner_span, ti, Ni);
            } else if (inner) {
              inner->Values(cell.inner_span, ti, Ni);
            }
            for (int r = 0, f = 0; r <= p; ++r) {
              for (int s = 0; s <= q; ++s, ++f) b[f] = No[r] * Ni[s];
            }
            for (int e = 0; e < d; ++e) {
              const double* C = net.data() + static_cast<size_t>(e) * functions;
              double residual = -values_(e, k);
              std::fill_n(along, q + 1, 0.0);
              for (int r = 0; r <= p; ++r) {
                across[r] = 0;
                for (int s = 0; s <= q; ++s) {
                  across[r] += C[r * (q + 1) + s] * Ni[s];
                  along[s] += C[r * (q + 1) + s] * No[r];
                }
                residual += across[r] * No[r];
              }
              if (move_outer) Apply(Do, across, D);
              if (move_inner) Apply(Di, along, D + active_outer);
              sum.Add(w, residual, D, b.data(), e);
            }
          }
          sums[c] = std::move(sum);
        }
      });

  const int free = knots.free();
  const std::vector<int> group_outer = (solved->u_outside ? knots.u : *knots.v).GroupOfKnots();
  const std::vector<int> group_inner =
      inner ? (solved->u_outside ? *knots.v : knots.u).GroupOfKnots() : std::vector<int>();
  ProjectedSquares result;
  result.cost = solved->cost;
  result.squares = solved->squares;
  result.normal = Eigen::MatrixXd::Zero(free, free);
  result.gradient = Eigen::VectorXd::Zero(free);
  Eigen::MatrixXd mixed =
      Eigen::MatrixXd::Zero(solved->coefficients.rows(), Eigen::Index{free} * d);
  std::vector<int> columns(static_cast<size_t>(active));
  for (size_t c = 0; c < cells.size(); ++c) {
    const CellOrder::Cell& cell = cells[c];
    if (move_outer) ColumnsOnSpan(group_outer, p, cell.outer_span, first_outer, columns.data());
    if (move_inner)
      ColumnsOnSpan(group_inner, q, cell.inner_span, first_inner, columns.data() + active_outer);
    for (int j = 0; j < active; ++j) {
      if (columns[j] < 0) continue;
      result.gradient[columns[j]] += sums[c].gradient[j];
      for (int l = 0; l < active; ++l) {
        if (columns[l] >= 0) result.normal(columns[j], columns[l]) += sums[c].products(j, l);
      }
      for (int e = 0; e < d; ++e) {
        for (int r = 0; r <= p; ++r) {
          mixed.col(e * free + columns[j]).segment(solved->Row(cell, r), q + 1) +=
              sums[c].mixed.col(e * active + j).segment(r * (q + 1), q + 1);
        }
      }
    }
  }
  Eigen::MatrixXd X = mixed;
  solved->factor.Solve(X);
  for (int e = 0; e < d; ++e) {
    result.normal.noalias() -=
        mixed.middleCols(e * free, free).transpose() * X.middleCols(e * free, free);
  }
  if (!result.normal.allFinite() || !result.gradient.allFinite()) {
    result.normal.setZero();  // overflow: no direction is known
    result.gradient.setZero();
  }
  return result;
}

std::optional<VariableProjection::SpanErrors> VariableProjection::Errors(const MovingKnots& knots,
                                                                         ThreadPool& pool) const {
  const auto solved = Solve(knots, pool);
  if (!solved) return std::nullopt;
  const auto& cells = solved->order.cells();
  std::vector<Eigen::Vector3d> sums(cells.size(), Eigen::Vector3d::Zero());  // r², r² u, r² v
  solved->ForResiduals(
      values_, pool, [&](std::ptrdiff_t c, Eigen::Index k, const Eigen::VectorXd& residual) {
        const double square = (weights_.size() > 0 ? weights_[k] : 1.0) * residual.squaredNorm();
        sums[c] += square * Eigen::Vector3d(1, u_[k], v_[k]);
      });
  const auto gather = [&](const SplineBasis& basis, bool outer, int component) {
    std::vector<Eigen::Vector2d> of_span(static_cast<size_t>(basis.size()),
                                         Eigen::Vector2d::Zero());
    for (size_t c = 0; c < cells.size(); ++c) {
      of_span[outer ? cells[c].outer_span : cells[c].inner_span] +=
          Eigen::Vector2d(sums[c][0], sums[c][component]);
    }
    std::vector<SpanError> errors;
    for (const int span : basis.Spans()) {
      const double a = basis.knots()[span], b = basis.knots()[span + 1];
      const double squares = of_span[span][0];
      const double centroid = squares > 0 ? of_span[span][1] / squares : (a + b) / 2;
      errors.push_back({a, b, squares, std::clamp(centroid, a, b)});
    }
    return errors;
  };
  SpanErrors errors;
  errors.u = gather(knots.u.basis(), solved->u_outside, 1);
  if (knots.v) errors.v = gather(knots.v->basis(), !solved->u_outside, 2);
  return errors;
}

}  // namespace batten::internal
