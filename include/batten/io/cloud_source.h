// SPDX-License-Identifier: MIT
// Files of points that are passed over, for fits of clouds larger than memory.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "batten/fitting/point_source.h"
#include "batten/io/cloud_options.h"

namespace batten {

// Several files as one cloud, read anew in each pass, a piece in memory at a time: LAS, PLY, PCD
// and text (of PCD with compressed columns, a whole file). Files of meshes, whose corners are found
// only when all is read, are refused, and so are pipes, weights and points in the plane.
//
// A pass throws ReadError as ReadCloud does, and where a file is not what it was in the first pass:
// another size, another time of change, other points.
class CloudFileSource : public PointSource {
 public:
  // Throws UsageError where a path is no such file, std::invalid_argument where there is none.
  // options.take is not used; options.progress may cancel.
  explicit CloudFileSource(std::vector<std::string> paths, CloudReadOptions options = {});

  void Pass(const TakePoints& take) override;

  // What the last whole pass found, as CloudFile says it.
  Eigen::Index points_in_file() const { return rows_; }
  Eigen::Index non_finite() const { return non_finite_; }
  Eigen::Index filtered() const { return filtered_; }

  // Sentences on files that have other columns than the first: what they have besides coordinates
  // is not used.
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  // What tells that a file is the same.
  struct Trace {
    std::int64_t bytes = 0, seconds = 0, nanoseconds = 0;
    std::uint64_t points = 0;  // a sum over the bits of all coordinates
    bool operator==(const Trace&) const = default;
  };
  Trace TraceOf(const std::string& path) const;
  void Require(const std::string& path, const Trace& now, const Trace& then) const;

  std::vector<std::string> paths_;
  CloudReadOptions options_;
  std::vector<Trace> traces_;  // of the first pass
  Eigen::Index rows_ = 0, non_finite_ = 0, filtered_ = 0;
  std::vector<std::string> warnings_;
};

}  // namespace batten
