// SPDX-License-Identifier: MIT
// Splines through values and derivatives at given parameters, over a given basis.
#pragma once

#include <Eigen/Core>
#include <span>

#include "batten/geometry/spline_basis.h"

namespace batten::internal {

// A value (order 0) or derivative at a parameter of the domain; `from_left` takes the piece below a
// knot.
struct SplineDatum {
  double at;
  int order = 0;
  bool from_left = false;
};

// The coefficients, a column for each function of the basis, of the spline that meets column k of
// `values` at data[k]; over a periodic basis the last p columns are the first p. There are as many
// data as free coefficients, n or over a periodic basis n − p. Values are taken less their mean, so
// that the distance from the origin costs nothing. Throws std::invalid_argument where the data do
// not determine the spline. O(n·p²) for each row. [Piegl & Tiller 1997, §9.2; de Boor 1978, XIII]
Eigen::MatrixXd Interpolated(const SplineBasis& basis,
                             std::span<const SplineDatum> data,
                             const Eigen::MatrixXd& values);

}  // namespace batten::internal
