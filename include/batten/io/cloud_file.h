// SPDX-License-Identifier: MIT
// What files of points hold.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "batten/fitting/closed_surface.h"
#include "batten/fitting/point_cloud.h"

namespace batten {

// The faces of all files, world coordinates.
struct CloudMesh {
  FaceSurface faces;
  Eigen::Index sampled = 0;  // points on its triangles, the last ones of the cloud
};

// What was read. A normal that is not finite, missing, or beyond 1e18 is zero, which means none;
// its point is kept. points_in_file = cloud.size() + non_finite + filtered.
struct CloudFile {
  PointCloud cloud;  // finite points only, in the order of the files
  // Rows or vertices, kept or not; of STL distinct corners; and the points on triangles
  Eigen::Index points_in_file = 0;
  Eigen::Index non_finite = 0;  // dropped because a number they need is NaN, infinite or missing
  Eigen::Index filtered = 0;    // dropped by `where`, `las_classes` or `box`
  // Places of those not finite among all rows that match `where`, from 0: holes of a grid
  std::vector<Eigen::Index> missing;
  // The first point in `cloud` of each block of points, increasing from 0: a file begins one, and
  // so does a point of a text after a line of blanks. None without points in `cloud`.
  std::vector<Eigen::Index> blocks;
  // Sentences on how the files were understood where that is not plain: decimal commas, degrees.
  std::vector<std::string> remarks;
  // Longitude and latitude in degrees of x = y = 0, where degrees became metres
  std::optional<Eigen::Vector2d> projection_middle;
  std::vector<std::string> fields;  // of the first file, as it names them; else "1", "2", …
  std::optional<CloudMesh> mesh;    // where faces were asked for and are there
  // Step between neighbouring coordinates where the first file says it (LAS), else zero
  Eigen::Vector3d scale = Eigen::Vector3d::Zero();
};

}  // namespace batten
