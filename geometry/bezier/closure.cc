// SPDX-License-Identifier: MIT
#include "batten/geometry/closure.h"

#include <algorithm>
#include <cmath>

#include "geometry/numeric/box_diagonal.h"
#include "geometry/nurbs/homogeneous.h"
#include "geometry/bezier/limit_series.h"

namespace batten {
using namespace internal;
namespace {

constexpr int kMostLines = 200;

// Parameters in every span, its ends among them, about `most` in all.
std::vector<double> Places(const SplineBasis& basis, int most) {
  const std::vector<int> spans = basis.Spans();
  const int count =
      std::max(1, std::min(2 * basis.degree() + 2, most / static_cast<int>(spans.size())));
  const size_t step = std::max<size_t>(1, spans.size() / most);
  std::vector<double> places;
  for (size_t k = 0; k < spans.size(); k += step) {
    const double a = basis.knots()[spans[k]], b = basis.knots()[spans[k] + 1];
    for (int i = 0; i < count; ++i) places.push_back(a + (b - a) * i / count);
  }
  places.push_back(basis.upper());
  return places;
}

Direction Other(Direction direction) {
  return direction == Direction::kU ? Direction::kV : Direction::kU;
}

// The parameter line along `direction` at a parameter of the other direction.
NurbsCurve<3> LineAt(const NurbsSurface& surface, Direction direction, double at) {
  const Direction other = Other(direction);
  const SplineBasis& across = BasisOf(surface, other);
  const int span = across.Span(at), q = across.degree();
  double N[kMaxDegree + 1];
  across.Values(span, at, N);
  const Eigen::MatrixXd rows = HomogeneousRows(surface, other).middleCols(span - q, q + 1);
  const Eigen::VectorXd sum = rows * Eigen::Map<const Eigen::VectorXd>(N, q + 1);
  return CurveFromHomogeneous<3>(
      BasisOf(surface, direction), sum.reshaped(4, sum.size() / 4), surface.rational());
}

// Power series to the left and right of a joint, of equal size in the parameter, as far as the
// degree.
struct Joint {
  VectorSeries left, right;
  double left_width, right_width;
  Eigen::Vector3d shift;  // of the origins
  double size;            // of the two pieces
};

Joint JointOf(const CurvePiece& left, const CurvePiece& right) {
  const int p = left.degree();
  double size = 0;
  for (int i = 0; i <= p; ++i) {
    size = std::max({size,
                     (left.Euclidean(i) - left.Euclidean(0)).norm(),
                     (right.Euclidean(i) - right.Euclidean(0)).norm()});
  }
  return {TaylorSeries(left, 1, p, false),
          TaylorSeries(right, 0, p, false),
          left.u1 - left.u0,
          right.u1 - right.u0,
          right.origin - left.origin,
          size};
}

// The highest order up to which the derivatives agree; −1 if not even the points do.
int Agreement(const Joint& joint, double tolerance) {
  const double width = std::max(joint.left_width, joint.right_width);
  int order = -1;
  for (int k = 0; k < joint.left.size(); ++k) {
    const double left = std::pow(width / joint.left_width, k);
    const double right = std::pow(width / joint.right_width, k);
    Eigen::Vector3d jump = right * joint.right[k] - left * joint.left[k];
    if (k == 0) jump += joint.shift;
    double rounding = 0;
    for (const auto& [series, scale] : {std::pair{&joint.left, left}, {&joint.right, right}}) {
      rounding += scale * (series->x[k].error + series->y[k].error + series->z[k].error);
    }
    if (!(jump.norm() <= tolerance * joint.size + rounding)) break;
    order = k;
  }
  return order;
}

// Of a closed curve, from its end to its beginning.
template <int Dim>
int SeamOrder(const NurbsCurve<Dim>& curve, double tolerance) {
  const SplineBasis& basis = curve.basis();
  const std::vector<int> spans = basis.Spans();
  const Joint joint = JointOf(PieceOf(curve, spans.back()), PieceOf(curve, spans.front()));
  int least = 0;
  if (basis.periodic()) {  // the knot at the seam is one like others
    const int multiplicity =
        std::max(basis.Multiplicity(basis.lower()), basis.Multiplicity(basis.upper()));
    least = std::max(0, basis.degree() - multiplicity);
  }
  return std::max(least, Agreement(joint, tolerance));
}

}  // namespace

template <int Dim>
bool Closed(const NurbsCurve<Dim>& curve, double tolerance) {
  const double gap = (curve.At(curve.basis().lower()) - curve.At(curve.basis().upper())).norm();
  return gap <= tolerance * BoxDiagonal(curve.control_points());
}

bool Closed(const NurbsSurface& surface, Direction direction, double tolerance) {
  const SplineBasis& basis = BasisOf(surface, direction);
  const double allowed = tolerance * BoxDiagonal(surface.control_points());
  const auto at = [&](double along, double across) {
    return direction == Direction::kU ? surface.At(along, across) : surface.At(across, along);
  };
  const SplineBasis& across = BasisOf(surface, Other(direction));
  for (const double place : Places(across, across.size() * (2 * across.degree() + 2))) {
    if (!((at(basis.lower(), place) - at(basis.upper(), place)).norm() <= allowed)) return false;
  }
  return true;
}

template <int Dim>
std::vector<KnotContinuity> ContinuityAtKnots(const NurbsCurve<Dim>& curve, double tolerance) {
  const std::vector<CurvePiece> pieces = PiecesOf(curve);
  const int p = curve.basis().degree();
  std::vector<KnotContinuity> result;
  for (size_t k = 0; k + 1 < pieces.size(); ++k) {
    KnotContinuity joint{pieces[k].u1, curve.basis().Multiplicity(pieces[k].u1), 0, 0};
    joint.guaranteed = p - joint.multiplicity;
    joint.actual =
        std::max(joint.guaranteed, Agreement(JointOf(pieces[k], pieces[k + 1]), tolerance));
    result.push_back(joint);
  }
  return result;
}

std::vector<KnotContinuity> ContinuityAtKnots(const NurbsSurface& surface,
                                              Direction direction,
                                              double tolerance) {
  std::vector<KnotContinuity> result;
  for (const double at : Places(BasisOf(surface, Other(direction)), kMostLines)) {
    const std::vector<KnotContinuity> line =
        ContinuityAtKnots(LineAt(surface, direction, at), tolerance);
    if (result.empty()) result = line;
    for (size_t k = 0; k < line.size(); ++k) {
      result[k].actual = std::min(result[k].actual, line[k].actual);
    }
  }
  return result;
}

template <int Dim>
std::optional<int> SeamContinuity(const NurbsCurve<Dim>& curve, double tolerance) {
  if (!Closed(curve, tolerance)) return std::nullopt;
  return SeamOrder(curve, tolerance);
}

std::optional<int> SeamContinuity(const NurbsSurface& surface,
                                  Direction direction,
                                  double tolerance) {
  if (!Closed(surface, direction, tolerance)) return std::nullopt;
  int order = BasisOf(surface, direction).degree();
  for (const double at : Places(BasisOf(surface, Other(direction)), kMostLines)) {
    order = std::min(order, SeamOrder(LineAt(surface, direction, at), tolerance));
  }
  return order;
}

CollapsedEdgeSet CollapsedEdges(const NurbsSurface& surface, double tolerance) {
  const double allowed = tolerance * BoxDiagonal(surface.control_points());
  const auto collapsed = [&](Direction along, double at) {
    return BoxDiagonal(LineAt(surface, along, at).control_points()) <= allowed;
  };
  const SplineBasis &u = surface.basis_u(), &v = surface.basis_v();
  return {collapsed(Direction::kV, u.lower()),
          collapsed(Direction::kV, u.upper()),
          collapsed(Direction::kU, v.lower()),
          collapsed(Direction::kU, v.upper())};
}

template bool Closed(const NurbsCurve<2>&, double);
template bool Closed(const NurbsCurve<3>&, double);
template std::vector<KnotContinuity> ContinuityAtKnots(const NurbsCurve<2>&, double);
template std::vector<KnotContinuity> ContinuityAtKnots(const NurbsCurve<3>&, double);
template std::optional<int> SeamContinuity(const NurbsCurve<2>&, double);
template std::optional<int> SeamContinuity(const NurbsCurve<3>&, double);

}  // namespace batten
