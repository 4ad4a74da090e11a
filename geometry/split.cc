// SPDX-License-Identifier: MIT
#include "batten/geometry/split.h"

#include <stdexcept>
#include <string>

#include "batten/geometry/knot_refinement.h"
#include "batten/geometry/number_text.h"

namespace batten {
namespace {

[[noreturn]] void Reject(const std::string& function, const std::string& rule) {
  throw std::invalid_argument(function + ": " + rule);
}

// Both pieces come out of one refinement with u repeated p times.
std::pair<ControlRows, ControlRows> SplitRows(const ControlRows& rows,
                                              const std::string& name,
                                              double u) {
  const SplineBasis& basis = rows.basis;
  const int p = basis.degree();
  if (!(u > basis.lower() && u < basis.upper())) {
    Reject("Split",
           name + " = " + NumberText(u) + " is not strictly inside the domain " +
               IntervalText(basis.lower(), basis.upper()));
  }
  const std::vector<double> more(p - basis.Multiplicity(u), u);
  const ControlRows whole = Cut(rows, basis.lower(), basis.upper(), more);
  const std::vector<double>& U = whole.basis.knots();
  int first = 0;  // place of the first u
  while (U[first] < u) ++first;
  std::vector<double> low(U.begin(), U.begin() + first + p), high(U.begin() + first, U.end());
  low.push_back(u);
  high.insert(high.begin(), u);
  return {ColumnsOf(whole, 0, SplineBasis(p, std::move(low))),
          ColumnsOf(whole, first - 1, SplineBasis(p, std::move(high)))};
}

ControlRows SegmentRows(const ControlRows& rows, double a, double b) {
  const SplineBasis& basis = rows.basis;
  const bool inside = a >= basis.lower() && a < b && b <= basis.upper();
  if (inside) return Cut(rows, a, b);
  const double period = basis.upper() - basis.lower();
  if (basis.periodic() && a >= basis.lower() && a < basis.upper() && b > a && b <= a + period) {
    return Cut(UnrolledTwice(rows), a, b);
  }
  Reject("Segment",
         IntervalText(a, b) + " is not a piece of the domain " +
             IntervalText(basis.lower(), basis.upper()) +
             (basis.periodic() ? " or of one period from a place of it" : ""));
}

std::vector<ControlRows> DecomposeRows(const ControlRows& rows) {
  const int p = rows.basis.degree();
  const ControlRows whole = BezierRows(rows);
  std::vector<ControlRows> pieces;
  for (const int span : whole.basis.Spans()) {
    const std::vector<double>& U = whole.basis.knots();
    std::vector<double> knots(p + 1, U[span]);
    knots.insert(knots.end(), p + 1, U[span + 1]);
    pieces.push_back(ColumnsOf(whole, span - p, SplineBasis(p, std::move(knots))));
  }
  return pieces;
}

}  // namespace

template <int Dim>
std::pair<NurbsCurve<Dim>, NurbsCurve<Dim>> Split(const NurbsCurve<Dim>& curve, double u) {
  const auto [low, high] = SplitRows(RowsOf(curve), "u", u);
  return {CurveOf<Dim>(low), CurveOf<Dim>(high)};
}

std::pair<NurbsSurface, NurbsSurface> Split(const NurbsSurface& surface,
                                            Direction direction,
                                            double at) {
  const auto [low, high] = SplitRows(RowsOf(surface, direction), "at", at);
  const SplineBasis& other = OtherBasis(surface, direction);
  return {SurfaceOf(low, direction, other), SurfaceOf(high, direction, other)};
}

template <int Dim>
NurbsCurve<Dim> Segment(const NurbsCurve<Dim>& curve, double a, double b) {
  return Edited(curve, [&](const ControlRows& rows) { return SegmentRows(rows, a, b); });
}

NurbsSurface Segment(const NurbsSurface& surface, Direction direction, double a, double b) {
  const auto edit = [&](const ControlRows& rows) { return SegmentRows(rows, a, b); };
  return Edited(surface, direction, edit);
}

NurbsSurface Segment(const NurbsSurface& surface, double a, double b, double c, double d) {
  return Segment(Segment(surface, Direction::kU, a, b), Direction::kV, c, d);
}

template <int Dim>
std::vector<NurbsCurve<Dim>> Decompose(const NurbsCurve<Dim>& curve) {
  std::vector<NurbsCurve<Dim>> pieces;
  for (const ControlRows& rows : DecomposeRows(RowsOf(curve))) pieces.push_back(CurveOf<Dim>(rows));
  return pieces;
}

std::vector<NurbsSurface> Decompose(const NurbsSurface& surface, Direction direction) {
  std::vector<NurbsSurface> pieces;
  for (const ControlRows& rows : DecomposeRows(RowsOf(surface, direction))) {
    pieces.push_back(SurfaceOf(rows, direction, OtherBasis(surface, direction)));
  }
  return pieces;
}

std::vector<NurbsSurface> Decompose(const NurbsSurface& surface) {
  std::vector<NurbsSurface> pieces;
  for (const NurbsSurface& strip : Decompose(surface, Direction::kU)) {
    for (NurbsSurface& piece : Decompose(strip, Direction::kV)) pieces.push_back(std::move(piece));
  }
  return pieces;
}

template std::pair<NurbsCurve<2>, NurbsCurve<2>> Split(const NurbsCurve<2>&, double);
template std::pair<NurbsCurve<3>, NurbsCurve<3>> Split(const NurbsCurve<3>&, double);
template NurbsCurve<2> Segment(const NurbsCurve<2>&, double, double);
template NurbsCurve<3> Segment(const NurbsCurve<3>&, double, double);
template std::vector<NurbsCurve<2>> Decompose(const NurbsCurve<2>&);
template std::vector<NurbsCurve<3>> Decompose(const NurbsCurve<3>&);

}  // namespace batten
