// SPDX-License-Identifier: MIT
// Options and result of fitting a solid of smooth spline faces.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "batten/fitting/fit_report.h"
#include "batten/fitting/point_mask.h"
#include "batten/fitting/progress.h"
#include "batten/geometry/quad_mesh.h"
#include "batten/geometry/solid_model.h"

namespace batten {

struct SolidFitOptions {
  // Distance in the data's units, > 0: faces of the layout with points beyond it are refined, if
  // points left out ask for that; absent: those that miss them by more than noise.
  std::optional<double> tolerance = std::nullopt;
  // Fairness relative to the data, ≥ 0, over the layout as it is; absent: by generalised
  // cross-validation.
  std::optional<double> smoothing = std::nullopt;
  int max_iterations = 40;     // ≥ 1: steps, where smoothing is given
  bool keep_outliers = false;  // all points count
  bool merge_faces = true;     // as few faces as the layout allows; else one for each of its own
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  // subtracted from the coordinates of the result
  std::uint64_t seed = 1;                           // of samples for spacing and noise
  int threads = 0;                                  // 0: all cores
  Progress progress = nullptr;
};

// Throws std::invalid_argument naming the field whose value breaks its rule.
void Check(const SolidFitOptions& options);

struct SolidFit {
  // In world coordinates less options.shift; where the layout has caps an open shell without them.
  SolidModel solid;
  SolidAudit audit;  // of it
  // Of the surface, in the same coordinates: with the layout's faces, or four or sixteen for each.
  QuadMesh control_mesh;
  QuadMeshSummary layout;      // of the layout
  Eigen::VectorXd residuals;   // of every point: signed along the normal
  Eigen::MatrixXd parameters;  // 2 × m, of its foot
  std::vector<int> faces;      // on which of the solid's faces that is
  PointMask outliers;          // points that did not count
  // Of every tenth point that counts, weighted: squared distances from a surface fitted without
  // these; empty where smoothing was given.
  Eigen::VectorXd held_out;
  FitReport report;
};

}  // namespace batten
