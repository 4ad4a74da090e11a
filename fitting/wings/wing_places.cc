// SPDX-License-Identifier: MIT
#include "fitting/wings/wing_places.h"

namespace batten::internal {

WingPlaces PlacesIn(const WingFrame& frame,
                    const Eigen::Matrix3Xd& points,
                    const SheetSides& sides,
                    ThreadPool& pool) {
  const auto count = static_cast<size_t>(points.cols());
  WingPlaces result{std::vector<WingPlace>(count), std::vector<int>(count, 0)};
  pool.For(points.cols(), 1000, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t k = begin; k < end; ++k) {
      WingPlace& place = result.places[static_cast<size_t>(k)];
      place = frame.PlaceOf(points.col(k));
      if (!sides.labelled[k]) continue;
      const Eigen::Vector3d across = frame.AxesAt(place.v).col(1);
      result.side[static_cast<size_t>(k)] =
          frame.facing * sides.normals.col(k).dot(across) > 0 ? 1 : -1;
    }
  });
  return result;
}

}  // namespace batten::internal
