// SPDX-License-Identifier: MIT
// The kernels that fits spend their time in, one thread.
#include <benchmark/benchmark.h>

#include <memory>

#include "batten/fitting/fitting_bases.h"
#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/grid_selection.h"
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
