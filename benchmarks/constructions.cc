// SPDX-License-Identifier: MIT
// Surfaces by construction, one thread, with OpenCASCADE's own beside them in the same run. The
// counter `deviation` is the largest distance found of the surface from what it is to contain.
#include <benchmark/benchmark.h>

#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepOffsetAPI_ThruSections.hxx>
#include <BRep_Tool.hxx>
#include <GeomFill_BSplineCurves.hxx>
#include <GeomFill_Pipe.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "batten/geometry/composition.h"
#include "batten/geometry/coons_surface.h"
#include "batten/geometry/foot_point.h"
#include "batten/geometry/gordon_surface.h"
#include "batten/geometry/iso_curve.h"
#include "batten/geometry/lofted_surface.h"
#include "batten/geometry/make_curve.h"
#include "batten/geometry/swept_surface.h"

namespace batten::internal {
namespace {

using Curves = std::vector<NurbsCurve<3>>;

Handle(Geom_BSplineCurve) Peer(const NurbsCurve<3>& curve) {
  const SplineBasis& basis = curve.basis();
  TColgp_Array1OfPnt poles(1, basis.size());
  TColStd_Array1OfReal weights(1, basis.size());
  for (int i = 0; i < basis.size(); ++i) {
    const Eigen::Vector3d p = curve.control_points().col(i);
    poles(i + 1) = gp_Pnt(p.x(), p.y(), p.z());
    weights(i + 1) = curve.weights()[i];
  }
  std::vector<double> values = basis.knots();
  values.erase(std::unique(values.begin(), values.end()), values.end());
  const int distinct = static_cast<int>(values.size());
  TColStd_Array1OfReal knots(1, distinct);
  TColStd_Array1OfInteger multiplicities(1, distinct);
  for (int k = 0; k < distinct; ++k) {
    knots(k + 1) = values[k];
    multiplicities(k + 1) = basis.Multiplicity(values[k]);
  }
  return new Geom_BSplineCurve(poles, weights, knots, multiplicities, basis.degree());
}

NurbsSurface FromPeer(const Handle(Geom_Surface) & surface) {
  const Handle(Geom_BSplineSurface) peer = Handle(Geom_BSplineSurface)::DownCast(surface);
  peer->SetUNotPeriodic();
  peer->SetVNotPeriodic();
  const auto basis = [](int degree, const TColStd_Array1OfReal& knots) {
    return SplineBasis(degree, std::vector<double>(knots.begin(), knots.end()));
  };
  const int m = peer->NbUPoles(), n = peer->NbVPoles();
  Eigen::Matrix3Xd points(3, m * n);
  Eigen::VectorXd weights(m * n);
  for (int i = 0; i < m; ++i) {
    for (int j = 0; j < n; ++j) {
      const gp_Pnt p = peer->Pole(i + 1, j + 1);
      points.col(i * n + j) << p.X(), p.Y(), p.Z();
      weights[i * n + j] = peer->Weight(i + 1, j + 1);
    }
  }
  return NurbsSurface(basis(peer->UDegree(), peer->UKnotSequence()),
                      basis(peer->VDegree(), peer->VKnotSequence()),
                      std::move(points),
                      std::move(weights));
}

double FarthestFrom(const NurbsSurface& surface, const Curves& curves) {
  constexpr int kPlaces = 100;
  const SurfaceFootPoints feet(surface);
  double worst = 0;
  for (const NurbsCurve<3>& curve : curves) {
    const double lower = curve.basis().lower(), upper = curve.basis().upper();
    for (int k = 0; k <= kPlaces; ++k) {
      const Eigen::Vector3d p = curve.At(lower + (upper - lower) * k / kPlaces);
      worst = std::max(worst, feet.Nearest(p).distance);
    }
  }
  return worst;
}

// Wavy sections of `size` control points, one a unit above the other, about twenty wide.
Curves Sections(int count, int size) {
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> uniform(-0.02, 0.02);
  const SplineBasis basis = SplineBasis::Uniform(3, size, 0, 1);
  Curves sections;
  for (int k = 0; k < count; ++k) {
    Eigen::Matrix3Xd points(3, size);
    for (int i = 0; i < size; ++i) {
      const double x = 20 * basis.Greville(i);
      points.col(i) << x, std::sin(x + 0.1 * k) + uniform(generator), k;
    }
    sections.emplace_back(basis, points);
  }
  return sections;
}

void Loft50(benchmark::State& state) {
  const Curves sections = Sections(50, 100);
  for (auto _ : state) benchmark::DoNotOptimize(Loft(sections));
  const LoftedSurface loft = Loft(sections);
  state.counters["deviation"] = FarthestFrom(loft.surface, sections);
  state.counters["control_points"] = loft.surface.size_u() * loft.surface.size_v();
}
BENCHMARK(Loft50)->Unit(benchmark::kMillisecond);

Handle(Geom_Surface) ThruSections(const Curves& sections) {
  BRepOffsetAPI_ThruSections maker(false, false, 1e-6);
  maker.CheckCompatibility(false);
  for (const NurbsCurve<3>& section : sections) {
    maker.AddWire(BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(Peer(section)).Edge()).Wire());
  }
  maker.Build();
  return BRep_Tool::Surface(TopoDS::Face(TopExp_Explorer(maker.Shape(), TopAbs_FACE).Current()));
}

void Loft50OpenCascade(benchmark::State& state) {
  const Curves sections = Sections(50, 100);
  for (auto _ : state) benchmark::DoNotOptimize(ThruSections(sections));
  const NurbsSurface loft = FromPeer(ThruSections(sections));
  state.counters["deviation"] = FarthestFrom(loft, sections);
  state.counters["control_points"] = loft.size_u() * loft.size_v();
}
BENCHMARK(Loft50OpenCascade)->Unit(benchmark::kMillisecond);

// A wavy sheet of 24 × 24 control points and its iso-curves.
NurbsSurface Sheet() {
  constexpr int kNet = 24;
  const SplineBasis basis = SplineBasis::Uniform(3, kNet, 0, 1);
  Eigen::Matrix3Xd points(3, kNet * kNet);
  for (int i = 0; i < kNet; ++i) {
    for (int j = 0; j < kNet; ++j) {
      const double x = basis.Greville(i), y = basis.Greville(j);
      points.col(i * kNet + j) << 10 * x, 10 * y, std::sin(5 * x) * std::cos(4 * y) + x * x;
    }
  }
  return NurbsSurface(basis, basis, points);
}

struct Network {
  Curves u, v;

