// SPDX-License-Identifier: MIT
#include "batten/fitting/point_source.h"

#include <algorithm>
#include <stdexcept>

namespace batten {
namespace {

constexpr Eigen::Index kPiece = 1 << 16;

}  // namespace

ArraySource::ArraySource(const Eigen::Matrix3Xd& points) : points_(points) {
  if (!points.allFinite())
    throw std::invalid_argument("ArraySource: points: a coordinate is not finite");
}

void ArraySource::Pass(const TakePoints& take) {
  for (Eigen::Index at = 0; at < points_.cols(); at += kPiece)
    take(points_.middleCols(at, std::min(kPiece, points_.cols() - at)));
}

}  // namespace batten
