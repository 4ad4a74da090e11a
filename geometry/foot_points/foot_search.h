// SPDX-License-Identifier: MIT
// The global search for closest points over a FootTable. Internal; foot_point.h is the public face.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "geometry/foot_points/capture_radius.h"
#include "geometry/foot_points/foot_kernels.h"
#include "geometry/foot_points/foot_table.h"
#include "geometry/foot_points/found_foot.h"
#include "geometry/numeric/bounding_volume_tree.h"
#include "geometry/numeric/point_kd_tree.h"

namespace batten::internal {

// What searches of one thread share, so that a query does not allocate.
struct FootWorkspace {
  std::vector<BoundingVolumeTree::Near> near;
  std::vector<double> arena;
};

// Seeds: the nearest of nine samples a piece. Newton steps across pieces give an upper bound d.
// Within the reach of a place where |S − q| is stationary that is enough (CaptureRadius). Else
// every piece whose box is nearer than d is proved to hold nothing nearer than √(d² − τ), or gives
// a nearer point: F = |P|² − 2q·wP + (|q|² − d² + τ)w², P the homogeneous numerator about the
// piece's centre, is a polynomial of bidegree (2p, 2q); where its Bernstein coefficients are not
// negative, or it is convex and its least value is not, nothing is nearer; where it is monotone
// only a side can be; otherwise it is halved. τ = ε(2d + ε) + rounding with ε = 1e-11 of the
// shape's size; where rounding would weigh more than that, the polynomial is made anew from control
// points about q, which loses no digits. Where that takes long, as it does on shapes much longer
// than wide, the search goes on by distances from convex hulls (HullSearch).
class FootSearch {
 public:
  explicit FootSearch(FootTable table);

  const FootTable& table() const { return table_; }

  FoundFoot Nearest(const Eigen::Vector3d& q, FootWorkspace& workspace) const;

  // The same from a place that is thought near.
  FoundFoot NearestFrom(
      const Eigen::Vector3d& q, int piece, double x, double y, FootWorkspace& workspace) const;

  // That place and the lower bound, where its reach says that nothing is nearer than by an
  // acceptable miss; elsewhere the lower bound is zero.
  FoundFoot Look(const Eigen::Vector3d& q, int piece, double x, double y) const;

  // The local minimum below a place, across pieces; the lower bound is zero.
  FoundFoot Descend(const Eigen::Vector3d& q, int piece, double x, double y) const;

  // The point at a place.
  Eigen::Vector3d Position(int piece, double x, double y) const;

  // Where to look up the start for a point: the point itself, or nearer where it is far away.
  Eigen::Vector3d Lookup(const Eigen::Vector3d& q) const;

 private:
  FootPiece Piece(int piece) const;
  FoundFoot Prove(const Eigen::Vector3d& q, const FoundFoot& start, FootWorkspace& workspace) const;
  // By DistanceCertificate, looking at so many coefficients.
  FoundFoot ProveBySquares(const Eigen::Vector3d& q,
                           const FoundFoot& start,
                           int most_work,
                           FootWorkspace& workspace) const;
  // The lower bound by the reach of a place, zero where that says nothing.
  double BoundByReach(const FoundFoot& found) const;
  // The gradient that counts at a place of a piece.
  void Pull(const FootPlace& place, FoundFoot& found) const;

  FootTable table_;
  BoundingVolumeTree boxes_;
  PointKdTree samples_;
  CaptureRadius reach_;
};

}  // namespace batten::internal
