// SPDX-License-Identifier: MIT
// Proves of one piece after another that it holds nothing nearer to a point than the best place so
// far, or finds a nearer place. Internal to the search for closest points.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/trim_region.h"
#include "geometry/bezier/bernstein_polynomial.h"
#include "geometry/foot_points/foot_kernels.h"
#include "geometry/foot_points/foot_table.h"
#include "geometry/foot_points/found_foot.h"

namespace batten::internal {

// What the square of a least distance may be missed by, with rounding.
double AcceptableFootMiss(const FootTable& table, double squared);

// Whether nothing is proved to be nearer by more than that, or, with trims, a few times as much.
bool IsCertified(const FootTable& table, const FoundFoot& found);

// With a region, only places in it count, and on its loops nothing may be nearer than the start. A
// nearer place of the region is then still found: where |S − q| falls towards one side of a cell,
// whoever follows it from a place inside comes to that side or to a loop first; and the nearer
// places of a convex cell hang together, so that none counts where one does not.
class DistanceCertificate {
 public:
  // `arena` is scratch memory that grows as needed.
  DistanceCertificate(const FootTable& table,
                      const Eigen::Vector3d& q,
                      const FoundFoot& start,
                      std::vector<double>& arena,
                      const TrimRegion* region = nullptr,
                      int most_work = kMostWork);

  // Coefficients looked at for one point before the bound is given as it stands: a second
  // at most, of places that are equally near all over a shape.
  static constexpr int kMostWork = 5000000;

  // After this nothing on the piece, whose box has that squared distance, is nearer than the lower
  // bound of the result. `cut`: a loop passes through the piece, which otherwise counts wholly.
  void Check(int piece, double box_squared, bool cut = false);

  double squared() const { return squared_; }
  // What a squared distance may be missed by.
  double AcceptableMiss() const;
  FoundFoot result() const;

 private:
  // Part of the piece: its place in local parameters, degrees (an edge has one degree zero), the
  // coefficients of F and, where F is made from it, the net about q.
  struct Cell {
    LocalBox box;
    int p, q;
    double* f;
    double* net;  // null: F comes from the table
    int values() const { return (2 * p + 1) * (2 * q + 1); }
    int numbers() const { return 4 * (p + 1) * (q + 1); }
  };
  enum class PointClass { kNothingNearer, kNearer, kUndecided };

  PointClass CheckCell(const Cell& cell, int depth, size_t used);
  PointClass CheckConvex(const Cell& cell, double bend);
  PointClass CheckSide(const Cell& cell, bool first, bool low, int depth, size_t used);
  PointClass CheckHalves(const Cell& cell, bool first, int depth, size_t used);
  PointClass Corner(const Cell& cell);
  PointClass Try(const LocalBox& box, double x, double y);
  FootPlace DescendInRegion(const LocalBox& box, double x, double y) const;
  bool Counts(double x, double y) const { return !cut_ || InRegion(x, y); }
  bool InRegion(double x, double y) const;
  bool Outside(const LocalBox& box) const;
  PointClass Certify(double least);
  double SquaresOfNet(const Cell& cell);
  Cell Take(const Cell& like, size_t& used);

  const FootTable& table_;
  Eigen::Vector3d q_;
  std::vector<double>& arena_;
  const TrimRegion* region_;
  bool cut_ = false;  // the piece at hand counts in part

  int best_piece_;
  double best_x_, best_y_, squared_;

  double epsilon_;  // an acceptable miss
  // Of the cell at hand: F ≥ 0 there means |S − q|² ≥ d² − tolerance; and F is that much (times w²)
  // lower than what must be negative for a nearer place.
  double tolerance_ = 0, margin_ = 0;
  double wanted_ = 0;  // an acceptable miss of the squared distance
  double proved_;      // no squared distance looked at so far is below this
  const int most_work_;
  int work_ = 0;  // coefficients looked at for this point

  int piece_ = 0;
  Eigen::Vector3d local_q_;
  FootPiece form_{};
};

}  // namespace batten::internal
