// SPDX-License-Identifier: MIT
#include "batten/fitting/joint_cells.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "batten/fitting/fairness.h"
#include "batten/fitting/normal_equations.h"
#include "batten/geometry/knot_derivatives.h"

namespace batten {
namespace {

constexpr int kBatch = 48;               // rows of a cell that are multiplied at once
constexpr double kFarthestWeight = 1;    // a step's change of a log weight at most
constexpr double kFarthestGap = 2;       // and of a log gap
constexpr double kPriorInNoise = 75;     // on squared log weights, in variances of the noise
constexpr double kCalmWhereEmpty = 100;  // of fairness, in cells without points
constexpr double kFading = 1.5;          // power of the misfit that fairness fades with
constexpr double kWildestWeight = 25;    // a log weight at most, against the mean

[[noreturn]] void Reject(const std::string& rule) {
  throw std::invalid_argument("Optimize: " + rule);
}

// The thin-plate (or membrane) form of one cell, in the functions that live on it.
Eigen::MatrixXd CellFairness(const SplineBasis& bu, int span_u, const SplineBasis* bv, int span_v) {
  const int p = bu.degree(), q = bv ? bv->degree() : 0, f = (p + 1) * (q + 1);
  struct Term {
    int order_u, order_v;
    double factor;
  };
  std::vector<Term> terms;
  if (!bv) {
    terms = {{std::min(2, p), 0, 1.0}};
  } else if (std::min(p, q) >= 2) {
    terms = {{2, 0, 1.0}, {1, 1, 2.0}, {0, 2, 1.0}};
  } else {
    terms = {{1, 0, 1.0}, {0, 1, 1.0}};
  }
  const Quadrature gu(p + 1), gv(q + 1);
  const double a = bu.knots()[span_u], b = bu.knots()[span_u + 1];
  const double c = bv ? bv->knots()[span_v] : 0, d = bv ? bv->knots()[span_v + 1] : 1;
  Eigen::MatrixXd form = Eigen::MatrixXd::Zero(f, f);
  std::vector<double> Nu(3 * (p + 1)), Nv(3 * (q + 1), 0.0);
  Nv[0] = 1;
  Eigen::VectorXd row(f);
  for (int i = 0; i <= p; ++i) {
    bu.Derivatives(span_u, (a + b) / 2 + (b - a) / 2 * gu.nodes[i], 2, Nu.data());
    for (int j = 0; j <= q; ++j) {
      if (bv) bv->Derivatives(span_v, (c + d) / 2 + (d - c) / 2 * gv.nodes[j], 2, Nv.data());
      const double weight = gu.weights[i] * (b - a) / 2 * (bv ? gv.weights[j] * (d - c) / 2 : 1.0);
      for (const Term& term : terms) {
        for (int r = 0; r <= p; ++r) {
          for (int s = 0; s <= q; ++s) {
            row[r * (q + 1) + s] = Nu[term.order_u * (p + 1) + r] * Nv[term.order_v * (q + 1) + s];
          }
        }
        form.selfadjointView<Eigen::Lower>().rankUpdate(row, weight * term.factor);
      }
    }
  }
  return form.selfadjointView<Eigen::Lower>();
}

// Index of a row of control points among those that are no copies.
int WithoutCopies(const SplineBasis& basis, int i) {
  return basis.periodic() ? i % (basis.size() - basis.degree()) : i;
}

int Distinct(const SplineBasis& basis) {
  return basis.periodic() ? basis.size() - basis.degree() : basis.size();
}

}  // namespace

// What the rows of one point are made of.
struct JointCells::Workspace {
  int span_u = 0, span_v = 0;
  Eigen::VectorXd R;       // rational functions
  Eigen::MatrixXd corner;  // the cell's control points
  Eigen::MatrixXd toward;  // control points less the point of the shape
  Eigen::MatrixXd knots;   // dimension × local knots: how the point moves with them
};

JointCells::JointCells(const FittingProblem& problem,
                       const Eigen::MatrixXd& control_points,
                       const Eigen::VectorXd& weights,
                       const JointOptions& options,
                       ThreadPool& pool)
    : options_(options),
      pool_(pool),
      data_(problem.shared_data()),
      projector_(data_->values, options.orthogonal, pool),
      shape_{problem.basis_u(),
             problem.is_curve() ? std::nullopt : std::make_optional(problem.basis_v()),
             control_points,
             weights.size() > 0 ? weights : Eigen::VectorXd::Ones(control_points.cols()).eval()},
      accepted_(shape_),
      functions_(shape_.functions()),
      accepted_feet_(data_->parameters),
      residual_noise_(data_->parameters) {
  const Eigen::Index dimension = data_->values.rows();
  if (dimension != control_points.rows()) Reject("data and control points differ in dimension");
  if (dimension != 3 && !(problem.is_curve() && dimension == 2)) {
    Reject("points must be of three coordinates, or two for a curve");
  }
  if (control_points.cols() != problem.unknowns() || shape_.weights.size() != problem.unknowns()) {
    Reject("control points or weights are not as many as the bases say");
  }
  if (!control_points.allFinite() || !shape_.weights.allFinite() ||
      !(shape_.weights.minCoeff() > 0)) {
    Reject("control points must be finite and weights positive");
  }
  const auto add_direction = [&](const SplineBasis& basis, bool free) {
    KnotGaps gaps(basis);
    const bool is_free = free && gaps.groups() > 0;
    if (is_free && basis.periodic()) Reject("knots of a periodic direction cannot be free");
    directions_.push_back(
        {is_free, gaps, gaps.Variables(), gaps.GroupOfKnots(), gaps.Derivatives()});
  };
  add_direction(shape_.basis_u, options.free_knots_u);
  if (shape_.basis_v) add_direction(*shape_.basis_v, options.free_knots_v);
  MakeBlocks();
  double trace = 0;
  std::vector<double> R(static_cast<size_t>(functions_));
  for (Eigen::Index k = 0; k < accepted_feet_.cols(); ++k) {
    const double u = accepted_feet_(0, k), v = accepted_feet_(1, k);
    shape_.Rational(
        shape_.basis_u.Span(u), shape_.basis_v ? shape_.basis_v->Span(v) : 0, u, v, R.data());
    const double weight = data_->weights.size() > 0 ? data_->weights[k] : 1.0;
    for (const double value : R) trace += weight * value * value;
  }
  fairness_unit_ =
      options.fairness * trace /
      FairnessForm(shape_.basis_u, shape_.basis_v ? &*shape_.basis_v : nullptr).Trace();
  MakeCells();
  MakeFairness();
}

void JointCells::MakeBlocks() {
  const int size_v = shape_.size_v();
  const int distinct_v = shape_.basis_v ? Distinct(*shape_.basis_v) : 1;
  const int distinct_u = Distinct(shape_.basis_u);
  const auto wide_enough = [](const SplineBasis& basis) {
    return !basis.periodic() || Distinct(basis) > basis.degree();
  };
  if (!wide_enough(shape_.basis_u) || (shape_.basis_v && !wide_enough(*shape_.basis_v))) {
    Reject("a periodic direction needs more different control points than its degree");
  }
  net_.resize(dimension(), Eigen::Index{distinct_u} * distinct_v);
  log_weights_.resize(net_.cols());
  for (int i = 0; i < shape_.basis_u.size(); ++i) {
    for (int j = 0; j < size_v; ++j) {
      const int block = WithoutCopies(shape_.basis_u, i) * distinct_v +
                        (shape_.basis_v ? WithoutCopies(*shape_.basis_v, j) : 0);
      block_of_.push_back(block);
      net_.col(block) = shape_.net.col(Eigen::Index{i} * size_v + j);
      log_weights_[block] = std::log(shape_.weights[Eigen::Index{i} * size_v + j]);
    }
  }
  if (options_.free_weights) log_weights_.array() -= log_weights_.mean();
  accepted_log_weights_ = log_weights_;
}

void JointCells::MakeCells() {
  cells_of_block_ = Eigen::VectorXd::Zero(blocks());
  const std::vector<int> spans_v = shape_.basis_v ? shape_.basis_v->Spans() : std::vector<int>{0};
  for (const int i : shape_.basis_u.Spans()) {
    for (const int j : spans_v) {
      cells_.push_back({i, j, {}, {}});
      for (const int block : BlocksOf(static_cast<int>(cells_.size()) - 1))
        cells_of_block_[block] += 1;
    }
  }
}

void JointCells::MakeFairness() {
  const SplineBasis* bv = shape_.basis_v ? &*shape_.basis_v : nullptr;
  for (Cell& cell : cells_) {
    cell.fairness =
        fairness_unit_ > 0
            ? Eigen::MatrixXd(fairness_unit_ *
                              CellFairness(shape_.basis_u, cell.span_u, bv, cell.span_v))
            : Eigen::MatrixXd();
  }
}

std::vector<int> JointCells::BlocksOf(int cell) const {
  std::vector<int> indices;
  for (int k = 0; k < functions_; ++k) {
    indices.push_back(BlockOf(shape_.ControlPoint(cells_[cell].span_u, cells_[cell].span_v, k)));
  }
  return indices;
}

Eigen::MatrixXd JointCells::KnotChain(int direction) const {
  const Direction& knots = directions_[static_cast<size_t>(direction)];
  Eigen::MatrixXd chain =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(knots.group_of.size()), knots.chain.cols());
  for (size_t k = 0; k < knots.group_of.size(); ++k) {
    if (knots.group_of[k] >= 0)
      chain.row(static_cast<Eigen::Index>(k)) = knots.chain.row(knots.group_of[k]);
  }
  return chain;
}

