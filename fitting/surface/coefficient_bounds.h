// SPDX-License-Identifier: MIT
// Intervals for the coefficients of a surface, from the data in their supports.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/fitting_problem.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// For each coefficient of the net (v fastest) the interval [low, high] of its height: the one value
// of a height field; of points in space the component along a direction of its own.
struct CoefficientBounds {
  Eigen::VectorXd low, high;
  Eigen::Matrix3Xd up;  // points in space only

  double HeightOf(const Eigen::MatrixXd& net, Eigen::Index k) const {
    return net.rows() == 1 ? net(0, k) : up.col(k).dot(net.col(k));
  }
  // With intervals so many times as wide.
  void Widen(double factor) {
    const Eigen::VectorXd more = (factor - 1) / 2 * (high - low);
    low -= more;
    high += more;
  }
  // Whether any coefficient of a net is outside.
  bool Leaves(const Eigen::MatrixXd& net) const {
    for (Eigen::Index k = 0; k < low.size(); ++k) {
      const double height = HeightOf(net, k);
      if (height < low[k] || height > high[k]) return true;
    }
    return false;
  }
  // Moves a coefficient along its direction to a height.
  void SetHeight(Eigen::MatrixXd& net, Eigen::Index k, double height) const {
    if (net.rows() == 1) {
      net(0, k) = height;
    } else {
      net.col(k) += (height - HeightOf(net, k)) * up.col(k);
    }
  }
};

// Whether the data with positive weight leave no quarter of a cell empty.
bool FillsEveryCell(const FittingProblem& problem);

// Bounds about a smooth shape, the net `smooth` over the problem's bases. A coefficient's interval
// is the range of the heights above the shape, along its normal, that the data in its support have
// (at least four data, else those of the cells around it too), grown on both sides by `slack` and a
// margin of the range:
//  · where the support has a gap, an empty quarter of a cell or, for points in space, whose
//    parameters are less sure, an empty cell: by how much the coefficient of a polynomial can leave
//    the range of the polynomial on the support. It is the polynomial's polar form at the knots
//    inside; Chebyshev polynomials give 7/6 of the half range over equal cubic spans, 1 at a
//    clamped end, and the product of both directions' factors in two. (Next to a clamped end others
//    give a little more: 0.27 of the range for the third cubic coefficient, where these give 0.22.)
//    By the convex hull property the surface in a gap stays near the smooth shape and the data
//    around it. Of a height field no such coefficient leaves the range of all heights by more than
//    a fifth of it and the slack.
//  · elsewhere by what a spline within the range needs: the range itself for cubics.
// Only data with positive weight count. Periodic directions wrap.
// O(m (p+1)(q+1)). [polar forms: Ramshaw 1989]
CoefficientBounds BoundsFromData(const FittingProblem& problem,
                                 const Eigen::MatrixXd& smooth,
                                 double slack,
                                 ThreadPool& pool);

}  // namespace batten::internal
