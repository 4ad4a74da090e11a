# SPDX-License-Identifier: MIT
"""Exact shapes as NURBS on [0, 1], and surfaces made of curves. Lengths in the data's units, angles in radians. Round surfaces: u goes round the
axis, v along the profile, normals look outward. `axis` need not have length one; `x` is where angle 0 is, made
perpendicular (None: the coordinate axis farthest from the axis)."""
from __future__ import annotations

import math
from typing import Any, Dict, List, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike

from . import _core
from ._arrays import Floats, finite, number
from ._curve import Curve
from ._geometry import _body_of
from ._surface import Surface

FULL = 2 * math.pi

__all__ = [
    "line", "circle", "arc", "ellipse", "bilinear", "plane", "cylinder", "cone", "sphere", "torus", "revolve",
    "extrude", "ruled", "aligned", "loft", "sweep", "swing", "gordon", "coons", "patch",
    "conic", "blend", "fill", "chain",
]


def _three(name: str, value: Any) -> Floats:
    return finite(name, value, 3)


def _frame(center: Any, axis: Any, x: Any) -> Tuple[Floats, Floats, Optional[Floats]]:
    return _three("center", center), _three("axis", axis), None if x is None else _three("x", x)


def _two(name: str, value: Any) -> Tuple[float, float]:
    a, b = finite(name, value, 2).tolist()
    return a, b


def _angles(start: Any, sweep: Any) -> Tuple[float, float]:
    return number("start", start), number("sweep", sweep)


def line(start: ArrayLike, end: ArrayLike) -> Curve:
    """A segment.

    Parameters
    ----------
    start, end : array_like of shape (2,) or (3,)
        They differ.

    Returns
    -------
    Curve
        Of degree 1.
    """
    a, b = finite("start", start, None), finite("end", end, None)
    if a.size not in (2, 3) or a.size != b.size:
        raise ValueError("start, end: two or three numbers each are needed")
    return Curve._of(_core.line(a, b))


def arc(
    radius: float,
    *,
    center: ArrayLike = (0, 0, 0),
    axis: ArrayLike = (0, 0, 1),
    x: Optional[ArrayLike] = None,
    start: float = 0,
    sweep: float = FULL / 4,
) -> Curve:
    """An arc of a circle, counter-clockwise about the axis.

    Parameters
    ----------
    radius : float
        Positive.
    center : array_like of shape (3,), or (2,) for an arc in the plane
        Of its circle.
    axis, x : array_like of shape (3,)
        Normal of its plane, and where angle 0 is.
    start, sweep : float
        Radians; the sweep is in (0, 2π].

    Returns
    -------
    Curve
        Rational, of degree 2.
    """
    middle = finite("center", center, None)
    if middle.size not in (2, 3):
        raise ValueError("center: two or three numbers are needed")
    _, normal, zero = _frame((0, 0, 0), axis, x)
    return Curve._of(
        _core.arc(middle, normal, zero, number("radius", radius), _angles(start, sweep))
    )


def circle(
    radius: float, *, center: ArrayLike = (0, 0, 0), axis: ArrayLike = (0, 0, 1), x: Optional[ArrayLike] = None
) -> Curve:
    """A full circle, counter-clockwise about the axis.

    Parameters
    ----------
    radius : float
        Positive.
    center : array_like of shape (3,), or (2,) for a circle in the plane
        Its centre.
    axis, x : array_like of shape (3,)
        Normal of its plane, and where it begins.

    Returns
    -------
    Curve
        Rational, of degree 2, nine control points.
    """
    return arc(radius, center=center, axis=axis, x=x, sweep=FULL)


def ellipse(
    radii: Tuple[float, float],
    *,
    center: ArrayLike = (0, 0, 0),
    axis: ArrayLike = (0, 0, 1),
    x: Optional[ArrayLike] = None,
    start: float = 0,
    sweep: float = FULL,
) -> Curve:
    """An ellipse, or an arc of one.

    Parameters
    ----------
    radii : (float, float)
        Along x and across.
    center, axis, x : array_like of shape (3,)
        Its centre, the normal of its plane, and where angle 0 is.
    start, sweep : float
        Radians, of the circle it is the affine image of.

    Returns
    -------
    Curve
        Rational, of degree 2.
    """
    angles = _angles(start, sweep)
    return Curve._of(_core.ellipse(*_frame(center, axis, x), _two("radii", radii), angles))


