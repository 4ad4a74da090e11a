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
  // What tells that a file is the same.
  struct Trace {
    std::int64_t bytes = 0, seconds = 0, nanoseconds = 0;
    std::uint64_t points = 0;  // a sum over the bits of all coordinates
    bool operator==(const Trace&) const = default;
  };
  // What a pass leaves behind.
  struct Passed {
    std::vector<Trace> traces;  // of the files; none before the first pass
    Eigen::Index rows = 0, non_finite = 0, filtered = 0;
    std::vector<std::string> warnings;
  };

  // Throws UsageError where a path is no such file, std::invalid_argument where there is none.
  // options.take is not used; options.progress may cancel.
  explicit CloudFileSource(std::vector<std::string> paths, CloudReadOptions options = {});

  void Pass(const TakePoints& take) override;

  // What the last whole pass found, as CloudFile says it.
  Eigen::Index points_in_file() const { return passed_.rows; }
  Eigen::Index non_finite() const { return passed_.non_finite; }
  Eigen::Index filtered() const { return passed_.filtered; }

  const std::vector<std::string>& paths() const { return paths_; }
  const Passed& passed() const { return passed_; }
  // Goes on after passes that another object made over the same files. Throws ReadError where a
  // file is not what it was then.
  void Resume(Passed passed);

  // Sentences on files that have other columns than the first (what they have besides coordinates
  // is not used), and on those that seem to be in another unit.
  const std::vector<std::string>& warnings() const { return passed_.warnings; }

 private:
  Trace TraceOf(const std::string& path) const;
  void Require(const std::string& path, const Trace& now, const Trace& then) const;

  std::vector<std::string> paths_;
  CloudReadOptions options_;
  Passed passed_;
};

}  // namespace batten
