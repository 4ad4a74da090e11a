// SPDX-License-Identifier: MIT
#include "geometry/bezier/spline_pieces.h"

#include <algorithm>
#include <array>
#include <limits>

#include "geometry/bezier/bezier_span.h"
#include "geometry/numeric/constants.h"

namespace batten::internal {
namespace {

// The bound for w (P − origin): half a unit in the last place of both, and of the differences; what
// sums of `terms` products add to it in the conversion to Bézier form.
double ErrorOf(const Eigen::Vector3d& local, const Eigen::Vector3d& point, double w, int terms) {
  const double size = local.cwiseAbs().maxCoeff();
  return size == 0 ? 0 : w * kEpsilon * (point.cwiseAbs().maxCoeff() + terms * size);
}

SurfacePiece MakePiece(const NurbsSurface& surface,
                       int span_u,
                       int span_v,
                       const Eigen::MatrixXd& in_u,
                       const Eigen::MatrixXd& in_v,
                       const std::optional<Eigen::Vector3d>& origin) {
  const SplineBasis &bu = surface.basis_u(), &bv = surface.basis_v();
  const int p = bu.degree(), q = bv.degree();
  SurfacePiece piece{bu.knots()[span_u],
                     bu.knots()[span_u + 1],
                     bv.knots()[span_v],
                     bv.knots()[span_v + 1],
                     origin.value_or(surface.control_point(span_u - p / 2, span_v - q / 2)),
                     p,
                     q,
                     Eigen::Matrix4Xd(4, (p + 1) * (q + 1)),
                     Eigen::VectorXd((p + 1) * (q + 1))};
  std::array<Eigen::MatrixXd, 5> net;  // the last one the errors
  for (Eigen::MatrixXd& coordinate : net) coordinate.resize(p + 1, q + 1);
  for (int i = 0; i <= p; ++i) {
    for (int j = 0; j <= q; ++j) {
      const Eigen::Index k = Eigen::Index{span_u - p + i} * surface.size_v() + span_v - q + j;
      const double w = surface.weights()[k];
      const Eigen::Vector3d local = surface.control_points().col(k) - piece.origin;
      for (int d = 0; d < 3; ++d) net[d](i, j) = w * local[d];
      net[3](i, j) = w;
      net[4](i, j) = ErrorOf(local, surface.control_points().col(k), w, p + q + 2);
    }
  }
  for (int d = 0; d < 5; ++d) {
    const Eigen::MatrixXd bezier = in_u * net[d] * in_v.transpose();
    for (int i = 0; i <= p; ++i) {
      if (d < 4) {
        piece.points.row(d).segment(i * (q + 1), q + 1) = bezier.row(i);
      } else {
        piece.errors.segment(i * (q + 1), q + 1) = bezier.row(i).transpose();
      }
    }
  }
  return piece;
}

// Lower orders first: in the order of differences the point is solved for. [Piegl & Tiller 1997,
// eq. 4.8]
CurvePieceJet Quotient(const std::array<Eigen::Vector4d, 4>& a) {
  const double w = a[0][3];
  CurvePieceJet jet;
  jet.point = a[0].head<3>() / w;
  jet.first = (a[1].head<3>() - a[1][3] * jet.point) / w;
  jet.second = (a[2].head<3>() - 2 * a[1][3] * jet.first - a[2][3] * jet.point) / w;
  jet.third =
      (a[3].head<3>() - 3 * a[1][3] * jet.second - 3 * a[2][3] * jet.first - a[3][3] * jet.point) /
      w;
  return jet;
}

}  // namespace

template <int Dim>
CurvePiece PieceOf(const NurbsCurve<Dim>& curve,
                   int span,
                   const std::optional<Eigen::Vector3d>& origin) {
  const int p = curve.basis().degree();
  const auto in_space = [&](int i) {
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    point.head<Dim>() = curve.control_points().col(i);
    return point;
  };
  CurvePiece piece{curve.basis().knots()[span],
                   curve.basis().knots()[span + 1],
                   origin.value_or(in_space(span - p / 2)),
                   Eigen::Matrix4Xd(4, p + 1),
                   Eigen::VectorXd(p + 1)};
  Eigen::Matrix4Xd local(4, p + 1);
  for (int i = 0; i <= p; ++i) {
    const double w = curve.weights()[span - p + i];
    const Eigen::Vector3d point = in_space(span - p + i);
    local.col(i) << w * (point - piece.origin), w;
    piece.errors[i] = ErrorOf(point - piece.origin, point, w, p + 2);
  }
  const Eigen::MatrixXd bezier = BezierSpanMatrix(curve.basis(), span);
  piece.points.noalias() = local * bezier.transpose();
  piece.errors = bezier * piece.errors.eval();
  return piece;
}

template <int Dim>
std::vector<CurvePiece> PiecesOf(const NurbsCurve<Dim>& curve) {
  std::vector<CurvePiece> pieces;
  for (const int span : curve.basis().Spans()) pieces.push_back(PieceOf(curve, span));
  return pieces;
}

template CurvePiece PieceOf(const NurbsCurve<2>&, int, const std::optional<Eigen::Vector3d>&);
template CurvePiece PieceOf(const NurbsCurve<3>&, int, const std::optional<Eigen::Vector3d>&);
template std::vector<CurvePiece> PiecesOf(const NurbsCurve<2>&);
template std::vector<CurvePiece> PiecesOf(const NurbsCurve<3>&);

SurfacePiece PieceOf(const NurbsSurface& surface,
                     int span_u,
                     int span_v,
                     const std::optional<Eigen::Vector3d>& origin) {
  return MakePiece(surface,
                   span_u,
                   span_v,
                   BezierSpanMatrix(surface.basis_u(), span_u),
                   BezierSpanMatrix(surface.basis_v(), span_v),
                   origin);
}

namespace {

// The corner, replaced by the nearest of the control points if it is that to rounding.
class CornerFinder {
 public:
  CornerFinder(const Eigen::Vector3d& corner, double error)
      : corner_(corner), nearest_(corner), least_(4 * error) {}
  void See(const Eigen::Vector3d& point) {
    const double distance = (point - corner_).cwiseAbs().maxCoeff();
    if (distance > least_) return;
    least_ = distance;
    nearest_ = point;
  }
  const Eigen::Vector3d& nearest() const { return nearest_; }

