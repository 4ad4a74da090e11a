// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <vector>

#include "batten/geometry/foot_point.h"
#include "batten/geometry/join.h"
#include "batten/geometry/offset_curve.h"
#include "batten/geometry/split.h"

namespace batten {

template <int Dim>
std::vector<NurbsCurve<Dim>> WithoutLoops(const CurveOffset<Dim>& offset,
                                          const NurbsCurve<Dim>& curve,
                                          double distance,
                                          const OffsetOptions& options) {
  const NurbsCurve<Dim>& whole = offset.curve;
  const auto& points = curve.control_points();
  constexpr double kOfTheSize = 1e-6;
  const double tolerance = options.tolerance.value_or(
      kOfTheSize * (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm());
  std::vector<double> cuts{whole.basis().lower(), whole.basis().upper()};
  for (const CurveSelfMeeting<Dim>& one : offset.self_meetings) {
    cuts.push_back(one.first);
    cuts.push_back(one.second);
  }
  std::sort(cuts.begin(), cuts.end());
  const CurveFootPoints<Dim> feet(curve);
  // At places between its ends, where loops are nearer than the distance.
  const auto clear = [&](double from, double to) {
    constexpr int kPlaces = 9;
    for (int k = 1; k <= kPlaces; ++k) {
      Eigen::Vector3d place = Eigen::Vector3d::Zero();
      place.template head<Dim>() = whole.At(from + (to - from) * k / (kPlaces + 1));
      if (feet.Nearest(place).distance < std::abs(distance) - 4 * tolerance) return false;
    }
    return true;
  };
  const double least = 1e-9 * (cuts.back() - cuts.front());
  std::vector<NurbsCurve<Dim>> kept;
  const auto meets = [&](const NurbsCurve<Dim>& a, const NurbsCurve<Dim>& b) {
    return (a.At(a.basis().upper()) - b.At(b.basis().lower())).norm() <= 8 * tolerance;
  };
  for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
    if (cuts[k + 1] - cuts[k] <= least || !clear(cuts[k], cuts[k + 1])) continue;
    NurbsCurve<Dim> part = Segment(whole, cuts[k], cuts[k + 1]);
    if (!kept.empty() && meets(kept.back(), part)) {
      kept.back() = Join(kept.back(), part, 8 * tolerance);
    } else {
      kept.push_back(std::move(part));
    }
  }
  if (kept.size() > 1 && meets(kept.back(), kept.front())) {
    kept.front() = Join(kept.back(), kept.front(), 8 * tolerance);
    kept.pop_back();
  }
  return kept;
}

template std::vector<NurbsCurve<2>> WithoutLoops(const CurveOffset<2>&,
                                                 const NurbsCurve<2>&,
                                                 double,
                                                 const OffsetOptions&);
template std::vector<NurbsCurve<3>> WithoutLoops(const CurveOffset<3>&,
                                                 const NurbsCurve<3>&,
                                                 double,
                                                 const OffsetOptions&);

}  // namespace batten
