// SPDX-License-Identifier: MIT
// Data gaps of a surface's domain: connected parts without data, their rims and distances.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/fitting/fitting_problem.h"

namespace batten::internal {

// A connected part of the domain without data.
struct DataGap {
  std::vector<int> places;       // of the map, ascending
  std::vector<size_t> rim;       // indices into places: those that touch places with data
  std::vector<int> shore;        // places outside the gap that touch the rim
  std::vector<double> distance;  // of each place from the data
  double reach = 0;              // the greatest of those
  bool at_border = false;        // of the domain: not surrounded by data
};

// Divides the domain into places half a spacing wide, wider where there would be more than 320
// along a side. In periodic directions places are neighbours across the seam; towards a pole a
// point fills more of its row the nearer it is to the pole. A gap is the union of discs of three
// spacings' radius that hold no data, so chance gaps between points do not count. Distances are
// accurate to some hundredths (chamfer distance in eight directions).
class GapMap {
 public:
  // Maps the gaps of a fitting problem; only its first `measured` data with a positive weight
  // count. O(m).
  GapMap(const FittingProblem& problem, Eigen::Index measured, double spacing);

  const std::vector<DataGap>& gaps() const { return gaps_; }
  double gap_share() const;  // of the domain
  double side() const;       // of a place, the longer one
  Eigen::Vector2d Centre(int place) const;
  int GapAt(const Eigen::Vector2d& uv) const;  // the index of the gap there, or −1

  // Solves Laplace's equation inside a gap with fixed values at its rim and a free boundary at the
  // domain's border; the solution never leaves the convex hull of the rim's values. `rim`: d × rim
  // places; result: d × places.
  Eigen::MatrixXd HarmonicFill(const DataGap& hole, const Eigen::MatrixXd& rim) const;

 private:
  int Place(double u, double v) const;
  int Neighbour(int place, int di, int dj) const;  // −1: beyond the border
  void Occupy(
      double u, double v, const Poles& poles, double spacing, std::vector<char>& occupied) const;
  std::vector<double> DistancesFrom(const std::vector<char>& marked) const;
  void FindDataGaps(const std::vector<char>& occupied, double radius);
  void Describe(DataGap& hole, const std::vector<double>& distance) const;

  int nu_, nv_;
  bool round_u_, round_v_;
  double u0_, v0_, du_, dv_;
  std::vector<int> gap_of_;  // of every place: index of its gap, or −1
  std::vector<DataGap> gaps_;
};

}  // namespace batten::internal
