// SPDX-License-Identifier: MIT
// Ways to minimise orthogonal distances, run for as long as one likes, and what comes of it.
#pragma once

#include <Eigen/Core>
#include <chrono>
#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <string>
#include <type_traits>

#include "batten/fitting/distances.h"
#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/optimize.h"
#include "batten/fitting/progress.h"
#include "batten/fitting/solve_linear.h"
#include "batten/geometry/foot_point.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/joint/joint_optimization.h"

namespace batten::internal {

// A shape and the data it is meant for, whose parameters are where foot points are searched from.
struct FittedShape {
  FittingProblem problem;
  Eigen::MatrixXd net;
  Eigen::VectorXd weights;  // empty: ones
};

// Data, and points of the shape they were taken from.
struct KnownCase {
  std::string name;
  FittingProblem problem;
  Eigen::Matrix3Xd truth;
  double across = 0;  // variance of the noise across the shape: what a distance squared expects

  // What noise alone leaves of the sum of squared distances.
  double Floor() const { return across * static_cast<double>(problem.size() - problem.unknowns()); }
};

// Seconds since it was made, and a Progress that stops once they exceed a limit.
class StopAfter {
 public:
  explicit StopAfter(double limit) : limit_(limit) {}

  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  }
  Progress AsProgress() const {
    return [this](const char*, double) { return seconds() < limit_; };
  }

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  double limit_;
};

// The most memory held since the last call of Reset, in MB; where the system cannot forget, since
// the start of the program.
class PeakMemory {
 public:
  static void Reset() { std::ofstream("/proc/self/clear_refs") << "5"; }

  static double Megabytes() {
    std::ifstream status("/proc/self/status");
    for (std::string word; status >> word;) {
      if (word != "VmHWM:") continue;
      double kilobytes = 0;
      status >> kilobytes;
      return kilobytes / 1024;
    }
    return std::numeric_limits<double>::quiet_NaN();
  }
};

inline Eigen::Matrix3Xd InSpace(const Eigen::MatrixXd& points) {
  Eigen::Matrix3Xd result = Eigen::Matrix3Xd::Zero(3, points.cols());
  result.topRows(points.rows()) = points;
  return result;
}

inline Eigen::VectorXd WeightsOf(const FittedShape& shape) {
  return shape.weights.size() > 0 ? shape.weights : Eigen::VectorXd::Ones(shape.net.cols());
}

// Calls `use` with the shape's curve or surface.
template <typename Use>
auto WithGeometry(const FittedShape& shape, const Use& use) {
  const FittingProblem& problem = shape.problem;
  if (!problem.is_curve()) {
    return use(NurbsSurface(problem.basis_u(), problem.basis_v(), shape.net, WeightsOf(shape)));
  }
  if (shape.net.rows() == 2) {
    return use(NurbsCurve<2>(problem.basis_u(), shape.net, WeightsOf(shape)));
  }
  return use(NurbsCurve<3>(problem.basis_u(), shape.net, WeightsOf(shape)));
}

// From the nearest points of the whole shape.
inline double SumOfSquares(const FittedShape& shape,
                           const Eigen::MatrixXd& points,
                           ThreadPool& pool) {
  return WithGeometry(shape, [&](const auto& geometry) {
    return DistancesTo(geometry, InSpace(points), pool).distances.squaredNorm();
  });
}

inline double Rms(const FittedShape& shape, const Eigen::MatrixXd& points, ThreadPool& pool) {
  return std::sqrt(SumOfSquares(shape, points, pool) / static_cast<double>(points.cols()));
}

// The linear fit at the case's own parameters: what every method starts from.
inline FittedShape LinearStart(const KnownCase& known, ThreadPool& pool) {
  return {known.problem, SolveLinear(known.problem, pool).coefficients, {}};
}

struct MethodRun {
  FittedShape shape;
  int steps = 0;
  double seconds = 0;
  std::string note;
};

using Method = std::function<MethodRun(const FittedShape& start, double limit, ThreadPool& pool)>;

namespace internal {

constexpr int kBlock = 512;

// Local foot points of the data; returns the sum of squared distances.
inline double Project(const FittedShape& shape, Eigen::Matrix2Xd& parameters, ThreadPool& pool) {
  const Eigen::Matrix3Xd points = InSpace(shape.problem.data().values);
  Eigen::VectorXd distances(points.cols());
  WithGeometry(shape, [&](const auto& geometry) {
    using Geometry = std::decay_t<decltype(geometry)>;
    if constexpr (std::is_same_v<Geometry, NurbsSurface>) {
      const PointDistances found = DistancesFrom(geometry, points, parameters, pool);
      parameters = found.parameters;
      distances = found.distances;
    } else {
      constexpr int kDimension = std::is_same_v<Geometry, NurbsCurve<2>> ? 2 : 3;
      const CurveFootPoints<kDimension> feet(geometry);
      pool.For(points.cols(), kBlock, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
        for (std::ptrdiff_t k = begin; k < end; ++k) {
          const CurveFoot foot = feet.Near(points.col(k), parameters(0, k));
          parameters(0, k) = foot.u;
          distances[k] = foot.distance;
        }
      });
    }
    return 0;
  });
  return distances.squaredNorm();
}

}  // namespace internal

// Projects all points, solves linearly, and again, until a round gains less than 1e-7 of the sum.
inline MethodRun Alternate(const FittedShape& start, double limit, ThreadPool& pool) {
  constexpr double kLeastGain = 1e-7;
  const StopAfter clock(limit);
  MethodRun run{start, 0, 0, ""};
  Eigen::Matrix2Xd parameters = start.problem.data().parameters;
  double squares = internal::Project(run.shape, parameters, pool);
  FittedShape next = start;
  while (clock.seconds() < limit) {
    next.problem = next.problem.WithParameters(parameters);
    next.net = SolveLinear(next.problem, pool).coefficients;
    const double found = internal::Project(next, parameters, pool);
    ++run.steps;
    if (!(found < squares)) break;
    const bool settled = squares - found < kLeastGain * squares;
    squares = found;
    run.shape = next;
    if (settled) break;
  }
  run.seconds = clock.seconds();
  return run;
}

inline MethodRun JointOptimization(const FittedShape& start, double limit, ThreadPool& pool) {
  const StopAfter clock(limit);
  JointOptions options;
  options.least_gain = 1e-5;
  options.progress = clock.AsProgress();
  JointResult result = OptimizeJointly(start.problem, start.net, start.weights, options, pool);
  return {{result.problem, result.control_points, result.weights},
          result.iterations,
          clock.seconds(),
          result.note};
}

inline MethodRun WholeOptimiser(const FittedShape& start, double limit, ThreadPool& pool) {
  const StopAfter clock(limit);
  OptimizeOptions options;
  options.progress = clock.AsProgress();
  OptimizeResult result = Optimize(start.problem, start.net, start.weights, options, pool);
  return {{result.problem, result.control_points, result.weights},
          result.iterations,
          clock.seconds(),
          result.note};
}

}  // namespace batten::internal