int JointCells::local_knots() const {
  int count = directions_[0].free ? 2 * shape_.basis_u.degree() : 0;
  if (shape_.basis_v && directions_[1].free) count += 2 * shape_.degree_v();
  return count;
}

int JointCells::local_columns() const {
  return functions_ * (dimension() + (options_.free_weights ? 1 : 0)) + local_knots();
}

int JointCells::columns() const {
  int count = functions_ * (dimension() + (options_.free_weights ? 1 : 0));
  for (const Direction& direction : directions_) {
    if (direction.free) count += direction.gaps.groups() + 1;
  }
  return count;
}

// From the unknowns to the shape; false where they don't make one.
bool JointCells::UpdateShape() {
  if (!net_.allFinite() || !log_weights_.allFinite()) return false;
  if (log_weights_.cwiseAbs().maxCoeff() > kWildestWeight) return false;
  for (size_t k = 0; k < block_of_.size(); ++k) {
    shape_.net.col(static_cast<Eigen::Index>(k)) = net_.col(block_of_[k]);
    if (options_.free_weights)
      shape_.weights[static_cast<Eigen::Index>(k)] = std::exp(log_weights_[block_of_[k]]);
  }
  for (size_t d = 0; d < directions_.size(); ++d) {
    Direction& direction = directions_[d];
    if (!direction.free) continue;
    const auto gaps = direction.gaps.At(direction.log_gaps);
    if (!gaps) return false;
    (d == 0 ? shape_.basis_u : *shape_.basis_v) = gaps->basis();
  }
  return true;
}

