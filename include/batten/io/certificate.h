// SPDX-License-Identifier: MIT
// Certificates: proved bounds of the distances of points from a geometry, and of its regularity.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "batten/fitting/point_cloud.h"
#include "batten/geometry/parameter_box.h"
#include "batten/geometry/thread_pool.h"
#include "batten/io/geometry_types.h"

namespace batten {

// lower ≤ distance ≤ upper. The upper bound is witnessed by a place: (u, v) of geometry `index` or,
// on the border of its trims, the point of trim loop `loop` at its parameter u.
struct PointBounds {
  double lower = 0, upper = 0;
  int index = 0, loop = -1;
  double u = 0, v = 0;
};

// Parts of a surface whose regularity is not proved (regularity.h).
struct RegularityClaim {
  int index = 0;  // of the surface
  std::vector<ParameterBox> unproved;
};

struct CertificateSummary {
  double max_upper = 0;  // every point is so near
  double max_lower = 0;  // some point is at least so far
  std::optional<double> tolerance;
  Eigen::Index proved_within = 0, proved_out = 0, undecided = 0;  // of the tolerance
  bool folds_proved_absent = false;
  std::optional<double> mesh_chord;   // the surfaces are so near to the planes of the triangles
  std::vector<std::string> unproved;  // a sentence each
};

struct Certificate {
  std::vector<PointBounds> points;  // of the cloud's, in order
  std::vector<RegularityClaim> regularity;
  CertificateSummary summary;
};

// Bounds of the distances from the geometry, given in the coordinates of the cloud's world less
// `shift`. Distances and their lower bounds are those of SurfaceFootPoints, widened by 1e-9 of the
// geometry's size and by the rounding of coordinates; the lower bound of a point whose nearest
// place is on the border of trims by 1e-5 of the size. Nothing is assumed where a search ended
// without proof: the bounds are then apart, and a sentence says so. Throws std::invalid_argument
// without geometry.
Certificate Certify(const std::vector<Geometry>& geometry,
                    const PointCloud& cloud,
                    const Eigen::Vector3d& shift,
                    std::optional<double> tolerance,
                    ThreadPool& pool);

// The schema "batten-certificate-1", which batten-verify reads: the geometry as ToGeometryJson has
// it, a row [x, y, z, lower, upper, index, loop, u, v] for every point, and the summary.
std::string ToCertificateJson(const Certificate& certificate,
                              const std::vector<Geometry>& geometry,
                              const PointCloud& cloud,
                              const Eigen::Vector3d& shift);

}  // namespace batten
