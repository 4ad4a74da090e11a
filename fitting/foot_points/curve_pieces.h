// SPDX-License-Identifier: MIT
// A polynomial curve as power-basis pieces, one a span, for foot-point search.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/foot_points/curve_foot_kernel.h"

namespace batten::internal {

// Builds the table that LocalCurveFootPoints reads. The curve must have no weights and a degree of
// kMaxFootDegree at most. O(n p²).
template <int Dim>
class CurvePieces {
 public:
  static bool Covers(const NurbsCurve<Dim>& curve) {
    return !curve.rational() && curve.basis().degree() <= kMaxFootDegree;
  }

  explicit CurvePieces(const NurbsCurve<Dim>& curve);

  CurvePieceTable table() const;
  int size() const { return static_cast<int>(breaks_.size()) - 1; }

 private:
  int degree_;
  bool periodic_;
  std::vector<double> breaks_, powers_;
};

extern template class CurvePieces<2>;
extern template class CurvePieces<3>;

// Foot points, a local minimum each, from starts in the domain: many at once by
// LocalCurveFootPoints where that converges, by CurveFootPoints::Near elsewhere. Points are Dim ×
// m. About 30 million a second and core. Results do not depend on the number of threads.
template <int Dim>
Eigen::VectorXd LocalFootPointsKernel(const NurbsCurve<Dim>& curve,
                                      const Eigen::MatrixXd& points,
                                      const Eigen::VectorXd& starts,
                                      ThreadPool& pool);

extern template Eigen::VectorXd LocalFootPointsKernel<2>(const NurbsCurve<2>&,
                                                         const Eigen::MatrixXd&,
                                                         const Eigen::VectorXd&,
                                                         ThreadPool&);
extern template Eigen::VectorXd LocalFootPointsKernel<3>(const NurbsCurve<3>&,
                                                         const Eigen::MatrixXd&,
                                                         const Eigen::VectorXd&,
                                                         ThreadPool&);

}  // namespace batten::internal
