// SPDX-License-Identifier: MIT
#include "fitting/foot_points/warm_start_foot_points.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "geometry/evaluation/evaluation_kernels.h"

namespace batten::internal {
namespace {

constexpr std::ptrdiff_t kWarmBlock = 512;  // points that are evaluated together

// The search of one block: every point has its best parameter and a step to try from there. All
// trials of a round are evaluated together.
template <int Dim>
class BlockSearch {
 public:
  using Vector = Eigen::Matrix<double, Dim, 1>;
  using Columns = Eigen::Matrix<double, Dim, Eigen::Dynamic>;

  BlockSearch(const CurveEvaluator<Dim>& curve,
              const Columns& points,
              WarmStartFootPoints<Dim>& feet)
      : curve_(curve), basis_(curve.curve().basis()), points_(points), foot_points_(feet) {}

  void Run(std::ptrdiff_t begin, std::ptrdiff_t end) {
    constexpr int kRounds = 80;
    states_.assign(static_cast<size_t>(end - begin), {});
    active_.resize(states_.size());
    for (size_t i = 0; i < states_.size(); ++i) {
      active_[i] = i;
      states_[i].trial =
          basis_.Clamp(foot_points_.parameters[begin + static_cast<std::ptrdiff_t>(i)]);
    }
    for (int round = 0; round < kRounds && !active_.empty(); ++round) {
      Evaluate();
      size_t left = 0;
      for (size_t a = 0; a < active_.size(); ++a) {
        const size_t i = active_[a];
        const std::ptrdiff_t k = begin + static_cast<std::ptrdiff_t>(i);
        if (Judge(states_[i], k, jets_.data() + a * 3 * Dim)) active_[left++] = i;
      }
      active_.resize(left);
    }
    for (std::ptrdiff_t k = begin; k < end; ++k) foot_points_.held[k] = Held(k);
  }

 private:
  struct State {
    double trial = 0, step = 0;
    double squares = std::numeric_limits<double>::infinity();
  };

  void Evaluate() {
    trials_.resize(active_.size());
    jets_.resize(active_.size() * 3 * Dim);
    for (size_t a = 0; a < active_.size(); ++a) trials_[a] = states_[active_[a]].trial;
    EvaluateCurve(curve_.table(), trials_.data(), trials_.size(), 2, jets_.data());
  }

  // Takes a trial that is nearer and goes on from it, or shortens its step. Returns whether there
  // is another trial.
  bool Judge(State& state, std::ptrdiff_t k, const double* jet) {
    constexpr double kShorter = 0.25;
    const Eigen::Map<const Vector> point(jet), first(jet + Dim), second(jet + 2 * Dim);
    const Vector difference = point - points_.col(k);
    const double squares = difference.squaredNorm();
    if (!(squares < state.squares)) {
      if (TryKnot(state, k)) return true;
      state.step *= kShorter;
      return Try(state, k);
    }
    state.squares = squares;
    const double speed = first.squaredNorm(), slope = difference.dot(first);
    const double bend = difference.dot(second);
    foot_points_.parameters[k] = state.trial;
    foot_points_.differences.col(k) = difference;
    foot_points_.tangents.col(k) =
        speed > 0 ? (first / std::sqrt(speed)).eval() : Vector::Zero().eval();
    foot_points_.bend[k] = speed > 0 ? bend / speed : 0;
    constexpr double kPerpendicular = 1e-7;
    const double length = std::sqrt(speed * squares);
    if (std::abs(slope) <= kPerpendicular * length) return false;
    // Where the distance is concave, the magnitude of its curvature still sets the step length.
    constexpr double kFlattest = 1e-2;
    state.step = -slope / std::max(std::abs(speed + bend), kFlattest * speed);
    return Try(state, k);
  }

  bool Held(std::ptrdiff_t k) const {
    constexpr double kCosine = 1e-4;
    const auto difference = foot_points_.differences.col(k);
    if (!(std::abs(difference.dot(foot_points_.tangents.col(k))) > kCosine * difference.norm())) {
      return false;
    }
    const double u = foot_points_.parameters[k];
    const bool end = u <= basis_.lower() || u >= basis_.upper();
    return (end && !basis_.periodic()) || basis_.Multiplicity(u) >= basis_.degree();
  }

  // A step that failed may have passed a kink, which only a knot can be: the first knot on its way
  // is tried next.
  bool TryKnot(State& state, std::ptrdiff_t k) const {
    const double from = foot_points_.parameters[k], to = from + state.step;
    int i = basis_.Span(from);
    if (state.step > 0) {
      ++i;
    } else {
      const int first = basis_.periodic() ? 0 : basis_.degree();  // a period goes on before
      while (i > first && basis_.knots()[i] == from) --i;
    }
    const double knot = basis_.knots()[i];
    const bool between = state.step > 0 ? knot > from && knot < to : knot < from && knot > to;
    const double trial = basis_.Clamp(knot);
    if (!between || trial == state.trial) return false;
    state.step = knot - from;
    state.trial = trial;
    return true;
  }

  bool Try(State& state, std::ptrdiff_t k) const {
    constexpr double kLeast = 1e-13;
    const double from = foot_points_.parameters[k], length = basis_.upper() - basis_.lower();
    if (!(std::abs(state.step) > kLeast * length) || !std::isfinite(state.step)) return false;
    state.step = std::clamp(state.step, -length / 2, length / 2);
    state.trial = basis_.Clamp(from + state.step);
    return state.trial != from;
  }

  const CurveEvaluator<Dim>& curve_;
  const SplineBasis& basis_;
  const Columns& points_;
  WarmStartFootPoints<Dim>& foot_points_;
  std::vector<State> states_;
  std::vector<size_t> active_;
  std::vector<double> trials_, jets_;
};

}  // namespace

template <int Dim>
double WarmStartFootPoints<Dim>::Squares(const Eigen::VectorXd& weights) const {
  const Eigen::VectorXd squares = differences.colwise().squaredNorm();
  return weights.size() > 0 ? weights.dot(squares) : squares.sum();
}

template <int Dim>
WarmStartFootPoints<Dim> FootPointsFrom(const CurveEvaluator<Dim>& curve,
                                        const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points,
                                        const Eigen::VectorXd& start,
                                        ThreadPool& pool) {
  const Eigen::Index count = points.cols();
  WarmStartFootPoints<Dim> feet;
  feet.parameters = start;
  feet.differences.resize(Dim, count);
  feet.tangents.resize(Dim, count);
  feet.bend.resize(count);
  feet.held.resize(count);
  constexpr std::ptrdiff_t kShare = 8;  // blocks that a thread takes at once
  pool.For(count, kWarmBlock * kShare, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    BlockSearch<Dim> search(curve, points, feet);
    for (std::ptrdiff_t k = begin; k < end; k += kWarmBlock)
      search.Run(k, std::min(k + kWarmBlock, end));
  });
  return feet;
}

template struct WarmStartFootPoints<2>;
template struct WarmStartFootPoints<3>;
template WarmStartFootPoints<2> FootPointsFrom<2>(const CurveEvaluator<2>&,
                                                  const Eigen::Matrix2Xd&,
                                                  const Eigen::VectorXd&,
                                                  ThreadPool&);
template WarmStartFootPoints<3> FootPointsFrom<3>(const CurveEvaluator<3>&,
                                                  const Eigen::Matrix3Xd&,
                                                  const Eigen::VectorXd&,
                                                  ThreadPool&);

}  // namespace batten::internal