def bilinear(p00: ArrayLike, p10: ArrayLike, p01: ArrayLike, p11: ArrayLike) -> Surface:
    """The surface between four corners.

    Parameters
    ----------
    p00, p10, p01, p11 : array_like of shape (3,)
        S(0,0), S(1,0), S(0,1), S(1,1).

    Returns
    -------
    Surface
        Of degree 1 × 1.
    """
    corners = [_three(name, p) for name, p in (("p00", p00), ("p10", p10), ("p01", p01), ("p11", p11))]
    return Surface._of(_core.bilinear(*corners))


def plane(
    size: Tuple[float, float],
    *,
    center: ArrayLike = (0, 0, 0),
    axis: ArrayLike = (0, 0, 1),
    x: Optional[ArrayLike] = None,
) -> Surface:
    """A rectangle.

    Parameters
    ----------
    size : (float, float)
        Its sides, along x and across.
    center, axis, x : array_like of shape (3,)
        Its middle, its normal, and the direction of u.

    Returns
    -------
    Surface
        Of degree 1 × 1.
    """
    w, h = _two("size", size)
    if not (w > 0 and h > 0):
        raise ValueError("size: both sides must be positive")
    return Surface._of(_core.plane(*_frame(center, axis, x), (-w / 2, w / 2), (-h / 2, h / 2)))


def cylinder(
    radius: float,
    height: float,
    *,
    center: ArrayLike = (0, 0, 0),
    axis: ArrayLike = (0, 0, 1),
    x: Optional[ArrayLike] = None,
    start: float = 0,
    sweep: float = FULL,
) -> Surface:
    """A cylinder, or a part of one.

    Parameters
    ----------
    radius, height : float
        Positive.
    center, axis, x : array_like of shape (3,)
        The middle of its foot, its axis from the foot up, and where angle 0 is.
    start, sweep : float
        Radians about the axis.

    Returns
    -------
    Surface
        Exact.
    """
    r, h = number("radius", radius), number("height", height)
    angles = _angles(start, sweep)
    return Surface._of(_core.cylinder(*_frame(center, axis, x), r, (0.0, h), angles))


def cone(
    radius: float,
    height: float,
    *,
    top_radius: float = 0,
    center: ArrayLike = (0, 0, 0),
    axis: ArrayLike = (0, 0, 1),
    x: Optional[ArrayLike] = None,
    start: float = 0,
    sweep: float = FULL,
) -> Surface:
    """A cone, a frustum, or a part of one.

    Parameters
    ----------
    radius, height : float
        Of the foot, and from foot to top.
    top_radius : float
        0: a tip.
    center, axis, x : array_like of shape (3,)
        The middle of its foot, its axis from the foot up, and where angle 0 is.
    start, sweep : float
        Radians about the axis.

    Returns
    -------
    Surface
        Exact.
    """
    radii = (number("radius", radius), number("top_radius", top_radius))
    angles = _angles(start, sweep)
    return Surface._of(_core.cone(*_frame(center, axis, x), radii, (0.0, number("height", height)), angles))


def sphere(
    radius: float,
    *,
    center: ArrayLike = (0, 0, 0),
    axis: ArrayLike = (0, 0, 1),
    x: Optional[ArrayLike] = None,
    start: float = 0,
    sweep: float = FULL,
    latitudes: Tuple[float, float] = (-math.pi / 2, math.pi / 2),
) -> Surface:
    """A sphere, or a part of one.

    Parameters
    ----------
    radius : float
        Positive.
    center, axis, x : array_like of shape (3,)
        Its centre, from the south to the north pole, and where longitude 0 is.
    start, sweep : float
        Longitudes, radians.
    latitudes : (float, float)
        From where to where, radians.

    Returns
    -------
    Surface
        Exact; poles are collapsed edges.
    """
    angles = _angles(start, sweep)
    r = number("radius", radius)
    return Surface._of(_core.sphere(*_frame(center, axis, x), r, angles, _two("latitudes", latitudes)))