// Whether weights and knots have moved so little that the accepted derivatives mean something.
bool JointCells::NearAccepted() const {
  if ((log_weights_ - accepted_log_weights_).cwiseAbs().maxCoeff() > kFarthestWeight) return false;
  for (size_t d = 0; d < directions_.size(); ++d) {
    const Direction& direction = directions_[d];
    if (!direction.free) continue;
    const KnotGaps now(d == 0 ? shape_.basis_u : *shape_.basis_v);
    if (now.groups() != direction.gaps.groups()) return false;
    if ((now.Variables() - direction.gaps.Variables()).cwiseAbs().maxCoeff() > kFarthestGap)
      return false;
  }
  return true;
}

bool JointCells::Project() {
  if (!UpdateShape() || !NearAccepted()) return false;
  new_facing_ = FacingOf(shape_, pool_);
  if (facing_ && !new_facing_.Keeps(*facing_)) return false;
  return ProjectPoints();
}

bool JointCells::Return() {
  if (!UpdateShape()) return false;
  new_facing_ = FacingOf(shape_, pool_);
  return ProjectPoints();
}

bool JointCells::ProjectPoints() {
  projector_.Project(shape_, accepted_feet_, feet_);
  if (!feet_.difference.allFinite()) return false;
  const CellOrder sorted(shape_.basis_u,
                         shape_.basis_v ? &*shape_.basis_v : nullptr,
                         feet_.parameters.row(0),
                         feet_.parameters.row(1));
  order_ = sorted.points();
  for (Cell& cell : cells_) cell.begin = cell.end = 0;
  size_t at = 0;
  for (const CellOrder::Cell& filled : sorted.cells()) {
    while (cells_[at].span_u != filled.outer_span || cells_[at].span_v != filled.inner_span) ++at;
    cells_[at].begin = filled.begin;
    cells_[at].end = filled.end;
  }
  return true;
}

