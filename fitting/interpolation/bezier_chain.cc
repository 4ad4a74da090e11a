// SPDX-License-Identifier: MIT
#include "fitting/interpolation/bezier_chain.h"

#include <cmath>
#include <utility>

#include "batten/geometry/knot_vectors.h"
#include "fitting/core/rounding.h"
#include "geometry/numeric/polygon.h"

namespace batten::internal {
namespace {

// Speeds at the ends over a domain of length 1.
template <int Dim>
double SpeedAtStart(const ChainPiece<Dim>& piece) {
  const auto p = static_cast<double>(piece.points.cols() - 1);
  return p * piece.weights[1] * (piece.points.col(1) - piece.points.col(0)).norm();
}
template <int Dim>
double SpeedAtEnd(const ChainPiece<Dim>& piece) {
  const Eigen::Index p = piece.points.cols() - 1;
  return static_cast<double>(p) * piece.weights[p - 1] *
         (piece.points.col(p) - piece.points.col(p - 1)).norm();
}

template <int Dim>
bool Polynomial(const ChainPiece<Dim>& piece) {
  return (piece.weights.array() == 1).all();
}

// Lengths of the pieces' domains, and where they make the curve C¹ with the piece before.
struct Steps {
  std::vector<double> lengths;
  std::vector<bool> continuous;
};

template <int Dim>
Steps StepsOf(const std::vector<ChainPiece<Dim>>& pieces) {
  constexpr double kDrift = 30;
  Steps steps;
  for (size_t k = 0; k < pieces.size(); ++k) {
    const double length = PolygonLength(pieces[k].points);
    double step = 0;
    if (k > 0 && pieces[k - 1].smooth) {
      step = SpeedAtStart(pieces[k]) * steps.lengths.back() / SpeedAtEnd(pieces[k - 1]);
    }
    const bool continuous = step > length / kDrift && step < length * kDrift;
    steps.lengths.push_back(continuous ? step : length);
    steps.continuous.push_back(continuous);
  }
  return steps;
}

// Whether the seam is C¹ between polynomial pieces.
template <int Dim>
bool ContinuousAtSeam(const std::vector<ChainPiece<Dim>>& pieces, const Steps& steps) {
  const ChainPiece<Dim>&first = pieces.front(), &last = pieces.back();
  if (first.points.cols() < 3 || !last.smooth || !Polynomial(first) || !Polynomial(last)) {
    return false;
  }
  const double arriving = SpeedAtEnd(last) / steps.lengths.back(),
               leaving = SpeedAtStart(first) / steps.lengths.front();
  // Rounding is summed along the chain.
  return std::abs(arriving - leaving) <= kRelativelyEqual * leaving;
}

// The periodic form of a clamped curve whose ends coincide: the seam becomes a knot of multiplicity
// p, or p − 1 where the curve is C¹ there and the common point is no control point.
template <int Dim>
NurbsCurve<Dim> RoundTheSeam(const NurbsCurve<Dim>& curve, bool continuous) {
  const SplineBasis& basis = curve.basis();
  const int p = basis.degree(), n = basis.size();
  const int distinct = continuous ? n - 2 : n - 1;
  std::vector<double> breaks(1, basis.lower());
  breaks.insert(breaks.end(), basis.knots().begin() + p + 1, basis.knots().begin() + n);
  breaks.insert(breaks.end(), static_cast<size_t>(continuous ? p - 1 : p), basis.upper());
  SplineBasis periodic = PeriodicKnots(p, breaks);
  Eigen::Matrix<double, Dim, Eigen::Dynamic> control(Dim, periodic.size());
  Eigen::VectorXd weights(periodic.size());
  for (int i = 0; i < periodic.size(); ++i) {
    const int from = i % distinct == 0 && continuous ? n - 2 : i % distinct;
    control.col(i) = curve.control_points().col(from);
    weights[i] = curve.weights()[from];
  }
  return NurbsCurve<Dim>(std::move(periodic), std::move(control), std::move(weights));
}

}  // namespace

template <int Dim>
Chain<Dim> Chained(const std::vector<ChainPiece<Dim>>& pieces, bool closed) {
  const Eigen::Index p = pieces.front().points.cols() - 1;
  const auto count = static_cast<Eigen::Index>(pieces.size());
  const Steps steps = StepsOf(pieces);
  Eigen::VectorXd breaks(count + 1);
  breaks[0] = 0;
  for (Eigen::Index k = 0; k < count; ++k) {
    breaks[k + 1] = breaks[k] + steps.lengths[static_cast<size_t>(k)];
  }
  breaks /= breaks[count];
  Eigen::Matrix<double, Dim, Eigen::Dynamic> control(Dim, count * p + 1);
  Eigen::VectorXd weights(count * p + 1);
  std::vector<double> knots(static_cast<size_t>(p) + 1, 0.0);
  Eigen::Index size = 0;
  const auto add = [&](const ChainPiece<Dim>& piece, Eigen::Index i) {
    control.col(size) = piece.points.col(i);
    weights[size++] = piece.weights[i];
  };
  add(pieces.front(), 0);
  for (Eigen::Index k = 0; k < count; ++k) {
    const ChainPiece<Dim>& piece = pieces[static_cast<size_t>(k)];
    for (Eigen::Index i = 1; i < p; ++i) add(piece, i);
    const bool last = k + 1 == count;
    const bool drops = !last && p > 1 && steps.continuous[static_cast<size_t>(k) + 1] &&
                       Polynomial(piece) && Polynomial(pieces[static_cast<size_t>(k) + 1]);
    if (!drops) add(piece, p);
    knots.insert(knots.end(), static_cast<size_t>(last ? p + 1 : drops ? p - 1 : p), breaks[k + 1]);
  }
  NurbsCurve<Dim> curve(SplineBasis(static_cast<int>(p), std::move(knots)),
                        control.leftCols(size),
                        weights.head(size));
  if (!closed) return {std::move(curve), std::move(breaks)};
  return {RoundTheSeam<Dim>(curve, ContinuousAtSeam<Dim>(pieces, steps)), std::move(breaks)};
}

template Chain<2> Chained<2>(const std::vector<ChainPiece<2>>&, bool);
template Chain<3> Chained<3>(const std::vector<ChainPiece<3>>&, bool);

}  // namespace batten::internal
