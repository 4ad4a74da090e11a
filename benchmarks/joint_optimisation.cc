// SPDX-License-Identifier: MIT
// Prints, as Markdown tables, what the joint optimisation is worth: cost and truth over time beside
// alternation (all points projected, then a linear solution, and again), nets that fit already,
// conics with free weights, and free knots. An argument chooses one table: shell, coarse, curves,
// settled, conics, knots.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "batten/fitting/free_knots.h"
#include "batten/geometry/knot_vectors.h"
#include "jittered_shell.h"
#include "known_clouds.h"
#include "optimisation_runs.h"
#include "optimisation_shapes.h"

using namespace batten;
using namespace batten::internal;

namespace batten::internal {
namespace {

constexpr int kThreads = 2;
constexpr double kSigma = 1e-3;
constexpr double kTimes[] = {0.05, 0.1, 0.2, 0.5, 1};
constexpr double kLongest = 3;  // seconds for a method that does not end by itself
constexpr double kLate = 1.2;   // times what was allowed: worth a word

Eigen::Matrix3Xd ShellGrid() {
  constexpr int kSide = 100;
  Eigen::Matrix3Xd points(3, kSide * kSide);
  for (int k = 0; k < kSide * kSide; ++k) {
    const double u = (k / kSide + 0.5) / kSide, v = (k % kSide + 0.5) / kSide;
    points.col(k) = Shell(u, v);
  }
  return points;
}

KnownCase ShellCase(Eigen::Index points, int net, double jitter, unsigned seed) {
  const ShellKind kind{
      .points = points, .net = net, .sigma = kSigma, .jitter = jitter, .seed = seed};
  return {"S2, " + std::to_string(points / 1000) + "k, " + std::to_string(net) + "²",
          JitteredShell(kind),
          ShellGrid(),
          kSigma * kSigma};
}

// The mean squared share of z along the normals of Franke's function.
double FrankeUprightness() {
  constexpr int kSide = 200;
  constexpr double kStep = 1e-4;
  double sum = 0;
  for (int k = 0; k < kSide * kSide; ++k) {
    const double x = (k / kSide + 0.5) / kSide, y = (k % kSide + 0.5) / kSide;
    const double dx = (Franke(x + kStep, y) - Franke(x - kStep, y)) / (2 * kStep);
    const double dy = (Franke(x, y + kStep) - Franke(x, y - kStep)) / (2 * kStep);
    sum += 1 / (1 + dx * dx + dy * dy);
  }
  return sum / (kSide * kSide);
}

// Noise is in z only.
KnownCase FrankeCase(Eigen::Index points, int net, unsigned seed) {
  auto data = std::make_shared<FittingData>();
  data->values = Scatter(Franke, points, kSigma, 0, seed);
  data->parameters = data->values.topRows(2);
  const SplineBasis basis = SplineBasis::Uniform(3, net, 0, 1);
  return {"S1, " + std::to_string(points / 1000) + "k, " + std::to_string(net) + "²",
          FittingProblem(basis, basis, std::move(data), 1e-6),
          TruthGrid(Franke, 100),
          kSigma * kSigma * FrankeUprightness()};
}

// Points in order along a curve, at chord lengths that scatter by half a span either way.
KnownCase CurveCase(const std::string& name,
                    Eigen::VectorXd (*curve)(double),
                    Eigen::Index count,
                    int net,
                    double sigma) {
  std::mt19937_64 engine(20261121);
  std::vector<double> places;
  for (Eigen::Index k = 0; k < count; ++k) places.push_back(Uniform(engine));
  std::sort(places.begin(), places.end());
  const auto dimension = static_cast<int>(curve(0).size());
  auto data = std::make_shared<FittingData>();
  data->values.resize(dimension, count);
  data->parameters.setZero(2, count);
  auto parameters = data->parameters.row(0);
  for (Eigen::Index k = 0; k < count; ++k) {
    data->values.col(k) = curve(places[k]) + Noise(engine, dimension, sigma);
    if (k == 0) continue;
    parameters[k] = parameters[k - 1] + (data->values.col(k) - data->values.col(k - 1)).norm();
  }
  const double length = parameters[count - 1], span = length / (net - 3);
  for (double& u : parameters) u = std::clamp(u + span * (Uniform(engine) - 0.5), 0.0, length);
  Eigen::Matrix3Xd truth = Eigen::Matrix3Xd::Zero(3, 5000);
  for (int k = 0; k < truth.cols(); ++k) {
    truth.col(k).head(dimension) = curve((k + 0.5) / static_cast<double>(truth.cols()));
  }
  return {name + ", " + std::to_string(count / 1000) + "k, " + std::to_string(net),
          FittingProblem(SplineBasis::Uniform(3, net, 0, length), std::move(data), 1e-6),
          std::move(truth),
          sigma * sigma * (dimension - 1)};
}

// What a method has come to after so many seconds: it is run again and stopped then.
void PrintAfter(const KnownCase& known,
                const FittedShape& start,
                const Method& method,
                double limit,
                ThreadPool& pool) {
  const MethodRun run = method(start, limit, pool);
  std::printf(" %.4g (%.1e)",
              SumOfSquares(run.shape, known.problem.data().values, pool),
              Rms(run.shape, known.truth, pool));
  if (run.seconds > kLate * limit) std::printf(" at %.2f s", run.seconds);
  std::printf(" |");
}

void PrintMethod(const KnownCase& known,
                 const FittedShape& start,
                 const char* name,
                 const Method& method,
                 ThreadPool& pool) {
  PeakMemory::Reset();
  const MethodRun run = method(start, kLongest, pool);
  const double peak = PeakMemory::Megabytes();
  std::printf("| %s | %s | %d | %.3f | %.1f | %.0f | %.5g | %.5g | %.2e |",
              known.name.c_str(),
              name,
              run.steps,
              run.seconds,
              1e3 * run.seconds / std::max(1, run.steps),
              peak,
              SumOfSquares(run.shape, known.problem.data().values, pool),
              known.Floor(),
              Rms(run.shape, known.truth, pool));
  for (const double limit : kTimes) {
    if (run.seconds < limit) {
      std::printf(" · |");
    } else {
      PrintAfter(known, start, method, limit, pool);
    }
  }
  std::printf(" %s |\n", run.seconds < kLongest ? run.note.c_str() : "stopped");
  std::fflush(stdout);
}

void PrintOverTime(const std::vector<KnownCase>& cases, ThreadPool& pool) {
  std::printf(
      "| case | method | steps | s | ms a step | peak MB | Σd² | floor | truth rms | 0.05 s: Σd² "
      "(truth) | 0.1 s | 0.2 s | 0.5 s | 1 s | note |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const KnownCase& known : cases) {
    const FittedShape start = LinearStart(known, pool);
    std::printf("| %s | linear start | 0 | | | | %.5g | %.5g | %.2e | | | | | | |\n",
                known.name.c_str(),
                SumOfSquares(start, known.problem.data().values, pool),
                known.Floor(),
                Rms(start, known.truth, pool));
    PrintMethod(known, start, "alternation", Alternate, pool);
    PrintMethod(known, start, "joint stage", JointOptimization, pool);
    PrintMethod(known, start, "whole optimiser", WholeOptimiser, pool);
  }
}

void PrintShell(ThreadPool& pool) {
  std::printf("\n## S2, base parameters off by half a cell (σ = 1e-3)\n\n");
  PrintOverTime({ShellCase(20000, 24, 0.5, 1), ShellCase(100000, 24, 0.5, 1)}, pool);
}

void PrintCoarse(ThreadPool& pool) {
  std::printf("\n## Nets too coarse, smooth parameters (σ = 1e-3)\n\n");
  PrintOverTime({FrankeCase(20000, 12, 1), ShellCase(20000, 12, 0, 1)}, pool);
}

void PrintCurves(ThreadPool& pool) {
  std::printf("\n## Curves, chord lengths off by up to half a span\n\n");
  PrintOverTime({CurveCase("flower", Flower, 5000, 40, kSigma),
                 CurveCase("wave", Wave, 5000, 40, kSigma),
                 CurveCase("helix", Helix, 2000, 70, 1e-4),
                 CurveCase("helix", Helix, 100000, 70, 1e-4)},
                pool);
}

void PrintSettled(ThreadPool& pool) {
  std::printf(
      "\n## A net that already fits: truth rms after over before, 10 seeds, 20k points, 24²\n\n"
      "| cloud | mean truth before | mean ratio | worst ratio | optimised |\n"
      "|---|---|---|---|---|\n");
  constexpr int kSeeds = 10;
  const std::function<KnownCase(int)> clouds[] = {
      [](int seed) { return FrankeCase(20000, 24, seed); },
      [](int seed) { return ShellCase(20000, 24, 0, seed); }};
  for (const auto& cloud : clouds) {
    double sum = 0, ratios = 0, worst = 0;
    int ran = 0;
    for (int seed = 1; seed <= kSeeds; ++seed) {
      const KnownCase known = cloud(seed);
      const FittedShape start = LinearStart(known, pool);
      const MethodRun run = WholeOptimiser(start, kLongest, pool);
      const double before = Rms(start, known.truth, pool);
      const double ratio = Rms(run.shape, known.truth, pool) / before;
      sum += before;
      ratios += ratio;
      worst = std::max(worst, ratio);
      ran += run.steps > 0 ? 1 : 0;
    }
    std::printf("| %s | %.2e | %.3f | %.3f | %d of %d |\n",
                cloud(1).name.c_str(),
                sum / kSeeds,
                ratios / kSeeds,
                worst,
                ran,
                kSeeds);
    std::fflush(stdout);
  }
}

using Patch = std::function<Eigen::Vector3d(double, double)>;

struct PatchKind {
  std::string name;
  Patch patch;
  int degree, net_u, net_v;
};

std::vector<PatchKind> Conics() {
  std::vector<PatchKind> kinds;
  const std::pair<const char*, Patch> shapes[] = {
      {"cylinder", Cylinder}, {"sphere", Sphere}, {"torus", Torus}};
  for (const auto& [name, patch] : shapes) {
    for (const auto& [u, v] : {std::pair(3, 3), std::pair(3, 5), std::pair(5, 3)}) {
      kinds.push_back({name, patch, 2, u, v});
    }
  }
  return kinds;
}

// 2000 points over the plane below them; truth is a twenty-fifth narrower, as the ends of a fit
// are those of its data.
KnownCase PatchCase(const PatchKind& kind, double sigma) {
  std::mt19937_64 engine(3);
  auto data = std::make_shared<FittingData>();
  data->values.resize(3, 2000);
  for (auto point : data->values.colwise()) {
    const double u = Uniform(engine), v = Uniform(engine);
    point = kind.patch(u, v) + Eigen::Vector3d(Noise(engine, 3, sigma));
  }
  data->parameters = data->values.topRows(2);
  Eigen::Matrix3Xd truth(3, 4000);
  for (auto point : truth.colwise()) {
    const double u = 0.02 + 0.96 * Uniform(engine), v = 0.02 + 0.96 * Uniform(engine);
    point = kind.patch(u, v);
  }
  const Eigen::Vector2d low = data->parameters.rowwise().minCoeff();
  const Eigen::Vector2d high = data->parameters.rowwise().maxCoeff();
  const SplineBasis u = SplineBasis::Uniform(kind.degree, kind.net_u, low[0], high[0]);
  const SplineBasis v = SplineBasis::Uniform(kind.degree, kind.net_v, low[1], high[1]);
  return {kind.name + ", " + std::to_string(kind.net_u) + " × " + std::to_string(kind.net_v),
          FittingProblem(u, v, std::move(data), 1e-6),
          std::move(truth),
          sigma * sigma};
}

struct PatchRun {
  OptimizeResult result;
  double seconds = 0, size = 0, truth = 0;  // truth: rms over the size
};

PatchRun RunPatch(const KnownCase& known, bool weights, ThreadPool& pool) {
  const FittedShape start = LinearStart(known, pool);
  OptimizeOptions options;
  options.free.weights = weights;
  const StopAfter clock(1e9);
  PatchRun run{Optimize(start.problem, start.net, {}, options, pool)};
  run.seconds = clock.seconds();
  const Eigen::MatrixXd& points = known.problem.data().values;
  run.size = (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
  const FittedShape found{run.result.problem, run.result.control_points, run.result.weights};
  run.truth = Rms(found, known.truth, pool) / run.size;
  return run;
}

void PrintExact(const std::vector<PatchKind>& kinds, ThreadPool& pool) {
  std::printf(
      "| patch | steps, weights free | s | rms/size | weights | steps, weights fixed | s | "
      "rms/size "
      "|\n|---|---|---|---|---|---|---|---|\n");
  for (const PatchKind& kind : kinds) {
    const KnownCase known = PatchCase(kind, 0);
    const PatchRun with = RunPatch(known, true, pool), without = RunPatch(known, false, pool);
    std::printf("| %s | %d | %.2f | %.1e | %.2f … %.2f | %d | %.2f | %.1e |\n",
                known.name.c_str(),
                with.result.iterations,
                with.seconds,
                with.result.rms_after / with.size,
                with.result.weights.minCoeff(),
                with.result.weights.maxCoeff(),
                without.result.iterations,
                without.seconds,
                without.result.rms_after / without.size);
    std::fflush(stdout);
  }
}

void PrintConics(ThreadPool& pool) {
  std::printf("\n## Exact samples, 2000 points: weights free and fixed\n\n");
  std::vector<PatchKind> kinds = Conics();
  for (int seed = 1; seed <= 5; ++seed) {
    const NurbsSurface surface = RandomRational(seed);
    kinds.push_back({"random rational bicubic " + std::to_string(seed),
                     [surface](double u, double v) { return surface.At(u, v); },
                     3,
                     6,
                     6});
  }
  PrintExact(kinds, pool);
  std::printf(
      "\n## The conics with noise (σ = 1e-3)\n\n"
      "| patch | truth/size, weights free | weights fixed | weights | steps | s | note |\n"
      "|---|---|---|---|---|---|---|\n");
  for (const PatchKind& kind : Conics()) {
    const KnownCase known = PatchCase(kind, kSigma);
    const PatchRun with = RunPatch(known, true, pool), without = RunPatch(known, false, pool);
    std::printf("| %s | %.2e | %.2e | %.2f … %.2f | %d | %.2f | %s |\n",
                known.name.c_str(),
                with.truth,
                without.truth,
                with.result.weights.minCoeff(),
                with.result.weights.maxCoeff(),
                with.result.iterations,
                with.seconds,
                with.result.note.c_str());
    std::fflush(stdout);
  }
}

struct KnotCase {
  const char* name;
  double (*f)(double);
  double lower, upper;
  int samples, knots;
  double known;  // the best of many starts of other programs
};

constexpr KnotCase kKnotCases[] = {
    {"step", Step, 0, 1, 201, 4, 3.38553},
    {"step", Step, 0, 1, 201, 5, 1.54032},
    {"step", Step, 0, 1, 201, 6, 0.0602135},
    {"step", Step, 0, 1, 201, 8, 0.0113010},
    {"cusp", Cusp, 0, 1, 201, 4, 206.83},
    {"cusp", Cusp, 0, 1, 201, 5, 53.202},
    {"cusp", Cusp, 0, 1, 201, 6, 3.75483},
    {"cusp", Cusp, 0, 1, 201, 8, 0.382092},
    {"peak", Peak, 0, 1, 201, 4, 3.60005e-4},
    {"peak", Peak, 0, 1, 201, 5, 9.94115e-5},
    {"peak", Peak, 0, 1, 201, 6, 5.08625e-5},
    {"peak", Peak, 0, 1, 201, 8, 1.48498e-5},
    {"bump", Bump, -2, 2, 201, 4, 0.780214},
    {"bump", Bump, -2, 2, 201, 5, 9.52628e-3},
    {"bump", Bump, -2, 2, 201, 6, 4.45022e-3},
    {"bump", Bump, -2, 2, 201, 8, 2.71909e-4},
    {"titanium", Titanium, 595, 1075, 49, 5, 0.00765276},
};

void PrintKnots(ThreadPool& pool) {
  std::printf(
      "\n## Free knots: cubics over samples of a function, default starts\n\n"
      "| function | knots | Σd², uniform | Σd², free | over the best known | s | knots found "
      "(multiplicity) |\n|---|---|---|---|---|---|---|\n");
  for (const KnotCase& known : kKnotCases) {
    auto data = std::make_shared<FittingData>();
    data->parameters.setZero(2, known.samples);
    data->values.resize(1, known.samples);
    for (int k = 0; k < known.samples; ++k) {
      const double x = known.lower + (known.upper - known.lower) * k / (known.samples - 1);
      data->parameters(0, k) = x;
      data->values(0, k) = known.f(x);
    }
    const FittingProblem problem(
        SplineBasis::Uniform(3, 4 + known.knots, known.lower, known.upper), std::move(data), 0);
    const StopAfter clock(1e9);
    const FreeKnotResult found = OptimizeKnots(problem, {}, pool);
    const double seconds = clock.seconds();
    std::printf("| %s | %d | %.6g | %.6g | %.5f | %.2f |",
                known.name,
                known.knots,
                found.squares_before,
                found.squares_after,
                found.squares_after / known.known,
                seconds);
    const auto knots = DomainKnots(found.problem.basis_u());
    for (size_t i = 1; i + 1 < knots.size(); ++i) {
      std::printf(" %.6g", knots[i].knot);
      if (knots[i].multiplicity > 1) std::printf(" (%d)", knots[i].multiplicity);
    }
    std::printf(" |\n");
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace batten::internal

int main(int argc, char** argv) {
  const std::pair<std::string_view, void (*)(ThreadPool&)> tables[] = {{"shell", PrintShell},
                                                                       {"coarse", PrintCoarse},
                                                                       {"curves", PrintCurves},
                                                                       {"settled", PrintSettled},
                                                                       {"conics", PrintConics},
                                                                       {"knots", PrintKnots}};
  const std::string_view chosen = argc > 1 ? argv[1] : "";
  const bool known = std::any_of(std::begin(tables), std::end(tables), [&](const auto& table) {
    return table.first == chosen;
  });
  if (argc > 2 || (argc == 2 && !known)) {
    std::fprintf(stderr, "usage: joint_optimisation [shell|coarse|curves|settled|conics|knots]\n");
    return 2;
  }
  ThreadPool pool(kThreads);
  std::printf("%d threads\n", kThreads);
  double peak = 0;
  for (const auto& [name, print] : tables) {
    if (!chosen.empty() && name != chosen) continue;
    print(pool);
    peak = std::max(peak, PeakMemory::Megabytes());
  }
  std::printf("\npeak memory %.0f MB\n", peak);
  return 0;
}