void JointCells::Accept() {
  accepted_ = shape_;
  accepted_feet_ = feet_.parameters;
  accepted_log_weights_ = log_weights_;
  facing_ = new_facing_;
  facing_->Watch(shape_, feet_.parameters);
  used_damping_ = damping;
  if (start_squares_ < 0) start_squares_ = SquaredDistances();
  // Fairness where the data determine the shape fades as the misfit does, so that exact data are
  // met exactly.
  const double calm = start_squares_ > 0
                          ? std::pow(std::min(1.0, SquaredDistances() / start_squares_), kFading)
                          : 0.0;
  for (Cell& cell : cells_) {
    const Eigen::Index points = cell.end - cell.begin;
    cell.calm = points == 0 ? kCalmWhereEmpty : points > functions_ ? calm : 1.0;
  }
  bool knots_moved = false;
  for (size_t d = 0; d < directions_.size(); ++d) {
    Direction& direction = directions_[d];
    if (!direction.free) continue;
    direction.gaps = *direction.gaps.At(direction.log_gaps);
    direction.chain = direction.gaps.Derivatives();
    knots_moved = true;
  }
  if (knots_moved) MakeFairness();
  prior_ = std::max(options_.weight_prior, FreePrior());
  pool_.For(cells(), 4, [&](std::ptrdiff_t first, std::ptrdiff_t last) {
    for (std::ptrdiff_t c = first; c < last; ++c) cells_[c].proximal = ProximalForm(cells_[c]);
  });
  Linearise();
}

double JointCells::Weight(Eigen::Index k) const {
  return (data_->weights.size() > 0 ? data_->weights[k] : 1.0) *
         LossWeight(options_.loss, Distance(k), options_.loss_scale);
}

JointCells::Explained JointCells::NoiseShare() const {
  Eigen::VectorXd weights(feet_.difference.cols());
  for (Eigen::Index k = 0; k < weights.size(); ++k) weights[k] = Weight(k);
  double variance = residual_noise_.Variance(feet_.difference, weights);
  if (options_.noise > 0) variance = std::min(variance, options_.noise * options_.noise);
  const double counted = static_cast<double>((weights.array() > 0).count());
  const double squares = feet_.difference.colwise().squaredNorm().dot(weights);
  return {squares, variance * std::max(0.0, counted - static_cast<double>(blocks()))};
}

// A prior that holds no exact shape back, since it fades with the misfit, and keeps weights from
// following noise: 75 of its variances where it is all there is.
double JointCells::FreePrior() const {
  if (!options_.free_weights) return 0;
  const double mean = SquaredDistances() / static_cast<double>(feet_.difference.cols());
  const double noise = residual_noise_.Variance(feet_.difference, data_->weights);
  const double share = mean > 0 ? std::min(1.0, noise / mean) : 0.0;
  return mean * (1 + kPriorInNoise * std::pow(share, 4));
}

double JointCells::Prior(int block) const {
  return options_.free_weights ? prior_ / cells_of_block_[block] : 0.0;
}

