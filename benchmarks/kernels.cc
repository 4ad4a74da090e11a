// SPDX-License-Identifier: MIT
// The kernels that fits spend their time in, one thread.
#include <benchmark/benchmark.h>

#include <memory>

#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/grid_selection.h"
#include "batten/geometry/foot_point.h"
#include "known_clouds.h"

namespace batten {
namespace {

FittingProblem Problem(Eigen::Index count, int cells) {
  const Eigen::Matrix3Xd points = Scatter(Franke, count, 1e-3, 0, 1);
  auto data = std::make_shared<FittingData>();
  data->parameters = points.topRows<2>();
  data->values = points.row(2);
  return FittingProblem(
      FittingBasis(3, cells, 0, 1), FittingBasis(3, cells, 0, 1), std::move(data), 1e-4);
}

NurbsSurface Surface(int cells) {
  ThreadPool pool(1);
  const FittingProblem problem = Problem(20000, cells);
  const LinearSolution solution = SolveLinear(problem, pool);
  Eigen::Matrix3Xd net(3, solution.coefficients.cols());
  for (int i = 0; i < problem.basis_u().size(); ++i) {
    for (int j = 0; j < problem.basis_v().size(); ++j) {
      const Eigen::Index k = Eigen::Index{i} * problem.basis_v().size() + j;
      net.col(k) << problem.basis_u().Greville(i), problem.basis_v().Greville(j),
          solution.coefficients(0, k);
    }
  }
  return NurbsSurface(problem.basis_u(), problem.basis_v(), net);
}

void EvaluatePoints(benchmark::State& state) {
  const NurbsSurface surface = Surface(21);
  const Eigen::Matrix3Xd at = Scatter(Franke, 4096, 0, 0, 2);
  for (auto _ : state) {
    for (Eigen::Index k = 0; k < at.cols(); ++k)
      benchmark::DoNotOptimize(surface.At(at(0, k), at(1, k)));
  }
  state.SetItemsProcessed(state.iterations() * at.cols());
}
BENCHMARK(EvaluatePoints);

void EvaluateSecondDerivatives(benchmark::State& state) {
  const NurbsSurface surface = Surface(21);
  const Eigen::Matrix3Xd at = Scatter(Franke, 4096, 0, 0, 2);
  for (auto _ : state) {
    for (Eigen::Index k = 0; k < at.cols(); ++k)
      benchmark::DoNotOptimize(surface.JetAt(at(0, k), at(1, k)));
  }
  state.SetItemsProcessed(state.iterations() * at.cols());
}
BENCHMARK(EvaluateSecondDerivatives);

void FootPointsGlobal(benchmark::State& state) {
  const SurfaceFootPoints finder(Surface(21));
  const Eigen::Matrix3Xd points = Scatter(Franke, 4096, 1e-3, 0, 3);
  for (auto _ : state) {
    for (Eigen::Index k = 0; k < points.cols(); ++k)
      benchmark::DoNotOptimize(finder.Nearest(points.col(k)));
  }
  state.SetItemsProcessed(state.iterations() * points.cols());
}
BENCHMARK(FootPointsGlobal);

void FootPointsWarm(benchmark::State& state) {
  const NurbsSurface surface = Surface(21);
  const Eigen::Matrix3Xd points = Scatter(Franke, 4096, 1e-3, 0, 3);
  for (auto _ : state) {
    for (Eigen::Index k = 0; k < points.cols(); ++k) {
      benchmark::DoNotOptimize(LocalFootPoint(surface, points.col(k), points(0, k), points(1, k)));
    }
  }
  state.SetItemsProcessed(state.iterations() * points.cols());
}
BENCHMARK(FootPointsWarm);

void LinearSolve(benchmark::State& state) {
  ThreadPool pool(1);
  const FittingProblem problem = Problem(state.range(1), static_cast<int>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(SolveLinear(problem, pool));
  state.SetItemsProcessed(state.iterations() * problem.size());
}
BENCHMARK(LinearSolve)
    ->Args({21, 100000})
    ->Args({21, 1000000})
    ->Args({61, 1000000})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace batten

BENCHMARK_MAIN();
