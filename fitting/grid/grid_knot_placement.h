// SPDX-License-Identifier: MIT
// Knot placement in one direction of a grid: few knot lines that keep a tolerance.
#pragma once

#include <Eigen/Core>
#include <map>
#include <vector>

#include "batten/geometry/spline_basis.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// The breaks of a spline and the largest distance of a sample from its least-squares fit over them.
struct GridKnotPlacement {
  std::vector<double> breaks;
  double error = 0;
};

// Searches knots common to curves that share their parameters: the lines of a grid in one
// direction. For a number of spans, breaks start at equal shares of the samples and move in rounds
// of: fit all curves, take each span's largest error e; an error goes as the width to the power p +
// 1, so that the density of breaks grows in proportion to e^{1/(p+1)}, half of it a round in the
// logarithm. At the end errors of spans are nearly equal, which is best to first order.
// [equidistribution: de Boor 1973, "Good approximation by splines with variable knots"]
class GridKnotSearch {
 public:
  // `lines` lines of `curves` points (3 × (lines · curves), the curves fastest) at increasing
  // parameters in [lower, upper]. Closed: periodic there. With `meet_ends` fits go through the
  // first and last points.
  GridKnotSearch(int degree,
                 Eigen::VectorXd parameters,
                 Eigen::Matrix3Xd points,
                 double lower,
                 double upper,
                 bool closed,
                 bool meet_ends);

  // The largest number of spans that the samples determine with fewer than `control_points` control
  // points.
  int SpansBelow(int control_points) const;

  // The best breaks found for so many spans, cached; the search starts from the breaks of a similar
  // number of spans where these are known. O(lines · curves · p) for each of about ten rounds.
  const GridKnotPlacement& Best(int spans, ThreadPool& pool);

  // The least number of spans found, by doubling and halving, that keeps the tolerance; most + 1
  // where none does up to `most`.
  int SpansFor(double tolerance, int most, ThreadPool& pool);

  SplineBasis BasisOf(const std::vector<double>& breaks) const;
  int ControlPoints(int spans) const { return closed_ ? spans : spans + degree_; }

 private:
  // Largest errors of the lines; empty where the samples don't determine the fit.
  std::vector<double> LineErrors(const std::vector<double>& breaks, ThreadPool& pool) const;
  const GridKnotPlacement* NearestTo(int spans) const;  // of those found
  std::vector<double> EqualShares(int spans) const;
  std::vector<double> Moved(const std::vector<double>& breaks,
                            const std::vector<double>& errors) const;

  int degree_;
  Eigen::VectorXd parameters_;
  Eigen::Matrix3Xd points_;
  double lower_, upper_;
  bool closed_, meet_ends_;
  std::map<int, GridKnotPlacement> found_;
};

}  // namespace batten::internal
