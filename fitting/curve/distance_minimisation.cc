// SPDX-License-Identifier: MIT
#include "fitting/curve/distance_minimisation.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "batten/geometry/curve_evaluator.h"
#include "fitting/foot_points/curve_pieces.h"
#include "fitting/least_squares/fairness.h"
#include "fitting/least_squares/normal_equations.h"
#include "fitting/linear/net_system.h"
#include "geometry/numeric/reject.h"

namespace batten::internal {
namespace {

void Check(const FittingProblem& problem,
           const Eigen::MatrixXd& net,
           const DistanceMinimisationOptions& options) {
  if (!problem.is_curve()) Reject("MinimiseDistance", "the problem is a surface's");
  const Eigen::Index dimension = problem.data().values.rows();
  if (dimension != 2 && dimension != 3) {
    Reject("MinimiseDistance",
           "the values have " + std::to_string(dimension) + " coordinates, not 2 or 3");
  }
  if (problem.size() == 0) Reject("MinimiseDistance", "there are no data");
  if (net.rows() != dimension || net.cols() != problem.basis_u().size()) {
    Reject("MinimiseDistance", "the net does not fit the basis and the values");
  }
  if (options.max_rounds < 0) Reject("MinimiseDistance", "max_rounds is negative");
  if (!(options.relative_gain >= 0)) Reject("MinimiseDistance", "relative_gain is negative");
  if (!(options.damping > 0 && options.damping <= 1))
    Reject("MinimiseDistance", "damping is not in (0, 1]");
}

// The curve at the local foot points of the data.
template <int Dim>
struct FootPointTerms {
  using Columns = Eigen::Matrix<double, Dim, Eigen::Dynamic>;

  Eigen::VectorXd parameters;
  Columns differences;  // C(u) − q
  Columns tangents;     // of length one, or zero where the curve stands still
  Eigen::VectorXd bend;  // (C − q)·C″ / |C′|²: distance over radius of curvature, negative for
                         // points on the side of its centre
  // At an end or a kink of the curve with a difference that is not perpendicular to the tangent.
  Eigen::Array<bool, Eigen::Dynamic, 1> held;
};

template <int Dim>
FootPointTerms<Dim> TermsAtFootPoints(const NurbsCurve<Dim>& curve,
                                      const Eigen::MatrixXd& points,
                                      const Eigen::VectorXd& start,
                                      ThreadPool& pool) {
  using Columns = typename FootPointTerms<Dim>::Columns;
  const Eigen::Index count = points.cols();
  FootPointTerms<Dim> feet{LocalFootPointsKernel<Dim>(curve, points, start, pool),
                           Columns(Dim, count),
                           Columns(Dim, count),
                           Eigen::VectorXd(count),
                           Eigen::Array<bool, Eigen::Dynamic, 1>(count)};
  typename CurveEvaluator<Dim>::PointColumns jets;
  CurveEvaluator<Dim>(curve).Derivatives(
      {feet.parameters.data(), static_cast<size_t>(count)}, 2, jets, pool);
  constexpr double kCosine = 1e-4;
  const SplineBasis& basis = curve.basis();
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto first = jets.col(3 * k + 1);
    const double speed = first.squaredNorm();
    feet.differences.col(k) = jets.col(3 * k) - points.col(k);
    feet.tangents.col(k).setZero();
    if (speed > 0) feet.tangents.col(k) = first / std::sqrt(speed);
    const auto difference = feet.differences.col(k);
    feet.bend[k] = speed > 0 ? difference.dot(jets.col(3 * k + 2)) / speed : 0;
    const double u = feet.parameters[k];
    const bool end = !basis.periodic() && (u <= basis.lower() || u >= basis.upper());
    feet.held[k] = std::abs(difference.dot(feet.tangents.col(k))) > kCosine * difference.norm() &&
                   (end || basis.Multiplicity(u) >= basis.degree());
  }
  return feet;
}

// Σ w Σ N², the trace of a problem's point-distance matrix.
double PointTrace(const SplineBasis& basis,
                  const Eigen::VectorXd& parameters,
                  const Eigen::VectorXd& weights) {
  double values[kMaxDegree + 1], trace = 0;
  for (Eigen::Index k = 0; k < parameters.size(); ++k) {
    basis.Values(basis.Span(parameters[k]), parameters[k], values);
    for (int r = 0; r <= basis.degree(); ++r) trace += weights[k] * values[r] * values[r];
  }
  return trace;
}

// One run; the members are the problem and what does not change.
template <int Dim>
class Minimiser {
 public:
  using Columns = Eigen::Matrix<double, Dim, Eigen::Dynamic>;
  using Vector = Eigen::Matrix<double, Dim, 1>;
  using Square = Eigen::Matrix<double, Dim, Dim>;

