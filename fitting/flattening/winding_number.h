// SPDX-License-Identifier: MIT
// Winding numbers along a graph: whether its closed paths go round.
#pragma once

#include <vector>

#include "fitting/flattening/sheet_graph.h"

namespace batten::internal {

// Step of a coordinate along every edge of a graph, from its first node to its second. Along a
// closed path the steps of an angle add up to a whole number of turns.
struct GraphSteps {
  const std::vector<SheetEdge>* edges;
  std::vector<double> steps;
  Eigen::Index nodes;
};

// Unwrapped coordinate, summed along a spanning forest of shortest paths from the first member of
// every component, and the edges along which it misses by more than `slip`, with their `misfits`:
// coordinate of the second node less that of the first less the step.
struct Unwrapped {
  std::vector<double> values;  // of a node that is no member: 0
  std::vector<int> part;       // number of its component; −1 of a node that is no member
  std::vector<int> seams;      // edges
  std::vector<double> misfits;
};
Unwrapped Unwrap(const GraphSteps& steps, const std::vector<bool>& members, double slip);

// Returns the share of bands across a second coordinate in which some closed path of the members
// goes round: the steps of the first coordinate add up to more than `slip`. A band is `width` wide,
// the next begins half a width further; bands with fewer than three members are not counted. With a
// period the second coordinate is periodic. 0 if there is no band. A spiral of many turns has no
// such path; a closed shape with holes has one in most bands. O(edges).
double ClosedFraction(const GraphSteps& steps,
                      const std::vector<bool>& members,
                      double slip,
                      const std::vector<double>& across,
                      double width,
                      double period = 0);

}  // namespace batten::internal
