// SPDX-License-Identifier: MIT
// The outline of a cloud in the parameters of its surface, with its holes.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "batten/fitting/outline_options.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/thread_pool.h"

namespace batten {

struct OutlineCurve {
  NurbsCurve<2> loop;           // closed, clamped; cubic, or of degree one where it is a rectangle
  std::vector<double> corners;  // their parameters, ascending; knots of full multiplicity
};

struct Outline {
  // The outer one first and counter-clockwise, then holes clockwise, by falling area.
  std::vector<OutlineCurve> loops;
  bool fills = false;  // there is no hole and the outer loop is the whole rectangle
  std::vector<std::string> warnings;
  int parts = 1;  // that the cloud falls into; the largest one is described
};

// The outline of points (2 × m in [0, length_u] × [0, length_v], which it never leaves), fair: of
// few control points, corners kept. It lies about half a spacing outside the ragged border of the
// points, holds them all but those a spacing or more beyond it, which a warning counts, and runs
// exactly along edges of the rectangle where it is nowhere far from them. Gaps and parts of less
// than 36 h² are taken to be chance.
//
// Round periodic directions there is no edge: borders cross the seam. Where the part goes right
// round, its outer loop runs along the seam on either side; holes that the seam cuts become part of
// the outer loop. A tube without holes, with straight ends, fills.
//
// Method: alpha shape of 2.5 h; straight windows find corners; between them least squares by cubics
// of which Schwarz' criterion chooses the number of spans; then the least move that holds all
// points (quadratic program). O(m) and little more along the border. The same for any number of
// threads, and up to rounding for any order of the points. Throws std::invalid_argument unless the
// spacing and lengths are positive, the noise is not negative, and there is a point.
Outline FindOutline(const Eigen::Matrix2Xd& parameters,
                    const OutlineOptions& options,
                    ThreadPool& pool);

}  // namespace batten
