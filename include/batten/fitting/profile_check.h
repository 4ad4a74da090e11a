// SPDX-License-Identifier: MIT
// Whether points lie in the zone that a profile tolerance allows, with the uncertainty of saying
// so.
#pragma once

#include <Eigen/Core>

namespace batten {

// Signed distances from the nominal geometry that are allowed, along its normals. A profile
// tolerance T without more is bilateral, −T/2 … T/2 [ISO 1101, 17.15]; unilateral or unequal zones
// are any others that low < high.
struct ProfileZone {
  double low = 0, high = 0;
};

// By the decision rule of ISO 14253-1: what is in the zone by more than the expanded uncertainty
// conforms, what is out of it by more does not, in between it cannot be told.
enum class Conformity { kConforms, kUndecided, kDoesNotConform };
const char* Name(Conformity conformity);  // "conforms", "undecided", "does_not_conform"

struct ProfileVerdict {
  ProfileZone zone;
  double lowest = 0, highest = 0;      // measured distances
  double uncertainty = 0;              // expanded (two standard deviations), the largest
  Eigen::Index out = 0, doubtful = 0;  // points out of the zone for sure; too near to its sides
  Conformity decision = Conformity::kConforms;  // of all points together
};

// `deviations`: the standard deviation of each distance. Throws std::invalid_argument unless low <
// high and there is one deviation, not negative, for each distance.
ProfileVerdict CheckProfile(const Eigen::VectorXd& distances,
                            const Eigen::VectorXd& deviations,
                            const ProfileZone& zone);

}  // namespace batten
