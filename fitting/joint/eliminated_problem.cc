// SPDX-License-Identifier: MIT
#include "fitting/joint/eliminated_problem.h"

#include <algorithm>
#include <cmath>

#include "fitting/least_squares/fairness.h"
#include "fitting/least_squares/normal_equations.h"
#include "fitting/linear/coefficient_order.h"
#include "geometry/numeric/reject.h"

namespace batten::internal {
namespace {

constexpr double kFarthestWeight = 1;          // a step's change of a log weight at most
constexpr double kPriorInNoise = 75;           // on squared log weights, in variances of the noise
constexpr double kRegularizationOfGaps = 100;  // of fairness, in cells without points
constexpr double kFading = 1.5;                // power of the misfit that fairness fades with
constexpr double kWildestWeight = 25;          // a log weight at most, against the mean

}  // namespace

EliminatedProblem::EliminatedProblem(const FittingProblem& problem,
                                     const Eigen::MatrixXd& control_points,
                                     const Eigen::VectorXd& weights,
                                     const JointOptions& options,
                                     ThreadPool& pool)
    : options_(options),
      pool_(pool),
      data_(problem.shared_data()),
      projector_(data_->values, options.orthogonal, pool, options.held),
      shape_{problem.basis_u(),
             problem.is_curve() ? std::nullopt : std::make_optional(problem.basis_v()),
             control_points,
             weights.size() > 0 ? weights : Eigen::VectorXd::Ones(control_points.cols()).eval()},
      accepted_(shape_),
      functions_(shape_.functions()),
      energy_(problem.energy()),
      accepted_foot_points_(data_->parameters),
      residual_noise_(data_->parameters) {
  const Eigen::Index dimension = data_->values.rows();
  if (dimension != control_points.rows())
    Reject("Optimize", "data and control points differ in dimension");
  if (dimension != 3 && !(problem.is_curve() && dimension == 2)) {
    Reject("Optimize", "points must be of three coordinates, or two for a curve");
  }
  if (control_points.cols() != problem.net_size() || shape_.weights.size() != problem.net_size()) {
    Reject("Optimize", "control points or weights are not as many as the bases say");
  }
  if (!control_points.allFinite() || !shape_.weights.allFinite() ||
      !(shape_.weights.minCoeff() > 0)) {
    Reject("Optimize", "control points must be finite and weights positive");
  }
  const auto add_direction = [&](const SplineBasis& basis, bool free) {
    KnotGaps gaps(basis);
    const bool is_free = free && gaps.groups() > 0;
    if (is_free && basis.periodic())
      Reject("Optimize", "knots of a periodic direction cannot be free");
    directions_.push_back(
        {is_free, gaps, gaps.Variables(), gaps.GroupOfKnots(), gaps.Derivatives()});
  };
  add_direction(shape_.basis_u, options.free_knots_u);
  if (shape_.basis_v) add_direction(*shape_.basis_v, options.free_knots_v);
  rational_ = !(shape_.weights.array() == shape_.weights[0]).all();
  MakeBlocks();
  double trace = 0;
  std::vector<double> R(static_cast<size_t>(functions_));
  for (Eigen::Index k = 0; k < accepted_foot_points_.cols(); ++k) {
    const double u = accepted_foot_points_(0, k), v = accepted_foot_points_(1, k);
    shape_.Rational(
        shape_.basis_u.Span(u), shape_.basis_v ? shape_.basis_v->Span(v) : 0, u, v, R.data());
    const double weight = data_->weights.size() > 0 ? data_->weights[k] : 1.0;
    for (const double value : R) trace += weight * value * value;
  }
  fairness_unit_ =
      options.fairness * trace /
      FairnessForm(shape_.basis_u, shape_.basis_v ? &*shape_.basis_v : nullptr, energy_).Trace();
  MakeCells();
  MakeFairness();
}

void EliminatedProblem::MakeBlocks() {
  const int size_v = shape_.size_v();
  const int distinct_v = shape_.basis_v ? DistinctCount(*shape_.basis_v) : 1;
  const int distinct_u = DistinctCount(shape_.basis_u);
  const auto wide_enough = [](const SplineBasis& basis) {
    return !basis.periodic() || DistinctCount(basis) > basis.degree();
  };
  if (!wide_enough(shape_.basis_u) || (shape_.basis_v && !wide_enough(*shape_.basis_v))) {
    Reject("Optimize", "a periodic direction needs more different control points than its degree");
  }
  net_.resize(dimension(), Eigen::Index{distinct_u} * distinct_v);
  log_weights_.resize(net_.cols());
  for (int i = 0; i < shape_.basis_u.size(); ++i) {
    for (int j = 0; j < size_v; ++j) {
      const int block = DistinctIndex(shape_.basis_u, i) * distinct_v +
                        (shape_.basis_v ? DistinctIndex(*shape_.basis_v, j) : 0);
      block_of_.push_back(block);
      net_.col(block) = shape_.net.col(Eigen::Index{i} * size_v + j);
      log_weights_[block] = std::log(shape_.weights[Eigen::Index{i} * size_v + j]);
    }
  }
  if (options_.free_weights) log_weights_.array() -= log_weights_.mean();
  accepted_log_weights_ = log_weights_;
}

void EliminatedProblem::MakeCells() {
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

std::vector<int> EliminatedProblem::BlocksOf(int cell) const {
  std::vector<int> indices;
  for (int k = 0; k < functions_; ++k) {
    indices.push_back(BlockOf(shape_.ControlPoint(cells_[cell].span_u, cells_[cell].span_v, k)));
  }
  return indices;
}

Eigen::MatrixXd EliminatedProblem::KnotChain(int direction) const {
  const Direction& knots = directions_[static_cast<size_t>(direction)];
  Eigen::MatrixXd chain =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(knots.group_of.size()), knots.chain.cols());
  for (size_t k = 0; k < knots.group_of.size(); ++k) {
    if (knots.group_of[k] >= 0)
      chain.row(static_cast<Eigen::Index>(k)) = knots.chain.row(knots.group_of[k]);
  }
  return chain;
}

int EliminatedProblem::local_knots() const {
  int count = directions_[0].free ? 2 * shape_.basis_u.degree() : 0;
  if (shape_.basis_v && directions_[1].free) count += 2 * shape_.degree_v();
  return count;
}

int EliminatedProblem::local_columns() const {
  return functions_ * (dimension() + (options_.free_weights ? 1 : 0)) + local_knots();
}

int EliminatedProblem::columns() const {
  int count = functions_ * (dimension() + (options_.free_weights ? 1 : 0));
  for (const Direction& direction : directions_) {
    if (direction.free) count += direction.gaps.groups() + 1;
  }
  return count;
}

// Computes the shape from the unknowns; false where they give none.
bool EliminatedProblem::UpdateShape() {
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
bool EliminatedProblem::NearAccepted() const {
  if ((log_weights_ - accepted_log_weights_).cwiseAbs().maxCoeff() > kFarthestWeight) return false;
  for (size_t d = 0; d < directions_.size(); ++d) {
    const Direction& direction = directions_[d];
    if (!direction.free) continue;
    const KnotGaps now(d == 0 ? shape_.basis_u : *shape_.basis_v);
    if (now.groups() != direction.gaps.groups()) return false;
    if ((now.Variables() - direction.gaps.Variables()).cwiseAbs().maxCoeff() > kFarthestLogGap)
      return false;
  }
  return true;
}

bool EliminatedProblem::Project() {
  if (!UpdateShape() || !NearAccepted()) return false;
  new_facing_ = FacingOf(shape_, pool_);
  if (facing_ && !new_facing_.Keeps(*facing_)) return false;
  return ProjectPoints();
}

bool EliminatedProblem::Return() {
  if (!UpdateShape()) return false;
  new_facing_ = FacingOf(shape_, pool_);
  return ProjectPoints();
}

bool EliminatedProblem::ProjectPoints() {
  projector_.Project(shape_, accepted_foot_points_, foot_points_);
  if (!foot_points_.difference.allFinite()) return false;
  const CellOrder sorted(shape_.basis_u,
                         shape_.basis_v ? &*shape_.basis_v : nullptr,
                         foot_points_.parameters.row(0),
                         foot_points_.parameters.row(1));
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

void EliminatedProblem::AcceptState() {
  accepted_ = shape_;
  accepted_foot_points_ = foot_points_.parameters;
  accepted_log_weights_ = log_weights_;
  facing_ = new_facing_;
  facing_->Watch(shape_, foot_points_.parameters);
  used_damping_ = damping;
  if (start_squares_ < 0) start_squares_ = SquaredDistances();
  // Fairness where the data determine the shape fades as the misfit does, so that exact data are
  // met exactly.
  const double regularized =
      start_squares_ > 0 ? std::pow(std::min(1.0, SquaredDistances() / start_squares_), kFading)
                         : 0.0;
  for (Cell& cell : cells_) {
    const Eigen::Index points = cell.end - cell.begin;
    cell.regularized = points == 0           ? kRegularizationOfGaps
                       : points > functions_ ? regularized
                                             : 1.0;
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
  if (only_points()) {
    SumPoints();
    return;
  }
  pool_.For(cells(), 4, [&](std::ptrdiff_t first, std::ptrdiff_t last) {
    for (std::ptrdiff_t c = first; c < last; ++c) cells_[c].proximal = ProximalForm(cells_[c]);
  });
}

void EliminatedProblem::Accept() {
  AcceptState();
  Linearise();
}

double EliminatedProblem::Weight(Eigen::Index k) const {
  return (data_->weights.size() > 0 ? data_->weights[k] : 1.0) *
         LossWeight(options_.loss, Distance(k), options_.loss_scale);
}

double EliminatedProblem::RobustSquares() const {
  double sum = 0;
  for (Eigen::Index k = 0; k < foot_points_.difference.cols(); ++k) {
    sum += 2 * (data_->weights.size() > 0 ? data_->weights[k] : 1.0) *
           LossValue(options_.loss, Distance(k), options_.loss_scale);
  }
  return sum;
}

EliminatedProblem::Explained EliminatedProblem::NoiseShare() const {
  Eigen::VectorXd weights(foot_points_.difference.cols());
  for (Eigen::Index k = 0; k < weights.size(); ++k) weights[k] = Weight(k);
  double variance = residual_noise_.Variance(foot_points_.difference, weights);
  if (options_.noise > 0) variance = std::min(variance, options_.noise * options_.noise);
  const double counted = static_cast<double>((weights.array() > 0).count());
  const double squares = foot_points_.difference.colwise().squaredNorm().dot(weights);
  return {squares, variance * std::max(0.0, counted - static_cast<double>(blocks()))};
}

// A prior that holds no exact shape back, since it fades with the misfit, and keeps weights from
// following noise: 75 of its variances where it is all there is.
double EliminatedProblem::FreePrior() const {
  if (!options_.free_weights) return 0;
  const double mean = SquaredDistances() / static_cast<double>(foot_points_.difference.cols());
  const double noise = residual_noise_.Variance(foot_points_.difference, data_->weights);
  const double share = mean > 0 ? std::min(1.0, noise / mean) : 0.0;
  return mean * (1 + kPriorInNoise * std::pow(share, 4));
}

double EliminatedProblem::Prior(int block) const {
  return options_.free_weights ? prior_ / cells_of_block_[block] : 0.0;
}

}  // namespace batten::internal
