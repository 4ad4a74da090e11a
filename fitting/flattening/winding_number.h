// SPDX-License-Identifier: MIT
// Whether a graph goes all the way round, counted along its edges.
#pragma once

#include <vector>

#include "fitting/flattening/sheet_graph.h"

namespace batten::internal {

// A step along every edge of a graph in some coordinate, from its first node to its second. Round a
// closed way the steps of an angle add up to a whole number of turns.
struct GraphSteps {
  const std::vector<SheetEdge>* edges;
  std::vector<double> steps;
  Eigen::Index nodes;
};

// The coordinate itself, summed along a spanning forest of shortest ways from the first of the
// members of every part, and the edges along which it does not fit by more than `slip`: their
// `misfits`, coordinate of the second less that of the first less the step.
struct Unwrapped {
  std::vector<double> values;  // of a node that is no member: 0
  std::vector<int> part;       // number of its part; −1 of a node that is no member
  std::vector<int> seams;      // edges
  std::vector<double> misfits;
};
Unwrapped Unwrap(const GraphSteps& steps, const std::vector<bool>& members, double slip);

// The share of bands across a second coordinate in which some closed way of the members goes round,
// so that the steps of the first do not add up to less than `slip`. A band is `width` wide, the
// next begins half a width further; bands with fewer than three members count not at all. With a
// period the second coordinate is a circle. 0 where there is no band. A spiral of many turns has no
// such way; a closed shape with holes has one in most bands. O(edges).
double ClosedFraction(const GraphSteps& steps,
                      const std::vector<bool>& members,
                      double slip,
                      const std::vector<double>& across,
                      double width,
                      double period = 0);

}  // namespace batten::internal
