// SPDX-License-Identifier: MIT
// Surfaces of revolution, spheres and tori as what the parameters of a closed cloud are taken from.
#pragma once

#include <Eigen/Core>
#include <string>

#include "batten/fitting/neighbours.h"
#include "batten/fitting/progress.h"
#include "batten/fitting/round_nodes.h"
#include "batten/geometry/thread_pool.h"

namespace batten {

struct RevolutionShape;

struct RoundBase {
  std::string name;  // "revolution", "sphere", "torus"
  // 2 × m: u the angle round the axis times the mean radius, v the length along the profile, in
  // [0, length_u] × [0, length_v] (below a length where it is periodic). Smooth functions of the
  // point off the axis; u × v looks outwards.
  Eigen::Matrix2Xd parameters;
  double length_u = 0, length_v = 0;
  bool periodic_u = false, periodic_v = false;  // the parameter lives on a circle
  bool pole_start = false, pole_end = false;    // the edge v = 0, v = length_v is one point
  double turn = 0;                              // angle swept over length_u
  double misfit = 0;  // distance of the nodes from the base, root mean square, over the mean radius
  std::string why;    // one clause for the report
  std::string refusal;  // empty when the base serves, else why not and what to do

  bool serves() const { return refusal.empty(); }
};

struct RoundBaseOptions {
  Eigen::Index nodes = 2000;  // about
  double least_share = 0.9;   // of the nodes in one part
  double most_misfit = 0.09;  // a ripple of amplitude 0.1 has 0.07, a cube 0.11
  double least_closed = 0.5;  // of the profile's places gone round wholly, of what counts as closed
};

// A surface of revolution: axis and profile by least squares, both directions open or closed.
// Closed means that along the neighbour graph of the nodes ways lead round; a spiral has none.
// Where the profile comes to the axis within three spacings, that end is a pole. Open directions
// reach over the points, widened by the margin. Points (3 × m) are distinct and almost rid of
// outliers; `spacing` and `noise` are those of MeasureCloud. Parameters are finite and inside even
// with a refusal. Bit for bit the same for every number of threads. Throws std::invalid_argument
// unless there are points and index, spacing, noise and margin fit them; Cancelled when progress
// asks to stop. O(m log m).
RoundBase FindRevolutionBase(const Eigen::Matrix3Xd& points,
                             const NeighbourIndex& index,
                             double spacing,
                             double noise,
                             double margin,
                             const RoundBaseOptions& options,
                             ThreadPool& pool,
                             const Progress& progress = {});

// A sphere; poles lie where the data leave the most open, else on a coordinate axis.
RoundBase FindSphereBase(const Eigen::Matrix3Xd& points,
                         const NeighbourIndex& index,
                         double spacing,
                         double noise,
                         double margin,
                         const RoundBaseOptions& options,
                         ThreadPool& pool,
                         const Progress& progress = {});

// A torus whose axis does not meet its tube, of which more than half goes round.
RoundBase FindTorusBase(const Eigen::Matrix3Xd& points,
                        const NeighbourIndex& index,
                        double spacing,
                        double noise,
                        double margin,
                        const RoundBaseOptions& options,
                        ThreadPool& pool,
                        const Progress& progress = {});

// What only the points and their scale determine, for several of these over one cloud.
struct RoundCloud {
  const Eigen::Matrix3Xd& points;
  const RoundNodes& round;
  double spacing, noise, margin;
  const RevolutionShape* shape = nullptr;  // found about no preferred axis, if it is known
};
RoundBase RevolutionBaseOf(const RoundCloud& cloud,
                           const RoundBaseOptions& options,
                           ThreadPool& pool);
RoundBase SphereBaseOf(const RoundCloud& cloud, const RoundBaseOptions& options, ThreadPool& pool);
RoundBase TorusBaseOf(const RoundCloud& cloud, const RoundBaseOptions& options, ThreadPool& pool);

}  // namespace batten
