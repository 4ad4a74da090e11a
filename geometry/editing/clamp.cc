// SPDX-License-Identifier: MIT
#include "batten/geometry/clamp.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "geometry/editing/knot_refinement.h"
#include "geometry/editing/knot_removal.h"
#include "batten/geometry/knot_vectors.h"
#include "geometry/numeric/number_text.h"

namespace batten {
using namespace internal;
namespace {

ControlRows ClampedRows(const ControlRows& rows) {
  if (rows.basis.clamped()) return rows;
  return Cut(rows, rows.basis.lower(), rows.basis.upper());
}

// --- Unclamped

// The p knots in front of the domain, in increasing order, at distances that continue the inner
// spans of the upper end periodically. [Piegl & Tiller 1997, A12.1]
std::vector<double> PeriodicContinuation(const SplineBasis& basis) {
  std::vector<double> U = basis.knots();
  const int p = basis.degree(), n = basis.size();
  for (int i = 0; i < p; ++i) U[p - i - 1] = U[p - i] - (U[n - i] - U[n - i - 1]);
  return std::vector<double>(U.begin(), U.begin() + p);
}

// The control points P_0 … P_{p−1} of a row, homogeneous about the end point, after its clamped end
// a is replaced by the knots t_0 … t_{p−1} ≤ a: one argument a of the blossoms after the other
// becomes a t, by extrapolation over [a, u_{p+1+j}]. [A12.1]
void Extrapolate(const SplineBasis& basis,
                 const std::vector<double>& t,
                 std::vector<Eigen::Vector4d>& P) {
  const std::vector<double>& U = basis.knots();
  const int p = basis.degree();
  const double a = U[p];
  for (int i = 0; i + 2 <= p; ++i) {
    for (int j = i, k = p - 1; j >= 0; --j, --k) {
      const double end = U[p + j + 1];
      P[j] = ((end - t[k]) * P[j] - (a - t[k]) * P[j + 1]) / (end - a);
    }
  }
}

constexpr double kMostGrowth = 1000;  // see the header

// The rows with the clamped lower end opened to the knots t, or none where control points or
// weights grow too much.
std::optional<ControlRows> OpenedBelow(const ControlRows& rows, const std::vector<double>& t) {
  const int p = rows.basis.degree();
  std::vector<double> knots = rows.basis.knots();
  std::copy(t.begin(), t.end(), knots.begin());
  ControlRows opened = rows;
  opened.basis = SplineBasis(p, std::move(knots));
  double extent = 0, reach = 0;
  std::vector<Eigen::Vector4d> P(p + 1);
  for (Eigen::Index row = 0; row < rows.rows(); ++row) {
    const Eigen::Vector3d origin = rows.At(row, 0).place;
    double least = rows.At(row, 0).weight, most = least;
    for (int i = 0; i <= p; ++i) {
      const ControlRows::Point point = rows.At(row, i);
      P[i] << point.weight * (point.place - origin), point.weight;
      extent = std::max(extent, (point.place - origin).norm());
      least = std::min(least, point.weight);
      most = std::max(most, point.weight);
    }
    Extrapolate(rows.basis, t, P);
    for (int i = 0; i + 1 < p; ++i) {
      const double weight = rows.rational() ? P[i][3] : 1;
      if (!(weight >= least / kMostGrowth && weight <= most * kMostGrowth)) return std::nullopt;
      const Eigen::Vector3d from_end = P[i].head<3>() / weight;
      reach = std::max(reach, from_end.norm());
      opened.Set(row, i, {origin + from_end, weight});
    }
  }
  if (!(reach <= kMostGrowth * extent)) return std::nullopt;
  return opened;
}

ControlRows UnclampedBelow(const ControlRows& rows, const std::vector<double>& continuation) {
  const int p = rows.basis.degree();
  const double a = rows.basis.lower();
  std::vector<double> t = continuation;
  constexpr int kMostHalvings = 60;
  for (int halvings = 0; halvings <= kMostHalvings && t[p - 1] < a; ++halvings) {
    if (auto opened = OpenedBelow(rows, t)) return *std::move(opened);
    for (double& knot : t) knot = a - (a - knot) / 2;
  }
  throw std::invalid_argument("Unclamped: no knots outside the end " + NumberText(a) +
                              " keep the weights positive and the control points near");
}

// The same rows over the knots −u_{n+p} … −u_0: exact.
ControlRows Mirrored(const ControlRows& rows) {
  std::vector<double> knots(rows.basis.knots().rbegin(), rows.basis.knots().rend());
  for (double& knot : knots) knot = -knot;
  ControlRows mirrored = rows;
  mirrored.basis = SplineBasis(rows.basis.degree(), std::move(knots));
  for (Eigen::MatrixXd& x : mirrored.coordinates) x = x.rowwise().reverse().eval();
  if (rows.rational()) mirrored.weights = rows.weights.rowwise().reverse().eval();
  return mirrored;
}

ControlRows UnclampedRows(const ControlRows& rows) {
  const SplineBasis& basis = rows.basis;
  if (basis.periodic()) return rows;
  const ControlRows turned = Mirrored(rows);
  const std::vector<double> below = PeriodicContinuation(basis);
  const std::vector<double> above = PeriodicContinuation(turned.basis);
  const bool open_below = basis.knots().front() == basis.lower();
  const bool open_above = basis.knots().back() == basis.upper();
  ControlRows result = open_below ? UnclampedBelow(rows, below) : rows;
  if (open_above) result = Mirrored(UnclampedBelow(Mirrored(result), above));
  return result;
}

// --- Periodic

void CheckTolerance(double tolerance) {
  if (tolerance >= 0) return;
  throw std::invalid_argument("Periodic: tolerance = " + NumberText(tolerance) +
                              " is not a number of at least 0");
}

// The clamped rows with both end columns replaced by their middle.
ControlRows WithEndsJoined(const ControlRows& rows) {
  ControlRows joined = rows;
  const Eigen::Index last = rows.basis.size() - 1;
  for (Eigen::Index row = 0; row < rows.rows(); ++row) {
    const ControlRows::Point a = rows.At(row, 0), b = rows.At(row, last);
    const ControlRows::Point middle{a.place + (b.place - a.place) / 2,
                                    a.weight + (b.weight - a.weight) / 2};
    joined.Set(row, 0, middle);
    joined.Set(row, last, middle);
  }
  return joined;
}

// Clamped rows whose end columns are equal, as periodic ones with a seam of multiplicity p: the
// same control points but the last, then the first p once more.
ControlRows ClosedAtSeam(const ControlRows& rows) {
  const SplineBasis& basis = rows.basis;
  const int p = basis.degree(), round = basis.size() - 1;
  std::vector<double> breaks(1, basis.lower());
  breaks.insert(breaks.end(), basis.knots().begin() + p + 1, basis.knots().begin() + basis.size());
  breaks.insert(breaks.end(), p, basis.upper());
  ControlRows closed = EmptyRows(rows, PeriodicKnots(p, breaks));
  for (Eigen::Index row = 0; row < rows.rows(); ++row) {
    for (int j = 0; j < closed.basis.size(); ++j) closed.Set(row, j, rows.At(row, j % round));
  }
  return closed;
}

// Closes the seam, then removes what knots of it the tolerance allows. `across` is the degree in
// the other direction.
ControlRows PeriodicRows(const ControlRows& rows, double tolerance, int across) {
  if (rows.basis.periodic()) return rows;
  const ControlRows clamped = ClampedRows(rows), joined = WithEndsJoined(clamped);
  const ControlRows pieces = BezierRows(clamped);
  const double gap = BezierDeviation(pieces, BezierRows(joined), across);
  if (!(gap <= tolerance)) {
    throw std::invalid_argument("Periodic: the ends do not meet within the tolerance " +
                                NumberText(tolerance) + ": closing them moves points by up to " +
                                NumberText(gap) + " (weights at the ends count too)");
  }
  ControlRows best = ClosedAtSeam(joined);
  for (int k = 1; k < best.basis.degree(); ++k) {
    auto less = WithoutKnot(best, best.basis.lower());
    if (!less) break;
    if (!(BezierDeviation(pieces, BezierRows(less->rows), across) <= tolerance)) break;
    best = std::move(less->rows);
  }
  return best;
}

}  // namespace

template <int Dim>
NurbsCurve<Dim> Clamped(const NurbsCurve<Dim>& curve) {
  if (curve.basis().clamped()) return curve;
  return Edited(curve, ClampedRows);
}

NurbsSurface Clamped(const NurbsSurface& surface, Direction direction) {
  return Edited(surface, direction, ClampedRows);
}

template <int Dim>
NurbsCurve<Dim> Unclamped(const NurbsCurve<Dim>& curve) {
  return Edited(curve, UnclampedRows);
}

NurbsSurface Unclamped(const NurbsSurface& surface, Direction direction) {
  return Edited(surface, direction, UnclampedRows);
}

template <int Dim>
NurbsCurve<Dim> Periodic(const NurbsCurve<Dim>& curve, double tolerance) {
  CheckTolerance(tolerance);
  return CurveOf<Dim>(PeriodicRows(RowsOf(curve), tolerance, 0));
}

NurbsSurface Periodic(const NurbsSurface& surface, Direction direction, double tolerance) {
  CheckTolerance(tolerance);
  const SplineBasis& other = OtherBasis(surface, direction);
  const ControlRows rows = PeriodicRows(RowsOf(surface, direction), tolerance, other.degree());
  return SurfaceOf(rows, direction, other).WithTrims(surface.trims());
}

template NurbsCurve<2> Clamped(const NurbsCurve<2>&);
template NurbsCurve<3> Clamped(const NurbsCurve<3>&);
template NurbsCurve<2> Unclamped(const NurbsCurve<2>&);
template NurbsCurve<3> Unclamped(const NurbsCurve<3>&);
template NurbsCurve<2> Periodic(const NurbsCurve<2>&, double);
template NurbsCurve<3> Periodic(const NurbsCurve<3>&, double);

}  // namespace batten
