// SPDX-License-Identifier: MIT
// The rules of the fits that can be switched off, one by one, to measure what each is worth.
#pragma once

#include <string>
#include <vector>

namespace batten::internal {

enum class Rule {
  // preparation
  kLocalOutliers,   // points off the quadrics of their neighbours are no inliers
  kIsolatedPoints,  // nor are isolated points, where there are outliers
  kClutter,         // nor small parts beside a large one, until a base is chosen without them
  // parameterization
  kCertainBase,         // a base that hardly changes lengths ends the search
  kHopelessBases,       // a base that a few grids show to be worse is not scored
  kSmoothedParameters,  // a sheet's parameters are smoothed on a coarse surface
  kOutlineBase,         // a sheet of four sides ends in its outline
  // degrees of freedom and solution
  kBlockValidation,  // blocks of left-out points tell noise that neighbours share from shape
  kReweighting,      // a robust loss bounds residuals where there are outliers
  kNeighbourVotes,   // points off the surface count with neighbours that are off as far
  kKnotLines,        // knot lines are added and removed one by one after the grid is chosen
  kBounds,           // coefficients stay within what the data nearby allow
  kHeldBetween,      // what overshoots between the points all the same is brought back
  // the joint stage
  kJointStage,
  kStructuredGate,  // which runs only where residuals have a shape
  // curves
  kCorners,
  kRelocatedKnots,
  kLeastAbsolute,  // robust curves start near least absolute distances
  kOvershoot,      // fairness is raised where a curve overshoots between its points
};

// All rules with their names, such as "gentle-plane".
struct NamedRule {
  Rule rule;
  std::string name;
};
std::vector<NamedRule> AllRules();

// Whether a rule acts: all do unless the program switched one off.
bool Acts(Rule rule);

// For measurements, before any fit: not safe beside running ones.
void SwitchOff(Rule rule);

}  // namespace batten::internal