  Curves All() const {
    Curves all = u;
    all.insert(all.end(), v.begin(), v.end());
    return all;
  }
};

// With `paces`, every curve passes the others at parameters of its own: retraced by a quadratic.
Network NetworkOf(int count, bool paces) {
  const NurbsSurface sheet = Sheet();
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> uniform(0.3, 0.7);
  const auto traced = [&](const NurbsCurve<3>& curve) {
    const ScalarSpline map{SplineBasis::Uniform(2, 3, 0, 1),
                           Eigen::Vector3d(0, uniform(generator), 1)};
    return paces ? Composed(curve, map) : curve;
  };
  Network network;
  for (int k = 0; k < count; ++k) {
    const double at = k / (count - 1.0);
    network.u.push_back(traced(IsoCurve(sheet, Direction::kV, at)));
    network.v.push_back(traced(IsoCurve(sheet, Direction::kU, at)));
  }
  return network;
}

void Gordon20(benchmark::State& state, bool paces) {
  const Network network = NetworkOf(20, paces);
  const GordonOptions options{.tolerance = 1e-4};
  for (auto _ : state) benchmark::DoNotOptimize(Gordon(network.u, network.v, options));
  const GordonSurface gordon = Gordon(network.u, network.v, options);
  state.counters["deviation"] = FarthestFrom(gordon.surface, network.All());
  state.counters["control_points"] = gordon.surface.size_u() * gordon.surface.size_v();
}
BENCHMARK_CAPTURE(Gordon20, common_parameters, false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Gordon20, paces_of_their_own, true)->Unit(benchmark::kMillisecond);

NurbsCurve<3> Path() {
  constexpr int kSize = 30;
  const SplineBasis basis = SplineBasis::Uniform(3, kSize, 0, 1);
  Eigen::Matrix3Xd points(3, kSize);
  for (int i = 0; i < kSize; ++i) {
    const double t = basis.Greville(i);
    points.col(i) << 10 * std::cos(9 * t), 10 * std::sin(9 * t), 20 * t + 2 * std::sin(12 * t);
  }
  return NurbsCurve<3>(basis, points);
}

// A pipe is as far from its path as its radius, whatever frame carries it.
double PipeDeviation(const NurbsSurface& pipe, const NurbsCurve<3>& path, double radius) {
  constexpr int kPlaces = 60;
  const CurveFootPoints<3> feet(path);
  double worst = 0;
  for (int i = 0; i <= kPlaces; ++i) {
    for (int j = 1; j < kPlaces; ++j) {
      const double s = double(i) / kPlaces, t = double(j) / kPlaces;
      const Eigen::Vector3d p =
          pipe.At(pipe.basis_u().lower() + s * (pipe.basis_u().upper() - pipe.basis_u().lower()),
                  pipe.basis_v().lower() + t * (pipe.basis_v().upper() - pipe.basis_v().lower()));
      worst = std::max(worst, std::abs(feet.Nearest(p).distance - radius));
    }
  }
  return worst;
}

constexpr double kPipeTolerance = 1e-4;

void SweepPipe(benchmark::State& state) {
  const NurbsCurve<3> path = Path();
  const NurbsCurve<3> profile = MakeArc(Frame(path.At(0), path.JetAt(0).first), 1);
  const SweepOptions options{.tolerance = kPipeTolerance};
  for (auto _ : state) benchmark::DoNotOptimize(Sweep(profile, path, options));
  const NurbsSurface pipe = Sweep(profile, path, options).surface;
  state.counters["deviation"] = PipeDeviation(pipe, path, 1);
  state.counters["control_points"] = pipe.size_u() * pipe.size_v();
}
BENCHMARK(SweepPipe)->Unit(benchmark::kMillisecond);

Handle(Geom_Surface) OpenCascadePipe(const NurbsCurve<3>& path, const NurbsCurve<3>& profile) {
  GeomFill_Pipe pipe(Peer(path), Peer(profile), GeomFill_IsCorrectedFrenet);
  pipe.Perform(kPipeTolerance, true, GeomAbs_C2, 14, 400);
  return pipe.Surface();
}

void SweepPipeOpenCascade(benchmark::State& state) {
  const NurbsCurve<3> path = Path();
  const NurbsCurve<3> profile = MakeArc(Frame(path.At(0), path.JetAt(0).first), 1);
  for (auto _ : state) benchmark::DoNotOptimize(OpenCascadePipe(path, profile));
  const NurbsSurface pipe = FromPeer(OpenCascadePipe(path, profile));
  state.counters["deviation"] = PipeDeviation(pipe, path, 1);
  state.counters["control_points"] = pipe.size_u() * pipe.size_v();
}
BENCHMARK(SweepPipeOpenCascade)->Unit(benchmark::kMillisecond);

Curves Sides() {
  const NurbsSurface sheet = Sheet();
  return {IsoCurve(sheet, Direction::kV, 0),
          IsoCurve(sheet, Direction::kU, 1),
          IsoCurve(sheet, Direction::kV, 1),
          IsoCurve(sheet, Direction::kU, 0)};
}

void CoonsBilinear(benchmark::State& state) {
  const Curves sides = Sides();
  const CoonsOptions options{.tolerance = 1e-6};
  for (auto _ : state) benchmark::DoNotOptimize(Coons(sides, options));
  state.counters["deviation"] = FarthestFrom(Coons(sides, options).surface, sides);
}
BENCHMARK(CoonsBilinear)->Unit(benchmark::kMicrosecond);

void CoonsOpenCascade(benchmark::State& state) {
  const Curves sides = Sides();
  const auto filled = [&] {
    return GeomFill_BSplineCurves(
               Peer(sides[0]), Peer(sides[1]), Peer(sides[2]), Peer(sides[3]), GeomFill_CoonsStyle)
        .Surface();
  };
  for (auto _ : state) benchmark::DoNotOptimize(filled());
  state.counters["deviation"] = FarthestFrom(FromPeer(filled()), sides);
}
BENCHMARK(CoonsOpenCascade)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace batten::internal

BENCHMARK_MAIN();
