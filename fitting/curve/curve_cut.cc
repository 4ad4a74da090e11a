// SPDX-License-Identifier: MIT
#include "fitting/curve/curve_cut.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "batten/geometry/knot_vectors.h"
#include "batten/geometry/split.h"

namespace batten::internal {
namespace {

constexpr double kMostCut = 0.9;  // share of an end span: a longer cut is not made

}  // namespace

template <int Dim>
std::optional<CutCurve<Dim>> CutToData(const NurbsCurve<Dim>& curve, const FittingData& data) {
  const SplineBasis& basis = curve.basis();
  Eigen::Matrix2Xd parameters = data.parameters;
  if (basis.periodic()) return CutCurve<Dim>{curve, std::move(parameters)};
  double first = basis.upper(), last = basis.lower();
  for (Eigen::Index k = 0; k < parameters.cols(); ++k) {
    if (data.weights.size() > 0 && data.weights[k] == 0) continue;
    first = std::min(first, parameters(0, k));
    last = std::max(last, parameters(0, k));
  }
  if (first <= basis.lower() && last >= basis.upper())
    return CutCurve<Dim>{curve, std::move(parameters)};
  const std::vector<int> spans = basis.Spans();
  const auto inside = [&](int span, double share) {
    const double low = basis.knots()[static_cast<size_t>(span)],
                 high = basis.knots()[static_cast<size_t>(span) + 1];
    return low + share * (high - low);
  };
  if (first > inside(spans.front(), kMostCut) || last < inside(spans.back(), 1 - kMostCut) ||
      !(first < last))
    return std::nullopt;
  NurbsCurve<Dim> cut = curve;
  if (first > basis.lower()) cut = Split(cut, first).second;
  if (last < basis.upper()) cut = Split(cut, last).first;
  const double length = basis.upper() - basis.lower();
  parameters.row(0) =
      (basis.lower() + (parameters.row(0).array() - first) * (length / (last - first)))
          .max(basis.lower())
          .min(basis.upper());
  return CutCurve<Dim>{
      NurbsCurve<Dim>(
          Scaled(cut.basis(), basis.lower(), basis.upper()), cut.control_points(), cut.weights()),
      std::move(parameters)};
}

template std::optional<CutCurve<2>> CutToData<2>(const NurbsCurve<2>&, const FittingData&);
template std::optional<CutCurve<3>> CutToData<3>(const NurbsCurve<3>&, const FittingData&);

}  // namespace batten::internal
