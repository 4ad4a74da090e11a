// SPDX-License-Identifier: MIT
// Local curve interpolation: every piece depends on a few points nearby only.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/interpolate_curve.h"
#include "batten/fitting/point_tangents.h"

namespace batten {

enum class LocalPieces {
  kParabolas,  // quadratic B-spline; one or two pieces between neighbours
  kConics,     // rational quadratic: circular where neighbours' tangents are symmetric
  kCubics,     // one cubic between neighbours, C¹, of nearly constant speed
};

// Interpolates all points (Dim × m) with the tangents that TangentsAt finds for them; corners stay
// corners. A change of one point affects six pieces at most (Akima). Elsewhere the curve has one
// tangent: it is C¹ but where domains of the pieces would grow out of proportion, and at the seam
// of closed parabolas and conics. Straight stretches come out straight, circles circular from
// conics with Bessel's tangents. Domain [0, 1]; closed: periodic. O(m). Throws
// std::invalid_argument as TangentsAt does. [Piegl & Tiller 1997, §9.3]
template <int Dim>
InterpolatedCurve<Dim> InterpolateLocally(const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points,
                                          LocalPieces pieces = LocalPieces::kCubics,
                                          const TangentOptions& options = {});

extern template InterpolatedCurve<2> InterpolateLocally<2>(const Eigen::Matrix2Xd&,
                                                           LocalPieces,
                                                           const TangentOptions&);
extern template InterpolatedCurve<3> InterpolateLocally<3>(const Eigen::Matrix3Xd&,
                                                           LocalPieces,
                                                           const TangentOptions&);

}  // namespace batten
