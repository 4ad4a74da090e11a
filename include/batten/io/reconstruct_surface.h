// SPDX-License-Identifier: MIT
// A closed surface of triangles about the points of a body.
#pragma once

#include <vector>

#include "batten/fitting/closed_surface.h"
#include "batten/fitting/point_cloud.h"

namespace batten {

struct ReconstructedSurface {
  ClosedSurface closed;  // in the cloud's world coordinates
  // By triangle: beyond the points, as it is farther than a spacing and a half from all, has the
  // nearest on one side, or is the other side of a sheet. As caps of the surface they stay open.
  std::vector<char> beyond;
  // Of its area: farther than three spacings from all points, or on the other side of a sheet.
  double invented_share = 0;
};

// Screened Poisson reconstruction by PCL, from the cloud's normals or else from planes through
// neighbours turned outwards along a spanning tree; cells about as large as the spacing of the
// points. Only the largest part is kept. Throws RefusedData where more than `most_invented` of the
// area is invented, where the points are several bodies apart (smaller ones of up to one point in
// twenty are passed over), or nothing closed comes out; std::runtime_error where the module
// libbatten_reconstruction.so does not load. [Kazhdan & Hoppe 2013]
ReconstructedSurface ReconstructSurface(const PointCloud& cloud,
                                        double most_invented = 0.15,
                                        int threads = 0);

}  // namespace batten
