// SPDX-License-Identifier: MIT
// Levenberg–Marquardt and Gauss–Newton steps towards the minimum of Σ w ρ(d) over the freedoms of a
// shape, for points about the origin and of about unit size.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

#include "batten/geometry/thread_pool.h"
#include "fitting/core/rounding.h"
#include "geometry/numeric/constants.h"
#include "geometry/numeric/dense_solvers.h"

namespace batten::internal {

// Σ w ρ(d) with its gradient and Gauss–Newton matrix Σ w (ρ'/d) ∇d ∇dᵀ by N freedoms; those that a
// shape does not have stay zero.
template <int N>
struct ShapeForm {
  Eigen::Matrix<double, N, N> matrix = Eigen::Matrix<double, N, N>::Zero();
  Eigen::Matrix<double, N, 1> gradient = Eigen::Matrix<double, N, 1>::Zero();
  double cost = 0;

  void operator+=(const ShapeForm& other) {
    matrix += other.matrix;
    gradient += other.gradient;
    cost += other.cost;
  }
};

// Points whose sums are one part.
inline constexpr Eigen::Index kSumBlock = 8192;

// Σ of what `part(begin, end)` gives of blocks of [0, count), in their order, so that it does not
// depend on the number of threads.
template <Eigen::Index kBlock, typename Part>
auto SumOfBlocks(Eigen::Index count, const Part& part, ThreadPool& pool) {
  using Sum = decltype(part(0, 0));
  std::vector<Sum> parts(static_cast<size_t>((count + kBlock - 1) / kBlock));
  pool.For(count, kBlock, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    parts[static_cast<size_t>(begin / kBlock)] = part(begin, end);
  });
  Sum sum;
  for (const Sum& one : parts) sum += one;
  return sum;
}

template <typename Shape, int N>
struct ShapeMinimum {
  Shape shape;
  ShapeForm<N> form;  // there
  int steps = 0;
  bool converged = false;  // a whole Gauss–Newton step leads nowhere lower, or to rounding
};

// The local minimum below `start`: Levenberg–Marquardt steps until the sum does not fall, then,
// where the rms distance is below `polished`, Gauss–Newton steps while its gradient does: the sum
// is flat to rounding while the gradient still tells the place. Never worse than the start; one
// evaluation of the form a step. `form_of(shape)` gives the form, `moved(shape, step)` the shape
// after a step in its first `freedoms`. [Marquardt 1963; Moré 1978]
template <typename Shape, int N>
class ShapeDescent {
 public:
  using Form = ShapeForm<N>;
  using Step = Eigen::Matrix<double, N, 1>;

  template <typename FormOf, typename Moved>
  static ShapeMinimum<Shape, N> Run(const Shape& start,
                                    const FormOf& form_of,
                                    const Moved& moved,
                                    int freedoms,
                                    double weights,
                                    double polished,
                                    int most_steps) {
    ShapeMinimum<Shape, N> best{start, form_of(start)};
    const auto at_rounding = [&] {
      return 2 * best.form.cost <= std::pow(4 * kEpsilon, 2) * weights;
    };
    const auto take = [&](const Step& step, const auto& better) {
      const Shape next = moved(best.shape, step);
      const Form form = form_of(next);
      ++best.steps;
      if (!better(form)) return false;
      best.shape = next;
      best.form = form;
      return true;
    };
    const auto lower = [&](const Form& form) { return form.cost < best.form.cost; };
    double damping = 0;
    while (best.steps < most_steps && !best.converged) {
      best.converged = Lowest(best.form) || at_rounding();
      if (best.converged) break;
      const Step step = StepOf(best.form, freedoms, damping);
      best.converged =
          damping == 0 && -step.dot(best.form.gradient) <= kRelativeRounding * best.form.cost;
      if (best.converged) break;
      if (take(step, lower)) {
        damping = damping <= kFirstDamping ? 0 : damping * kLower;
      } else {
        damping = std::max(kFirstDamping, damping * kRaise);
        best.converged = damping > kMostDamping;
      }
    }
    constexpr int kPolishingSteps = 20;
    const int last = std::min(most_steps, best.steps + kPolishingSteps);
    if (std::sqrt(2 * best.form.cost / weights) > polished) return best;
    const auto flatter = [&](const Form& form) {
      return Slope(form) < 0.5 * Slope(best.form) &&
             form.cost <= (1 + 16 * kEpsilon) * best.form.cost;
    };
    while (best.converged && best.steps < last && !Lowest(best.form) &&
           take(StepOf(best.form, freedoms, 0), flatter)) {
    }
    return best;
  }

 private:
  static constexpr double kFirstDamping = 1e-4, kRaise = 8, kLower = 0.2, kMostDamping = 1e12;
  static constexpr double kDone = 1e-3;  // of the rounding of distances about one

  static bool Lowest(const Form& form) {
    return !(form.cost > 0) || Slope(form) <= kDone * kEpsilon;
  }

  // The gradient's size in units in which the diagonal of the matrix is one: a length, as distances
  // are, over the root of the number of points.
  static double Slope(const Form& form) {
    double most = 0;
    for (int i = 0; i < N; ++i) {
      if (form.matrix(i, i) > 0) {
        most = std::max(most, std::abs(form.gradient[i]) / std::sqrt(form.matrix(i, i)));
      }
    }
    return most;
  }

  // −(A + λ·diag A)⁻¹ g in the same units.
  static Step StepOf(const Form& form, int freedoms, double damping) {
    Eigen::VectorXd unit = form.matrix.diagonal().head(freedoms).cwiseSqrt();
    for (double& value : unit) value = value > 0 ? 1 / value : 0;
    Eigen::MatrixXd scaled =
        unit.asDiagonal() * form.matrix.topLeftCorner(freedoms, freedoms) * unit.asDiagonal();
    constexpr double kSymmetry = 1e-15;  // freedoms that move nothing are rounding
    scaled.diagonal().array() += damping + kSymmetry;
    for (int i = 0; i < freedoms; ++i) {
      if (unit[i] == 0) scaled(i, i) = 1;
    }
    Step step = Step::Zero();
    step.head(freedoms) = unit.cwiseProduct(Eigen::VectorXd(
        SymmetricSolution(scaled, -unit.cwiseProduct(form.gradient.head(freedoms)))));
    return step;
  }
};

}  // namespace batten::internal
