// SPDX-License-Identifier: MIT
// The outline of a cloud and its holes in the parameter plane of its surface.
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
  // Outer loops, counter-clockwise, then holes, clockwise, both by falling area. They cross neither
  // themselves nor each other.
  std::vector<OutlineCurve> loops;
  bool fills = false;  // there is no hole and the outer loop is the whole rectangle
  std::vector<std::string> warnings;
  int parts = 1;                      // connected parts of the cloud, each with an outer loop
  std::vector<Eigen::Index> outside;  // points outside the loops
};

// Finds a smooth outline for every part, of few control points with corners kept, of points (2 × m
// in [0, length_u] × [0, length_v], which it never leaves). It lies about half a spacing outside
// the ragged border of the points, contains them all except those a spacing or more beyond it,
// which a warning counts, none more than three beyond it, and runs exactly along edges of the
// rectangle where it is nowhere far from them. Gaps and parts of less than 36 h² are ignored as
// chance; where points are sparser than on the average, or on lines far apart, h is what it is
// there. Where a smooth outline would cross itself or another it follows the ragged border by
// straight lines, about the crossing only.
//
// Periodic directions have no edge: borders cross the seam. Where a part goes all the way round,
// its outer loop runs along the seam on either side; holes that the seam cuts become part of the
// outer loop. A tube with straight ends and no holes has `fills` set.
//
// Method: alpha shape of radius 2.5 h, up to sixteen times that where points are sparser; corner
// detection by straight windows; least-squares cubics between corners, with the number of spans by
// Schwarz' criterion; then the least move that contains all points (quadratic program). O(m) and
// little more along the border. The result does not depend on the number of threads, nor, up to
// rounding, on the order of the points. Throws std::invalid_argument unless the spacing and lengths
// are positive, the noise is not negative, and there is a point; RefusedData where the points are
// about a spacing wide, and a border of them has no length.
Outline FindOutline(const Eigen::Matrix2Xd& parameters,
                    const OutlineOptions& options,
                    ThreadPool& pool);

// Whether the points have one border and no holes, and the border runs along the edges of the
// rectangle: FindOutline(…).fills at the cost of the alpha shape.
bool FillTheirRectangle(const Eigen::Matrix2Xd& parameters,
                        const OutlineOptions& options,
                        ThreadPool& pool);

}  // namespace batten
