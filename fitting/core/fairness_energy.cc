// SPDX-License-Identifier: MIT
#include "batten/fitting/fairness_energy.h"

#include <algorithm>

namespace batten {

std::vector<EnergyTerm> EnergyTerms(FairnessEnergy energy, int outer_degree, int inner_degree) {
  const int wanted = energy == FairnessEnergy::kMembrane    ? 1
                     : energy == FairnessEnergy::kThinPlate ? 2
                                                            : 3;
  if (inner_degree == 0) return {{std::min(wanted, outer_degree), 0, 1}};
  const int order = std::min({wanted, outer_degree, inner_degree});
  std::vector<EnergyTerm> terms;
  double binomial = 1;
  for (int k = 0; k <= order; ++k) {
    terms.push_back({order - k, k, binomial});
    binomial = binomial * (order - k) / (k + 1);
  }
  return terms;
}

}  // namespace batten
