// SPDX-License-Identifier: MIT
#include "batten/geometry/join.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "batten/geometry/clamp.h"
#include "batten/geometry/degree_elevation.h"
#include "geometry/editing/compatible_surfaces.h"
#include "geometry/editing/control_rows.h"
#include "geometry/editing/knot_removal.h"
#include "geometry/numeric/construction_checks.h"
#include "geometry/numeric/number_text.h"

namespace batten {
using namespace internal;
namespace {

void CheckJoinTolerance(double tolerance) {
  if (tolerance >= 0) return;
  throw std::invalid_argument("Join: tolerance = " + NumberText(tolerance) +
                              " is not a number of at least 0");
}

void WriteOutWeights(ControlRows& rows) {
  if (rows.rational()) return;
  rows.weights = Eigen::MatrixXd::Constant(rows.rows(), rows.basis.size(), rows.common_weight);
}

// One column as rows of their own, so that two edges can be compared.
ControlRows Edge(const ControlRows& rows, Eigen::Index i) {
  ControlRows edge = EmptyRows(rows, SplineBasis(1, {0, 0, 1, 1}));
  for (Eigen::Index row = 0; row < rows.rows(); ++row) {
    edge.Set(row, 0, rows.At(row, i));
    edge.Set(row, 1, rows.At(row, i));
  }
  return edge;
}

// The knots of both, the second's shifted to begin where the first's end, that knot p times.
SplineBasis JoinedBasis(const SplineBasis& first, const SplineBasis& second) {
  const int p = first.degree();
  std::vector<double> knots(first.knots().begin(), first.knots().end() - 1);
  for (size_t k = p + 1; k < second.knots().size(); ++k) {
    knots.push_back(first.upper() + (second.knots()[k] - second.lower()));
  }
  return SplineBasis(p, std::move(knots));
}

// Of clamped rows of one degree and over the same basis across, of degree `across`.
ControlRows JoinedRows(ControlRows first, ControlRows second, double tolerance, int across) {
  const Eigen::Index last = first.basis.size() - 1;
  if (first.rational() || second.rational()) {
    WriteOutWeights(first);
    WriteOutWeights(second);
    second.weights *= first.weights.col(last).sum() / second.weights.col(0).sum();
  }
  const double gap = BezierDeviation(Edge(first, last), Edge(second, 0), across);
  if (!(gap <= tolerance)) {
    throw std::invalid_argument(
        "Join: the gap between the end of the first and the start of the "
        "second is " +
        NumberText(gap) + ", above the tolerance " + NumberText(tolerance));
  }
  ControlRows joined = EmptyRows(first, JoinedBasis(first.basis, second.basis));
  for (Eigen::Index row = 0; row < joined.rows(); ++row) {
    for (Eigen::Index i = 0; i < joined.basis.size(); ++i) {
      joined.Set(row, i, i <= last ? first.At(row, i) : second.At(row, i - last));
    }
    const ControlRows::Point a = first.At(row, last), b = second.At(row, 0);
    joined.Set(
        row, last, {a.place + (b.place - a.place) / 2, a.weight + (b.weight - a.weight) / 2});
  }
  return joined;
}

// Both of the higher degree of the two.
template <int Dim>
void RaiseToSameDegree(NurbsCurve<Dim>& a, NurbsCurve<Dim>& b) {
  const int by = b.basis().degree() - a.basis().degree();
  if (by > 0) a = Elevated(a, by);
  if (by < 0) b = Elevated(b, -by);
}
}  // namespace

template <int Dim>
NurbsCurve<Dim> Join(const NurbsCurve<Dim>& first,
                     const NurbsCurve<Dim>& second,
                     double tolerance) {
  CheckJoinTolerance(tolerance);
  NurbsCurve<Dim> a = Clamped(first), b = Clamped(second);
  RaiseToSameDegree(a, b);
  return CurveOf<Dim>(JoinedRows(RowsOf(a), RowsOf(b), tolerance, 0));
}

NurbsSurface Join(const NurbsSurface& first,
                  const NurbsSurface& second,
                  Direction direction,
                  double tolerance) {
  CheckJoinTolerance(tolerance);
  for (const NurbsSurface* surface : {&first, &second}) {
    RefuseTrims(surface->trimmed(), "Join", "the loops of two surfaces are not joined");
  }
  const Direction across = direction == Direction::kU ? Direction::kV : Direction::kU;
  NurbsSurface a = Clamped(first, direction), b = Clamped(second, direction);
  RaiseToSameDegree(a, b, direction);
  RaiseToSameDegree(a, b, across);
  PutOverSameKnots(a, b, across);
  const SplineBasis& other = OtherBasis(a, direction);
  return SurfaceOf(
      JoinedRows(RowsOf(a, direction), RowsOf(b, direction), tolerance, other.degree()),
      direction,
      other);
}

template NurbsCurve<2> Join(const NurbsCurve<2>&, const NurbsCurve<2>&, double);
template NurbsCurve<3> Join(const NurbsCurve<3>&, const NurbsCurve<3>&, double);

}  // namespace batten
