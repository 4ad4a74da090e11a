// SPDX-License-Identifier: MIT
// Which fairness energy a shape is made fair by.
#pragma once

#include <vector>

namespace batten {

// Integrals over the domain, of a surface ∫∫ and of a curve ∫, with parameters that are lengths:
enum class FairnessEnergy {
  kMembrane,    // S_u² + S_v²; C′²: short, bends freely; holds nothing but its place
  kThinPlate,   // S_uu² + 2 S_uv² + S_vv²; C″²: does not see planes
  kThirdOrder,  // S_uuu² + 3 S_uuv² + 3 S_uvv² + S_vvv²; C‴²: does not see quadratics
};

// One square of the energy: factor · (∂^outer ∂^inner S)².
struct EnergyTerm {
  int outer, inner;  // orders of derivatives
  double factor;
};

// The terms of an energy, which together do not change when the parameter plane is turned. Pieces
// of a degree below the order have no such derivatives: the highest order that both degrees (> 0)
// carry is taken instead. A curve has inner degree 0.
std::vector<EnergyTerm> EnergyTerms(FairnessEnergy energy, int outer_degree, int inner_degree);

}  // namespace batten
