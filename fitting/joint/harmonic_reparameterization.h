// SPDX-License-Identifier: MIT
// Harmonic reparameterization of a surface, which evens out its stretch.
#pragma once

#include <Eigen/Core>

#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// A map of a surface's domain onto itself that is harmonic on the surface: steep parts, which a
// base seen from above presses into a strip, get room. Each side of the rectangle goes to itself;
// along it points are free to slide. Bilinear elements on a grid; between its places the map is
// bilinear too, so it is continuous, and one to one but for discretisation. [Floater & Hormann
// 2005, "Surface parameterization: a tutorial and survey", §5: harmonic maps]
class ReparameterizeHarmonically {
 public:
  // The surface's bases must not be periodic. O(places^1.5), 80 × 80 places.
  ReparameterizeHarmonically(const NurbsSurface& surface, ThreadPool& pool);

  // Ratio of the largest to the least stretch |S_u × S_v| of the surface before the map, over 95 %
  // of the places.
  double unevenness() const { return unevenness_; }

  // Maps the parameters (u,v), one a column.
  Eigen::Matrix2Xd operator()(const Eigen::Matrix2Xd& parameters) const;

 private:
  double lower_[2], upper_[2], length_[2];
  Eigen::MatrixXd image_[2];  // of the grid's places, row for u, column for v; empty: unmoved
  double unevenness_ = 1;
};

}  // namespace batten::internal
