// SPDX-License-Identifier: MIT
#include "geometry/editing/tied_points.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "batten/geometry/closure.h"
#include "geometry/numeric/box_diagonal.h"

namespace batten::internal {
namespace {

// Whether two rows of control points coincide, for a net of this extent.
template <typename Points>
bool Coincide(const Points& a, const Points& b, double size) {
  return ((a - b).colwise().norm().array() <= kCloses * size).all();
}

}  // namespace

template <int Dim>
TiedPoints::TiedPoints(const NurbsCurve<Dim>& curve)
    : first_(static_cast<size_t>(DistinctPoints(curve))) {
  std::iota(first_.begin(), first_.end(), 0);
  const auto& points = curve.control_points();
  closed_u_ = curve.basis().clamped() && !curve.basis().periodic() &&
              Coincide(points.leftCols(1), points.rightCols(1), BoxDiagonal(points));
  if (closed_u_) Tie(0, points.cols() - 1);
}

TiedPoints::TiedPoints(const NurbsSurface& surface, Of what)
    : first_(static_cast<size_t>(DistinctPoints(surface))) {
  std::iota(first_.begin(), first_.end(), 0);
  const SplineBasis &u = surface.basis_u(), &v = surface.basis_v();
  const Eigen::Index rows = DistinctPoints(u), columns = DistinctPoints(v),
                     last_u = surface.size_u() - 1, last_v = surface.size_v() - 1;
  const double size = BoxDiagonal(surface.control_points());
  const auto row = [&](Eigen::Index i) {
    return surface.control_points().middleCols(i * surface.size_v(), surface.size_v());
  };
  const auto column = [&](Eigen::Index j) {
    return surface.control_points()(Eigen::all, Eigen::seqN(j, surface.size_u(), surface.size_v()));
  };
  const bool ends_u = u.clamped() && !u.periodic(), ends_v = v.clamped() && !v.periodic();
  closed_u_ = ends_u && Coincide(row(0), row(last_u), size);
  closed_v_ = ends_v && Coincide(column(0), column(last_v), size);
  for (Eigen::Index j = 0; closed_u_ && j < columns; ++j) Tie(j, last_u * columns + j);
  for (Eigen::Index i = 0; closed_v_ && i < rows; ++i) Tie(i * columns, i * columns + last_v);
  if (what == Of::kSeams) return;
  const CollapsedEdgeSet poles = CollapsedEdges(surface);
  for (const auto& [pole, i] :
       {std::pair(poles.u_lower, Eigen::Index{0}), {poles.u_upper, last_u}}) {
    for (Eigen::Index j = 1; pole && ends_u && j < columns; ++j) Tie(i * columns, i * columns + j);
  }
  for (const auto& [pole, j] :
       {std::pair(poles.v_lower, Eigen::Index{0}), {poles.v_upper, last_v}}) {
    for (Eigen::Index i = 1; pole && ends_v && i < rows; ++i) Tie(j, i * columns + j);
  }
}

// Roots come before what hangs on them.
Eigen::Index TiedPoints::First(Eigen::Index k) const {
  while (first_[static_cast<size_t>(k)] != k) k = first_[static_cast<size_t>(k)];
  return k;
}

void TiedPoints::Tie(Eigen::Index a, Eigen::Index b) {
  const Eigen::Index one = First(a), other = First(b);
  first_[static_cast<size_t>(std::max(one, other))] = std::min(one, other);
}

ControlForm TiedPoints::Together(const ControlForm& form) const {
  ControlForm together{{}, Eigen::VectorXd(form.values.size())};
  for (size_t k = 0; k < form.index.size(); ++k) {
    AddTerm(together, First(form.index[k]), form.values[static_cast<Eigen::Index>(k)]);
  }
  together.values.conservativeResize(std::ssize(together.index));
  return together;
}

Eigen::MatrixXd TiedPoints::Spread(Eigen::MatrixXd moves) const {
  for (Eigen::Index k = 0; k < moves.cols(); ++k) moves.col(k) = moves.col(First(k)).eval();
  return moves;
}

template TiedPoints::TiedPoints(const NurbsCurve<2>&);
template TiedPoints::TiedPoints(const NurbsCurve<3>&);

}  // namespace batten::internal
