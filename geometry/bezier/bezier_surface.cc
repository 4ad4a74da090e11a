// SPDX-License-Identifier: MIT
#include "batten/geometry/bezier_surface.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "geometry/bezier/bernstein.h"
#include "geometry/bezier/bezier_span.h"
#include "geometry/bezier/normal_limits.h"
#include "geometry/numeric/construction_checks.h"
#include "geometry/numeric/number_text.h"
#include "geometry/nurbs/rational_derivatives.h"
#include "geometry/bezier/rational_patch.h"
#include "geometry/bezier/weighted_means.h"
#include "geometry/numeric/reject.h"

namespace batten {
using namespace internal;
namespace {

void CheckDegrees(const std::string& function, int degree_u, int degree_v) {
  for (const int degree : {degree_u, degree_v}) {
    if (degree < 0 || degree > kMaxBezierDegree) {
      Reject(function,
             "degree " + std::to_string(degree) + " is not in [0, " +
                 std::to_string(kMaxBezierDegree) + "]");
    }
  }
}

// Control points on the way of de Casteljau's algorithm: Euclidean, and weights.
struct Net {
  Eigen::Matrix3Xd points;
  Eigen::VectorXd weights;

  // Point `to` becomes the mean of itself and point `other` with 1 − t and t, in homogeneous
  // coordinates.
  void Blend(int to, int other, double t) {
    const double right = t * weights[other];
    weights[to] = (1 - t) * weights[to] + right;
    points.col(to) += (right / weights[to]) * (points.col(other) - points.col(to));
  }

