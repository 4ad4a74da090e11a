// SPDX-License-Identifier: MIT
// From how far away a foot that is nearest among its neighbours is nearest of all. Internal to the
// search for closest points.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "geometry/foot_points/foot_table.h"

namespace batten::internal {

// Every piece is cut into 2 × 2 parts, and round each part a rectangle of neighbours is looked at,
// across which the surface is smooth. For x = S(a) in the part, δ a step to a place y of the
// rectangle, and coordinates of δ in which the part's mean tangents are orthonormal:
//  |y − x| ≥ m|δ|, m from the range of the tangents over the rectangle;
//  y − x = Jδ + r, |r| ≤ Λ|δ|²/2, Λ from bounds of the second derivatives.
// For a point q at the distance d from x, g the gradient of |S − q|²/2 at a,
//  |y − q|² = d² + |y − x|² − 2(q − x)·(y − x) ≥ d² + 2g·δ + (m² − dΛ)|δ|²,
// which is at least d² − |g|²/(m² − dΛ). What of g only leads out of the domain may be left out:
// there g·δ is not negative. Everything outside of the rectangle is farther from x than 2d, and so
// from q than d, if its boxes are. So each part has a reach: d < m²/Λ, and half the distance of
// those boxes. (Federer's reach, part by part.)
// Bounds are those of Bernstein coefficients; polynomial surfaces only, the others have no reach,
// and neither have parts at poles and creases. [Federer 1959, "Curvature measures", §4]
class CaptureRadius {
 public:
  CaptureRadius() = default;  // reaches nothing
  explicit CaptureRadius(const FootTable& table);

  // For a place of a piece, its distance d from a point, and the gradient of |S − q|²/2 in local
  // parameters less what only leads out of the domain: by how much the least squared distance of
  // the surface may be below d² at most; infinite where that is not known.
  double Miss(int piece, double x, double y, double distance, double gx, double gy) const;

 private:
  // Steps are measured by R = (xx xy; 0 yy) times the step in local parameters.
  struct Part {
    double reach = 0;     // negative or zero: none
    double stretch2 = 0;  // m²
    double bend = 0;      // Λ
    double per_xx = 0, xy = 0, per_yy = 0;
    double size = 0;  // coordinates about the piece's centre are no greater
  };
  class Builder;

  std::vector<Part> parts_;  // four a piece
};

}  // namespace batten::internal