void JointCells::Prepare(const Cell& cell, Eigen::Index k, Workspace& work) const {
  const double u = feet_.parameters(0, k), v = feet_.parameters(1, k);
  shape_.Rational(cell.span_u, cell.span_v, u, v, work.R.data());
  if (only_points()) return;
  const Eigen::VectorXd point = data_->values.col(k) + feet_.difference.col(k);
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
void JointCells::FillRow(const Workspace& work,
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

// [J r]ᵀ[J r] of the cell's points, fairness, prior and proximal term; its last entry is twice the
// cost.
Eigen::MatrixXd JointCells::CellForm(const Cell& cell) const {
  const int dim = dimension(), f = functions_, n = local_columns();
  Eigen::MatrixXd form = Eigen::MatrixXd::Zero(n + 1, n + 1);
  Eigen::MatrixXd rows(n + 1, kBatch);
  int filled = 0;
  const auto flush = [&] {
    if (filled > 0) form.selfadjointView<Eigen::Lower>().rankUpdate(rows.leftCols(filled));
    filled = 0;
  };
  Workspace work{cell.span_u,
                 cell.span_v,
                 Eigen::VectorXd(f),
                 Eigen::MatrixXd(dim, f),
                 Eigen::MatrixXd(dim, f),
                 Eigen::MatrixXd::Zero(dim, local_knots())};
  for (int a = 0; a < f; ++a)
    work.corner.col(a) = shape_.net.col(shape_.ControlPoint(cell.span_u, cell.span_v, a));
  double cost = 0;
  Eigen::VectorXd direction(dim);
  for (Eigen::Index i = cell.begin; i < cell.end; ++i) {
    const Eigen::Index k = order_[i];
    const double weight = Weight(k);
    const double plain = data_->weights.size() > 0 ? data_->weights[k] : 1.0;
    cost += 2 * plain * LossValue(options_.loss, Distance(k), options_.loss_scale);
    if (weight == 0) continue;
    Prepare(cell, k, work);
    const double root = std::sqrt(weight);
    const int kept = feet_.directions[k];
    for (int d = 0; d < (kept == 0 ? dim : kept); ++d) {
      if (kept == 0) {
        direction = Eigen::VectorXd::Unit(dim, d);
      } else {
        direction = d == 0 ? feet_.first.col(k) : feet_.second.col(k);
      }
      double* row = rows.col(filled).data();
      FillRow(work, direction, root, row);
      row[n] = root * direction.dot(feet_.difference.col(k));
      if (++filled == kBatch) flush();
    }
  }
  flush();
  if (cell.fairness.size() > 0) {
    const double calm = cell.calm;
    const Eigen::MatrixXd pull = calm * work.corner * cell.fairness;
    for (int a = 0; a < f; ++a) {
      for (int b = 0; b <= a; ++b) {
        for (int d = 0; d < dim; ++d) form(dim * a + d, dim * b + d) += calm * cell.fairness(a, b);
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
// form. Of control points alone every coordinate has the same.
Eigen::MatrixXd JointCells::ProximalForm(const Cell& cell) const {
  const int dim = dimension(), f = functions_, n = only_points() ? f : local_columns();
  Eigen::MatrixXd form = Eigen::MatrixXd::Zero(n, n);
  Eigen::MatrixXd rows(n, kBatch);
  int filled = 0;
  const auto flush = [&] {
    if (filled > 0) form.selfadjointView<Eigen::Lower>().rankUpdate(rows.leftCols(filled));
    filled = 0;
  };
  Workspace work{cell.span_u,
                 cell.span_v,
                 Eigen::VectorXd(f),
                 Eigen::MatrixXd(dim, f),
                 Eigen::MatrixXd(dim, f),
                 Eigen::MatrixXd::Zero(dim, local_knots())};
  for (int a = 0; a < f; ++a)
    work.corner.col(a) = shape_.net.col(shape_.ControlPoint(cell.span_u, cell.span_v, a));
  for (Eigen::Index i = cell.begin; i < cell.end; ++i) {
    const Eigen::Index k = order_[i];
    Prepare(cell, k, work);
    const double root = std::sqrt(Weight(k));
    for (int d = 0; d < (only_points() ? 1 : dim); ++d) {
      if (only_points()) {
        rows.col(filled) = root * work.R;
      } else {
        FillRow(work, Eigen::VectorXd::Unit(dim, d), root, rows.col(filled).data());
      }
      if (++filled == kBatch) flush();
    }
  }
  flush();
  return form.selfadjointView<Eigen::Lower>();
}

// Local unknowns less the accepted ones, control points one coordinate a row if they are alone.
Eigen::VectorXd JointCells::Displacement(const Cell& cell) const {
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

// Twice what the cell adds to the cost.
double JointCells::CellCost(const Cell& cell) const {
  const int dim = dimension(), f = functions_;
  double cost = 0;
  for (Eigen::Index i = cell.begin; i < cell.end; ++i) {
    const Eigen::Index k = order_[i];
    cost += 2 * (data_->weights.size() > 0 ? data_->weights[k] : 1.0) *
            LossValue(options_.loss, Distance(k), options_.loss_scale);
  }
  if (cell.fairness.size() > 0) {
    Eigen::MatrixXd corner(dim, f);
    for (int a = 0; a < f; ++a)
      corner.col(a) = shape_.net.col(shape_.ControlPoint(cell.span_u, cell.span_v, a));
    cost += cell.calm * (corner * cell.fairness).cwiseProduct(corner).sum();
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
    cost += used_damping_ * (corner * cell.proximal).cwiseProduct(corner).sum();
  } else {
    cost += used_damping_ * moved.dot(cell.proximal * moved);
  }
  return cost;
}

void JointCells::Linearise() {
  const size_t residuals = static_cast<size_t>(rows()), all = residuals * (columns() + 1);
  linear_.resize(all * cells_.size());
  pool_.For(cells(), 4, [&](std::ptrdiff_t first, std::ptrdiff_t last) {
    for (std::ptrdiff_t c = first; c < last; ++c) {
      double* begin = linear_.data() + all * static_cast<size_t>(c);
      Rows(cells_[static_cast<size_t>(c)], begin, begin + residuals);
    }
  });
}

void JointCells::Evaluate(int cell, double* residual, double* jacobian) const {
  const auto residuals = static_cast<size_t>(rows()), index = static_cast<size_t>(cell);
  if (jacobian == nullptr) {
    std::fill_n(residual, residuals, 0.0);
    residual[0] = std::sqrt(std::max(0.0, CellCost(cells_[index])));
    return;
  }
  const size_t all = residuals * (columns() + 1);
  const double* begin = linear_.data() + all * index;
  std::copy_n(begin, residuals, residual);
  std::copy_n(begin + residuals, all - residuals, jacobian);
}

void JointCells::Rows(const Cell& cell, double* residual, double* jacobian) const {
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

}  // namespace batten