def torus(
    major_radius: float,
    minor_radius: float,
    *,
    center: ArrayLike = (0, 0, 0),
    axis: ArrayLike = (0, 0, 1),
    x: Optional[ArrayLike] = None,
    start: float = 0,
    sweep: float = FULL,
    tube_start: float = 0,
    tube_sweep: float = FULL,
) -> Surface:
    """A torus, or a part of one.

    Parameters
    ----------
    major_radius, minor_radius : float
        From the axis to the tube's middle, and of the tube.
    center, axis, x : array_like of shape (3,)
        Its centre, its axis, and where angle 0 is.
    start, sweep : float
        Radians about the axis.
    tube_start, tube_sweep : float
        Radians round the tube, from the outermost point towards the axis' direction.

    Returns
    -------
    Surface
        Exact.
    """
    radii = (number("major_radius", major_radius), number("minor_radius", minor_radius))
    round_axis = _angles(start, sweep)
    tube = (number("tube_start", tube_start), number("tube_sweep", tube_sweep))
    return Surface._of(_core.torus(*_frame(center, axis, x), radii, round_axis, tube))


def revolve(
    profile: Curve,
    *,
    center: ArrayLike = (0, 0, 0),
    axis: ArrayLike = (0, 0, 1),
    start: float = 0,
    sweep: float = FULL,
) -> Surface:
    """A curve turned about an axis.

    Parameters
    ----------
    profile : Curve
        In space.
    center, axis : array_like of shape (3,)
        A point of the axis, and its direction.
    start, sweep : float
        Radians.

    Returns
    -------
    Surface
        v is the profile's parameter.
    """
    origin, direction, _ = _frame(center, axis, None)
    angles = _angles(start, sweep)
    return Surface._of(_core.revolve(_body_of("profile", profile), origin, direction, angles))


def _curve(name: str, value: Any) -> _core.Body:
    if isinstance(value, Curve) and value.dimension == 3:
        return value._body
    raise ValueError(f"{name}: a Curve in space is needed")


def _curves(name: str, values: Any) -> List[_core.Body]:
    if isinstance(values, Curve) or not isinstance(values, Sequence):
        raise ValueError(f"{name}: a list of curves is needed")
    return [_curve(f"{name}[{k}]", one) for k, one in enumerate(values)]


def _tolerance(given: Any, *curves: Any) -> float:
    if given is not None:
        return number("tolerance", given)
    points = np.concatenate([np.asarray(one.control_points).reshape(-1, 3) for one in curves])
    return 1e-5 * float(np.linalg.norm(np.ptp(points, axis=0)))


def extrude(profile: Curve, by: ArrayLike) -> Surface:
    """A curve moved along a vector; exact.

    Parameters
    ----------
    profile : Curve
        In space.
    by : array_like of shape (3,)
        How far and in which direction.

    Returns
    -------
    Surface
        u is the profile's parameter, v in [0, 1].
    """
    return Surface._of(_core.extrude(_curve("profile", profile), _three("by", by)))


def ruled(first: Curve, second: Curve, *, by_length: bool = False, tolerance: Optional[float] = None) -> Surface:
    """The straight lines between two curves.

    Parameters
    ----------
    first, second : Curve
        In space, both closed or both open; one may be a point.
    by_length : bool
        Join points at equal shares of the lengths, not of the parameters.
    tolerance : float, optional
        With `by_length`: how far the edge may leave the second curve (None: 1e-5 of the size).

    Returns
    -------
    Surface
        v = 0 is the first curve, v = 1 the second.
    """
    bodies = _curve("first", first), _curve("second", second)
    return Surface._of(_core.ruled(*bodies, bool(by_length), _tolerance(tolerance, first, second)))


def aligned(curves: Sequence[Curve]) -> List[Curve]:
    """The curves turned round, and closed ones begun elsewhere, where they then run beside the one before.

    Parameters
    ----------
    curves : sequence of Curve
        In space, all closed or all open.

    Returns
    -------
    list of Curve
        The first, and what needs no change, as given.
    """
    return [Curve._of(body) for body in _core.aligned(_curves("curves", curves))]


def _end(name: str, direction: Optional[ArrayLike], fullness: float) -> Optional[Tuple[Floats, float]]:
    return None if direction is None else (_three(name, direction), number(name + "_fullness", fullness))


