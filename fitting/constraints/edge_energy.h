// SPDX-License-Identifier: MIT
// The fairness of a surface whose edges are given.
#pragma once

#include <Eigen/Core>
#include <array>

#include "fitting/constraints/edge_rows.h"
#include "batten/fitting/fairness_energy.h"

namespace batten::internal {

// With e_c the surface of one unknown of the rows of edges (last: of what is given), and ⟨ , ⟩ the
// bilinear form of the energy, coordinates added.
struct EdgeEnergy {
  std::array<Eigen::MatrixXd, 3> inner;  // ⟨M_i N_j, e_c⟩ of a coordinate: n_u·n_v × (unknowns + 1)
  Eigen::MatrixXd edges;                 // ⟨e_b, e_c⟩
};

// Every e_c is a sum of products of a spline of u and one of v, so all is made of one-dimensional
// forms. O(n · unknowns).
EdgeEnergy EnergyOf(const EdgeRows& edges, FairnessEnergy energy);

}  // namespace batten::internal
