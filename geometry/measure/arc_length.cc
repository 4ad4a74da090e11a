// SPDX-License-Identifier: MIT
#include "batten/geometry/arc_length.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "geometry/numeric/adaptive_sum.h"
#include "geometry/numeric/box_diagonal.h"
#include "geometry/numeric/gauss_rule.h"
#include "geometry/nurbs/rational_derivatives.h"
#include "geometry/bezier/spline_pieces.h"
#include "geometry/numeric/constants.h"
#include "geometry/numeric/reject.h"
#include "geometry/nurbs/span_breaks.h"

namespace batten {
using namespace internal;
namespace {

constexpr double kTolerance = 1e-13;
constexpr double kLeastPart = 0x1p-48;  // of a piece: shorter ones are not cut
constexpr size_t kMostSplits = 200000;

const GaussRule& Fine() {
  static const GaussRule rule = GaussLegendre(20);
  return rule;
}
const GaussRule& Coarse() {
  static const GaussRule rule = GaussLegendre(12);
  return rule;
}

// |C′(t)| of a piece in homogeneous Bézier form. With the two points X0 and X1 that de Casteljau's
// algorithm leaves before its last step, C′ = p (X1 w0 − X0 w1) / w². [Floater 1992]
double Speed(const Eigen::Matrix4Xd& points, double t) {
  const int p = static_cast<int>(points.cols()) - 1;
  double B[kMaxDegree + 1];
  BernsteinBasis(p - 1, t, B);
  Eigen::Vector4d first = Eigen::Vector4d::Zero(), last = first;
  for (int i = 0; i < p; ++i) {
    first += B[i] * points.col(i);
    last += B[i] * points.col(i + 1);
  }
  const double w = (1 - t) * first[3] + t * last[3];
  return p * (last.head<3>() * first[3] - first.head<3>() * last[3]).norm() / (w * w);
}

double Integral(const GaussRule& rule, const Eigen::Matrix4Xd& points, double t0, double t1) {
  double sum = 0;
  for (Eigen::Index k = 0; k < rule.nodes.size(); ++k) {
    sum += rule.weights[k] * Speed(points, t0 + (t1 - t0) * rule.nodes[k]);
  }
  return sum * (t1 - t0);
}

// Bézier points of a vector that has the direction of C′(t): the hodograph, of a rational piece
// the numerator above as a product of Bernstein polynomials.
Eigen::Matrix3Xd Directions(const Eigen::Matrix4Xd& points) {
  const int p = static_cast<int>(points.cols()) - 1;
  if ((points.row(3).array() == points(3, 0)).all()) {
    return points.topRightCorner(3, p) - points.topLeftCorner(3, p);
  }
  Eigen::Matrix3Xd product = Eigen::Matrix3Xd::Zero(3, 2 * p - 1);
  for (int i = 0; i < p; ++i) {
    for (int j = 0; j < p; ++j) {
      const double part = Binomial(p - 1, i) * Binomial(p - 1, j) / Binomial(2 * p - 2, i + j);
      product.col(i + j) += part * (points.col(i + 1).head<3>() * points(3, j) -
                                    points.col(j).head<3>() * points(3, i + 1));
    }
  }
  return product;
}

// De Casteljau at t: the points of [0, t] and of [t, 1].
std::array<Eigen::Matrix3Xd, 2> Cut(Eigen::Matrix3Xd points, double t) {
  const Eigen::Index n = points.cols() - 1;
  Eigen::Matrix3Xd first = points;
  for (Eigen::Index k = 1; k <= n; ++k) {
    for (Eigen::Index i = 0; i <= n - k; ++i) {
      points.col(i) = (1 - t) * points.col(i) + t * points.col(i + 1);
    }
    first.col(k) = points.col(0);
  }
  return {std::move(first), std::move(points)};
}

// Whether all vectors lie in a cone about their sum: then C′ vanishes at the ends of the stretch at
// most, and no cusp can hide between the nodes of a rule.
bool InOneCone(const Eigen::Matrix3Xd& directions) {
  constexpr double kCosine = 0.1;
  const Eigen::Vector3d axis = directions.rowwise().sum();
  const double least = kCosine * axis.norm();
  for (const auto& direction : directions.colwise()) {
    if (!(direction.dot(axis) >= least * direction.norm())) return false;
  }
  return true;
}

// The part of an integral that a cusp between the end of a stretch and the node next to it, at
// 0.0034 of its width, can hide: twice the square of that.
constexpr double kHidden = 5e-5;

struct Cell {
  int piece;
  double t0, t1;
  Eigen::Matrix3Xd directions;  // on [t0, t1]
  CellIntegral integral;
};

Cell Measured(const std::vector<Eigen::Matrix4Xd>& pieces,
              int piece,
              double t0,
              double t1,
              Eigen::Matrix3Xd directions) {
  const double fine = Integral(Fine(), pieces[piece], t0, t1);
  const double coarse = Integral(Coarse(), pieces[piece], t0, t1);
  double error = std::abs(fine - coarse);
  if (!InOneCone(directions)) error = std::max(error, kHidden * fine);
  return {piece, t0, t1, std::move(directions), {fine, error}};
}

Cell Measured(const std::vector<Eigen::Matrix4Xd>& pieces, int piece, double t0, double t1) {
  Eigen::Matrix3Xd directions = Directions(pieces[piece]);
  if (t1 < 1) directions = Cut(std::move(directions), t1)[0];
  if (t0 > 0) directions = Cut(std::move(directions), t0 / t1)[1];
  return Measured(pieces, piece, t0, t1, std::move(directions));
}

// Refined until exact and put in the order of the curve; `size` is that of the control points.
void Refine(const std::vector<Eigen::Matrix4Xd>& pieces, double size, std::vector<Cell>& cells) {
  const auto split = [&](const Cell& cell) -> std::vector<Cell> {
    if (cell.t1 - cell.t0 < kLeastPart) return {};
    const double middle = (cell.t0 + cell.t1) / 2;
    auto [first, second] = Cut(cell.directions, 0.5);
    return {Measured(pieces, cell.piece, cell.t0, middle, std::move(first)),
            Measured(pieces, cell.piece, middle, cell.t1, std::move(second))};
  };
  RefineUntilExact(cells, kTolerance, kEpsilon * size, kMostSplits, split);
  std::sort(cells.begin(), cells.end(), [](const Cell& a, const Cell& b) {
    return a.piece != b.piece ? a.piece < b.piece : a.t0 < b.t0;
  });
}

double Sum(const std::vector<Cell>& cells) {
  CarriedSum sum;
  for (const Cell& cell : cells) sum.Add(cell.integral.value);
  return sum.value();
}

template <int Dim>
std::vector<Eigen::Matrix4Xd> PointsOfPieces(const NurbsCurve<Dim>& curve) {
  std::vector<Eigen::Matrix4Xd> pieces;
  for (CurvePiece& piece : PiecesOf(curve)) pieces.push_back(std::move(piece.points));
  return pieces;
}

// The length between parameters of the domain.
template <int Dim>
double Within(const NurbsCurve<Dim>& curve, double a, double b) {
  std::vector<Eigen::Matrix4Xd> pieces;
  std::vector<Cell> cells;
  for (const int span : curve.basis().Spans()) {
    const double low = curve.basis().knots()[span], high = curve.basis().knots()[span + 1];
    if (high <= a || low >= b) continue;
    pieces.push_back(PieceOf(curve, span).points);
    const double t0 = std::max(0.0, (a - low) / (high - low));
    const double t1 = b >= high ? 1 : (b - low) / (high - low);
    cells.push_back(Measured(pieces, static_cast<int>(pieces.size()) - 1, t0, t1));
  }
  Refine(pieces, BoxDiagonal(curve.control_points()), cells);
  return Sum(cells);
}

}  // namespace

template <int Dim>
double ArcLength(const NurbsCurve<Dim>& curve) {
  return Within(curve, curve.basis().lower(), curve.basis().upper());
}

template <int Dim>
double ArcLength(const NurbsCurve<Dim>& curve, double a, double b) {
  const SplineBasis& basis = curve.basis();
  const double lower = basis.lower(), upper = basis.upper();
  const std::string given = "[" + std::to_string(a) + ", " + std::to_string(b) + "]";
  if (!(a <= b)) Reject("ArcLength", given + " is not a ≤ b");
  if (!basis.periodic()) {
    if (a < lower || b > upper) {
      Reject("ArcLength",
             given + " is not inside the domain [" + std::to_string(lower) + ", " +
                 std::to_string(upper) + "]");
    }
    return Within(curve, a, b);
  }
  if (!(b - a <= upper - lower)) Reject("ArcLength", given + " is longer than one period");
  const double start = basis.Clamp(a), end = start + (b - a);
  if (end <= upper) return Within(curve, start, end);
  return Within(curve, start, upper) + Within(curve, lower, std::min(upper, end - (upper - lower)));
}

template <int Dim>
double ParameterAtLength(const NurbsCurve<Dim>& curve, double s) {
  return ArcLengthMap(curve).ParameterAt(s);
}

template <int Dim>
ArcLengthMap::ArcLengthMap(const NurbsCurve<Dim>& curve)
    : basis_(curve.basis()), pieces_(PointsOfPieces(curve)), breaks_(BreaksIn(basis_)) {
  std::vector<Cell> cells;
  for (int k = 0; k < static_cast<int>(pieces_.size()); ++k) {
    cells.push_back(Measured(pieces_, k, 0, 1));
  }
  Refine(pieces_, BoxDiagonal(curve.control_points()), cells);
  CarriedSum sum;
  for (const Cell& cell : cells) {
    stretches_.push_back({cell.piece, cell.t0, cell.t1, sum.value(), cell.integral.value});
    sum.Add(cell.integral.value);
  }
  length_ = sum.value();
}

double ArcLengthMap::PartOf(const Stretch& stretch, double t) const {
  if (t >= stretch.t1) return stretch.length;
  return Integral(Fine(), pieces_[stretch.piece], stretch.t0, t);
}

double ArcLengthMap::LengthAt(double u) const {
  u = basis_.Clamp(u);
  const auto next = std::upper_bound(breaks_.begin() + 1, breaks_.end() - 1, u);
  const int piece = static_cast<int>(next - breaks_.begin()) - 1;
  const double low = breaks_[piece], high = breaks_[piece + 1];
  const double t = std::clamp((u - low) / (high - low), 0.0, 1.0);
  const auto after =
      std::partition_point(stretches_.begin(), stretches_.end(), [&](const Stretch& stretch) {
        return stretch.piece < piece || (stretch.piece == piece && stretch.t0 <= t);
      });
  const Stretch& stretch = *(after - 1);
  return stretch.before + PartOf(stretch, t);
}

// Newton's method on the length within one stretch; a step that leaves the bounds known so far, or
// that follows one which did not halve the error, gives way to bisection. [Press et al. 2007, §9.4]
double ArcLengthMap::ParameterAt(double s) const {
  constexpr double kBeyond = 1e-12;
  if (!(s >= -kBeyond * length_) || !(s <= (1 + kBeyond) * length_)) {
    Reject("ArcLengthMap::ParameterAt",
           "s = " + std::to_string(s) + " is not in [0, " + std::to_string(length_) + "]");
  }
  if (s <= 0) return basis_.lower();
  if (s >= length_) return basis_.upper();
  const auto after =
      std::partition_point(stretches_.begin(), stretches_.end(), [&](const Stretch& stretch) {
        return stretch.before <= s;
      });
  const Stretch& stretch = *(after - 1);
  const double rest = s - stretch.before;
  const double exact = 2 * kEpsilon * length_;
  double low = stretch.t0, high = stretch.t1;
  double t = stretch.length > 0 ? low + (high - low) * std::min(1.0, rest / stretch.length) : low;
  double last = std::numeric_limits<double>::infinity();
  constexpr int kMostSteps = 200;
  for (int step = 0; step < kMostSteps; ++step) {
    const double error = PartOf(stretch, t) - rest;
    (error > 0 ? high : low) = t;
    if (std::abs(error) <= exact || high - low <= kEpsilon * high) break;
    const double speed = Speed(pieces_[stretch.piece], t);
    const double newton = t - error / speed;
    const bool slow = std::abs(error) > last / 2;
    last = std::abs(error);
    t = !slow && newton > low && newton < high ? newton : (low + high) / 2;
  }
  const double u0 = breaks_[stretch.piece], u1 = breaks_[stretch.piece + 1];
  return std::min(u1, u0 + t * (u1 - u0));
}

template double ArcLength(const NurbsCurve<2>&);
template double ArcLength(const NurbsCurve<3>&);
template double ArcLength(const NurbsCurve<2>&, double, double);
template double ArcLength(const NurbsCurve<3>&, double, double);
template double ParameterAtLength(const NurbsCurve<2>&, double);
template double ParameterAtLength(const NurbsCurve<3>&, double);
template ArcLengthMap::ArcLengthMap(const NurbsCurve<2>&);
template ArcLengthMap::ArcLengthMap(const NurbsCurve<3>&);

}  // namespace batten
