// SPDX-License-Identifier: MIT
// The search for closest points on the part of a surface that its loops leave. Internal;
// foot_point.h is the public face.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "batten/geometry/trim_region.h"
#include "geometry/foot_points/foot_search.h"
#include "geometry/foot_points/loop_curves.h"
#include "geometry/numeric/bounding_volume_tree.h"
#include "geometry/numeric/point_kd_tree.h"

namespace batten::internal {

// Where the nearest place of the whole surface counts, that is the answer. Elsewhere it is the
// nearest place of the loops, certified as curves are, or a local minimum inside that is nearer:
// all pieces that count in part and might hold one are checked (DistanceCertificate).
class TrimmedFootSearch {
 public:
  // The search over the whole surface must outlive this.
  TrimmedFootSearch(const NurbsSurface& surface, const FootSearch& whole);

  bool Counts(const FoundFoot& found) const;

  // The nearest place that counts. `untrimmed` is the nearest of the whole surface, and does not.
  FoundFoot Nearest(const Eigen::Vector3d& q,
                    const FoundFoot& untrimmed,
                    FootWorkspace& workspace) const;

 private:
  // A place of the surface at which the search may begin.
  struct Sample {
    int piece;
    double x, y;
  };
  void AddSamples();
  FoundFoot At(const Eigen::Vector3d& q, int piece, double x, double y) const;
  FoundFoot OnLoops(const Eigen::Vector3d& q, FootWorkspace& workspace) const;
  FoundFoot FromSample(const Eigen::Vector3d& q, const FoundFoot& known) const;

  const FootSearch& whole_;
  TrimRegion region_;
  LoopCurves loops_;
  FootSearch on_loops_;
  std::vector<int> pieces_;  // those that count, wholly or in part
  std::vector<bool> cut_;    // which of them in part
  BoundingVolumeTree boxes_;
  std::vector<Sample> samples_;
  PointKdTree sample_tree_;
};

}  // namespace batten::internal
