// SPDX-License-Identifier: MIT
// Knot removal: fewer control points, the shape kept within a tolerance.
#pragma once

#include "batten/geometry/direction.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

template <typename Shape>
struct KnotRemoval {
  Shape shape;
  int removed;   // how many knots, counted with multiplicity
  double error;  // no point moved by more, at equal parameters; in the data's units
};

// Removes an inner knot `times` times, or fewer times where more would move a point by more than
// `tolerance` (≥ 0, in the data's units). What is periodic stays periodic; its seam can be removed
// until one knot is left there, and the end of an unclamped domain where it is repeated inside.
// With nothing removed the shape is returned as it was, error 0.
//
// Each removal makes p − s + 1 control points, s the multiplicity, into p − s others. They are
// solved for from both sides, where that is stable, and the one equation too many is satisfied by
// spreading the misfit evenly over all of them. Removal that would need weights that are not
// positive is not made. `error` is a true bound, to rounding, and at most 1 % above the largest
// distance or of the order of rounding (DeviationBound); whether a removal keeps the tolerance is
// decided by the same bound, so none is missed that is better by 1 %. A knot that was inserted is
// removed with an error of rounding size, so give at least that as tolerance (1e-12 of the size).
// [Piegl & Tiller 1997, §5.4, A5.8; the spreading follows Eck & Hadenfeld 1995]
//
// Throws std::invalid_argument if the tolerance is negative or not a number, if `u` (`at`) is not
// exactly a knot that can be removed, or if times is not in [1, as often as that].
template <int Dim>
KnotRemoval<NurbsCurve<Dim>> RemoveKnot(const NurbsCurve<Dim>& curve,
                                        double u,
                                        int times,
                                        double tolerance);
KnotRemoval<NurbsSurface> RemoveKnot(
    const NurbsSurface& surface, Direction direction, double at, int times, double tolerance);

// Removes knots, in both directions of a surface, the one that moves the shape least first, as long
// as the whole deviation stays within the tolerance. Throws as above. About K·(K + n) times the
// work of one removal, K the number of knots. [Piegl & Tiller 1997, A9.8 in spirit]
template <int Dim>
KnotRemoval<NurbsCurve<Dim>> RemoveKnots(const NurbsCurve<Dim>& curve, double tolerance);
KnotRemoval<NurbsSurface> RemoveKnots(const NurbsSurface& surface, double tolerance);

}  // namespace batten
