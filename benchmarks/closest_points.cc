// SPDX-License-Identifier: MIT
// Closest points, one thread, with OpenCASCADE's beside them in the same run.
#include <benchmark/benchmark.h>

#include <Eigen/Geometry>
#include <Extrema_GenLocateExtPS.hxx>
#include <GeomAPI_ProjectPointOnCurve.hxx>
#include <GeomAPI_ProjectPointOnSurf.hxx>
#include <GeomAdaptor_Surface.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <algorithm>
#include <cmath>
#include <random>

#include "batten/geometry/foot_point.h"
#include "occt_surface.h"

namespace batten::internal {
namespace {

constexpr int kNet = 24, kQueries = 4096;
constexpr double kNoise = 1e-3;

enum Place { kNear, kMedium, kFar };

// A wavy sheet about one unit wide.
NurbsSurface Sheet(bool rational) {
  const SplineBasis basis = SplineBasis::Uniform(3, kNet, 0, 1);
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> uniform(-0.5, 0.5);
  Eigen::Matrix3Xd points(3, kNet * kNet);
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(points.cols());
  for (int i = 0; i < kNet; ++i) {
    for (int j = 0; j < kNet; ++j) {
      const double x = basis.Greville(i), y = basis.Greville(j);
      points.col(i * kNet + j) << x, y, 0.3 * std::sin(5 * x) * std::cos(4 * y) + 0.1 * x * x;
      if (rational) weights[i * kNet + j] = std::exp(uniform(generator));
    }
  }
  return NurbsSurface(basis, basis, points, weights);
}

struct Queries {
  Eigen::Matrix3Xd points{3, kQueries};
  Eigen::Matrix2Xd starts{2, kQueries};
};

Queries QueriesAbout(const NurbsSurface& surface, Place place) {
  std::mt19937 generator(2);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> normal;
  Queries queries;
  for (int k = 0; k < kQueries; ++k) {
    const double u = uniform(generator), v = uniform(generator);
    const SurfaceJet jet = surface.JetAt(u, v);
    const Eigen::Vector3d direction =
        Eigen::Vector3d(normal(generator), normal(generator), normal(generator)).normalized();
    switch (place) {
      case kNear:
        queries.points.col(k) =
            jet.point + kNoise * normal(generator) * jet.du.cross(jet.dv).normalized();
        break;
      case kMedium:
        queries.points.col(k) = jet.point + 0.3 * direction;
        break;
      case kFar:
        queries.points.col(k) = jet.point + 10 * direction;
    }
    queries.starts.col(k) << std::clamp(u + 0.005 * normal(generator), 0.0, 1.0),
        std::clamp(v + 0.005 * normal(generator), 0.0, 1.0);
  }
  return queries;
}

void Global(benchmark::State& state, bool rational, Place place) {
  const NurbsSurface surface = Sheet(rational);
  const SurfaceFootPoints finder(surface);
  const Queries queries = QueriesAbout(surface, place);
  for (auto _ : state) {
    for (int k = 0; k < kQueries; ++k) {
      benchmark::DoNotOptimize(finder.Nearest(queries.points.col(k)));
    }
  }
  state.SetItemsProcessed(state.iterations() * kQueries);
}
BENCHMARK_CAPTURE(Global, near, false, kNear);
BENCHMARK_CAPTURE(Global, near_rational, true, kNear);
BENCHMARK_CAPTURE(Global, medium, false, kMedium);
BENCHMARK_CAPTURE(Global, medium_rational, true, kMedium);
BENCHMARK_CAPTURE(Global, far, false, kFar);
BENCHMARK_CAPTURE(Global, far_rational, true, kFar);

void GlobalOpenCascade(benchmark::State& state, Place place) {
  const NurbsSurface surface = Sheet(false);
  const auto peer = ToOpenCascade(surface);
  const Queries queries = QueriesAbout(surface, place);
  constexpr int kFew = 256;
  GeomAPI_ProjectPointOnSurf projector;
  projector.Init(peer, 0, 1, 0, 1, 1e-9, Extrema_ExtAlgo_Tree);
  for (auto _ : state) {
    for (int k = 0; k < kFew; ++k) {
      const auto q = queries.points.col(k);
      projector.Perform(gp_Pnt(q.x(), q.y(), q.z()));
      double distance = projector.NbPoints() > 0 ? projector.LowerDistance() : 0;
      benchmark::DoNotOptimize(distance);
    }
  }
  state.SetItemsProcessed(state.iterations() * kFew);
}
BENCHMARK_CAPTURE(GlobalOpenCascade, near, kNear);
BENCHMARK_CAPTURE(GlobalOpenCascade, medium, kMedium);

void WarmStart(benchmark::State& state, bool rational) {
  const NurbsSurface surface = Sheet(rational);
  const SurfaceFootPoints finder(surface);
  const Queries queries = QueriesAbout(surface, kNear);
  for (auto _ : state) {
    for (int k = 0; k < kQueries; ++k) {
      benchmark::DoNotOptimize(
          finder.Near(queries.points.col(k), queries.starts(0, k), queries.starts(1, k)));
    }
  }
  state.SetItemsProcessed(state.iterations() * kQueries);
}
BENCHMARK_CAPTURE(WarmStart, plain, false);
BENCHMARK_CAPTURE(WarmStart, rational, true);

void WarmStartOpenCascade(benchmark::State& state) {
  const NurbsSurface surface = Sheet(false);
  const GeomAdaptor_Surface peer(ToOpenCascade(surface));
  const Queries queries = QueriesAbout(surface, kNear);
  Extrema_GenLocateExtPS locate(peer, 1e-9, 1e-9);
  for (auto _ : state) {
    for (int k = 0; k < kQueries; ++k) {
      const auto q = queries.points.col(k);
      locate.Perform(gp_Pnt(q.x(), q.y(), q.z()), queries.starts(0, k), queries.starts(1, k));
      double distance = locate.IsDone() ? locate.SquareDistance() : 0;
      benchmark::DoNotOptimize(distance);
    }
  }
  state.SetItemsProcessed(state.iterations() * kQueries);
}
BENCHMARK(WarmStartOpenCascade);

constexpr int kCurveNet = 53;  // 50 spans

NurbsCurve<3> Wire(bool rational) {
  const SplineBasis basis = SplineBasis::Uniform(3, kCurveNet, 0, 1);
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> uniform(-0.5, 0.5);
  Eigen::Matrix3Xd points(3, kCurveNet);
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(kCurveNet);
  for (int i = 0; i < kCurveNet; ++i) {
    const double t = 6 * basis.Greville(i);
    points.col(i) << std::cos(t), std::sin(1.7 * t), 0.2 * t;
    if (rational) weights[i] = std::exp(uniform(generator));
  }
  return NurbsCurve<3>(basis, points, weights);
}

Eigen::Matrix3Xd CurveQueries() {
  std::mt19937 generator(4);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Eigen::Matrix3Xd points(3, kQueries);
  for (double& x : points.reshaped()) x = uniform(generator);
  points.row(2).array() = 0.6 * (points.row(2).array() + 1);
  return points;
}

void GlobalOnCurve(benchmark::State& state, bool rational) {
  const CurveFootPoints<3> finder(Wire(rational));
  const Eigen::Matrix3Xd queries = CurveQueries();
  for (auto _ : state) {
    for (int k = 0; k < kQueries; ++k) benchmark::DoNotOptimize(finder.Nearest(queries.col(k)));
  }
  state.SetItemsProcessed(state.iterations() * kQueries);
}
BENCHMARK_CAPTURE(GlobalOnCurve, plain, false);
BENCHMARK_CAPTURE(GlobalOnCurve, rational, true);

void GlobalOnCurveOpenCascade(benchmark::State& state) {
  const NurbsCurve<3> wire = Wire(false);
  TColgp_Array1OfPnt poles(1, kCurveNet);
  for (int i = 0; i < kCurveNet; ++i) {
    const Eigen::Vector3d p = wire.control_points().col(i);
    poles(i + 1) = gp_Pnt(p.x(), p.y(), p.z());
  }
  const int distinct = kCurveNet - 2;
  TColStd_Array1OfReal knots(1, distinct);
  TColStd_Array1OfInteger multiplicities(1, distinct);
  for (int k = 1; k <= distinct; ++k) {
    knots(k) = wire.basis().knots()[k + 2];
    multiplicities(k) = k == 1 || k == distinct ? 4 : 1;
  }
  const Handle(Geom_BSplineCurve) peer = new Geom_BSplineCurve(poles, knots, multiplicities, 3);
  const Eigen::Matrix3Xd queries = CurveQueries();
  constexpr int kFew = 256;
  GeomAPI_ProjectPointOnCurve projector;
  projector.Init(peer, 0, 1);
  for (auto _ : state) {
    for (int k = 0; k < kFew; ++k) {
      const auto q = queries.col(k);
      projector.Perform(gp_Pnt(q.x(), q.y(), q.z()));
      double distance = projector.NbPoints() > 0 ? projector.LowerDistance() : 0;
      benchmark::DoNotOptimize(distance);
    }
  }
  state.SetItemsProcessed(state.iterations() * kFew);
}
BENCHMARK(GlobalOnCurveOpenCascade);

}  // namespace
}  // namespace batten::internal

BENCHMARK_MAIN();
