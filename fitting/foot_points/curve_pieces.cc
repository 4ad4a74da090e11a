// SPDX-License-Identifier: MIT
#include "fitting/foot_points/curve_pieces.h"

#include <cstddef>

#include "batten/geometry/foot_point.h"
#include "fitting/core/shared_constants.h"
#include "geometry/nurbs/span_breaks.h"

namespace batten::internal {

template <int Dim>
CurvePieces<Dim>::CurvePieces(const NurbsCurve<Dim>& curve)
    : degree_(curve.basis().degree()),
      periodic_(curve.basis().periodic()),
      breaks_(BreaksIn(curve.basis())) {
  powers_.reserve(static_cast<size_t>(size() * Dim * (degree_ + 1)));
  for (size_t i = 0; i + 1 < breaks_.size(); ++i) {
    const double half = 0.5 * (breaks_[i + 1] - breaks_[i]);
    const auto derivatives = curve.Derivatives(0.5 * (breaks_[i] + breaks_[i + 1]), degree_);
    double scale = 1;
    for (int k = 0; k <= degree_; ++k) {
      for (int d = 0; d < Dim; ++d) powers_.push_back(scale * derivatives(d, k));
      scale *= half / (k + 1);
    }
  }
}

template <int Dim>
CurvePieceTable CurvePieces<Dim>::table() const {
  return {Dim, degree_, size(), periodic_, breaks_.data(), powers_.data()};
}

template class CurvePieces<2>;
template class CurvePieces<3>;

namespace {

template <int Dim>
void SlowCorrection(const NurbsCurve<Dim>& curve,
                    const Eigen::MatrixXd& points,
                    const Eigen::VectorXd& starts,
                    const std::vector<Eigen::Index>& which,
                    Eigen::VectorXd& feet,
                    ThreadPool& pool) {
  const CurveFootPoints<Dim> finder(curve);
  pool.For(std::ssize(which), kPointsPerTask, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    Eigen::Vector3d q = Eigen::Vector3d::Zero();
    for (std::ptrdiff_t i = begin; i < end; ++i) {
      const Eigen::Index k = which[static_cast<size_t>(i)];
      q.head<Dim>() = points.col(k);
      feet[k] = finder.Near(q, starts[k]).u;
    }
  });
}

}  // namespace

template <int Dim>
Eigen::VectorXd LocalFootPointsKernel(const NurbsCurve<Dim>& curve,
                                      const Eigen::MatrixXd& points,
                                      const Eigen::VectorXd& starts,
                                      ThreadPool& pool) {
  Eigen::VectorXd feet(points.cols());
  std::vector<int> found(static_cast<size_t>(points.cols()), -1);
  if (CurvePieces<Dim>::Covers(curve)) {
    const CurvePieces<Dim> pieces(curve);
    const CurvePieceTable table = pieces.table();
    pool.For(points.cols(), kPointsPerTask, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      double squares[kPointsPerTask];
      LocalCurveFootPoints(table,
                           points.data() + Dim * begin,
                           starts.data() + begin,
                           end - begin,
                           {feet.data() + begin, squares, found.data() + begin});
    });
  }
  std::vector<Eigen::Index> missed;
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    if (found[static_cast<size_t>(k)] < 0) missed.push_back(k);
  }
  if (!missed.empty()) SlowCorrection(curve, points, starts, missed, feet, pool);
  return feet;
}

template Eigen::VectorXd LocalFootPointsKernel<2>(const NurbsCurve<2>&,
                                                  const Eigen::MatrixXd&,
                                                  const Eigen::VectorXd&,
                                                  ThreadPool&);
template Eigen::VectorXd LocalFootPointsKernel<3>(const NurbsCurve<3>&,
                                                  const Eigen::MatrixXd&,
                                                  const Eigen::VectorXd&,
                                                  ThreadPool&);

}  // namespace batten::internal
