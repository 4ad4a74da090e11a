// SPDX-License-Identifier: MIT
// Point clouds from files.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "batten/fitting/point_cloud.h"
#include "batten/io/cloud_options.h"
#include "batten/io/file_format.h"

namespace batten {

// What was read. A normal that is not finite, missing, or beyond 1e18 is zero, which means none;
// its point is kept. points_in_file = cloud.size() + non_finite + filtered.
struct CloudFile {
  PointCloud cloud;                 // finite points only, in the order of the files
  Eigen::Index points_in_file = 0;  // rows or vertices, kept or not; of STL distinct corners
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
  // Step between neighbouring coordinates where the first file says it (LAS), else zero
  Eigen::Vector3d scale = Eigen::Vector3d::Zero();
};

// The format of a file to be read: FormatOf, but where the extension is none that is known, a
// regular file whose first rows are numbers is text. Throws as FormatOf, and ReadError where the
// file can't be read.
FileFormat InputFormat(const std::string& path, const std::string& format = "");

// Reads PCD, PLY, LAS, text, and the vertices of OBJ, STL and OFF. Several files become one cloud
// that keeps what all of them hold (normals, weights, colours, parameters). Coordinates stay double
// from the file on; the origin is split off at the end (PointCloud::FromWorld). The path "-" is
// standard input.
//
// Memory grows with the points that have been read, never with what a header promises.
//
// Throws ReadError where a file can't be used, a coordinate is beyond 1e18, a weight is not
// positive, or no point is left; UsageError where the options ask for a column or format that is
// not there.
CloudFile ReadCloud(const std::vector<std::string>& paths, const CloudReadOptions& options = {});

}  // namespace batten
