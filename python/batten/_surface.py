# SPDX-License-Identifier: MIT
"""NURBS surfaces, trimmed or not."""
from __future__ import annotations

from typing import Any, Dict, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._arrays import (
    Floats,
    Path,
    broadcast,
    doubles,
    finite,
    in_space,
    number,
    one_of,
    plain,
    plane_numbers,
    range_of,
    whole,
    wholes,
)
from ._curve import Curve, scalar_spline
from ._geometry import Geometry, Knot, Removal, _body_of, direction_of


class Curvature(NamedTuple):
    """Curvature of a surface, one over the data's units (Gaussian: squared); NaN where it has no limit.

    Attributes
    ----------
    gaussian, mean : ndarray
        With the normal S_u × S_v.
    low, high : ndarray
        Principal curvatures, low ≤ high.
    """

    gaussian: Floats
    mean: Floats
    low: Floats
    high: Floats


def _region(u: Any, v: Any) -> Tuple[Optional[Tuple[float, float]], Optional[Tuple[float, float]]]:
    if u is None and v is None:
        raise ValueError("u, v: one of them at least is needed")
    return None if u is None else range_of("u", u), None if v is None else range_of("v", v)


class Mesh(NamedTuple):
    """Triangles: ``trimesh.Trimesh(mesh.vertices, mesh.faces)`` takes them.

    Attributes
    ----------
    vertices : ndarray of shape (V, 3)
        On the surface, in the data's units.
    faces : ndarray of int32, shape (F, 3)
        Indices of vertices, counter-clockwise seen against the normals.
    parameters : ndarray of shape (V, 2)
        u and v of the vertices.
    normals : ndarray of shape (V, 3)
        Unit normals of the surface.
    """

    vertices: Floats
    faces: NDArray[np.int32]
    parameters: Floats
    normals: Floats


