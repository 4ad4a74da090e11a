// SPDX-License-Identifier: MIT
// What is asked of a file of points: which columns mean what, which rows are kept.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace batten {

// Keeps the rows whose column holds exactly the value (in the column's own precision).
struct RowFilter {
  std::string column;  // 1-based number, or name in the header
  double value = 0;
};

// What becomes of x and y that are longitude and latitude in degrees (WGS 84).
enum class CloudProjection {
  kByNames,  // as kLocal where the columns are named so (lon, lat, longitude, …), else as kNone
  kLocal,    // metres east and north of a middle
  kNone,     // they stay
};

// What of a mesh counts.
enum class CloudFaces {
  kIgnored,   // its vertices
  kKept,      // the same; its faces are there too
  kSampled,   // points on its triangles as well, where the vertices do not stand for these
  kFlat,      // as kSampled, where every edge is flat or sharp
  kMeasured,  // as kSampled, and on long triangles of any mesh
};

struct CloudReadOptions {
  // A format word as FormatOf takes it; empty: by extension. Needed for standard input.
  std::string format;

  // Role (x y z u v nx ny nz w red green blue) → column, by 1-based number or by name in the
  // header. Roles left out are found by their usual names; x y z else are the first three columns
  // of a text file. With x and y given but no z the cloud is plane.
  std::map<std::string, std::string> columns;

  // The box is one of degrees all the same, and z stays as it is.
  CloudProjection projection = CloudProjection::kByNames;

  // Longitude and latitude in degrees of the place that becomes x = y = 0. Empty: the middle of the
  // points that are kept, so that points of another choice or file are metres from another place.
  std::optional<Eigen::Vector2d> projection_middle;

  // Take u and v by their names from PCD and PLY too; text always does.
  bool parameters = false;

  // Rows must match all of these.
  std::vector<RowFilter> where;

  // Only points of these classes (2 is ground); LAS files only, empty: all.
  std::vector<int> las_classes;

  // Faces are read from regular files that MayHoldFaces; none are sampled, which a remark says,
  // where rows are chosen (`where`, `columns`) or have weights or parameters, or degrees become
  // metres.
  CloudFaces faces = CloudFaces::kIgnored;

  // Only points inside, borders included. World coordinates, the data's units.
  std::optional<Eigen::AlignedBox3d> box;

  // Gets the points piece by piece, at most 65536 of them (3 × m, world coordinates), instead of
  // their being kept: the cloud is then empty. Nothing else of them is passed on, so that a column
  // of weights is refused, and points in the plane are.
  std::function<void(const Eigen::Matrix3Xd& points)> take;

  // Gets the fraction read from time to time; may throw to cancel, and what it throws passes
  // through.
  std::function<void(double fraction)> progress;
};

// Sets the projection from its word: local, local=LON,LAT or none. Throws std::invalid_argument
// that says what is wrong with the word.
void TakeProjection(const std::string& word, CloudReadOptions& options);

}  // namespace batten