  // The points first, first + stride, … of a row of degree n, blended down to the first.
  void BlendRow(int first, int stride, int n, double t) {
    for (int last = n; last > 0; --last) {
      for (int i = 0; i < last; ++i) Blend(first + i * stride, first + (i + 1) * stride, t);
    }
  }
};

// The rows of a net in Bernstein form along u: one matrix for every j, with p+1 columns.
template <typename Edit>
Eigen::MatrixXd AlongU(const Eigen::MatrixXd& net, int q, const Edit& edit) {
  const Eigen::Index count = net.cols() / (q + 1), rows = net.rows();
  Eigen::MatrixXd stacked(rows * (q + 1), count);
  for (Eigen::Index i = 0; i < count; ++i) {
    stacked.col(i) = net.middleCols(i * (q + 1), q + 1).reshaped();
  }
  const Eigen::MatrixXd edited = edit(stacked);
  Eigen::MatrixXd result(rows, edited.cols() * (q + 1));
  for (Eigen::Index i = 0; i < edited.cols(); ++i) {
    result.middleCols(i * (q + 1), q + 1) = edited.col(i).reshaped(rows, q + 1);
  }
  return result;
}

// The same along v: one matrix for every i, with q+1 columns.
template <typename Edit>
Eigen::MatrixXd AlongV(const Eigen::MatrixXd& net, int q, const Edit& edit) {
  const Eigen::Index count = net.cols() / (q + 1);
  std::vector<Eigen::MatrixXd> parts;
  for (Eigen::Index i = 0; i < count; ++i) {
    parts.push_back(edit(net.middleCols(i * (q + 1), q + 1)));
  }
  const Eigen::Index width = parts[0].cols();
  Eigen::MatrixXd result(net.rows(), width * count);
  for (Eigen::Index i = 0; i < count; ++i) result.middleCols(i * width, width) = parts[i];
  return result;
}

BezierCurve<3> CurveOfColumns(const BezierSurface& surface, int first, int stride, int degree) {
  Eigen::Matrix3Xd points(3, degree + 1);
  Eigen::VectorXd weights(degree + 1);
  for (int i = 0; i <= degree; ++i) {
    points.col(i) = surface.control_points().col(first + i * stride);
    weights[i] = surface.weights()[first + i * stride];
  }
  return BezierCurve<3>(std::move(points), std::move(weights));
}

// The surface whose control points are means of the given ones, along u and then along v.
BezierSurface Means(const BezierSurface& surface,
                    const Eigen::MatrixXd& along_u,
                    const Eigen::MatrixXd& along_v) {
  const Eigen::Index p = surface.degree_u(), q = surface.degree_v();
  const Eigen::Index r = along_u.cols() - 1, s = along_v.cols() - 1;
  Eigen::Matrix3Xd half(3, (r + 1) * (q + 1)), points(3, (r + 1) * (s + 1));
  Eigen::VectorXd half_weights(half.cols()), weights(points.cols());
  for (Eigen::Index j = 0; j <= q; ++j) {
    const auto from = Eigen::seqN(j, p + 1, q + 1), to = Eigen::seqN(j, r + 1, q + 1);
    const WeightedPoints means = WeightedMeans(
        {surface.control_points()(Eigen::all, from), surface.weights()(from)}, along_u);
    half(Eigen::all, to) = means.points;
    half_weights(to) = means.weights;
  }
  for (Eigen::Index i = 0; i <= r; ++i) {
    const WeightedPoints means = WeightedMeans(
        {half.middleCols(i * (q + 1), q + 1), half_weights.segment(i * (q + 1), q + 1)}, along_v);
    points.middleCols(i * (s + 1), s + 1) = means.points;
    weights.segment(i * (s + 1), s + 1) = means.weights;
  }
  return BezierSurface(
      static_cast<int>(r), static_cast<int>(s), std::move(points), std::move(weights));
}

// The only span of a basis.
int OneSpan(const SplineBasis& basis) {
  const std::vector<int> spans = basis.Spans();
  if (spans.size() != 1) {
    Reject("ToBezier", "the surface has " + std::to_string(spans.size()) + " spans, not one");
  }
  return spans[0];
}

}  // namespace

BezierSurface::BezierSurface(int degree_u,
                             int degree_v,
                             Eigen::Matrix3Xd control_points,
                             Eigen::VectorXd weights)
    : degree_u_(degree_u),
      degree_v_(degree_v),
      control_points_(std::move(control_points)),
      weights_(std::move(weights)) {
  CheckDegrees("BezierSurface", degree_u, degree_v);
  const Eigen::Index count = Eigen::Index{degree_u + 1} * (degree_v + 1);
  if (weights_.size() == 0) weights_ = Eigen::VectorXd::Ones(control_points_.cols());
  if (control_points_.cols() != count || weights_.size() != count) {
    Reject("BezierSurface",
           std::to_string(control_points_.cols()) + " control points and " +
               std::to_string(weights_.size()) + " weights do not fit the degrees, which need " +
               std::to_string(count));
  }
  if (!control_points_.allFinite()) Reject("BezierSurface", "a control point is not finite");
  if (!weights_.allFinite() || !(weights_.minCoeff() > 0)) {
    Reject("BezierSurface", "a weight is not positive and finite");
  }
  rational_ = (weights_.array() != weights_[0]).any();
}

Eigen::Vector3d BezierSurface::At(double u, double v, DeCasteljauOrder order) const {
  u = std::clamp(u, 0.0, 1.0);
  v = std::clamp(v, 0.0, 1.0);
  const int p = degree_u_, q = degree_v_, stride = q + 1;
  Net net{control_points_, weights_};
  switch (order) {
    case DeCasteljauOrder::kUFirst:
      for (int j = 0; j <= q; ++j) net.BlendRow(j, stride, p, u);
      net.BlendRow(0, 1, q, v);
      break;
    case DeCasteljauOrder::kVFirst:
      for (int i = 0; i <= p; ++i) net.BlendRow(i * stride, 1, q, v);
      net.BlendRow(0, stride, p, u);
      break;
    case DeCasteljauOrder::kBilinear: {
      const int both = std::min(p, q);
      for (int r = 1; r <= both; ++r) {
        for (int i = 0; i <= p - r; ++i) {
          // Row i+1 still holds the points of the last round; row i is blended with it in place.
          for (int j = 0; j <= q - r + 1; ++j) net.Blend(Column(i, j), Column(i + 1, j), u);
          for (int j = 0; j <= q - r; ++j) net.Blend(Column(i, j), Column(i, j + 1), v);
        }
      }
      if (p > q) net.BlendRow(0, stride, p - both, u);
      if (q > p) net.BlendRow(0, 1, q - both, v);
      break;
    }
  }
  return net.points.col(0);
}

SurfaceDerivatives BezierSurface::Derivatives(double u, double v, int order) const {
  if (order < 0) Reject("BezierSurface::Derivatives", "order is negative");
  const int p = degree_u_, q = degree_v_;
  Eigen::MatrixXd along_u(p + 1, order + 1), along_v(q + 1, order + 1);
  BernsteinDerivatives(p, std::clamp(u, 0.0, 1.0), order, along_u.data());
  BernsteinDerivatives(q, std::clamp(v, 0.0, 1.0), order, along_v.data());
  const Eigen::Matrix4Xd points = Homogeneous(*this);
  Eigen::Matrix4Xd table = Eigen::Matrix4Xd::Zero(4, (order + 1) * (order + 1));
  for (int i = 0; i <= p; ++i) {
    const Eigen::MatrixXd row = points.middleCols(i * (q + 1), q + 1) * along_v;  // 4 × (order+1)
    for (int k = 0; k <= order; ++k) {
      const int count = order - k + 1;
      table.middleCols(k * (order + 1), count) += along_u(i, k) * row.leftCols(count);
    }
  }
  RationalSurfaceDerivatives(order, table);
  return SurfaceDerivatives(order, std::move(table));
}

// (A/w)' = (A'w − Aw')/w² has the degrees 2p−1 and 2q above; raised by one they are those of w².
BezierSurface PartialDerivative(const BezierSurface& surface, Direction direction) {
  const bool along_u = direction == Direction::kU;
  const int p = surface.degree_u(), q = surface.degree_v();
  const auto derivative = [&](const Eigen::MatrixXd& net) {
    return along_u ? AlongU(net, q, BernsteinDerivative) : AlongV(net, q, BernsteinDerivative);
  };
  if (!surface.rational()) {  // the polynomial A itself
    return BezierSurface(along_u ? std::max(p - 1, 0) : p,
                         along_u ? q : std::max(q - 1, 0),
                         derivative(surface.control_points()));
  }
  CheckDegrees("PartialDerivative", 2 * p, 2 * q);
  const int r = along_u ? 1 : 0, s = 1 - r;
  if ((along_u ? p : q) == 0) {
    return BezierSurface(p, q, Eigen::Matrix3Xd::Zero(3, surface.weights().size()));
  }
  // In differences from the first control point, so that far from the origin nothing is lost.
  Eigen::MatrixXd columns = Homogeneous(surface);
  columns.topRows(3) -= surface.control_points().col(0) * columns.row(3);
  const Eigen::MatrixXd first = derivative(columns);
  const Eigen::RowVectorXd w = columns.row(3);
  Eigen::MatrixXd numerator = PatchProduct(first.topRows(3), p - r, q - s, w, p, q) -
                              PatchProduct(columns.topRows(3), p, q, first.row(3), p - r, q - s);
  const Eigen::RowVectorXd one = Eigen::RowVectorXd::Ones(2);
  numerator = PatchProduct(numerator, 2 * p - r, 2 * q - s, one, r, s);
  const Eigen::RowVectorXd square = PatchProduct(w, p, q, w, p, q);
  return BezierSurface(
      2 * p, 2 * q, numerator.array().rowwise() / square.array(), square.transpose());
}

Eigen::Vector3d TwistVector(const BezierSurface& surface, int u, int v) {
  if ((u != 0 && u != 1) || (v != 0 && v != 1)) {
    Reject("TwistVector",
           "(" + std::to_string(u) + ", " + std::to_string(v) + ") is not a corner of [0, 1]²");
  }
  const int p = surface.degree_u(), q = surface.degree_v();
  if (p == 0 || q == 0) return Eigen::Vector3d::Zero();
  const int i0 = u * p, j0 = v * q, i1 = u == 0 ? 1 : p - 1, j1 = v == 0 ? 1 : q - 1;
  const Eigen::Vector3d corner = surface.control_point(i0, j0);
  const double w = surface.weight(i0, j0);
  const double w10 = surface.weight(i1, j0) / w, w01 = surface.weight(i0, j1) / w;
  const double w11 = surface.weight(i1, j1) / w;
  const double scale = (u == v ? 1.0 : -1.0) * p * q;
  return scale * (w11 * (surface.control_point(i1, j1) - corner) -
                  w10 * w01 *
                      ((surface.control_point(i1, j0) - corner) +
                       (surface.control_point(i0, j1) - corner)));
}

Eigen::Matrix3Xd ControlTwists(const BezierSurface& surface) {
  const int p = surface.degree_u(), q = surface.degree_v();
  Eigen::Matrix3Xd twists(3, p * q);
  for (int i = 0; i < p; ++i) {
    for (int j = 0; j < q; ++j) {
      twists.col(i * q + j) =
          p * q *
          ((surface.control_point(i + 1, j + 1) - surface.control_point(i + 1, j)) -
           (surface.control_point(i, j + 1) - surface.control_point(i, j)));
    }
  }
  return twists;
}

std::array<BezierSurface, 4> Subdivided(const BezierSurface& surface, double u, double v) {
  for (const double t : {u, v}) {
    if (!(t > 0 && t < 1)) {
      Reject("Subdivided", "parameter " + NumberText(t) + " is not inside (0, 1)");
    }
  }
  const int p = surface.degree_u(), q = surface.degree_v();
  const auto cut_u = SplitBernstein(Eigen::MatrixXd::Identity(p + 1, p + 1), u);
  const auto cut_v = SplitBernstein(Eigen::MatrixXd::Identity(q + 1, q + 1), v);
  return {Means(surface, cut_u.first, cut_v.first),
          Means(surface, cut_u.first, cut_v.second),
          Means(surface, cut_u.second, cut_v.first),
          Means(surface, cut_u.second, cut_v.second)};
}

BezierSurface Elevated(const BezierSurface& surface, int by_u, int by_v) {
  const int p = surface.degree_u(), q = surface.degree_v();
  for (const int by : {by_u, by_v}) {
    if (by < 0) Reject("Elevated", "by = " + std::to_string(by) + " is negative");
    if (by > kMaxBezierDegree) CheckDegrees("Elevated", by, by);
  }
  CheckDegrees("Elevated", p + by_u, q + by_v);
  return Means(surface,
               ElevatedBernstein(Eigen::MatrixXd::Identity(p + 1, p + 1), by_u),
               ElevatedBernstein(Eigen::MatrixXd::Identity(q + 1, q + 1), by_v));
}

std::array<BezierCurve<3>, 4> BoundaryCurves(const BezierSurface& surface) {
  const int p = surface.degree_u(), q = surface.degree_v();
  return {CurveOfColumns(surface, 0, 1, q),
          CurveOfColumns(surface, surface.Column(p, 0), 1, q),
          CurveOfColumns(surface, 0, q + 1, p),
          CurveOfColumns(surface, q, q + 1, p)};
}

std::optional<Eigen::Vector3d> NormalAt(const BezierSurface& surface, double u, double v) {
  if (surface.degree_u() == 0 || surface.degree_v() == 0) return {};  // a curve or a point
  return LimitNormal(ToNurbs(surface), u, v);
}

NurbsSurface ToNurbs(const BezierSurface& surface) {
  const double breaks[] = {0, 1};
  return NurbsSurface(SplineBasis::Clamped(surface.degree_u(), breaks),
                      SplineBasis::Clamped(surface.degree_v(), breaks),
                      surface.control_points(),
                      surface.weights());
}

BezierSurface ToBezier(const NurbsSurface& surface) {
  RefuseTrims(surface.trimmed(), "ToBezier", "a Bézier surface has no loops");
  const SplineBasis &basis_u = surface.basis_u(), &basis_v = surface.basis_v();
  const int p = basis_u.degree(), q = basis_v.degree();
  const int span_u = OneSpan(basis_u), span_v = OneSpan(basis_v);
  Eigen::Matrix3Xd points(3, (p + 1) * (q + 1));
  Eigen::VectorXd weights(points.cols());
  for (int i = 0; i <= p; ++i) {
    const Eigen::Index from = Eigen::Index{span_u - p + i} * surface.size_v() + span_v - q;
    points.middleCols(i * (q + 1), q + 1) = surface.control_points().middleCols(from, q + 1);
    weights.segment(i * (q + 1), q + 1) = surface.weights().segment(from, q + 1);
  }
  return Means(BezierSurface(p, q, std::move(points), std::move(weights)),
               BezierSpanMatrix(basis_u, span_u).transpose(),
               BezierSpanMatrix(basis_v, span_v).transpose());
}

Eigen::Matrix4Xd Homogeneous(const BezierSurface& surface) {
  Eigen::Matrix4Xd columns = Eigen::Matrix4Xd::Ones(4, surface.weights().size());
  if (surface.rational()) columns.row(3) = surface.weights().transpose();
  columns.topRows<3>() = surface.control_points() * columns.row(3).asDiagonal();
  return columns;
}

}  // namespace batten