  Minimiser(const FittingProblem& problem,
            const DistanceMinimisationOptions& options,
            ThreadPool& pool)
      : options_(options),
        pool_(pool),
        basis_(problem.basis_u()),
        points_(problem.data().values),
        weights_(problem.data().weights.size() > 0 ? problem.data().weights
                                                   : Eigen::VectorXd::Ones(problem.size()).eval()),
        fairness_(DerivativeGram(basis_,
                                 EnergyTerms(problem.energy(), basis_.degree(), 0).front().outer)),
        parameters_(problem.data().parameters.row(0).transpose()) {
    const double trace = fairness_.col(0).sum();
    if (problem.smoothing() > 0 && trace > 0) {
      lambda_ = problem.smoothing() * PointTrace(basis_, parameters_, weights_) / trace;
    }
  }

  DistanceMinimum Run(const Eigen::MatrixXd& net) {
    State state = At(net, parameters_);
    DistanceMinimum result;
    result.rms.push_back(Rms(state));
    double damping = options_.model == DistanceModel::kPoint ? 1 : options_.damping, raise = 4;
    while (result.rounds < options_.max_rounds && !result.converged && state.sum > 0) {
      if (options_.progress &&
          !options_.progress("correct", static_cast<double>(result.rounds) / options_.max_rounds)) {
        break;
      }
      ++result.rounds;
      const NetSystem::Step step = StepFrom(state, damping);
      std::optional<State> next = Moved(state, step);
      if (!next || !(next->sum < state.sum)) {
        result.converged = damping >= 1;  // point distances find nothing either
        damping = std::min(1.0, damping * raise);
        raise *= 2;
        continue;
      }
      const double fall = state.sum - next->sum;
      result.converged = fall <= options_.relative_gain * state.sum;
      damping = Adapted(damping, fall / step.promise);
      raise = 4;
      state = std::move(*next);
      result.rms.push_back(Rms(state));
    }
    result.converged = result.converged || !(state.sum > 0);
    result.control_points = std::move(state.net);
    result.parameters = std::move(state.feet.parameters);
    return result;
  }

 private:
  struct State {
    Columns net;
    FootPointTerms<Dim> feet;
    double squares, sum;  // Σ w |r|², and with fairness
  };

  State At(Columns net, const Eigen::VectorXd& start) const {
    State state{std::move(net), {}, 0, 0};
    const NurbsCurve<Dim> curve(basis_, state.net);
    state.feet = TermsAtFootPoints<Dim>(curve, points_, start, pool_);
    state.squares = weights_.dot(state.feet.differences.colwise().squaredNorm());
    state.sum = state.squares + lambda_ * Energy(state.net);
    return state;
  }

  // None where the step leads nowhere finite.
  std::optional<State> Moved(const State& state, const NetSystem::Step& step) const {
    const Columns net = state.net + step.net;
    if (!(step.promise > 0) || !net.allFinite()) return std::nullopt;
    return At(net, state.feet.parameters);
  }

  double Rms(const State& state) const { return std::sqrt(state.squares / weights_.sum()); }

  // Less where the sum fell as the model promised, more where it fell by much less. [Nielsen 1999]
  double Adapted(double damping, double gain) const {
    constexpr double kLeast = 1e-6, kFastest = 0.2, kSlowest = 2;
    if (options_.model == DistanceModel::kPoint) return 1;
    const double factor = std::clamp(1 - std::pow(2 * gain - 1, 3), kFastest, kSlowest);
    return std::clamp(damping * factor, kLeast, 1.0);
  }

  // ∫ |C″|²
  double Energy(const Columns& net) const {
    double energy = 0;
    if (lambda_ > 0) energy = FairnessTimes(net).cwiseProduct(net).sum();
    return energy;
  }

  Columns FairnessTimes(const Columns& net) const {
    Columns product = Columns::Zero(Dim, net.cols());
    for (int i = 0; i < basis_.size(); ++i) {
      product.col(i) += fairness_(i, 0) * net.col(i);
      for (int a = 1; a <= basis_.degree() && i + a < basis_.size(); ++a) {
        product.col(i) += fairness_(i, a) * net.col(i + a);
        product.col(i + a) += fairness_(i, a) * net.col(i);
      }
    }
    return product;
  }

