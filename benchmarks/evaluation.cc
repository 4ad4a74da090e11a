// SPDX-License-Identifier: MIT
// Evaluation, one thread, with OpenCASCADE beside it in the same run: a surface of 24×24 bicubic
// control points, at random parameters and on grids. "Wild" weights lie in [1e-2, 1e2], "tame" ones
// in [0.5, 2].
#include <benchmark/benchmark.h>

#include <Geom_BSplineSurface.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColStd_Array2OfReal.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <vector>

#include "batten/geometry/curve_evaluator.h"
#include "batten/geometry/surface_evaluator.h"
#include "random_splines.h"

namespace batten::internal {
namespace {

constexpr int kSize = 24, kDegree = 3, kParameters = 1 << 14;

enum class Weights { kNone, kTame, kWild };

NurbsSurface Surface(Weights kind) {
  RandomSplines random(1);
  const SplineBasis basis = SplineBasis::Uniform(kDegree, kSize, 0, 1);
  Eigen::Matrix3Xd points(3, kSize * kSize);
  for (int i = 0; i < kSize; ++i) {
    for (int j = 0; j < kSize; ++j) {
      points.col(i * kSize + j) << basis.Greville(i), basis.Greville(j), random.Real(-0.1, 0.1);
    }
  }
  if (kind == Weights::kNone) return NurbsSurface(basis, basis, points);
  const double most = kind == Weights::kTame ? 2 : 100;
  return NurbsSurface(basis, basis, points, random.Weights(points.cols(), 1 / most, most));
}

NurbsCurve<3> Curve(bool rational) {
  RandomSplines random(1);
  SplineBasis basis = SplineBasis::Uniform(kDegree, 50 + kDegree, 0, 1);
  Eigen::Matrix3Xd points(3, basis.size());
  for (double& x : points.reshaped()) x = random.Real(-1, 1);
  return NurbsCurve<3>(
      basis, points, rational ? random.Weights(points.cols(), 0.5, 2) : Eigen::VectorXd());
}

Handle(Geom_BSplineSurface) Occt(const NurbsSurface& surface) {
  const std::vector<int> spans = surface.basis_u().Spans();
  const int knots = static_cast<int>(spans.size()) + 1;
  TColgp_Array2OfPnt poles(1, kSize, 1, kSize);
  TColStd_Array2OfReal weights(1, kSize, 1, kSize);
  TColStd_Array1OfReal values(1, knots);
  TColStd_Array1OfInteger multiplicities(1, knots);
  multiplicities.Init(1);
  multiplicities(1) = multiplicities(knots) = kDegree + 1;
  values(knots) = surface.basis_u().upper();
  for (int k = 1; k < knots; ++k) {
    values(k) = surface.basis_u().knots()[spans[static_cast<size_t>(k - 1)]];
  }
  for (int i = 0; i < kSize; ++i) {
    for (int j = 0; j < kSize; ++j) {
      const Eigen::Vector3d p = surface.control_point(i, j);
      poles(i + 1, j + 1) = gp_Pnt(p[0], p[1], p[2]);
      weights(i + 1, j + 1) = surface.weights()[i * kSize + j];
    }
  }
  return new Geom_BSplineSurface(
      poles, weights, values, values, multiplicities, multiplicities, kDegree, kDegree);
}

Eigen::Matrix2Xd RandomParameters() {
  RandomSplines random(2);
  Eigen::Matrix2Xd parameters(2, kParameters);
  for (double& x : parameters.reshaped()) x = random.Real(0, 1);
  return parameters;
}

void Points(benchmark::State& state, Weights weights) {
  const SurfaceEvaluator evaluator(Surface(weights));
  const Eigen::Matrix2Xd at = RandomParameters();
  Eigen::Matrix3Xd points;
  for (auto _ : state) {
    evaluator.Points(at, points);
    benchmark::DoNotOptimize(points.data());
  }
  state.SetItemsProcessed(state.iterations() * at.cols());
}
BENCHMARK_CAPTURE(Points, polynomial, Weights::kNone);
BENCHMARK_CAPTURE(Points, tame, Weights::kTame);
BENCHMARK_CAPTURE(Points, wild, Weights::kWild);

void PointsOneByOne(benchmark::State& state, Weights weights) {
  const SurfaceEvaluator evaluator(Surface(weights));
  const Eigen::Matrix2Xd at = RandomParameters();
  for (auto _ : state) {
    for (const auto& uv : at.colwise()) benchmark::DoNotOptimize(evaluator.At(uv[0], uv[1]));
  }
  state.SetItemsProcessed(state.iterations() * at.cols());
}
BENCHMARK_CAPTURE(PointsOneByOne, polynomial, Weights::kNone);

void PointsWithoutTables(benchmark::State& state, Weights weights) {
  const NurbsSurface surface = Surface(weights);
  const Eigen::Matrix2Xd at = RandomParameters();
  for (auto _ : state) {
    for (const auto& uv : at.colwise()) benchmark::DoNotOptimize(surface.At(uv[0], uv[1]));
  }
  state.SetItemsProcessed(state.iterations() * at.cols());
}
BENCHMARK_CAPTURE(PointsWithoutTables, polynomial, Weights::kNone);
BENCHMARK_CAPTURE(PointsWithoutTables, tame, Weights::kTame);

void PointsOcctD0(benchmark::State& state, Weights weights) {
  const Handle(Geom_BSplineSurface) surface = Occt(Surface(weights));
  const Eigen::Matrix2Xd at = RandomParameters();
  gp_Pnt point;
  for (auto _ : state) {
    for (const auto& uv : at.colwise()) {
      surface->D0(uv[0], uv[1], point);
      benchmark::DoNotOptimize(point);
    }
  }
  state.SetItemsProcessed(state.iterations() * at.cols());
}
BENCHMARK_CAPTURE(PointsOcctD0, polynomial, Weights::kNone);
BENCHMARK_CAPTURE(PointsOcctD0, tame, Weights::kTame);

void SecondDerivatives(benchmark::State& state, Weights weights) {
  const SurfaceEvaluator evaluator(Surface(weights));
  const Eigen::Matrix2Xd at = RandomParameters();
  std::vector<SurfaceJet> jets;
  for (auto _ : state) {
    evaluator.Jets(at, jets);
    benchmark::DoNotOptimize(jets.data());
  }
  state.SetItemsProcessed(state.iterations() * at.cols());
}
BENCHMARK_CAPTURE(SecondDerivatives, polynomial, Weights::kNone);
BENCHMARK_CAPTURE(SecondDerivatives, tame, Weights::kTame);
BENCHMARK_CAPTURE(SecondDerivatives, wild, Weights::kWild);

void SecondDerivativesWithoutTables(benchmark::State& state, Weights weights) {
  const NurbsSurface surface = Surface(weights);
  const Eigen::Matrix2Xd at = RandomParameters();
  for (auto _ : state) {
    for (const auto& uv : at.colwise()) benchmark::DoNotOptimize(surface.JetAt(uv[0], uv[1]));
  }
  state.SetItemsProcessed(state.iterations() * at.cols());
}
BENCHMARK_CAPTURE(SecondDerivativesWithoutTables, polynomial, Weights::kNone);
BENCHMARK_CAPTURE(SecondDerivativesWithoutTables, tame, Weights::kTame);

void SecondDerivativesOcctD2(benchmark::State& state, Weights weights) {
  const Handle(Geom_BSplineSurface) surface = Occt(Surface(weights));
  const Eigen::Matrix2Xd at = RandomParameters();
  gp_Pnt point;
  gp_Vec du, dv, duu, dvv, duv;
  for (auto _ : state) {
    for (const auto& uv : at.colwise()) {
      surface->D2(uv[0], uv[1], point, du, dv, duu, dvv, duv);
      benchmark::DoNotOptimize(duv);
    }
  }
  state.SetItemsProcessed(state.iterations() * at.cols());
}
BENCHMARK_CAPTURE(SecondDerivativesOcctD2, polynomial, Weights::kNone);
BENCHMARK_CAPTURE(SecondDerivativesOcctD2, tame, Weights::kTame);

std::vector<double> GridLines() {
  std::vector<double> lines(1000);
  for (int i = 0; i < 1000; ++i) lines[static_cast<size_t>(i)] = i / 999.0;
  return lines;
}

void GridWithNormals(benchmark::State& state, Weights weights) {
  const SurfaceEvaluator evaluator(Surface(weights));
  const std::vector<double> lines = GridLines();
  SurfaceGrid grid;
  for (auto _ : state) {
    evaluator.Grid(lines, lines, grid);
    benchmark::DoNotOptimize(grid.normals.data());
  }
  state.SetItemsProcessed(state.iterations() * grid.points.cols());
}
BENCHMARK_CAPTURE(GridWithNormals, polynomial, Weights::kNone)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(GridWithNormals, tame, Weights::kTame)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(GridWithNormals, wild, Weights::kWild)->Unit(benchmark::kMillisecond);

void GridWithNormalsOcctD1(benchmark::State& state, Weights weights) {
  const Handle(Geom_BSplineSurface) surface = Occt(Surface(weights));
  const std::vector<double> lines = GridLines();
  std::vector<gp_Pnt> points(lines.size() * lines.size());
  std::vector<gp_Vec> normals(points.size());
  for (auto _ : state) {
    size_t k = 0;
    for (double u : lines) {
      for (double v : lines) {
        gp_Vec du, dv;
        surface->D1(u, v, points[k], du, dv);
        normals[k++] = du.Crossed(dv).Normalized();
      }
    }
    benchmark::DoNotOptimize(normals.data());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<long>(points.size()));
}
BENCHMARK_CAPTURE(GridWithNormalsOcctD1, polynomial, Weights::kNone)->Unit(benchmark::kMillisecond);

void CurveDerivatives(benchmark::State& state, bool rational) {
  const CurveEvaluator<3> evaluator(Curve(rational));
  RandomSplines random(2);
  std::vector<double> at(kParameters);
  for (double& u : at) u = random.Real(0, 1);
  Eigen::Matrix3Xd columns;
  for (auto _ : state) {
    evaluator.Derivatives(at, static_cast<int>(state.range(0)), columns);
    benchmark::DoNotOptimize(columns.data());
  }
  state.SetItemsProcessed(state.iterations() * kParameters);
}
BENCHMARK_CAPTURE(CurveDerivatives, polynomial, false)->DenseRange(0, 3);
BENCHMARK_CAPTURE(CurveDerivatives, rational, true)->DenseRange(0, 3);

void MakeTables(benchmark::State& state, Weights weights) {
  const NurbsSurface surface = Surface(weights);
  for (auto _ : state) benchmark::DoNotOptimize(SurfaceEvaluator(surface));
}
BENCHMARK_CAPTURE(MakeTables, polynomial, Weights::kNone)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(MakeTables, wild, Weights::kWild)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace batten::internal

BENCHMARK_MAIN();
