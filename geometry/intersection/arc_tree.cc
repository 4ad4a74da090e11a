// SPDX-License-Identifier: MIT
#include "geometry/intersection/arc_tree.h"

#include <algorithm>
#include <utility>

namespace batten::internal {
namespace {

// The direction of C' lies in the cone of the steps of a rational Bézier curve's control points.
// [Floater 1992]
void MeasureArc(NetArc& arc) {
  arc.points = arc.net.colwise().hnormalized();
  arc.bounds = Eigen::AlignedBox3d();
  for (const auto& x : arc.points.colwise()) arc.bounds.extend(Eigen::Vector3d(x));
  const Eigen::Index p = arc.points.cols() - 1;
  const Eigen::Matrix3Xd steps = arc.points.rightCols(p) - arc.points.leftCols(p);
  arc.tangent = ConeOf(steps, 0);
  arc.size = steps.colwise().norm().sum();
  const Eigen::Vector3d chord = arc.points.col(p) - arc.points.col(0);
  const double length = chord.norm();
  arc.flatness = length > 0 ? 0 : arc.size;
  for (const auto& x : arc.points.colwise()) {
    const Eigen::Vector3d d = x - arc.points.col(0);
    if (length > 0) arc.flatness = std::max(arc.flatness, d.cross(chord).norm() / length);
  }
}

}  // namespace

template <int Dim>
ArcTree::ArcTree(const NurbsCurve<Dim>& curve, const Eigen::Vector3d& origin)
    : pieces_(PiecesOf(curve)) {
  for (CurvePiece& piece : pieces_) {
    piece.origin -= origin;
    NetArc arc;
    arc.u0 = piece.u0;
    arc.u1 = piece.u1;
    arc.net = piece.points;
    arc.net.topRows<3>() += piece.origin * piece.points.row(3);
    MeasureArc(arc);
    arcs_.push_back(std::move(arc));
  }
  roots_ = static_cast<int>(arcs_.size());
}

template ArcTree::ArcTree(const NurbsCurve<2>&, const Eigen::Vector3d&);
template ArcTree::ArcTree(const NurbsCurve<3>&, const Eigen::Vector3d&);

int ArcTree::Halve(int k) {
  if (arcs_[k].children >= 0) return arcs_[k].children;
  NetArc low = arcs_[k], high = low;
  Eigen::Matrix4Xd b = low.net;
  const Eigen::Index p = b.cols() - 1;
  for (Eigen::Index r = 0; r <= p; ++r) {
    low.net.col(r) = b.col(0);
    high.net.col(p - r) = b.col(p - r);
    for (Eigen::Index i = 0; i < p - r; ++i) b.col(i) = (b.col(i) + b.col(i + 1)).eval() / 2;
  }
  low.u1 = high.u0 = low.Middle();
  MeasureArc(low);
  MeasureArc(high);
  const int first = static_cast<int>(arcs_.size());
  arcs_[k].children = first;
  arcs_.push_back(std::move(low));
  arcs_.push_back(std::move(high));
  return first;
}

Eigen::Matrix<double, 3, 2> ArcTree::JetAt(double u) const {
  auto place =
      std::upper_bound(pieces_.begin(), pieces_.end(), u, [](double x, const CurvePiece& piece) {
        return x < piece.u0;
      });
  const CurvePiece& piece = place == pieces_.begin() ? *place : *(place - 1);
  const double wide = piece.u1 - piece.u0;
  const CurvePieceJet jet = JetOf(piece, (u - piece.u0) / wide);
  Eigen::Matrix<double, 3, 2> columns;
  columns << jet.point + piece.origin, jet.first / wide;
  return columns;
}

}  // namespace batten::internal