def loft(
    sections: Sequence[Curve],
    *,
    degree: int = 3,
    closed: bool = False,
    start_tangent: Optional[ArrayLike] = None,
    end_tangent: Optional[ArrayLike] = None,
    start_tangent_fullness: float = 1,
    end_tangent_fullness: float = 1,
    spine: Optional[Curve] = None,
    align: bool = False,
    tolerance: Optional[float] = None,
) -> Surface:
    """The surface through section curves.

    Parameters
    ----------
    sections : sequence of Curve
        In space and in their order, of any degree and knots, all closed or all open.
    degree : int
        Across the sections, where there are enough.
    closed : bool
        Goes on from the last section to the first, smoothly.
    start_tangent, end_tangent : array_like of shape (3,), optional
        Directions in which the surface leaves the first section and arrives at the last.
    start_tangent_fullness, end_tangent_fullness : float
        Lengths of ∂S/∂v there, in mean lengths of the surface across the sections.
    spine : Curve, optional
        Past the sections in their order; they are crossed in its direction.
    align : bool
        Sections as `aligned` makes them.
    tolerance : float, optional
        Of sections whose weights differ too wildly to be lofted as they are (None: 1e-5 of the size).

    Returns
    -------
    Surface
        u runs along the sections, v across them in [0, 1].
    """
    bodies = _curves("sections", sections)
    if not bodies:
        raise ValueError("sections: there are none")
    return Surface._of(
        _core.loft(
            bodies,
            int(number("degree", degree)),
            bool(closed),
            _end("start_tangent", start_tangent, start_tangent_fullness),
            _end("end_tangent", end_tangent, end_tangent_fullness),
            None if spine is None else _curve("spine", spine),
            bool(align),
            _tolerance(tolerance, *sections),
        )
    )


def sweep(
    profile: Curve,
    trajectory: Curve,
    *,
    translational: bool = False,
    twist: float = 0,
    tolerance: Optional[float] = None,
) -> Surface:
    """A curve moved along another, and turned with it but not about it.

    Parameters
    ----------
    profile, trajectory : Curve
        In space; the profile stays where it is at the trajectory's beginning.
    translational : bool
        Moved without turning: exact.
    twist : float
        Radians by which it is turned about the trajectory on the way; whole turns where that is closed.
    tolerance : float, optional
        Largest distance from the exact sweep (None: 1e-5 of the size).

    Returns
    -------
    Surface
        u is the profile's parameter, v the trajectory's.
    """
    bodies = _curve("profile", profile), _curve("trajectory", trajectory)
    turn = number("twist", twist)
    if translational:
        if turn != 0 or tolerance is not None:
            raise ValueError("translational: it is exact and does not turn; leave twist and tolerance out")
        return Surface._of(_core.sweep_translational(*bodies))
    return Surface._of(_core.sweep(*bodies, _tolerance(tolerance, profile, trajectory), turn))


def swing(
    profile: Curve,
    trajectory: Curve,
    *,
    center: ArrayLike = (0, 0, 0),
    axis: ArrayLike = (0, 0, 1),
    x: Optional[ArrayLike] = None,
    scale: float = 1,
) -> Surface:
    """A profile that goes round an axis, as far out as a curve across it says; exact.

    Parameters
    ----------
    profile : Curve
        In the plane of x and the axis.
    trajectory : Curve
        In the plane through the centre across the axis.
    center, axis, x : array_like of shape (3,)
        A point of the axis, its direction, and the profile's plane (None: the coordinate axis farthest from the axis).
    scale : float
        Of profile times trajectory.

    Returns
    -------
    Surface
        u is the trajectory's parameter, v the profile's.
    """
    moved, along = _curve("profile", profile), _curve("trajectory", trajectory)
    return Surface._of(_core.swing(moved, along, *_frame(center, axis, x), number("scale", scale)))


