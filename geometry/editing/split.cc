// SPDX-License-Identifier: MIT
#include "batten/geometry/split.h"

#include <stdexcept>
#include <string>

#include "geometry/editing/control_rows.h"
#include "geometry/editing/split_rows.h"
#include "geometry/editing/trim_clip.h"
#include "geometry/numeric/construction_checks.h"
#include "geometry/numeric/reject.h"
#include "geometry/nurbs/homogeneous.h"

namespace batten {
using namespace internal;
namespace {

// An untrimmed piece of the surface along a direction, with what the surface's trims leave of it.
std::vector<NurbsSurface> Parts(const NurbsSurface& surface,
                                Direction direction,
                                const NurbsSurface& piece) {
  if (!surface.trimmed()) return {piece};
  const SplineBasis &whole = BasisOf(surface, direction), &part = BasisOf(piece, direction);
  const UnitDomain domain(surface);
  std::vector<TrimLoops> sets{surface.trims()};
  const auto cut = [&](double at, KeptSide side) {
    std::vector<TrimLoops> cut_sets;
    for (const TrimLoops& loops : sets) {
      for (TrimLoops& left : CutTrims(loops, domain, direction, at, side)) {
        cut_sets.push_back(std::move(left));
      }
    }
    sets = std::move(cut_sets);
  };
  if (part.lower() > whole.lower()) cut(part.lower(), KeptSide::kAbove);
  if (part.upper() < whole.upper()) cut(part.upper(), KeptSide::kBelow);
  std::vector<NurbsSurface> parts;
  const UnitDomain piece_domain(piece);
  for (TrimLoops& loops : sets) {
    parts.push_back(FillsDomain(loops, piece_domain) ? piece : piece.WithTrims(std::move(loops)));
  }
  return parts;
}

NurbsSurface OnePart(const std::string& function, std::vector<NurbsSurface> parts) {
  if (parts.empty()) Reject(function, "the trims of the surface leave nothing of a piece");
  if (parts.size() > 1) {
    Reject(function,
           "the trims of the surface leave " + std::to_string(parts.size()) +
               " parts of a piece, not one; SegmentParts gives them");
  }
  return std::move(parts.front());
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
  const auto trimmed = [&](const ControlRows& rows) {
    return OnePart("Split", Parts(surface, direction, SurfaceOf(rows, direction, other)));
  };
  return {trimmed(low), trimmed(high)};
}

template <int Dim>
NurbsCurve<Dim> Segment(const NurbsCurve<Dim>& curve, double a, double b) {
  return Edited(curve, [&](const ControlRows& rows) { return SegmentRows(rows, a, b); });
}

std::vector<NurbsSurface> SegmentParts(const NurbsSurface& surface,
                                       Direction direction,
                                       double a,
                                       double b) {
  const ControlRows rows = SegmentRows(RowsOf(surface, direction), a, b);
  if (b > BasisOf(surface, direction).upper()) {
    RefuseTrims(surface.trimmed(), "Segment", "a piece of it through the seam is not made");
  }
  return Parts(surface, direction, SurfaceOf(rows, direction, OtherBasis(surface, direction)));
}

NurbsSurface Segment(const NurbsSurface& surface, Direction direction, double a, double b) {
  return OnePart("Segment", SegmentParts(surface, direction, a, b));
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
    const NurbsSurface piece = SurfaceOf(rows, direction, OtherBasis(surface, direction));
    for (NurbsSurface& part : Parts(surface, direction, piece)) pieces.push_back(std::move(part));
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
