# SPDX-License-Identifier: MIT
"""Where curves and surfaces meet, and curves and surfaces at a distance."""
from __future__ import annotations

from typing import List, NamedTuple, Optional, Union

import numpy as np
from numpy.typing import ArrayLike

from . import _core
from ._arrays import Floats, finite, number
from ._curve import Curve
from ._geometry import Geometry, _body_of, wrap_all
from ._surface import Surface


class Branch(NamedTuple):
    """A curve along which two surfaces meet.

    Attributes
    ----------
    kind : str
        'transversal', 'tangential' or 'overlap'.
    closed : bool
        Whether the branch ends where it begins.
    curve : Curve
        The branch in space.
    on_first, on_second : list of Curve
        The branch in the parameters of the surfaces, on the same parameter as the curve; one each unless it runs over a seam.
    deviation : float
        The greatest distance of the curve from either surface, measured between the knots.
    """

    kind: str
    closed: bool
    curve: Curve
    on_first: List[Curve]
    on_second: List[Curve]
    deviation: float


class Meeting(NamedTuple):
    """A place that two shapes have in common.

    Attributes
    ----------
    point : numpy.ndarray
        The place.
    first, second : numpy.ndarray
        Its parameters on the shapes, one of a curve and two of a surface.
    tangential : bool
        Whether the shapes touch there.
    """

    point: Floats
    first: Floats
    second: Floats
    tangential: bool


class Overlap(NamedTuple):
    """What coincides.

    Attributes
    ----------
    first, second : numpy.ndarray
        Intervals of the parameters, one row for each direction.
    """

    first: Floats
    second: Floats


class Intersection(NamedTuple):
    """Everything in which two shapes meet.

    Attributes
    ----------
    branches : list of Branch
        The curves of two surfaces.
    points : list of Meeting
        Single places.
    overlaps : list of Overlap
        Where the shapes are the same.
    """

    branches: List[Branch]
    points: List[Meeting]
    overlaps: List[Overlap]


class Offset(NamedTuple):
    """A curve or surface at a distance.

    Attributes
    ----------
    geometry : list of Curve or Surface
        One; of a curve without its loops also several, or none.
    exact : bool
        Whether it is the offset to rounding.
    deviation : float
        The greatest distance from the exact offset, measured.
    self_meetings : numpy.ndarray
        Where it meets itself, one point a row.
    ok : bool
        Whether the tolerance is kept.
    """

    geometry: List[Geometry]
    exact: bool
    deviation: float
    self_meetings: Floats
    ok: bool


def _size(shape: Geometry) -> float:
    low, high = _core.bounding_box(shape._body)
    return float(np.linalg.norm(np.subtract(high, low)))


def _meeting(point: ArrayLike, first: ArrayLike, second: ArrayLike, tangential: bool) -> Meeting:
    return Meeting(
        np.asarray(point, dtype=float),
        np.atleast_1d(np.asarray(first, dtype=float)),
        np.atleast_1d(np.asarray(second, dtype=float)),
        tangential,
    )


def intersect(first: Geometry, second: Geometry, *, tolerance: Optional[float] = None) -> Intersection:
    """All curves, places and coincident parts that two shapes have in common.

    Parameters
    ----------
    first, second : Curve or Surface
        Of surfaces the parts inside their trims count. Two curves are both in the plane or both in space.
    tolerance : float, optional
        How far branches may be from the surfaces, points from each other, in the data's units; 1e-6 of the smaller
        size.

    Returns
    -------
    Intersection
        Branches are of two surfaces only; points of two surfaces are where they only touch, or where branches cross.

    Raises
    ------
    ValueError
        Where the shapes are too alike to be told apart within the tolerance: the message says where.
    """
    a, b = _body_of("first", first), _body_of("second", second)
    within = None if tolerance is None else number("tolerance", tolerance)
    if a.is_surface and b.is_surface:
        branches, touches, overlaps, _ = _core.intersect_surfaces(a, b, within)
        return Intersection(
            [
                Branch(kind, closed, Curve._of(curve), [Curve._of(p) for p in p1], [Curve._of(p) for p in p2], deviation)
                for kind, closed, curve, p1, p2, deviation in branches
            ],
            [_meeting(point, u, v, True) for point, u, v, _ in touches],
            [Overlap(np.asarray(u), np.asarray(v)) for u, v, _ in overlaps],
        )
    if within is None:
        within = 1e-6 * min(_size(first), _size(second))
    if not a.is_surface and not b.is_surface:
        points, stretches = _core.intersect_curves(a, b, within)
        return Intersection(
            [], [_meeting(*row) for row in points], [Overlap(np.array([u]), np.array([v])) for u, v in stretches]
        )
    swapped = a.is_surface
    places, parts = _core.intersect_curve_surface(b if swapped else a, a if swapped else b, within)
    meetings = [_meeting(*row) for row in places]
    found = [Overlap(np.array([u]), np.sort(np.array([start, end]).T, axis=1)) for u, start, end in parts]
    if swapped:
        meetings = [m._replace(first=m.second, second=m.first) for m in meetings]
        found = [Overlap(o.second, o.first) for o in found]
    return Intersection([], meetings, found)


def offset(
    shape: Union[Curve, Surface],
    distance: float,
    *,
    tolerance: Optional[float] = None,
    normal: ArrayLike = (0, 0, 1),
    trim_loops: bool = False,
) -> Offset:
    """A curve or surface at a distance: exact for lines, circles, planes, cylinders, cones, spheres and tori.

    Parameters
    ----------
    shape : Curve or Surface
        A surface without creases; trims stay.
    distance : float
        Along the surface's normal; of a curve to its left. Negative: to the other side.
    tolerance : float, optional
        How far the result may be from the exact offset, in the data's units; 1e-6 of the size.
    normal : array_like of shape (3,)
        Of a curve in space: from its tip left is seen.
    trim_loops : bool
        Cut away what of a curve's offset comes nearer to it than the distance.

    Returns
    -------
    Offset

    Raises
    ------
    ValueError
        Where the distance is beyond the radius of curvature: the message names the smallest radius and its place.
    """
    within = None if tolerance is None else number("tolerance", tolerance)
    bodies, exact, deviation, places, ok = _core.offset(
        _body_of("shape", shape), number("distance", distance), within, finite("normal", normal, 3).tolist(), bool(trim_loops)
    )
    return Offset(wrap_all(bodies), exact, deviation, np.asarray(places, dtype=float), ok)
