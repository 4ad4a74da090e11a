// SPDX-License-Identifier: MIT
#include "fitting/core/curve_excursion.h"

#include "batten/geometry/curve_evaluator.h"
#include "geometry/numeric/number_text.h"

namespace batten::internal {
namespace {

constexpr int kSamples = 32;  // of a span

}  // namespace

template <int Dim>
void EnterExcursion(const NurbsCurve<Dim>& curve,
                    const Eigen::AlignedBox<double, Dim>& box,
                    const Eigen::Vector3d& origin,
                    FitReport& report) {
  using Point = Eigen::Matrix<double, Dim, 1>;
  if (box.isEmpty()) return;
  const CurveEvaluator<Dim> evaluator(curve);
  Point farthest = Point::Zero();
  double most = 0;
  for (const int span : curve.basis().Spans()) {
    const double begin = curve.basis().knots()[static_cast<size_t>(span)],
                 end = curve.basis().knots()[static_cast<size_t>(span) + 1];
    for (int s = 0; s <= kSamples; ++s) {
      const Point place = evaluator.At(begin + (end - begin) * s / kSamples);
      const double off = (box.min() - place).cwiseMax(place - box.max()).cwiseMax(0).stableNorm();
      if (!(off > most)) continue;
      most = off;
      farthest = place;
    }
  }
  OvershootSummary overshoot;
  overshoot.max = most;
  overshoot.of_box = most > 0 ? most / box.diagonal().stableNorm() : 0;
  overshoot.in_spacings = report.input.spacing > 0 ? most / report.input.spacing : 0;
  overshoot.at = origin;
  overshoot.at.head<Dim>() += farthest;
  report.overshoot = overshoot;
  if (!report.leaves_points()) report.overshoot.reset();
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
