// SPDX-License-Identifier: MIT
// Branches of two 24 × 24 bicubics, one thread, with OpenCASCADE's beside them in the same run:
// seconds (the least of three), branches, their length, and how far they are from both surfaces.
#include <Eigen/Geometry>
#include <GeomAPI_IntSS.hxx>
#include <Geom_Curve.hxx>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <random>
#include <string>
#include <vector>

#include "batten/geometry/arc_length.h"
#include "batten/geometry/foot_point.h"
#include "batten/geometry/intersect_surfaces.h"
#include "occt_surface.h"

namespace batten::internal {
namespace {

constexpr int kNet = 24, kTurns = 3, kPlaces = 2000;

// A sheet one unit wide with waves and random bumps.
NurbsSurface Sheet(unsigned seed, double waves, double bumps, double phase) {
  const SplineBasis basis = SplineBasis::Uniform(3, kNet, 0, 1);
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(-bumps, bumps);
  Eigen::Matrix3Xd points(3, kNet * kNet);
  for (int i = 0; i < kNet; ++i) {
    for (int j = 0; j < kNet; ++j) {
      const double x = basis.Greville(i), y = basis.Greville(j);
      points.col(i * kNet + j) << x, y,
          waves * std::sin(5 * x + phase) * std::cos(4 * y) + uniform(generator);
    }
  }
  return NurbsSurface(basis, basis, points);
}

NurbsSurface Tilted(const NurbsSurface& surface, double angle) {
  const Eigen::Vector3d middle(0.5, 0.5, 0);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(angle, Eigen::Vector3d(1, 0.1, 0.2).normalized()).toRotationMatrix();
  return NurbsSurface(surface.basis_u(),
                      surface.basis_v(),
                      (turn * (surface.control_points().colwise() - middle)).colwise() + middle);
}

struct Measured {
  double seconds = 1e300, length = 0, deviation = 0;
  int branches = 0;
};

double SecondsOf(const auto& work) {
  double least = 1e300;
  for (int k = 0; k < kTurns; ++k) {
    const std::clock_t start = std::clock();
    work();
    least = std::min(least, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
  return least;
}

// Of points of the curves, from the farther surface, by certified foot points.
class Judge {
 public:
  Judge(const NurbsSurface& a, const NurbsSurface& b) : a_(a), b_(b) {}
  double Distance(const Eigen::Vector3d& x) const {
    return std::max(a_.Nearest(x).distance, b_.Nearest(x).distance);
  }

 private:
  SurfaceFootPoints a_, b_;
};

Measured Batten(const NurbsSurface& a, const NurbsSurface& b, double tolerance, const Judge& judge) {
  SurfaceIntersection met;
  Measured measured;
  measured.seconds = SecondsOf([&] { met = IntersectSurfaces(a, b, {.tolerance = tolerance}); });
  measured.branches = static_cast<int>(met.branches.size());
  for (const SurfaceBranch& branch : met.branches) {
    measured.length += ArcLength(branch.curve);
    const double from = branch.curve.basis().lower(), to = branch.curve.basis().upper();
    for (int k = 0; k <= kPlaces; ++k) {
      measured.deviation =
          std::max(measured.deviation, judge.Distance(branch.curve.At(from + k * (to - from) / kPlaces)));
    }
  }
  return measured;
}

Measured OpenCascade(const NurbsSurface& a,
                     const NurbsSurface& b,
                     double tolerance,
                     const Judge& judge) {
  const Handle(Geom_BSplineSurface) first = ToOpenCascade(a), second = ToOpenCascade(b);
  GeomAPI_IntSS met;
  Measured measured;
  measured.seconds = SecondsOf([&] { met.Perform(first, second, tolerance); });
  if (!met.IsDone()) return measured;
  measured.branches = met.NbLines();
  for (int line = 1; line <= met.NbLines(); ++line) {
    const Handle(Geom_Curve) curve = met.Line(line);
    Eigen::Vector3d last;
    for (int k = 0; k <= kPlaces; ++k) {
      const double t = curve->FirstParameter() +
                       k * (curve->LastParameter() - curve->FirstParameter()) / kPlaces;
      const gp_Pnt p = curve->Value(t);
      const Eigen::Vector3d x(p.X(), p.Y(), p.Z());
      measured.deviation = std::max(measured.deviation, judge.Distance(x));
      if (k > 0) measured.length += (x - last).norm();
      last = x;
    }
  }
  return measured;
}

void Row(const std::string& name, const NurbsSurface& a, const NurbsSurface& b) {
  constexpr double kTolerance = 1e-6;
  const Judge judge(a, b);
  const Measured ours = Batten(a, b, kTolerance, judge);
  const Measured theirs = OpenCascade(a, b, kTolerance, judge);
  std::printf("| %s | %.3f | %d | %.5f | %.1e | %.3f | %d | %.5f | %.1e | %.1f |\n",
              name.c_str(),
              ours.seconds,
              ours.branches,
              ours.length,
              ours.deviation,
              theirs.seconds,
              theirs.branches,
              theirs.length,
              theirs.deviation,
              theirs.seconds / ours.seconds);
  std::fflush(stdout);
}

}  // namespace
}  // namespace batten::internal

int main() {
  using namespace batten::internal;
  std::printf("| surfaces | batten s | branches | length | off | OpenCASCADE s | branches | length | "
              "off | time ratio |\n|---|---|---|---|---|---|---|---|---|---|\n");
  Row("waves across", Sheet(1, 0.1, 0, 0), Tilted(Sheet(2, 0.1, 0, 1), 1.2));
  Row("waves over waves", Sheet(1, 0.1, 0, 0), Sheet(2, 0.1, 0, 1));
  Row("bumps across", Sheet(1, 0.1, 0.03, 0), Tilted(Sheet(2, 0.1, 0.03, 1), 1.2));
  Row("small bumps over one another", Sheet(1, 0.1, 0.005, 0), Sheet(2, 0.1, 0.005, 1));
  return 0;
}
