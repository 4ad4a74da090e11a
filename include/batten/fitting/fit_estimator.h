// SPDX-License-Identifier: MIT
// How a fit weighed its points and its fairness: what its uncertainty needs beyond the shape.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "batten/fitting/fairness_energy.h"
#include "batten/fitting/free_variables.h"
#include "batten/fitting/mirror_plane.h"
#include "batten/fitting/point_mask.h"
#include "batten/fitting/pole_kind.h"
#include "batten/fitting/robust_loss.h"
#include "batten/geometry/joins.h"

namespace batten {

// Rows of control points next to an edge that conditions hold: 1, or 2 with the tangent planes.
struct HeldEdge {
  SurfaceEdge edge;
  int rows = 1;
};

struct FitEstimator {
  // Why the shape has no uncertainty of this kind; empty: it has.
  std::string refused = "this kind of fit has no error bars";
  double smoothing = 0;  // fairness relative to the data, as FittingProblem has it
  FairnessEnergy energy = FairnessEnergy::kThinPlate;
  Loss loss = Loss::kNone;                          // on the distances
  std::optional<double> loss_scale = std::nullopt;  // estimated from the distances when absent
  FreeVariables freed;                              // what the joint stage freed, where it ran
  Poles poles;
  std::vector<HeldEdge> held_edges;
  Eigen::Matrix2Xd held_points = Eigen::Matrix2Xd(2, 0);  // parameters where the surface is fixed
  std::optional<MirrorPlane> symmetric = std::nullopt;    // in the coordinates of the result
  PointMask used = {};  // the points fitted to; empty: those that are no outliers
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  // of the result against the points

  // The indices of the points fitted to, of the cloud's `count`. Throws std::invalid_argument where
  // the shape has no uncertainty, or the mask of its outliers is that of another cloud.
  std::vector<Eigen::Index> UsedPoints(const PointMask& outliers, Eigen::Index count) const;
};

}  // namespace batten
