// SPDX-License-Identifier: MIT
// A surface near all points, by which they get parameters.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "batten/geometry/surface_evaluator.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/parameterization/parameterization.h"
#include "fitting/streaming/foot_guesses.h"
#include "fitting/streaming/place_sums.h"

namespace batten::internal {

// Parameters and offsets of points: over a plane their coordinates and heights above the surface,
// else their foot points and signed distances. `distances` are those along the normal of the
// surface at the parameters.
struct PlacedPoints {
  Eigen::Matrix2Xd parameters;
  Eigen::VectorXd offsets, distances;
};

// A surface over the parameters of a base, in local coordinates, continued by `room` beyond edges
// that are open, so that points beyond those of a sample have a place.
class NearSurface {
 public:
  // `expected`: the number of points that will be placed; `some` of them.
  NearSurface(Parameterization base,
              const NurbsSurface& surface,
              double room,
              double expected,
              const Eigen::Matrix3Xd& some,
              ThreadPool& pool);

  PlacedPoints Place(const Eigen::Matrix3Xd& points, ThreadPool& pool) const;

  // The parameters that points may have.
  const Eigen::Vector2d& low() const { return low_; }
  const Eigen::Vector2d& high() const { return high_; }

  // The base of means of places, whose rectangle they fill up to the margin in directions that are
  // open; and the points that the means stand for.
  Parameterization BaseOf(const std::vector<PlaceMeans>& places, double margin) const;
  Eigen::Matrix3Xd PointsOf(const std::vector<PlaceMeans>& places) const;

 private:
  void PlaceOverPlane(const Eigen::Matrix3Xd& points, ThreadPool& pool, PlacedPoints& placed) const;

  Parameterization base_;
  SurfaceEvaluator surface_;
  std::optional<FootGuesses> guesses_;  // where the base is no plane
  Eigen::Vector2d low_, high_;
};

}  // namespace batten::internal
