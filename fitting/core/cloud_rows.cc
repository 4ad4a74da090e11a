// SPDX-License-Identifier: MIT
#include "batten/fitting/cloud_rows.h"

#include "geometry/numeric/reject.h"

namespace batten {
using namespace internal;
namespace {

template <typename Number>
PointCloud FromCoordinates(std::span<const Number> coordinates, int dimension) {
  if (dimension != 2 && dimension != 3) Reject("CloudFromCoordinates", "dimension is 2 or 3");
  const auto count = static_cast<Eigen::Index>(coordinates.size());
  if (count % dimension != 0) {
    Reject("CloudFromCoordinates",
           std::to_string(count) + " coordinates are no points of dimension " +
               std::to_string(dimension));
  }
  using Rows = Eigen::Matrix<Number, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  return CloudFromRows(Eigen::Map<const Rows>(coordinates.data(), count / dimension, dimension));
}

}  // namespace

PointCloud CloudFromCoordinates(std::span<const double> coordinates, int dimension) {
  return FromCoordinates(coordinates, dimension);
}

PointCloud CloudFromCoordinates(std::span<const float> coordinates, int dimension) {
  return FromCoordinates(coordinates, dimension);
}

}  // namespace batten