  double TangentWeight(const FootPointTerms<Dim>& feet, Eigen::Index k, double damping) const {
    if (feet.held[k]) return 1;
    double weight = 0;
    if (options_.model == DistanceModel::kSquared && feet.bend[k] > 0) {
      weight = feet.bend[k] / (1 + feet.bend[k]);
    }
    return std::max(weight, damping);
  }

  // The minimum of the quadratic model: H = Σ w N Nᵀ ⊗ W + λP, b = −Σ w N W r − λ P c.
  NetSystem::Step StepFrom(const State& state, double damping) const {
    const CellOrder order(basis_, nullptr, state.feet.parameters, parameters_);
    std::vector<CellSums> cells(order.cells().size());
    pool_.For(static_cast<std::ptrdiff_t>(cells.size()),
              1,
              [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
                for (std::ptrdiff_t c = begin; c < end; ++c) {
                  Gather(state.feet,
                         order,
                         order.cells()[static_cast<size_t>(c)],
                         damping,
                         cells[static_cast<size_t>(c)]);
                }
              });
    NetSystem system(basis_, Dim);
    const int p = basis_.degree();
    for (size_t c = 0; c < cells.size(); ++c) {
      const int first = order.cells()[c].outer_span - p;
      size_t pair = 0;
      for (int r = 0; r <= p; ++r) {
        system.AddRight(first + r, cells[c].right.col(r));
        for (int s = 0; s <= r; ++s) system.Add(first + r, first + s, cells[c].blocks[pair++]);
      }
    }
    if (lambda_ > 0) AddFairness(state, system);
    return system.Solve();
  }

  // The sums over the data of one knot span: blocks of the pairs r ≥ s of its functions.
  struct CellSums {
    std::vector<Square> blocks;
    Eigen::Matrix<double, Dim, Eigen::Dynamic> right;
  };

  void Gather(const FootPointTerms<Dim>& feet,
              const CellOrder& order,
              const CellOrder::Cell& cell,
              double damping,
              CellSums& sums) const {
    const int p = basis_.degree();
    double values[kMaxDegree + 1];
    sums.blocks.assign(static_cast<size_t>((p + 1) * (p + 2) / 2), Square::Zero());
    sums.right = Columns::Zero(Dim, p + 1);
    for (Eigen::Index at = cell.begin; at < cell.end; ++at) {
      const Eigen::Index k = order.points()[static_cast<size_t>(at)];
      if (weights_[k] == 0) continue;
      basis_.Values(cell.outer_span, feet.parameters[k], values);
      const Vector t = feet.tangents.col(k);
      const double free = 1 - TangentWeight(feet, k, damping);
      const Square metric = weights_[k] * (Square::Identity() - free * t * t.transpose());
      const Vector pull = metric * feet.differences.col(k);
      size_t pair = 0;
      for (int r = 0; r <= p; ++r) {
        sums.right.col(r) -= values[r] * pull;
        for (int s = 0; s <= r; ++s) sums.blocks[pair++] += (values[r] * values[s]) * metric;
      }
    }
  }

  void AddFairness(const State& state, NetSystem& system) const {
    const Columns pull = FairnessTimes(state.net);
    for (int i = 0; i < basis_.size(); ++i) {
      system.AddRight(i, -lambda_ * pull.col(i));
      for (int a = 0; a <= basis_.degree() && i + a < basis_.size(); ++a) {
        system.Add(i + a, i, lambda_ * fairness_(i, a) * Square::Identity());
      }
    }
  }

  const DistanceMinimisationOptions& options_;
  ThreadPool& pool_;
  const SplineBasis& basis_;
  const Eigen::MatrixXd& points_;
  const Eigen::VectorXd weights_;
  const Eigen::MatrixXd fairness_;  // row i, column a: that of the functions i and i + a
  const Eigen::VectorXd parameters_;
  double lambda_ = 0;
};

}  // namespace

DistanceMinimum MinimiseDistance(const FittingProblem& problem,
                                 const Eigen::MatrixXd& control_points,
                                 const DistanceMinimisationOptions& options,
                                 ThreadPool& pool) {
  Check(problem, control_points, options);
  if (control_points.rows() == 2) return Minimiser<2>(problem, options, pool).Run(control_points);
  return Minimiser<3>(problem, options, pool).Run(control_points);
}

}  // namespace batten::internal
