// SPDX-License-Identifier: MIT
#include "fitting/core/box_excursion.h"

#include <vector>

#include "batten/geometry/curve_evaluator.h"
#include "batten/geometry/surface_evaluator.h"
#include "geometry/numeric/number_text.h"
#include "geometry/nurbs/span_breaks.h"

namespace batten::internal {
namespace {

constexpr int kOfCurve = 32, kOfSurface = 8;  // samples of a span
constexpr double kLeaves = 0.5;               // diagonals

// The place farthest from a box.
template <int Dim>
struct Farthest {
  using Point = Eigen::Matrix<double, Dim, 1>;
  const Eigen::AlignedBox<double, Dim>& box;
  Point place = Point::Zero();
  double off = 0;

  void See(const Point& p) {
    const double now = (box.min() - p).cwiseMax(p - box.max()).cwiseMax(0).stableNorm();
    if (!(now > off)) return;
    off = now;
    place = p;
  }

  double Diagonal() const { return box.diagonal().stableNorm(); }

  void Enter(const Eigen::Vector3d& origin, FitReport& report) const {
    if (!(off > kLeaves * Diagonal())) return;
    OvershootSummary& overshoot = report.overshoot ? *report.overshoot : report.overshoot.emplace();
    overshoot.max = off;
    overshoot.of_box = off / Diagonal();
    overshoot.in_spacings = report.input.spacing > 0 ? off / report.input.spacing : 0;
    overshoot.at = origin;
    overshoot.at.head<Dim>() += place;
  }
};

}  // namespace

template <int Dim>
void EnterExcursion(const NurbsCurve<Dim>& curve,
                    const Eigen::AlignedBox<double, Dim>& box,
                    const Eigen::Vector3d& origin,
                    FitReport& report) {
  if (box.isEmpty()) return;
  const CurveEvaluator<Dim> evaluator(curve);
  Farthest<Dim> farthest{box};
  for (const double u : BreaksIn(curve.basis(), kOfCurve)) farthest.See(evaluator.At(u));
  farthest.Enter(origin, report);
}

void EnterExcursion(const NurbsSurface& surface,
                    const Eigen::AlignedBox3d& box,
                    const Eigen::Vector3d& origin,
                    FitReport& report) {
  if (box.isEmpty()) return;
  Farthest<3> hull{box}, farthest{box};
  for (const auto& point : surface.control_points().colwise()) hull.See(point);
  if (!(hull.off > kLeaves * hull.Diagonal())) return;
  const SurfaceEvaluator evaluator(surface);
  const std::vector<double> vs = BreaksIn(surface.basis_v(), kOfSurface);
  for (const double u : BreaksIn(surface.basis_u(), kOfSurface))
    for (const double v : vs) farthest.See(evaluator.At(u, v));
  farthest.Enter(origin, report);
}

void WarnOfExcursion(FitReport& report) {
  if (!report.leaves_points()) return;
  const Eigen::Vector3d& at = report.overshoot->at;
  report.warnings.push_back(report.end.words + ": near (" + RoundedText(at[0]) + ", " +
                            RoundedText(at[1]) + ", " + RoundedText(at[2]) + ")");
}

template void EnterExcursion<2>(const NurbsCurve<2>&,
                                const Eigen::AlignedBox2d&,
                                const Eigen::Vector3d&,
                                FitReport&);
template void EnterExcursion<3>(const NurbsCurve<3>&,
                                const Eigen::AlignedBox3d&,
                                const Eigen::Vector3d&,
                                FitReport&);

}  // namespace batten::internal
