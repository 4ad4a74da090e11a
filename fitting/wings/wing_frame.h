// SPDX-License-Identifier: MIT
// The lines of a wing's edge and nose, and the place of a point between them.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "fitting/wings/sheet_sides.h"

namespace batten::internal {

// A polynomial curve in space over v in 0 … 1; cubic.
class WingLine {
 public:
  WingLine() : coefficients_(Eigen::Matrix3Xd::Zero(3, 4)) {}
  // The least-squares curve through places (3 × m) at v; far ones count little.
  WingLine(const Eigen::VectorXd& v, const Eigen::Matrix3Xd& places);

  Eigen::Vector3d At(double v) const;
  // The curve's Bézier points over from … to.
  Eigen::Matrix3Xd BezierPoints(double from, double to) const;

 private:
  Eigen::Matrix3Xd coefficients_;  // of powers of 2v − 1
};

// Where a point is in its section, the plane through E(v), N(v) and the section's normal.
struct WingPlace {
  double v;      // 0 at one tip, 1 at the other
  double along;  // of the chord: 0 at the nose, 1 at the edge
  double above;  // over the chord, per chord
};

struct WingFrame {
  WingLine edge, nose;
  double chord = 0, span = 0;  // lengths, on average
  double nose_radius = 0;      // per chord
  double facing = 1;           // sign that turns the labelled points' normals outwards
  std::string failure_reason;

  bool ok() const { return failure_reason.empty(); }
  // The section's axes at v: along the chord to the edge, across the wing's plane, along the span.
  Eigen::Matrix3d AxesAt(double v) const;
  double ChordAt(double v) const { return (edge.At(v) - nose.At(v)).norm(); }
  WingPlace PlaceOf(const Eigen::Vector3d& point) const;
  // Whether the place is at the round nose, where its height tells its side.
  bool IsAtNose(const WingPlace& place) const;
  // −1 … 1 from edge to edge round the nose, 0 at the nose: the coordinate across the parabola of
  // the nose about its focus, which is the root of `along` farther back, so that a section with a
  // round nose is a polynomial of it. `side` is the sign of the upper or lower side.
  double Around(const WingPlace& place, int side) const;
};

// Groups of moat points at one end of the sections each: the likely edge first.
std::vector<std::vector<Eigen::Index>> EndsOfSections(const Eigen::Matrix3Xd& points,
                                                      const SheetSides& sides);

// Lays the lines through an edge's moat points and the labelled points that face away from them.
// O(m).
WingFrame FrameOf(const Eigen::Matrix3Xd& points,
                  const SheetSides& sides,
                  const std::vector<Eigen::Index>& edge,
                  const std::vector<Eigen::Index>& other_end);

}  // namespace batten::internal
