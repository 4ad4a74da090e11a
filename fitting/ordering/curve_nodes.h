// SPDX-License-Identifier: MIT
// Nodes on the middle lines of a cloud along curves, and its noise and spacing.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// The parabola fitted to neighbours across the direction in which they run.
struct LocalParabola {
  explicit LocalParabola(const Eigen::Matrix3Xd& points);

  // The distance of a point from it, or beyond its ends from the end's height.
  double Off(const Eigen::Vector3d& point) const;

  Eigen::Vector3d middle;
  Eigen::Matrix3d frame;  // the direction in the last column
  double along;           // Σ of squares of the places along it
  Eigen::VectorXd x;      // these over the root of that sum
  Eigen::Matrix<double, 3, 2> coefficients;
  Eigen::MatrixX2d rest;  // what it leaves across, the larger in the second column
};

inline constexpr Eigen::Index kNodeSample = 2000;  // points looked at for the scale
inline constexpr size_t kFewestForNoise = 12;      // points that tell it

// Standard deviation of one coordinate across the curve, from distances that have one such
// coordinate where the points are of a plane (rank 2 or less) and two in space.
double SigmaOfDistances(std::vector<double> distances, int rank);

// Returns at most `most` of the points, at even steps of their order.
Eigen::Matrix3Xd EveryFew(const Eigen::Matrix3Xd& points, Eigen::Index most);

// Noise and spacing of points along curves.
struct CurveScale {
  double noise = 0;    // standard deviation across the curve; 0 below 12 points
  double spacing = 0;  // median distance to the second neighbour; of many points, what it were if
                       // all lay along the middle line
};

// Estimates noise and spacing. The noise is the residual of a parabola through the neighbours of a
// point, at the first number of neighbours that makes them longer than thick; the median over some
// hundreds of points. Points must be distinct and in an order unrelated to the curve. O(m).
CurveScale ScaleOfCurves(const Eigen::Matrix3Xd& points);

// Returns nodes no two of which are nearer than `radius`. Where the noise exceeds the spacing of
// the points, each has moved to the middle of the points around it (mean shift across the direction
// in which they run); else they are points of the cloud. Those between curves, with far fewer
// points around than the next, are left out. O(m log m).
Eigen::Matrix3Xd CurveNodes(const Eigen::Matrix3Xd& points,
                            double noise,
                            double radius,
                            ThreadPool& pool);

}  // namespace batten::internal