def gordon(along_u: Sequence[Curve], along_v: Sequence[Curve], *, tolerance: Optional[float] = None) -> Surface:
    """The surface through a network of curves.

    Parameters
    ----------
    along_u, along_v : sequence of Curve
        In space, in any order and direction; every one of the first meets every one of the second once.
    tolerance : float, optional
        How far apart they may be there, and the surface from curves that had to be traced anew (None: 1e-5 of the size).

    Returns
    -------
    Surface
        Over [0, 1]².
    """
    u, v = _curves("along_u", along_u), _curves("along_v", along_v)
    if not u or not v:
        raise ValueError("along_u, along_v: curves in both directions are needed")
    return Surface._of(_core.gordon(u, v, _tolerance(tolerance, *along_u, *along_v)))


def coons(sides: Sequence[Curve], *, bicubic: bool = False, tolerance: Optional[float] = None) -> Surface:
    """The surface between three or four curves that go round.

    Parameters
    ----------
    sides : sequence of Curve
        In space, in any order and direction; of three the third corner becomes a pole.
    bicubic : bool
        Blended by cubics, with the sides' tangents at the corners, not by straight lines.
    tolerance : float, optional
        How far apart ends may be at a corner, and the surface from sides that had to be replaced for their weights
        (None: 1e-5 of the size).

    Returns
    -------
    Surface
        Over [0, 1]²; v = 0 is the first side.
    """
    bodies = _curves("sides", sides)
    if not bodies:
        raise ValueError("sides: there are none")
    return Surface._of(_core.coons(bodies, bool(bicubic), _tolerance(tolerance, *sides)))


def patch(
    corners: ArrayLike,
    *,
    tangents_u: Optional[ArrayLike] = None,
    tangents_v: Optional[ArrayLike] = None,
    twists: Optional[ArrayLike] = None,
) -> Surface:
    """The bicubic patch of positions, tangents and twists at its corners (u, v) = (0,0), (1,0), (0,1), (1,1).

    Parameters
    ----------
    corners : array_like of shape (4, 3)
        Positions.
    tangents_u, tangents_v : array_like of shape (4, 3), optional
        ∂S/∂u and ∂S/∂v (None: from corner to corner).
    twists : array_like of shape (4, 3), optional
        ∂²S/∂u∂v (None: zero).

    Returns
    -------
    Surface
        Of degree 3, 3.
    """

    def four(name: str, value: Any) -> Floats:
        rows = np.asarray(value, dtype=float)
        if rows.shape != (4, 3) or not np.isfinite(rows).all():
            raise ValueError(f"{name}: four finite points or vectors x, y, z are needed")
        return np.ascontiguousarray(rows)

    p = four("corners", corners)
    along_u = p[[1, 1, 3, 3]] - p[[0, 0, 2, 2]] if tangents_u is None else four("tangents_u", tangents_u)
    along_v = p[[2, 3, 2, 3]] - p[[0, 1, 0, 1]] if tangents_v is None else four("tangents_v", tangents_v)
    return Surface._of(_core.patch(p, along_u, along_v, np.zeros((4, 3)) if twists is None else four("twists", twists)))


def conic(
    points: Optional[ArrayLike] = None,
    *,
    ends: Optional[ArrayLike] = None,
    tangents: Optional[ArrayLike] = None,
    point: Optional[ArrayLike] = None,
    rho: Optional[float] = None,
) -> Curve:
    """An arc of an ellipse, parabola or hyperbola: through five points in order, or between two ends.

    Parameters
    ----------
    points : array_like of shape (5, 3)
        On the arc, in order; nothing else is given then.
    ends, tangents : array_like of shape (2, 3)
        Where it begins and ends, and in which directions.
    point : array_like of shape (3,)
        That it passes through; or
    rho : float
        In (0, 1): below 0.5 an ellipse, 0.5 a parabola, above a hyperbola.

    Returns
    -------
    Curve
        Rational, of degree 2.
    """
    if (points is None) == (ends is None):
        raise ValueError("conic: either points or ends is needed")
    if points is not None:
        if not (tangents is None and point is None and rho is None):
            raise ValueError("points: tangents, point and rho go with ends")
        return Curve._of(_core.conic_of_points([_three("points", row) for row in _rows("points", points, 5)]))
    if tangents is None or (point is None) == (rho is None):
        raise ValueError("ends: tangents and one of point and rho are needed")
    (p, q), (t, s) = _rows("ends", ends, 2), _rows("tangents", tangents, 2)
    given = (_three("ends", p), _three("tangents", t), _three("ends", q), _three("tangents", s))
    if point is not None:
        return Curve._of(_core.conic_through(*given, _three("point", point)))
    return Curve._of(_core.conic_of_rho(*given, number("rho", rho)))