class Surface(Geometry):
    """A tensor-product NURBS surface in space, whole or trimmed.

    Parameters
    ----------
    degree : int or (int, int)
        In u and v, 1 … 25.
    knots_u, knots_v : array_like of shape (n + degree_u + 1,), (m + degree_v + 1,)
        Not decreasing.
    control_points : array_like of shape (n, m, 3)
        Euclidean, in the data's units; the first index goes with u.
    weights : array_like of shape (n, m), optional
        Positive; ones when absent.
    periodic : (bool, bool)
        Directions whose knots and control points repeat.
    trims : sequence of Curve
        Closed plane curves in the domain: outer loops counter-clockwise, holes clockwise.

    Raises
    ------
    ValueError
        Naming what breaks its rule.
    """

    __slots__ = ()

    def __init__(
        self,
        degree: "int | Tuple[int, int]",
        knots_u: ArrayLike,
        knots_v: ArrayLike,
        control_points: ArrayLike,
        weights: Optional[ArrayLike] = None,
        *,
        periodic: Tuple[bool, bool] = (False, False),
        trims: Sequence[Curve] = (),
    ) -> None:
        u, v = pair("degree", degree)
        points = doubles("control_points", control_points, None, None, 3)
        body = _core.make_surface(
            (u, v),
            doubles("knots_u", knots_u, None),
            doubles("knots_v", knots_v, None),
            points,
            None if weights is None else doubles("weights", weights, *points.shape[:2]),
            (bool(periodic[0]), bool(periodic[1])),
            [_body_of("trims", trim) for trim in trims],
        )
        object.__setattr__(self, "_body", body)

    def __reduce__(self) -> Tuple[Any, ...]:
        return _remade, (
            self.degree,
            np.array(self.knots_u),
            np.array(self.knots_v),
            np.array(self.control_points),
            np.array(self.weights) if self.rational else None,
            self.periodic,
            tuple(self.trims),
        )

    def __repr__(self) -> str:
        n, m = self.control_points.shape[:2]
        words = ["rational"] if self.rational else []
        words += [f"closed in {d}" for d, closed in zip("uv", self.periodic) if closed]
        trims = len(self.trims)
        words += [f"{trims} trim loop" + "s" * (trims > 1)] if trims else []
        return f"<Surface: degree {self.degree[0]} x {self.degree[1]}, {n} x {m} control points" + "".join(
            ", " + word for word in words
        ) + ">"

    @property
    def degree(self) -> Tuple[int, int]:
        """Degrees in u and v."""
        return self._body.degree("u"), self._body.degree("v")

    @property
    def knots_u(self) -> Floats:
        """The knot vector in u, shape (n + degree_u + 1,). Read-only; the memory is the surface's own."""
        return self._body.knots("u")

    @property
    def knots_v(self) -> Floats:
        """The knot vector in v, shape (m + degree_v + 1,). Read-only; the memory is the surface's own."""
        return self._body.knots("v")

    @property
    def domain(self) -> Tuple[Tuple[float, float], Tuple[float, float]]:
        """Where u and v run."""
        return self._body.domain("u"), self._body.domain("v")

    @property
    def periodic(self) -> Tuple[bool, bool]:
        """Which directions close without a seam."""
        return self._body.periodic("u"), self._body.periodic("v")

    @property
    def closed(self) -> Tuple[bool, bool]:
        """Which directions close, to 1e-9 of the size, periodic or with a seam."""
        return bool(_core.closed(self._body, "u", 1e-9)), bool(_core.closed(self._body, "v", 1e-9))

    @property
    def greville(self) -> Tuple[Floats, Floats]:
        """Greville abscissae in u and v, shapes (n,) and (m,)."""
        return self._body.greville("u"), self._body.greville("v")

    @property
    def trims(self) -> List[Curve]:
        """The loops in the domain that bound the part that counts; none: all of it."""
        return [Curve._of(body) for body in self._body.trims()]

    @property
    def trimmed(self) -> bool:
        """Whether there are trim loops."""
        return len(self._body.trims()) > 0

    @property
    def area(self) -> float:
        """Of the surface, or its part inside the trims, in squares of the data's units."""
        return _core.area(self._body, None)

    @property
    def collapsed_edges(self) -> Dict[str, bool]:
        """Which edges of the domain are one point each: 'u lower', 'u upper', 'v lower', 'v upper'."""
        return dict(zip(("u lower", "u upper", "v lower", "v upper"), _core.collapsed_edges(self._body)))

    def __call__(self, u: ArrayLike, v: ArrayLike, *, threads: int = 0) -> Floats:
        """Points at parameters, whatever the trims.

        Parameters
        ----------
        u, v : array_like
            Of shapes that broadcast; outside the domain they are taken at its nearest edge, or whole periods away.
        threads : int
            0: all cores.

        Returns
        -------
        ndarray of the common shape + (3,)
            In the data's units.
        """
        a, b, shape = broadcast(u, v)
        return _core.points(self._body, a, b, whole("threads", threads, 0)).reshape(shape + (3,))

    def derivatives(self, u: ArrayLike, v: ArrayLike, order: int = 1, *, threads: int = 0) -> Floats:
        """Points and partial derivatives, right-continuous at knots, left at the upper ends.

        Parameters
        ----------
        u, v : array_like
            Of shapes that broadcast.
        order : int
            The highest total order.
        threads : int
            0: all cores.

        Returns
        -------
        ndarray of shape (order + 1, order + 1) + common shape + (3,)
            ``[k, l]`` is ∂^(k+l)S/∂u^k∂v^l; NaN where k + l is above the order.
        """
        a, b, shape = broadcast(u, v)
        order = whole("order", order, 0)
        values = _core.derivatives(self._body, a, b, order, whole("threads", threads, 0))
        return values.reshape((order + 1, order + 1) + shape + (3,))

    def normal(self, u: ArrayLike, v: ArrayLike, *, threads: int = 0) -> Floats:
        """Unit normals S_u × S_v / |…|, at poles their limits.

        Parameters
        ----------
        u, v : array_like
            Of shapes that broadcast.
        threads : int
            0: all cores.

        Returns
        -------
        ndarray of the common shape + (3,)
            NaN where there is none.
        """
        a, b, shape = broadcast(u, v)
        return _core.normals(self._body, a, b, whole("threads", threads, 0)).reshape(shape + (3,))

    def curvature(self, u: ArrayLike, v: ArrayLike, *, threads: int = 0) -> Curvature:
        """Gaussian, mean and principal curvatures.

        Parameters
        ----------
        u, v : array_like
            Of shapes that broadcast.
        threads : int
            0: all cores.

        Returns
        -------
        Curvature
            Four arrays of the common shape.
        """
        a, b, shape = broadcast(u, v)
        values = _core.curvatures(self._body, a, b, whole("threads", threads, 0))
        return Curvature(*(values[:, k].reshape(shape) for k in range(4)))

    def contains(self, u: ArrayLike, v: ArrayLike, *, threads: int = 0) -> NDArray[np.bool_]:
        """Which parameters lie inside the trims.

        Parameters
        ----------
        u, v : array_like
            Of shapes that broadcast.
        threads : int
            0: all cores.

        Returns
        -------
        ndarray of bool of the common shape
            True everywhere where there are no trims.
        """
        a, b, shape = broadcast(u, v)
        return _core.contains(self._body, a, b, whole("threads", threads, 0)).reshape(shape)

    def area_between(self, u: Tuple[float, float], v: Tuple[float, float]) -> float:
        """Area over a rectangle of parameters.

        Parameters
        ----------
        u, v : (float, float)
            Its sides.

        Returns
        -------
        float
            In squares of the data's units.
        """
        (a, b), (c, d) = finite("u", u, 2).tolist(), finite("v", v, 2).tolist()
        return _core.area(self._body, (a, b, c, d))

    def insert_knot(self, direction: str, at: float, times: int = 1) -> "Surface":
        """The same surface with a knot more.

        Parameters
        ----------
        direction : {'u', 'v'}
            Which knots.
        at : float
            In the domain.
        times : int
            How often.

        Returns
        -------
        Surface
            With `times` rows more.
        """
        d = direction_of(direction)
        return Surface._of(_core.insert_knot(self._body, d, number("at", at), whole("times", times)))

    def refine(self, direction: str, knots: ArrayLike) -> "Surface":
        """The same surface with many knots more.

        Parameters
        ----------
        direction : {'u', 'v'}
            Which knots.
        knots : array_like of shape (k,)
            A value as often as it is to be inserted.

        Returns
        -------
        Surface
            With k rows more.
        """
        return Surface._of(_core.refine(self._body, direction_of(direction), finite("knots", knots, None).tolist()))

    def remove_knot(self, direction: str, at: float, times: int = 1, *, tolerance: float = 0) -> Removal:
        """An inner knot taken away as often as the tolerance allows.

        Parameters
        ----------
        direction : {'u', 'v'}
            Which knots.
        at : float
            Exactly a knot.
        times : int
            How often at most.
        tolerance : float
            In the data's units.

        Returns
        -------
        Removal
            Surface, how often, and the bound of the deviation.
        """
        body, removed, error = _core.remove_knot(
            self._body, direction_of(direction), number("at", at), whole("times", times), number("tolerance", tolerance)
        )
        return Removal(Surface._of(body), removed, error)

    def elevate(self, direction: str, by: int = 1) -> "Surface":
        """The same surface with a higher degree.

        Parameters
        ----------
        direction : {'u', 'v'}
            Which degree.
        by : int
            Degrees more.

        Returns
        -------
        Surface
            The same at every parameter.
        """
        return Surface._of(_core.elevate(self._body, direction_of(direction), whole("by", by)))

    def reduce(self, direction: str, by: int = 1, *, tolerance: float = 0) -> Removal:
        """A degree lowered as far as the tolerance allows.

        Parameters
        ----------
        direction : {'u', 'v'}
            Which degree.
        by : int
            Degrees at most.
        tolerance : float
            In the data's units.

        Returns
        -------
        Removal
            Surface, degrees taken away, and the bound of the deviation.
        """
        d = direction_of(direction)
        body, reduced, error = _core.reduce(self._body, d, whole("by", by), number("tolerance", tolerance))
        return Removal(Surface._of(body), reduced, error)

    def split(self, direction: str, at: float) -> Tuple["Surface", "Surface"]:
        """The pieces below and above a parameter.

        Parameters
        ----------
        direction : {'u', 'v'}
            Whose parameter.
        at : float
            Inside the domain.

        Returns
        -------
        tuple of two Surface
            Over their parts of the domain.
        """
        first, second = _core.split(self._body, direction_of(direction), number("at", at))
        return Surface._of(first), Surface._of(second)

    def segment(self, direction: str, a: float, b: float) -> "Surface":
        """The piece over [a, b] in a direction.

        Parameters
        ----------
        direction : {'u', 'v'}
            Whose parameter.
        a, b : float
            In the domain, a < b; where periodic b may pass the end.

        Returns
        -------
        Surface
            With that domain.
        """
        return Surface._of(_core.segment(self._body, direction_of(direction), number("a", a), number("b", b)))

    def segment_parts(self, direction: str, a: float, b: float) -> List["Surface"]:
        """The piece over [a, b] once for every connected part of it inside the trims.

        Parameters
        ----------
        direction : {'u', 'v'}
            Whose parameter.
        a, b : float
            In the domain, a < b.

        Returns
        -------
        list of Surface
            They have the piece in common and other trims.
        """
        d = direction_of(direction)
        return [Surface._of(body) for body in _core.segment_parts(self._body, d, number("a", a), number("b", b))]

    def decompose(self, direction: Optional[str] = None) -> List["Surface"]:
        """The Bézier pieces.

        Parameters
        ----------
        direction : {'u', 'v'}, optional
            Cut in one direction only.

        Returns
        -------
        list of Surface
            Span by span in v for each span in u.
        """
        d = "" if direction is None else direction_of(direction)
        return [Surface._of(body) for body in _core.decompose(self._body, d)]

    def reverse(self, direction: str) -> "Surface":
        """Run through the other way in a direction; normals turn round.

        Parameters
        ----------
        direction : {'u', 'v'}
            Which.

        Returns
        -------
        Surface
            On the same domain.
        """
        return Surface._of(_core.reverse(self._body, direction_of(direction)))

    def swap(self) -> "Surface":
        """u and v exchanged; normals turn round.

        Returns
        -------
        Surface
            At (v, u) what this is at (u, v).
        """
        return Surface._of(_core.swap(self._body))

    def clamp(self, direction: Optional[str] = None) -> "Surface":
        """Beginning and ending at control points; what is periodic becomes closed.

        Parameters
        ----------
        direction : {'u', 'v'}, optional
            Both when absent.

        Returns
        -------
        Surface
            The same at every parameter.
        """
        return self._in_each(_core.clamp, direction)

    def unclamp(self, direction: Optional[str] = None) -> "Surface":
        """With end knots outside the domain.

        Parameters
        ----------
        direction : {'u', 'v'}, optional
            Both when absent.

        Returns
        -------
        Surface
            The same at every parameter.
        """
        return self._in_each(_core.unclamp, direction)

    def _in_each(self, change: Any, direction: Optional[str]) -> "Surface":
        body = self._body
        for d in ("u", "v") if direction is None else (direction_of(direction),):
            body = change(body, d)
        return Surface._of(body)

    def make_periodic(self, direction: str, tolerance: float) -> "Surface":
        """The periodic form of a surface that closes.

        Parameters
        ----------
        direction : {'u', 'v'}
            In which it closes.
        tolerance : float
            Within which the edges meet, in the data's units.

        Returns
        -------
        Surface
            Periodic in that direction.
        """
        d = direction_of(direction)
        return Surface._of(_core.make_periodic(self._body, d, number("tolerance", tolerance)))

    def reparameterize(self, direction: str, a: float, b: float) -> "Surface":
        """The same surface over the domain [a, b] in a direction; trims are scaled with it.

        Parameters
        ----------
        direction : {'u', 'v'}
            Which.
        a, b : float
            a < b.

        Returns
        -------
        Surface
            With the same control points.
        """
        return Surface._of(_core.reparameterize(self._body, direction_of(direction), number("a", a), number("b", b)))

    def moebius(self, direction: str, alpha: float, beta: float, gamma: float, delta: float) -> "Surface":
        """The same surface traced by s, u = (alpha s + beta) / (gamma s + delta).

        Parameters
        ----------
        direction : {'u', 'v'}
            Whose parameter.
        alpha, beta, gamma, delta : float
            With alpha delta − beta gamma > 0.

        Returns
        -------
        Surface
            With other weights and knots.
        """
        d, a, b = direction_of(direction), number("alpha", alpha), number("beta", beta)
        return Surface._of(_core.moebius(self._body, d, a, b, number("gamma", gamma), number("delta", delta)))

    def compose(self, direction: str, f: Any) -> "Surface":
        """The same surface traced by s in a direction, u = f(s).

        Parameters
        ----------
        direction : {'u', 'v'}
            Whose parameter.
        f : scipy.interpolate.BSpline of scalars, or (degree, knots, coefficients)
            Increasing from one end of the domain to the other.

        Returns
        -------
        Surface
            Of a degree that is multiplied by that of f.
        """
        degree, knots, values = scalar_spline(f)
        return Surface._of(_core.compose(self._body, direction_of(direction), degree, knots, values))

    def iso(self, direction: str, at: float) -> Curve:
        """The curve along which a parameter is fixed.

        Parameters
        ----------
        direction : {'u', 'v'}
            The parameter that is fixed.
        at : float
            Its value.

        Returns
        -------
        Curve
            In space, over the domain of the other parameter.
        """
        return Curve._of(_core.iso(self._body, direction_of(direction), number("at", at)))

    def boundary(self) -> List[Curve]:
        """The edges of the domain as curves in space.

        Returns
        -------
        list of four Curve
            u at its lower end, u at its upper, v at its lower, v at its upper.
        """
        return [Curve._of(body) for body in _core.boundary(self._body)]

    def set_weight(self, i: int, j: int, weight: float) -> "Surface":
        """One weight replaced.

        Parameters
        ----------
        i, j : int
            Of the control point, from 0.
        weight : float
            Positive.

        Returns
        -------
        Surface
            Drawn to that control point, or pushed from it.
        """
        return Surface._of(_core.set_weight(self._body, whole("i", i), whole("j", j), number("weight", weight)))

    def move_point(self, u: float, v: float, to: ArrayLike) -> "Surface":
        """The surface that passes through a point, with the least change.

        Parameters
        ----------
        u, v : float
            Where it is to pass.
        to : array_like of shape (3,)
            The point.

        Returns
        -------
        Surface
            With the same knots and weights.
        """
        return Surface._of(_core.move_point(self._body, number("u", u), number("v", v), finite("to", to, 3)))

    def move_points(
        self,
        uv: ArrayLike,
        to: ArrayLike,
        *,
        order: ArrayLike = (0, 0),
        keep: Optional[ArrayLike] = None,
        fixed: Optional[ArrayLike] = None,
    ) -> "Surface":
        """The surface that has several points or derivatives at once, with the least change.

        Parameters
        ----------
        uv : array_like of shape (k, 2)
            Where.
        to : array_like of shape (k, 3)
            The points, or derivatives.
        order : array_like of int, shape (2,) or (k, 2)
            Orders in u and v of the derivatives, 0, 0 for points.
        keep : array_like of shape (m, 2), optional
            Parameters at which points stay.
        fixed : array_like of int, shape (n, 2), optional
            Control points that stay, from 0.

        Returns
        -------
        Surface
            With the same knots, weights and trims.
        """
        none = np.zeros((0, 2))
        at, kept = finite("uv", uv, None, 2), finite("keep", none if keep is None else keep, None, 2)
        values = finite("to", to, len(at), 3)
        orders = wholes("order", np.broadcast_to(np.asarray(order), at.shape)) + [0] * kept.size
        targets = np.concatenate([values, self(kept[:, 0], kept[:, 1])])
        held = [] if fixed is None else wholes("fixed", plain("fixed", fixed).reshape(-1, 2))
        return Surface._of(_core.move_points(self._body, np.concatenate([at, kept]), targets, orders, held))

    def pull(self, u: float, v: float, i: int, j: int, by: float) -> "Surface":
        """A point pulled towards a control point by its weight.

        Parameters
        ----------
        u, v : float
            Of the point.
        i, j : int
            Of the control point, from 0.
        by : float
            How far, in the data's units; negative: pushed away.

        Returns
        -------
        Surface
            With the same control points and knots.
        """
        own = [whole("i", i), whole("j", j)]
        return Surface._of(_core.pull(self._body, number("u", u), number("v", v), own, number("by", by)))

    def warp(
        self,
        by: ArrayLike,
        *,
        u: Optional[Tuple[float, float]] = None,
        v: Optional[Tuple[float, float]] = None,
        shape: str = "bump",
        spans: int = 16,
    ) -> "Surface":
        """Moved along a vector within a region, all of it in the middle.

        Parameters
        ----------
        by : array_like of shape (3,)
            The move of the middle.
        u, v : two floats, optional
            The region, from, to; one of them may be left out.
        shape : {'bump', 'tent', 'plateau'}
            How it falls off.
        spans : int
            Knots are inserted for at least so many.

        Returns
        -------
        Surface
            The same outside the region.
        """
        move = finite("by", by, 3)
        word = one_of("shape", shape, ("bump", "tent", "plateau"))
        return Surface._of(_core.warp(self._body, _region(u, v), move, word, whole("spans", spans)))

    def flatten(
        self,
        normal: ArrayLike,
        offset: float,
        *,
        u: Optional[Tuple[float, float]] = None,
        v: Optional[Tuple[float, float]] = None,
        along: Optional[ArrayLike] = None,
        transition: float = 0.1,
    ) -> "Surface":
        """Flattened to a plane within a region.

        Parameters
        ----------
        normal : array_like of shape (3,)
            Of the plane normal·x = offset.
        offset : float
            Of that plane.
        u, v : two floats, optional
            The region, from, to; one of them may be left out.
        along : array_like of shape (3,), optional
            The direction in which points go to it; None: the normal.
        transition : float
            How far beyond the region, in shares of it, the surface may change.

        Returns
        -------
        Surface
            In the plane over the region, the same beyond the transition.
        """
        way = None if along is None else finite("along", along, 3)
        plane, distance = finite("normal", normal, 3), number("offset", offset)
        body = _core.flatten(
            self._body, _region(u, v), plane, distance, way, number("transition", transition)
        )
        return Surface._of(body)

    def bend(
        self,
        start: ArrayLike,
        center: ArrayLike,
        length: float,
        *,
        axis: ArrayLike = (0, 0, 1),
        tolerance: float,
    ) -> Tuple["Surface", float]:
        """Bent about a circle: the line from `start` on is wound onto it, what is behind turns along.

        Parameters
        ----------
        start, center : array_like of shape (3,)
            Of the circle, which runs right-handed about the axis.
        length : float
            Of the line that is wound, in the data's units.
        axis : array_like of shape (3,)
            Of the circle.
        tolerance : float
            How far points may be from their images, in the data's units.

        Returns
        -------
        tuple of Surface and float
            The surface, and how far the farthest sample is from its image.
        """
        first, middle = (in_space(name, value, 3) for name, value in (("start", start), ("center", center)))
        body, error = _core.bend(
            self._body, first, middle, finite("axis", axis, 3), number("length", length), number("tolerance", tolerance)
        )
        return Surface._of(body), error

    def extend(self, direction: str, length: float, *, upper: bool = True, natural: bool = False) -> "Surface":
        """Continued past an edge.

        Parameters
        ----------
        direction : {'u', 'v'}
            The parameter that goes on.
        length : float
            Mean arc length added, in the data's units.
        upper : bool
            Past the end of the domain, else before its start.
        natural : bool
            The last span's polynomial goes on; else a parabola.

        Returns
        -------
        Surface
            The old one on the old domain.
        """
        d = direction_of(direction)
        return Surface._of(_core.extend(self._body, d, bool(upper), number("length", length), bool(natural)))

    def join(self, other: "Surface", direction: str, *, tolerance: float) -> "Surface":
        """This surface and another across its upper edge and the other's lower one.

        Parameters
        ----------
        other : Surface
            Untrimmed, as this one.
        direction : {'u', 'v'}
            In which they follow one another.
        tolerance : float
            The widest gap, in the data's units.

        Returns
        -------
        Surface
            Both as one.
        """
        d = direction_of(direction)
        return Surface._of(_core.join(self._body, _body_of("other", other), d, number("tolerance", tolerance)))

    def with_trims(self, trims: Sequence[Curve]) -> "Surface":
        """With these loops in place of its own; none: untrimmed.

        Parameters
        ----------
        trims : sequence of Curve
            Closed plane curves in the domain: outer loops counter-clockwise, holes clockwise.

        Returns
        -------
        Surface
            Over the same domain.

        Raises
        ------
        ValueError
            Where a loop is open, crosses another, or is turned the wrong way.
        """
        body = self._body.with_trims([_body_of("trims", trim) for trim in trims])
        _core.check_trims(body)
        return Surface._of(body)

    def section(self, plane: ArrayLike, *, tolerance: Optional[float] = None) -> List[Curve]:
        """The curves in which a plane meets it, inside the trims, joined over seams and poles.

        Parameters
        ----------
        plane : array_like of shape (4,)
            a, b, c, d of a x + b y + c z + d = 0.
        tolerance : float, optional
            How far the curves may be from the true section, in the data's units; 1e-4 of the size.

        Returns
        -------
        list of Curve
            In space; none where the plane misses or only touches it.
        """
        within = None if tolerance is None else number("tolerance", tolerance)
        return [Curve._of(body) for body in _core.section(self._body, plane_numbers("plane", plane), within)]

    def cut(self, plane: ArrayLike, *, tolerance: Optional[float] = None) -> Tuple[List["Surface"], List["Surface"]]:
        """The parts on both sides of a plane.

        Parameters
        ----------
        plane : array_like of shape (4,)
            a, b, c, d of a x + b y + c z + d = 0.
        tolerance : float, optional
            Of the section, in the data's units; 1e-9 of the size.

        Returns
        -------
        above, below : list of Surface
            Above is where a x + b y + c z + d is positive.
        """
        within = None if tolerance is None else number("tolerance", tolerance)
        above, below = _core.cut(self._body, plane_numbers("plane", plane), within)
        return [Surface._of(body) for body in above], [Surface._of(body) for body in below]

    def trim(self, curve: Curve, *, keep: str = "inside", tolerance: Optional[float] = None) -> List["Surface"]:
        """Cut along a curve.

        Parameters
        ----------
        curve : Curve
            In the domain (two dimensions), or in space, projected; closed, or going right through.
        keep : {'inside', 'outside', 'both'}
            Inside is left of a curve that goes through.
        tolerance : float, optional
            Of the projection, in the data's units; 1e-8 of the size.

        Returns
        -------
        list of Surface
            The parts kept.
        """
        one_of("keep", keep, ("inside", "outside", "both"))
        within = None if tolerance is None else number("tolerance", tolerance)
        inside, outside = _core.trim(self._body, _body_of("curve", curve), within)
        kept = (inside if keep != "outside" else []) + (outside if keep != "inside" else [])
        return [Surface._of(body) for body in kept]

    def project(self, curve: Curve, *, tolerance: float) -> List[Curve]:
        """A curve in space brought onto the surface, as curves in the domain.

        Parameters
        ----------
        curve : Curve
            In space.
        tolerance : float
            In the data's units.

        Returns
        -------
        list of Curve
            Plane ones, over the curve's own parameter.
        """
        bodies = _core.project_curve(self._body, _body_of("curve", curve), number("tolerance", tolerance))
        return [Curve._of(body) for body in bodies]

    def tessellate(self, tolerance: Optional[float] = None, *, max_triangles: int = 50_000_000) -> Mesh:
        """Triangles within a proved chord tolerance, of the part inside the trims.

        Parameters
        ----------
        tolerance : float, optional
            In the data's units; 1e-3 of the size.
        max_triangles : int
            What needs more is refused.

        Returns
        -------
        Mesh
            vertices (V, 3), faces (F, 3), parameters (V, 2), normals (V, 3).
        """
        chord = 0.0 if tolerance is None else number("tolerance", tolerance)
        if tolerance is not None and not chord > 0:
            raise ValueError(f"tolerance: {tolerance!r} is not positive")
        return Mesh(*_core.mesh(self._body, chord, whole("max_triangles", max_triangles, 1)))

    def to_mesh(self, path: Path, *, tolerance: Optional[float] = None, format: str = "", unit: str = "mm") -> None:
        """Writes triangles as STL, OBJ, PLY or GLB.

        Parameters
        ----------
        path : path-like
            The extension says the format.
        tolerance : float, optional
            Of the chords, in the data's units; 1e-3 of the size.
        format : str
            'stl', 'obj', 'ply' or 'glb', where the extension does not tell.
        unit : str
            Of the coordinates: GLB is in metres.
        """
        from ._files import write_mesh

        write_mesh(self.tessellate(tolerance), path, format=format, unit=unit)

    def continuity(self, direction: str, tolerance: float = 1e-9) -> List[Knot]:
        """How smooth it is across the inner knots of a direction.

        Parameters
        ----------
        direction : {'u', 'v'}
            Whose knots.
        tolerance : float
            Relative to the size.

        Returns
        -------
        list of Knot
            In increasing order.
        """
        d = direction_of(direction)
        return [Knot(*one) for one in _core.continuity(self._body, d, number("tolerance", tolerance))]

    def seam_continuity(self, direction: str, tolerance: float = 1e-9) -> Optional[int]:
        """The continuity across the seam of a direction that closes.

        Parameters
        ----------
        direction : {'u', 'v'}
            Which.
        tolerance : float
            Relative to the size.

        Returns
        -------
        int or None
            None where it does not close.
        """
        return _core.seam_continuity(self._body, direction_of(direction), number("tolerance", tolerance))

    def analyze(self) -> Dict[str, Any]:
        """What it is, in one dictionary.

        Returns
        -------
        dict
            Degree, control points, domain, closed, continuity, bounding box, area, curvature, shape.
        """
        least = [
            min((knot.actual for knot in self.continuity(d)), default=degree) for d, degree in zip("uv", self.degree)
        ]
        return {
            "kind": "surface",
            "degree": self.degree,
            "control_points": self.control_points.shape[:2],
            "domain": self.domain,
            "rational": self.rational,
            "closed": self.closed,
            "periodic": self.periodic,
            "continuity": tuple(least),
            "trims": len(self.trims),
            "bounding_box": self.bounding_box,
            "area": self.area,
            "curvature": self.curvature_range,
            "shape": self.classify(),
        }

    def to_scipy(self) -> Any:
        """The same as a ``scipy.interpolate.NdBSpline`` (scipy 1.12 and later), trims left out.

        Returns
        -------
        scipy.interpolate.NdBSpline
            With values of shape (3,).

        Raises
        ------
        ValueError
            For a rational surface.
        ImportError
            Where scipy has no NdBSpline.
        """
        from ._friends import surface_to_scipy

        return surface_to_scipy(self)

    @classmethod
    def from_scipy(cls, spline: Any) -> "Surface":
        """The surface of a ``scipy.interpolate.NdBSpline`` with values of three numbers, or the graph z(x, y) of one of
        scipy's bivariate splines (SmoothBivariateSpline, RectBivariateSpline …).

        Parameters
        ----------
        spline : NdBSpline or BivariateSpline
            Over its own domain.

        Returns
        -------
        Surface
            The same at every parameter; of a graph u is x and v is y.
        """
        from ._friends import surface_from_scipy

        return surface_from_scipy(spline)

    @classmethod
    def from_geomdl(cls, entry: Any) -> "Surface":
        """The surface of a geomdl object or of the dictionary of its JSON exchange.

        Parameters
        ----------
        entry : dict or geomdl surface
            Of one surface.

        Returns
        -------
        Surface
            The same at every parameter.
        """
        from ._friends import from_geomdl

        (one,) = from_geomdl(entry)
        if not isinstance(one, Surface):
            raise ValueError("entry: holds a curve")
        return one

    def to_trimesh(self, tolerance: Optional[float] = None) -> Any:
        """A ``trimesh.Trimesh``, where trimesh is installed.

        Parameters
        ----------
        tolerance : float, optional
            Of the chords, in the data's units; 1e-3 of the size.

        Returns
        -------
        trimesh.Trimesh
            With the surface's normals.
        """
        from ._friends import to_trimesh

        return to_trimesh(self.tessellate(tolerance))

    def to_pyvista(self, tolerance: Optional[float] = None) -> Any:
        """A ``pyvista.PolyData``, where PyVista is installed.

        Parameters
        ----------
        tolerance : float, optional
            Of the chords, in the data's units; 1e-3 of the size.

        Returns
        -------
        pyvista.PolyData
            With normals.
        """
        from ._friends import to_pyvista

        return to_pyvista(self.tessellate(tolerance))


def pair(name: str, value: Any) -> Tuple[int, int]:
    """Two whole numbers, or one for both."""
    if hasattr(value, "__index__"):
        one = whole(name, value)
        return one, one
    try:
        first, second = value
    except (TypeError, ValueError):
        raise ValueError(f"{name}: {value!r} is neither a whole number nor two") from None
    return whole(name, first), whole(name, second)


def _remade(
    degree: Tuple[int, int],
    knots_u: Floats,
    knots_v: Floats,
    points: Floats,
    weights: Optional[Floats],
    periodic: Tuple[bool, bool],
    trims: Sequence[Curve],
) -> Surface:
    return Surface(degree, knots_u, knots_v, points, weights, periodic=periodic, trims=trims)
