// SPDX-License-Identifier: MIT
#include "geometry/intersection/patch_tree.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/intersection/normal_net.h"
#include "geometry/numeric/box_diagonal.h"
#include "geometry/nurbs/span_breaks.h"

namespace batten::internal {
namespace {

// For each span the break below and above it at which the shape may have a crease.
std::vector<std::pair<double, double>> SmoothStretches(const SplineBasis& basis) {
  const std::vector<double> breaks = BreaksIn(basis);
  std::vector<std::pair<double, double>> stretches;
  for (std::size_t from = 0, k = 1; k < breaks.size(); ++k) {
    if (k + 1 < breaks.size() && basis.Multiplicity(breaks[k]) < basis.degree()) continue;
    for (std::size_t i = from; i < k; ++i) stretches.emplace_back(breaks[from], breaks[k]);
    from = k;
  }
  return stretches;
}

// The number of the span between breaks that holds x, among those in [low, high].
std::size_t SpanIn(const std::vector<double>& breaks, double low, double high, double x) {
  const auto first = std::lower_bound(breaks.begin(), breaks.end(), low);
  const auto last = std::lower_bound(first, breaks.end(), high);
  const auto place = std::upper_bound(first, last, x);
  const auto span = place == first ? first : place - 1;
  return static_cast<std::size_t>(std::min(span, last - 1) - breaks.begin());
}

// Columns P_{i+1,j} − P_{ij} of the numerators, or those along v.
Eigen::Matrix3Xd Steps(const Eigen::Matrix4Xd& net, int p, int q, bool along_u) {
  const int n = q + 1, stride = along_u ? n : 1;
  Eigen::Matrix3Xd steps(3, along_u ? p * n : (p + 1) * q);
  Eigen::Index k = 0;
  for (int i = 0; i <= p - (along_u ? 1 : 0); ++i) {
    for (int j = 0; j <= q - (along_u ? 0 : 1); ++j) {
      const int c = i * n + j;
      steps.col(k++) = (net.col(c + stride) - net.col(c)).head<3>();
    }
  }
  return steps;
}

// S_u times the weight is X_u − w_u·S, X the numerator about the patch's middle: X_u lies in the
// cone of its own control vectors, and |w_u·S| is at most the greatest step of weights times the
// radius.
DirectionCone TangentCone(const Eigen::Matrix4Xd& net, int p, int q, bool along_u, double radius) {
  const int n = q + 1, stride = along_u ? n : 1;
  double step = 0;
  for (int i = 0; i <= p - (along_u ? 1 : 0); ++i) {
    for (int j = 0; j <= q - (along_u ? 0 : 1); ++j) {
      const int c = i * n + j;
      step = std::max(step, std::abs(net(3, c + stride) - net(3, c)));
    }
  }
  return ConeOf(Steps(net, p, q, along_u), step * radius);
}

void MeasureNet(NetPatch& patch, int p, int q) {
  const Eigen::Matrix4Xd& net = patch.net;
  patch.points = net.colwise().hnormalized();
  patch.bounds = Eigen::AlignedBox3d();
  for (const auto& x : patch.points.colwise()) patch.bounds.extend(Eigen::Vector3d(x));
  const Eigen::Vector3d middle = patch.bounds.center();
  Eigen::Matrix4Xd local = net;
  local.topRows<3>() -= middle * net.row(3);
  const double radius = patch.bounds.diagonal().norm() / 2;
  patch.along_u = TangentCone(local, p, q, true, radius);
  patch.along_v = TangentCone(local, p, q, false, radius);
  patch.normal = CrossCone(patch.along_u, patch.along_v);
  // Tangents turn round a pole, normals do not.
  constexpr double kWide = 0.5, kJunk = 1e-12, kUnits = 0x1p-48;
  if (patch.normal.spread > kWide && radius > 0) {
    const double rounding = kJunk + kUnits * patch.points.cwiseAbs().maxCoeff() / radius;
    const DirectionCone cone = ConeOf(NormalNet(local, p, q, rounding), 0);
    if (cone.spread < patch.normal.spread) patch.normal = cone;
  }
  patch.size_u = patch.size_v = 0;
  const int n = q + 1;
  for (int j = 0; j <= q; ++j) {
    double length = 0;
    for (int i = 0; i < p; ++i) {
      length += (patch.points.col((i + 1) * n + j) - patch.points.col(i * n + j)).norm();
    }
    patch.size_u = std::max(patch.size_u, length);
  }
  for (int i = 0; i <= p; ++i) {
    double length = 0;
    for (int j = 0; j < q; ++j) {
      length += (patch.points.col(i * n + j + 1) - patch.points.col(i * n + j)).norm();
    }
    patch.size_v = std::max(patch.size_v, length);
  }
  if (patch.normal.known()) {
    const Eigen::RowVectorXd heights = patch.normal.axis.transpose() * patch.points;
    patch.flatness = (heights.maxCoeff() - heights.minCoeff()) / 2;
  } else {
    patch.flatness = radius;
  }
}

}  // namespace

PatchTree::PatchTree(const NurbsSurface& surface, const Eigen::Vector3d& origin)
    : breaks_u_(BreaksIn(surface.basis_u())),
      breaks_v_(BreaksIn(surface.basis_v())),
      p_(surface.basis_u().degree()),
      q_(surface.basis_v().degree()) {
  const auto& points = surface.control_points();
  size_ = BoxDiagonal(points);
  const SurfacePieces pieces(surface);
  const auto smooth_u = SmoothStretches(surface.basis_u());
  const auto smooth_v = SmoothStretches(surface.basis_v());
  for (int i = 0; i < pieces.count_u(); ++i) {
    for (int j = 0; j < pieces.count_v(); ++j) {
      pieces_.push_back(pieces.Piece(i, j));
      pieces_.back().origin -= origin;
      smooth_.push_back(
          {smooth_u[i].first, smooth_u[i].second, smooth_v[j].first, smooth_v[j].second});
    }
  }
  for (const SurfacePiece& piece : pieces_) AddRoot(piece);
  roots_ = static_cast<int>(patches_.size());
}

void PatchTree::AddRoot(const SurfacePiece& piece) {
  NetPatch patch;
  patch.box = {piece.u0, piece.u1, piece.v0, piece.v1};
  patch.piece = static_cast<int>(patches_.size());
  patch.net = piece.points;
  patch.net.topRows<3>() += piece.origin * piece.points.row(3);
  patch.net /= piece.points.row(3).maxCoeff();
  Measure(patch);
  patches_.push_back(std::move(patch));
}

void PatchTree::Measure(NetPatch& patch) const {
  MeasureNet(patch, p_, q_);
  const Eigen::Vector2d middle = patch.Middle();
  const SurfaceJet jet = JetAt(smooth_[patch.piece], middle[0], middle[1]);
  patch.middle = jet.point;
  patch.half_u = (patch.box.u1 - patch.box.u0) / 2 * jet.du;
  patch.half_v = (patch.box.v1 - patch.box.v0) / 2 * jet.dv;
}

int PatchTree::Halve(int k) {
  if (patches_[k].children >= 0) return patches_[k].children;
  NetPatch low = patches_[k], high;
  const bool cut_u = low.size_u >= low.size_v;
  high = low;
  const Eigen::Matrix4Xd& net = patches_[k].net;
  const int rows = cut_u ? p_ : q_, others = cut_u ? q_ : p_, n = q_ + 1;
  for (int other = 0; other <= others; ++other) {
    const auto column = [&](int i) { return cut_u ? i * n + other : other * n + i; };
    Eigen::Vector4d b[kMaxDegree + 1];
    for (int i = 0; i <= rows; ++i) b[i] = net.col(column(i));
    for (int r = 0; r <= rows; ++r) {
      low.net.col(column(r)) = b[0];
      high.net.col(column(rows - r)) = b[rows - r];
      for (int i = 0; i < rows - r; ++i) b[i] = (b[i] + b[i + 1]) / 2;
    }
  }
  if (cut_u) {
    low.box.u1 = high.box.u0 = low.box.u0 / 2 + low.box.u1 / 2;
  } else {
    low.box.v1 = high.box.v0 = low.box.v0 / 2 + low.box.v1 / 2;
  }
  Measure(low);
  Measure(high);
  const int first = static_cast<int>(patches_.size());
  patches_[k].children = first;
  patches_.push_back(std::move(low));
  patches_.push_back(std::move(high));
  return first;
}

const SurfacePiece& PatchTree::PieceAt(const ParameterBox& smooth, double u, double v) const {
  const auto i = SpanIn(breaks_u_, smooth.u0, smooth.u1, u);
  const auto j = SpanIn(breaks_v_, smooth.v0, smooth.v1, v);
  return pieces_[i * (breaks_v_.size() - 1) + j];
}

SurfaceJet PatchTree::JetAt(const ParameterBox& smooth, double u, double v) const {
  const SurfacePiece& piece = PieceAt(smooth, u, v);
  const double wide = piece.u1 - piece.u0, tall = piece.v1 - piece.v0;
  SurfaceJet jet = JetOf(piece, (u - piece.u0) / wide, (v - piece.v0) / tall);
  jet.point += piece.origin;
  jet.du /= wide;
  jet.dv /= tall;
  jet.duu /= wide * wide;
  jet.duv /= wide * tall;
  jet.dvv /= tall * tall;
  return jet;
}

Eigen::Vector3d PatchTree::PointAt(const ParameterBox& smooth, double u, double v) const {
  const SurfacePiece& piece = PieceAt(smooth, u, v);
  double B[kMaxDegree + 1], C[kMaxDegree + 1];
  BernsteinBasis(p_, (u - piece.u0) / (piece.u1 - piece.u0), B);
  BernsteinBasis(q_, (v - piece.v0) / (piece.v1 - piece.v0), C);
  Eigen::Vector4d sum = Eigen::Vector4d::Zero();
  for (int i = 0; i <= p_; ++i) {
    Eigen::Vector4d row = Eigen::Vector4d::Zero();
    for (int j = 0; j <= q_; ++j) row += C[j] * piece.points.col(piece.Column(i, j));
    sum += B[i] * row;
  }
  return piece.origin + sum.head<3>() / sum[3];
}

bool Separated(const NetPatch& a, const NetPatch& b, double gap) {
  if (BoxesApart(a.bounds, b.bounds, gap)) return true;
  const auto apart = [&](const Eigen::Vector3d& axis) {
    return ApartAlong(a.points, b.points, axis, gap);
  };
  const bool known_a = a.normal.known(), known_b = b.normal.known();
  if (known_a && apart(a.normal.axis)) return true;
  if (known_b && apart(b.normal.axis)) return true;
  if (!known_a || !known_b) return false;
  const Eigen::Vector3d along = a.normal.axis.cross(b.normal.axis);
  const double sine = along.norm();
  constexpr double kLeastSine = 1e-6;
  if (sine < kLeastSine) return false;
  return apart(along / sine) || apart(a.normal.axis.cross(along) / sine) ||
         apart(b.normal.axis.cross(along) / sine);
}

}  // namespace batten::internal