def _rows(name: str, value: Any, count: int) -> List[Any]:
    rows = list(value)
    if len(rows) != count:
        raise ValueError(f"{name}: {count} points are needed, not {len(rows)}")
    return rows


_EDGES = ("u0", "u1", "v0", "v1")


def _edge(name: str, value: Optional[str], words: Tuple[str, ...]) -> Optional[str]:
    if value is not None and value not in words:
        raise ValueError(f"{name}: {value!r} is not among {', '.join(words)}")
    return value


def blend(
    first: Union[Curve, Surface],
    second: Union[Curve, Surface],
    *,
    continuity: int = 2,
    fullness: Union[float, Tuple[float, float]] = 1.0,
    from_edge: Optional[str] = None,
    to_edge: Optional[str] = None,
) -> Union[Curve, Surface]:
    """The curve between two curves, or the surface between two surfaces, that meets both smoothly.

    Parameters
    ----------
    first, second : Curve or Surface
        Two of one kind.
    continuity : int
        0, 1 or 2: positions, tangents, curvatures.
    fullness : float, or one for each end
        How far the directions of the shapes are followed, in widths of the gap.
    from_edge, to_edge : str
        "u0", "u1", "v0" or "v1" of surfaces, "start" or "end" of curves (both or neither); None: the nearest.

    Returns
    -------
    Curve or Surface
        Of degree 2 continuity + 1 across.
    """
    words = _EDGES if isinstance(first, Surface) else ("start", "end")
    start, end = _edge("from_edge", from_edge, words), _edge("to_edge", to_edge, words)
    if not isinstance(first, Surface) and (start is None) != (end is None):
        raise ValueError("from_edge, to_edge: of curves both or neither")
    full = (fullness, fullness) if isinstance(fullness, (int, float)) else _two("fullness", fullness)
    if continuity not in (0, 1, 2):
        raise ValueError(f"continuity: {continuity!r} is not 0, 1 or 2")
    bodies = _body_of("first", first), _body_of("second", second)
    made = _core.blend(*bodies, continuity, (float(full[0]), float(full[1])), start, end)
    return Surface._of(made) if isinstance(first, Surface) else Curve._of(made)


def fill(
    sides: Sequence[Union[Curve, Tuple[Surface, str]]],
    *,
    tolerance: Optional[float] = None,
    angle_tolerance: float = 1e-4,
) -> Tuple[List[Surface], Dict[str, Any]]:
    """The surfaces that fill a hole of three to six sides, tangent to the surfaces whose edges are given.

    Parameters
    ----------
    sides : sequence of Curve or (Surface, edge)
        In any order; edges are "u0", "u1", "v0", "v1".
    tolerance : float
        The widest gap; None: 1e-6 of the size.
    angle_tolerance : float
        Between tangent planes, in radians.

    Returns
    -------
    list of Surface, dict
        One at every corner; and what was reached: position_gap, inner_angle, outer_angle, tolerance, reached.
    """
    given: List[Tuple[Any, Optional[str]]] = []
    for side in sides:
        if isinstance(side, tuple):
            surface, word = side
            given.append((_body_of("sides", surface), _edge("sides", word, _EDGES)))
        else:
            given.append((_body_of("sides", side), None))
    angle = number("angle_tolerance", angle_tolerance)
    patches, quality = _core.fill(given, None if tolerance is None else number("tolerance", tolerance), angle)
    return [Surface._of(one) for one in patches], quality


def chain(curves: Sequence[Curve], *, tolerance: float = 0.0) -> Curve:
    """Curves that meet end to end, in any order and sense, as one that traces each exactly.

    Parameters
    ----------
    curves : sequence of Curve
        Lines, arcs, free curves; of one dimension.
    tolerance : float
        Ends up to this far apart are moved together.

    Returns
    -------
    Curve
        Of degree 3, or the highest there is.
    """
    return Curve._of(_core.chain([_body_of("curves", one) for one in curves], number("tolerance", tolerance)))
