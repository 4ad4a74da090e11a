// SPDX-License-Identifier: MIT
// The fairness energy of a surface with given edges, as a quadratic form of its unknowns.
#pragma once

#include <Eigen/Core>
#include <array>

#include "fitting/constraints/edge_rows.h"
#include "batten/fitting/fairness_energy.h"

namespace batten::internal {

// Blocks of the energy's quadratic form. e_c is the surface of one unknown of the edge rows (the
// last: of the given part), ⟨ , ⟩ the bilinear form of the energy summed over coordinates.
struct EdgeEnergy {
  std::array<Eigen::MatrixXd, 3> inner;  // ⟨M_i N_j, e_c⟩ of a coordinate: n_u·n_v × (unknowns + 1)
  Eigen::MatrixXd edges;                 // ⟨e_b, e_c⟩
};

// Computes the blocks from one-dimensional forms, since every e_c is a sum of products of a spline
// of u and one of v. O(n · unknowns).
EdgeEnergy EnergyOf(const EdgeRows& edges, FairnessEnergy energy);

}  // namespace batten::internal
