// SPDX-License-Identifier: MIT
// Trimming of open curves to the parameter range of their data.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "batten/fitting/fitting_problem.h"
#include "batten/geometry/nurbs_curve.h"

namespace batten::internal {

template <int Dim>
struct CutCurve {
  NurbsCurve<Dim> curve;        // on the domain there was
  Eigen::Matrix2Xd parameters;  // of the data, on it
};

// Trims the curve to the range from the first to the last parameter of the data with weight; beyond
// it no data determine the curve. Periodic curves, and those that end at their data, come back as
// they are. Returns nullopt where less than a tenth of an end span would be left.
template <int Dim>
std::optional<CutCurve<Dim>> CutToData(const NurbsCurve<Dim>& curve, const FittingData& data);

extern template std::optional<CutCurve<2>> CutToData<2>(const NurbsCurve<2>&, const FittingData&);
extern template std::optional<CutCurve<3>> CutToData<3>(const NurbsCurve<3>&, const FittingData&);

}  // namespace batten::internal
