// SPDX-License-Identifier: MIT
#include "geometry/construction/curves_together.h"

#include <algorithm>
#include <utility>

#include "batten/geometry/reparameterize.h"
#include "geometry/construction/one_sided_curve.h"

namespace batten::internal {

CurvesTogether RetracedCubics(const std::vector<NurbsCurve<3>>& curves,
                              const RetracingFunction& retracing,
                              const std::vector<FunctionBreak>& breaks,
                              double tolerance,
                              const char* function) {
  std::vector<OneSidedCurve> pieces(curves.begin(), curves.end());
  const Eigen::Index rows = 3 * static_cast<Eigen::Index>(curves.size());
  CubicApproximation cubic = ApproximateByCubic(
      [&](double s, Side side) {
        ValueAndSlope all{Eigen::VectorXd(rows), Eigen::VectorXd(rows)};
        for (std::size_t k = 0; k < pieces.size(); ++k) {
          const Retracing place = retracing(k, s, side);
          const CurveJet<3> jet = pieces[k].JetAt(place.at, side);
          const Eigen::Index row = 3 * static_cast<Eigen::Index>(k);
          all.value.segment<3>(row) = jet.point;
          all.slope.segment<3>(row) = jet.first * place.pace;
        }
        return all;
      },
      breaks,
      [](const Eigen::VectorXd& difference) {
        return difference.reshaped(3, difference.size() / 3).colwise().norm().maxCoeff();
      },
      tolerance,
      function);
  CurvesTogether together{{}, cubic.error};
  for (Eigen::Index row = 0; row < rows; row += 3) {
    together.curves.emplace_back(cubic.basis, cubic.coefficients.middleRows<3>(row));
  }
  return together;
}

std::vector<FunctionBreak> MergedBreaks(std::vector<FunctionBreak> breaks) {
  constexpr double kApart = 1e-9;  // of the domain
  std::ranges::sort(breaks, {}, &FunctionBreak::at);
  const double lower = breaks.front().at, upper = breaks.back().at;
  std::vector<FunctionBreak> apart = {breaks.front()};
  for (const FunctionBreak& next : breaks) {
    if (next.at - apart.back().at > kApart * (upper - lower)) {
      apart.push_back(next);
    } else {
      apart.back().continuity = std::min(apart.back().continuity, next.continuity);
    }
  }
  apart.back().at = upper;
  return apart;
}

CurvesTogether AsCubics(const std::vector<NurbsCurve<3>>& curves,
                        double tolerance,
                        const char* function) {
  std::vector<FunctionBreak> breaks;
  std::vector<NurbsCurve<3>> scaled;
  for (const NurbsCurve<3>& curve : curves) {
    scaled.push_back(Reparameterized(curve, 0, 1));
    const std::vector<FunctionBreak> own = BreaksOf(scaled.back());
    breaks.insert(breaks.end(), own.begin(), own.end());
  }
  return RetracedCubics(
      scaled,
      [](std::size_t, double s, Side) {
        return Retracing{s, 1};
      },
      MergedBreaks(std::move(breaks)),
      tolerance,
      function);
}

}  // namespace batten::internal
