// SPDX-License-Identifier: MIT
// Input that all primitive fits share: the points without duplicates, the scale, and the report.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "batten/fitting/point_cloud.h"
#include "batten/fitting/primitive_options.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/core/stage_clock.h"
#include "fitting/primitives/shape_data.h"

namespace batten::internal {

// The input of one primitive fit and the data its stages share.
struct PrimitiveInput {
  // Throws std::invalid_argument, with a sentence for the user, where there are no points, or where
  // some differ but their extent is too small or too large to compute with. O(m).
  PrimitiveInput(const PointCloud& given, const PrimitiveFitOptions& chosen);

  const PointCloud& cloud;
  const PrimitiveFitOptions& options;
  ThreadPool pool;
  StageClock clock;
  FitReport report;
  MergedCloud merged;
  double unit = 1;         // about the points' size
  Eigen::Vector3d middle;  // of their box, in the cloud's local coordinates
  double rounding = 0;     // of the size: distances below mean nothing
  Eigen::Vector3d move;    // from local coordinates to those of the result

  const Eigen::Matrix3Xd& points() const { return merged.cloud.points(); }
  bool plane() const { return cloud.dimension() == 2; }

  // (points − middle) / unit, with weights of mean one.
  ShapeData LocalData() const;

  // Minus twice the log-likelihood of points that lie anywhere in a cube of the size, in units of
  // `unit`.
  double Anywhere(Eigen::Index points) const;

  // Throws std::invalid_argument, with a sentence for the user, where fewer than `fewest` points
  // differ.
  void Require(const std::string& what, Eigen::Index fewest) const;
};

// The used point with the largest residual, in world coordinates.
Eigen::Vector3d FarthestPoint(const PrimitiveFit& fit, const PointCloud& cloud);

// Completes the report with the measured errors, the termination and the times, and hands it to
// `fit`.
void FinishReport(PrimitiveInput& input,
                  PrimitiveSummary primitive,
                  const std::string& kind,
                  PrimitiveFit& fit);

}  // namespace batten::internal
