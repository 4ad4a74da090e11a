// SPDX-License-Identifier: MIT
#include "batten/fitting/profile_check.h"

#include <algorithm>
#include <stdexcept>

namespace batten {

const char* Name(Conformity conformity) {
  switch (conformity) {
    case Conformity::kConforms:
      return "conforms";
    case Conformity::kUndecided:
      return "undecided";
    case Conformity::kDoesNotConform:
      return "does_not_conform";
  }
  return "";
}

ProfileVerdict CheckProfile(const Eigen::VectorXd& distances,
                            const Eigen::VectorXd& deviations,
                            const ProfileZone& zone) {
  constexpr double kCoverage = 2;  // standard deviations: 95 %
  if (!(zone.low < zone.high))
    throw std::invalid_argument("CheckProfile: zone: low must be below high");
  if (deviations.size() != distances.size() || !(deviations.array() >= 0).all())
    throw std::invalid_argument("CheckProfile: deviations: one, not negative, for each distance");
  ProfileVerdict verdict;
  verdict.zone = zone;
  if (distances.size() == 0) return verdict;
  verdict.lowest = distances.minCoeff();
  verdict.highest = distances.maxCoeff();
  verdict.uncertainty = kCoverage * deviations.maxCoeff();
  for (Eigen::Index k = 0; k < distances.size(); ++k) {
    const double beyond = std::max(zone.low - distances[k], distances[k] - zone.high);
    const double doubt = kCoverage * deviations[k];
    verdict.out += beyond > doubt;
    verdict.doubtful += beyond <= doubt && beyond > -doubt;
  }
  verdict.decision = verdict.out > 0        ? Conformity::kDoesNotConform
                     : verdict.doubtful > 0 ? Conformity::kUndecided
                                            : Conformity::kConforms;
  return verdict;
}

}  // namespace batten
