// SPDX-License-Identifier: MIT
#include "batten/fitting/point_source.h"

#include <algorithm>
#include <stdexcept>

#include "fitting/core/shared_constants.h"

namespace batten {

ArraySource::ArraySource(const Eigen::Matrix3Xd& points) : points_(points) {
  if (!points.allFinite())
    throw std::invalid_argument("ArraySource: points: a coordinate is not finite");
}

void ArraySource::Pass(const TakePoints& take) {
  const Eigen::Index piece = internal::kPointsOfPiece;
  for (Eigen::Index at = 0; at < points_.cols(); at += piece)
    take(points_.middleCols(at, std::min(piece, points_.cols() - at)));
}

}  // namespace batten