 private:
  Eigen::Vector3d corner_, nearest_;
  double least_;
};

}  // namespace

template <int Dim>
CurvePiece AboutEnd(const NurbsCurve<Dim>& curve, int span, int end) {
  const CurvePiece piece = PieceOf(curve, span);
  const int corner = end * piece.degree();
  CornerFinder finder(piece.Euclidean(corner), piece.errors.maxCoeff() / piece.points(3, corner));
  for (int i = span - piece.degree(); i <= span; ++i) {
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    point.head<Dim>() = curve.control_points().col(i);
    finder.See(point);
  }
  return PieceOf(curve, span, finder.nearest());
}

template CurvePiece AboutEnd(const NurbsCurve<2>&, int, int);
template CurvePiece AboutEnd(const NurbsCurve<3>&, int, int);

SurfacePiece AboutCorner(
    const NurbsSurface& surface, int span_u, int span_v, int end_u, int end_v) {
  const SurfacePiece piece = PieceOf(surface, span_u, span_v);
  const int i0 = end_u * piece.p, j0 = end_v * piece.q;
  CornerFinder finder(piece.Euclidean(i0, j0),
                      piece.errors.maxCoeff() / piece.points(3, piece.Column(i0, j0)));
  for (int i = span_u - piece.p; i <= span_u; ++i) {
    for (int j = span_v - piece.q; j <= span_v; ++j) finder.See(surface.control_point(i, j));
  }
  return PieceOf(surface, span_u, span_v, finder.nearest());
}

SurfacePieces::SurfacePieces(const NurbsSurface& surface)
    : surface_(surface), spans_u_(surface.basis_u().Spans()), spans_v_(surface.basis_v().Spans()) {
  for (const int span : spans_u_) matrices_u_.push_back(BezierSpanMatrix(surface.basis_u(), span));
  for (const int span : spans_v_) matrices_v_.push_back(BezierSpanMatrix(surface.basis_v(), span));
}

SurfacePiece SurfacePieces::Piece(int i,
                                  int j,
                                  const std::optional<Eigen::Vector3d>& origin) const {
  return MakePiece(surface_, spans_u_[i], spans_v_[j], matrices_u_[i], matrices_v_[j], origin);
}

void BernsteinBasis(int degree, double t, double* values) {
  values[0] = 1;
  for (int n = 1; n <= degree; ++n) {
    double saved = 0;
    for (int i = 0; i < n; ++i) {
      const double value = values[i];
      values[i] = saved + (1 - t) * value;
      saved = t * value;
    }
    values[n] = saved;
  }
}

// The k-th derivative is p!/(p−k)! times the Bézier form of degree p − k over k-th differences.
// [Piegl & Tiller 1997, eq. 1.10]
CurvePieceJet JetOf(const CurvePiece& piece, double t) {
  const int p = piece.degree();
  std::array<Eigen::Vector4d, kMaxDegree + 1> differences;
  for (int i = 0; i <= p; ++i) differences[i] = piece.points.col(i);
  std::array<Eigen::Vector4d, 4> a;
  double factor = 1;
  for (int k = 0; k <= 3; ++k) {
    a[k].setZero();
    if (k > p) continue;
    double B[kMaxDegree + 1];
    BernsteinBasis(p - k, t, B);
    for (int i = 0; i <= p - k; ++i) a[k] += factor * B[i] * differences[i];
    for (int i = 0; i < p - k; ++i) differences[i] = differences[i + 1] - differences[i];
    factor *= p - k;
  }
  return Quotient(a);
}

// Differences along u of order 0, 1, 2, each summed along v in Bézier form of degree q, q−1, q−2.
SurfaceJet JetOf(const SurfacePiece& piece, double s, double t) {
  const int p = piece.p, q = piece.q;
  std::array<std::array<Eigen::Vector4d, kMaxDegree + 1>, 3> rows;  // [order in v][i]
  double factor = 1;
  for (int l = 0; l <= 2; ++l) {
    double B[kMaxDegree + 1];
    if (l <= q) BernsteinBasis(q - l, t, B);
    for (int i = 0; i <= p; ++i) {
      rows[l][i].setZero();
      for (int j = 0; j <= q - l; ++j) {
        const int c = piece.Column(i, j);
        Eigen::Vector4d difference = piece.points.col(c);
        if (l == 1) difference = piece.points.col(c + 1) - difference;
        if (l == 2) {
          difference = (piece.points.col(c + 2) - piece.points.col(c + 1)) -
                       (piece.points.col(c + 1) - difference);
        }
        rows[l][i] += factor * B[j] * difference;
      }
    }
    factor *= q - l;
  }
  std::array<std::array<Eigen::Vector4d, 3>, 3> a;  // [order in u][order in v]
  factor = 1;
  for (int k = 0; k <= 2; ++k) {
    double B[kMaxDegree + 1];
    if (k <= p) BernsteinBasis(p - k, s, B);
    for (int l = 0; k + l <= 2; ++l) {
      a[k][l].setZero();
      for (int i = 0; i <= p - k; ++i) a[k][l] += factor * B[i] * rows[l][i];
      for (int i = 0; i < p - k; ++i) rows[l][i] = rows[l][i + 1] - rows[l][i];
    }
    factor *= p - k;
  }
  const double w = a[0][0][3];
  const auto xyz = [&](int k, int l) -> Eigen::Vector3d { return a[k][l].head<3>(); };
  SurfaceJet jet;
  jet.point = xyz(0, 0) / w;
  jet.du = (xyz(1, 0) - a[1][0][3] * jet.point) / w;
  jet.dv = (xyz(0, 1) - a[0][1][3] * jet.point) / w;
  jet.duu = (xyz(2, 0) - 2 * a[1][0][3] * jet.du - a[2][0][3] * jet.point) / w;
  jet.dvv = (xyz(0, 2) - 2 * a[0][1][3] * jet.dv - a[0][2][3] * jet.point) / w;
  jet.duv = (xyz(1, 1) - a[1][0][3] * jet.dv - a[0][1][3] * jet.du - a[1][1][3] * jet.point) / w;
  return jet;
}

}  // namespace batten::internal
