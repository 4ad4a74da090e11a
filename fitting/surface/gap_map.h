// SPDX-License-Identifier: MIT
// Where the domain of a surface holds no data, and what surrounds such places.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/fitting/fitting_problem.h"

namespace batten::internal {

// A connected part of the domain without data.
struct DataGap {
  std::vector<int> places;       // of the map, ascending
  std::vector<size_t> rim;       // those of them, by index, that touch places with data
  std::vector<int> shore;        // places outside that touch those
  std::vector<double> distance;  // of each place from the data
  double reach = 0;              // the greatest of those
  bool at_border = false;        // of the domain: not surrounded by data
};

// The domain cut into places half a spacing wide or, of many, wider; round periodic directions they
// are neighbours across the seam, and towards a pole a point fills the more of its row the nearer
// it is. A gap is what a disc of three spacings' radius covers wherever it holds no data: not the
// chance gaps between them. Distances are right to some hundredths (a chamfer in eight directions).
class GapMap {
 public:
  // Of a surface's problem; `measured` first data are asked, of them those with a weight. O(m).
  GapMap(const FittingProblem& problem, Eigen::Index measured, double spacing);

  const std::vector<DataGap>& gaps() const { return gaps_; }
  double gap_share() const;  // of the domain
  double side() const;       // of a place, the longer one
  Eigen::Vector2d Centre(int place) const;
  int GapAt(const Eigen::Vector2d& uv) const;  // the index of the gap there, or −1

  // Laplace's equation inside a gap, fixed at its rim, free at the domain's border: never outside
  // the convex hull of the rim's values. `rim`: d × rim places; result: d × places.
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
