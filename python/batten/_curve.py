# SPDX-License-Identifier: MIT
"""NURBS curves in the plane and in space."""
from __future__ import annotations

from typing import Any, Dict, List, Optional, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike

from . import _core
from ._arrays import Floats, doubles, finite, in_space, number, one_of, range_of, whole, wholes
from ._geometry import Geometry, Knot, Removal, _body_of


class Curve(Geometry):
    """A NURBS curve, C(u) = Σ N_i(u) w_i P_i / Σ N_i(u) w_i.

    Parameters
    ----------
    degree : int
        1 … 25.
    knots : array_like of shape (n + degree + 1,)
        Not decreasing; an inner knot at most `degree` times.
    control_points : array_like of shape (n, 2) or (n, 3)
        Euclidean, in the data's units.
    weights : array_like of shape (n,), optional
        Positive; ones when absent.
    periodic : bool
        Knots repeat after n − degree of them, and the last `degree` control points are the first ones again.

    Raises
    ------
    ValueError
        Naming what breaks its rule.
    """

    __slots__ = ()

    def __init__(
        self,
        degree: int,
        knots: ArrayLike,
        control_points: ArrayLike,
        weights: Optional[ArrayLike] = None,
        *,
        periodic: bool = False,
    ) -> None:
        body = _core.make_curve(
            whole("degree", degree),
            doubles("knots", knots, None),
            doubles("control_points", control_points),
            None if weights is None else doubles("weights", weights, None),
            bool(periodic),
        )
        object.__setattr__(self, "_body", body)

    def __reduce__(self) -> Tuple[Any, ...]:
        weights = np.array(self.weights) if self.rational else None
        return _remade, (self.degree, np.array(self.knots), np.array(self.control_points), weights, self.periodic)

    def __repr__(self) -> str:
        kind = ("rational " if self.rational else "") + ("periodic " if self.periodic else "")
        where = "the plane" if self.dimension == 2 else "space"
        a, b = self.domain
        return f"<Curve: {kind}degree {self.degree}, {len(self.control_points)} control points in {where}, u in [{a:g}, {b:g}]>"

    @property
    def degree(self) -> int:
        """Degree of the polynomial pieces."""
        return self._body.degree("u")

    @property
    def knots(self) -> Floats:
        """The knot vector, shape (n + degree + 1,). Read-only; the memory is the curve's own."""
        return self._body.knots("u")

    @property
    def domain(self) -> Tuple[float, float]:
        """Where the parameter runs."""
        return self._body.domain("u")

    @property
    def periodic(self) -> bool:
        """Whether it closes without a seam."""
        return self._body.periodic("u")

    @property
    def clamped(self) -> bool:
        """Whether it begins and ends at control points."""
        return self._body.clamped("u")

    @property
    def closed(self) -> bool:
        """Whether the ends are one point, to 1e-9 of the size."""
        return bool(_core.closed(self._body, "u", 1e-9))

    @property
    def greville(self) -> Floats:
        """Greville abscissae, shape (n,): with these as control points the spline is u."""
        return self._body.greville("u")

    @property
    def length(self) -> float:
        """Arc length, in the data's units, to 1e-12 of it."""
        return _core.length(self._body, None)

    def __call__(self, u: ArrayLike, *, threads: int = 0) -> Floats:
        """Points at parameters.

        Parameters
        ----------
        u : array_like of any shape
            Outside the domain they are taken at its nearest end, or whole periods away.
        threads : int
            0: all cores.

        Returns
        -------
        ndarray of shape u.shape + (dimension,)
            In the data's units.
        """
        at = doubles("u", u)
        return _core.points(self._body, at.reshape(-1), None, whole("threads", threads, 0)).reshape(at.shape + (self.dimension,))

    def derivatives(self, u: ArrayLike, order: int = 1, *, threads: int = 0) -> Floats:
        """Points and derivatives, right-continuous at knots, left at the upper end.

        Parameters
        ----------
        u : array_like of any shape
            Parameters.
        order : int
            The highest.
        threads : int
            0: all cores.

        Returns
        -------
        ndarray of shape (order + 1,) + u.shape + (dimension,)
            ``[k]`` is the k-th derivative: the data's units by the parameter's, to the power of k.
        """
        at = doubles("u", u)
        order = whole("order", order, 0)
        values = _core.derivatives(self._body, at.reshape(-1), None, order, whole("threads", threads, 0))
        return values.reshape((order + 1,) + at.shape + (self.dimension,))

    def tangent(self, u: ArrayLike) -> Floats:
        """Unit tangents.

        Parameters
        ----------
        u : array_like of any shape
            Parameters.

        Returns
        -------
        ndarray of shape u.shape + (dimension,)
            NaN where the derivative vanishes.
        """
        first = self.derivatives(u, 1)[1]
        length = np.linalg.norm(first, axis=-1, keepdims=True)
        units: Floats = first / np.where(length > 0, length, np.nan)
        return units

    def curvature(self, u: ArrayLike, *, threads: int = 0) -> Floats:
        """Curvature and torsion.

        Parameters
        ----------
        u : array_like of any shape
            Parameters.
        threads : int
            0: all cores.

        Returns
        -------
        ndarray of shape u.shape + (2,)
            One over the data's units; the curvature is not negative; NaN where there is no limit.
        """
        at = doubles("u", u)
        values = _core.curvatures(self._body, at.reshape(-1), None, whole("threads", threads, 0))
        return values.reshape(at.shape + (2,))

    def length_between(self, a: float, b: float) -> float:
        """Arc length between two parameters.

        Parameters
        ----------
        a, b : float
            In the domain, a ≤ b.

        Returns
        -------
        float
            In the data's units.
        """
        return _core.length(self._body, (number("a", a), number("b", b)))

    def parameter_at_length(self, length: ArrayLike) -> Floats:
        """Parameters at lengths from the beginning.

        Parameters
        ----------
        length : array_like of any shape
            0 … the curve's, in the data's units.

        Returns
        -------
        ndarray of that shape
            Parameters.
        """
        at = finite("length", length)
        return _core.parameters_at_lengths(self._body, at.reshape(-1)).reshape(at.shape)

    def insert_knot(self, at: float, times: int = 1) -> "Curve":
        """The same curve with a knot more.

        Parameters
        ----------
        at : float
            In the domain.
        times : int
            How often.

        Returns
        -------
        Curve
            With `times` control points more.
        """
        return Curve._of(_core.insert_knot(self._body, "u", number("at", at), whole("times", times)))

    def refine(self, knots: ArrayLike) -> "Curve":
        """The same curve with many knots more.

        Parameters
        ----------
        knots : array_like of shape (k,)
            A value as often as it is to be inserted.

        Returns
        -------
        Curve
            With k control points more.
        """
        return Curve._of(_core.refine(self._body, "u", finite("knots", knots, None).tolist()))

    def remove_knot(self, at: float, times: int = 1, *, tolerance: float = 0) -> Removal:
        """An inner knot taken away as often as the tolerance allows.

        Parameters
        ----------
        at : float
            Exactly a knot.
        times : int
            How often at most.
        tolerance : float
            In the data's units.

        Returns
        -------
        Removal
            Curve, how often, and the bound of the deviation.
        """
        body, removed, error = _core.remove_knot(
            self._body, "u", number("at", at), whole("times", times), number("tolerance", tolerance)
        )
        return Removal(Curve._of(body), removed, error)

    def elevate(self, by: int = 1) -> "Curve":
        """The same curve with a higher degree.

        Parameters
        ----------
        by : int
            Degrees more.

        Returns
        -------
        Curve
            The same at every parameter.
        """
        return Curve._of(_core.elevate(self._body, "u", whole("by", by)))

    def reduce(self, by: int = 1, *, tolerance: float = 0) -> Removal:
        """The degree lowered as far as the tolerance allows.

        Parameters
        ----------
        by : int
            Degrees at most.
        tolerance : float
            In the data's units.

        Returns
        -------
        Removal
            Curve, degrees taken away, and the bound of the deviation.
        """
        body, reduced, error = _core.reduce(self._body, "u", whole("by", by), number("tolerance", tolerance))
        return Removal(Curve._of(body), reduced, error)

    def split(self, at: float) -> Tuple["Curve", "Curve"]:
        """The pieces below and above a parameter.

        Parameters
        ----------
        at : float
            Inside the domain.

        Returns
        -------
        tuple of two Curve
            Over their parts of the domain.
        """
        first, second = _core.split(self._body, "u", number("at", at))
        return Curve._of(first), Curve._of(second)

    def segment(self, a: float, b: float) -> "Curve":
        """The piece over [a, b].

        Parameters
        ----------
        a, b : float
            In the domain, a < b; of a periodic curve b may pass the end.

        Returns
        -------
        Curve
            With the domain [a, b].
        """
        return Curve._of(_core.segment(self._body, "u", number("a", a), number("b", b)))

    def decompose(self) -> List["Curve"]:
        """The Bézier pieces.

        Returns
        -------
        list of Curve
            One for each span.
        """
        return [Curve._of(body) for body in _core.decompose(self._body, "")]

    def reverse(self) -> "Curve":
        """Run through the other way.

        Returns
        -------
        Curve
            On the same domain.
        """
        return Curve._of(_core.reverse(self._body, "u"))

    def clamp(self) -> "Curve":
        """Beginning and ending at control points; a periodic curve becomes a closed one.

        Returns
        -------
        Curve
            The same at every parameter.
        """
        return Curve._of(_core.clamp(self._body, "u"))

    def unclamp(self) -> "Curve":
        """With end knots outside the domain.

        Returns
        -------
        Curve
            The same at every parameter.
        """
        return Curve._of(_core.unclamp(self._body, "u"))

    def make_periodic(self, tolerance: float) -> "Curve":
        """The periodic form of a closed curve.

        Parameters
        ----------
        tolerance : float
            Within which the ends meet, in the data's units.

        Returns
        -------
        Curve
            Periodic.
        """
        return Curve._of(_core.make_periodic(self._body, "u", number("tolerance", tolerance)))

    def reparameterize(self, a: float, b: float) -> "Curve":
        """The same curve over the domain [a, b].

        Parameters
        ----------
        a, b : float
            a < b.

        Returns
        -------
        Curve
            With the same control points.
        """
        return Curve._of(_core.reparameterize(self._body, "u", number("a", a), number("b", b)))

    def moebius(self, alpha: float, beta: float, gamma: float, delta: float) -> "Curve":
        """The same curve traced by s, u = (alpha s + beta) / (gamma s + delta).

        Parameters
        ----------
        alpha, beta, gamma, delta : float
            With alpha delta − beta gamma > 0.

        Returns
        -------
        Curve
            With other weights and knots.
        """
        a, b = number("alpha", alpha), number("beta", beta)
        return Curve._of(_core.moebius(self._body, "u", a, b, number("gamma", gamma), number("delta", delta)))

    def compose(self, f: "Union[Curve, Any]") -> "Curve":
        """The same curve traced by s, u = f(s).

        Parameters
        ----------
        f : scipy.interpolate.BSpline of scalars, or (degree, knots, coefficients)
            Increasing from one end of the domain to the other.

        Returns
        -------
        Curve
            Of degree `degree` times that of f.
        """
        degree, knots, values = scalar_spline(f)
        return Curve._of(_core.compose(self._body, "u", degree, knots, values))

    def set_weight(self, index: int, weight: float) -> "Curve":
        """One weight replaced.

        Parameters
        ----------
        index : int
            Of the control point, from 0.
        weight : float
            Positive.

        Returns
        -------
        Curve
            Drawn to that control point, or pushed from it.
        """
        return Curve._of(_core.set_weight(self._body, whole("index", index), 0, number("weight", weight)))

    def move_point(self, u: float, to: ArrayLike) -> "Curve":
        """The curve that passes through a point, with the least change.

        Parameters
        ----------
        u : float
            Where it is to pass.
        to : array_like of shape (dimension,)
            The point.

        Returns
        -------
        Curve
            With the same knots and weights.
        """
        return Curve._of(_core.move_point(self._body, number("u", u), 0.0, finite("to", to, self.dimension)))

    def move_points(
        self,
        u: ArrayLike,
        to: ArrayLike,
        *,
        order: ArrayLike = 0,
        keep: ArrayLike = (),
        fixed: ArrayLike = (),
    ) -> "Curve":
        """The curve that has several points or derivatives at once, with the least change.

        Parameters
        ----------
        u : array_like of shape (k,)
            Where.
        to : array_like of shape (k, dimension)
            The points, or derivatives.
        order : int or array_like of shape (k,)
            0: points, else derivatives of that order.
        keep : array_like of shape (m,)
            Parameters at which points stay.
        fixed : array_like of int, shape (n,)
            Control points that stay, from 0.

        Returns
        -------
        Curve
            With the same knots and weights.
        """
        at, kept = finite("u", u, None), finite("keep", keep, None)
        values = finite("to", to, at.size, self.dimension)
        orders = wholes("order", np.broadcast_to(np.asarray(order), at.shape)) + [0] * kept.size
        where = np.concatenate([at, kept])
        targets = np.concatenate([values, self(kept)])
        return Curve._of(_core.move_points(self._body, where, targets, orders, wholes("fixed", fixed)))

    def pull(self, u: float, index: Union[int, Tuple[int, int]], by: float) -> "Curve":
        """A point pulled towards a control point, or the leg between two neighbours, by their weights.

        Parameters
        ----------
        u : float
            Of the point.
        index : int or two neighbouring ones
            Of the control points, from 0.
        by : float
            How far, in the data's units; negative: pushed away.

        Returns
        -------
        Curve
            With the same control points and knots.
        """
        own = wholes("index", np.atleast_1d(np.asarray(index)))
        return Curve._of(_core.pull(self._body, number("u", u), 0.0, own, number("by", by)))

    def warp(self, region: Tuple[float, float], by: ArrayLike, *, shape: str = "bump", spans: int = 16) -> "Curve":
        """Moved along a vector within a region, all of it in the middle.

        Parameters
        ----------
        region : two floats
            Parameters from, to.
        by : array_like of shape (dimension,)
            The move of the middle.
        shape : {'bump', 'tent', 'plateau'}
            How it falls off.
        spans : int
            Knots are inserted for at least so many.

        Returns
        -------
        Curve
            The same outside the region.
        """
        move = finite("by", by, self.dimension)
        word = one_of("shape", shape, ("bump", "tent", "plateau"))
        return Curve._of(_core.warp(self._body, (range_of("region", region), None), move, word, whole("spans", spans)))

    def flatten(
        self,
        region: Tuple[float, float],
        normal: ArrayLike,
        offset: float,
        *,
        along: Optional[ArrayLike] = None,
        transition: float = 0.1,
    ) -> "Curve":
        """Flattened to a plane, in the plane to a line, within a region.

        Parameters
        ----------
        region : two floats
            Parameters from, to.
        normal : array_like of shape (dimension,)
            Of the plane normal·x = offset.
        offset : float
            Of that plane.
        along : array_like of shape (dimension,), optional
            The direction in which points go to it; None: the normal.
        transition : float
            How far beyond the region, in shares of it, the curve may change.

        Returns
        -------
        Curve
            In the plane over the region, the same beyond the transition.
        """
        way = None if along is None else finite("along", along, self.dimension)
        plane, distance = finite("normal", normal, self.dimension), number("offset", offset)
        body = _core.flatten(
            self._body, (range_of("region", region), None), plane, distance, way, number("transition", transition)
        )
        return Curve._of(body)

    def bend(
        self,
        start: ArrayLike,
        center: ArrayLike,
        length: float,
        *,
        axis: ArrayLike = (0, 0, 1),
        tolerance: float,
    ) -> Tuple["Curve", float]:
        """Bent about a circle: the line from `start` on is wound onto it, what is behind turns along.

        Parameters
        ----------
        start, center : array_like of shape (dimension,)
            Of the circle, which runs right-handed about the axis.
        length : float
            Of the line that is wound, in the data's units.
        axis : array_like of shape (3,)
            Of the circle.
        tolerance : float
            How far points may be from their images, in the data's units.

        Returns
        -------
        tuple of Curve and float
            The curve, and how far the farthest sample is from its image.
        """
        first, middle = (in_space(name, value, self.dimension) for name, value in (("start", start), ("center", center)))
        body, error = _core.bend(
            self._body, first, middle, finite("axis", axis, 3), number("length", length), number("tolerance", tolerance)
        )
        return Curve._of(body), error

    def extend(self, length: float, *, upper: bool = True, natural: bool = False) -> "Curve":
        """Continued past an end.

        Parameters
        ----------
        length : float
            Arc length added, in the data's units.
        upper : bool
            Past the end of the domain, else before its start.
        natural : bool
            The last span's polynomial goes on; else a parabola.

        Returns
        -------
        Curve
            The old one on the old domain.
        """
        return Curve._of(_core.extend(self._body, "u", bool(upper), number("length", length), bool(natural)))

    def join(self, other: "Curve", *, tolerance: float) -> "Curve":
        """This curve followed by another that starts where it ends.

        Parameters
        ----------
        other : Curve
            Of the same dimension.
        tolerance : float
            The widest gap, in the data's units.

        Returns
        -------
        Curve
            Both as one.
        """
        return Curve._of(_core.join(self._body, _body_of("other", other), "u", number("tolerance", tolerance)))

    def continuity(self, tolerance: float = 1e-9) -> List[Knot]:
        """How smooth it is at its inner knots.

        Parameters
        ----------
        tolerance : float
            Relative to the size.

        Returns
        -------
        list of Knot
            In increasing order.
        """
        return [Knot(*one) for one in _core.continuity(self._body, "u", number("tolerance", tolerance))]

    def seam_continuity(self, tolerance: float = 1e-9) -> Optional[int]:
        """The continuity from the end to the beginning.

        Parameters
        ----------
        tolerance : float
            Relative to the size.

        Returns
        -------
        int or None
            None where it is not closed.
        """
        return _core.seam_continuity(self._body, "u", number("tolerance", tolerance))

    def analyze(self) -> Dict[str, Any]:
        """What it is, in one dictionary.

        Returns
        -------
        dict
            Degree, control points, domain, closed, continuity, bounding box, length, curvature, shape.
        """
        knots = self.continuity()
        return {
            "kind": "curve",
            "degree": self.degree,
            "control_points": len(self.control_points),
            "domain": self.domain,
            "rational": self.rational,
            "closed": self.closed,
            "periodic": self.periodic,
            "continuity": min((knot.actual for knot in knots), default=self.degree),
            "bounding_box": self.bounding_box,
            "length": self.length,
            "curvature": self.curvature_range,
            "shape": self.classify(),
        }

    def to_scipy(self) -> Any:
        """The same as a ``scipy.interpolate.BSpline``.

        Returns
        -------
        scipy.interpolate.BSpline
            With values of shape (dimension,). Over a periodic basis it is not extrapolated periodically.

        Raises
        ------
        ValueError
            For a rational curve: scipy has none.
        """
        from ._friends import curve_to_scipy

        return curve_to_scipy(self)

    @classmethod
    def from_scipy(cls, spline: Any) -> "Curve":
        """The curve of a ``scipy.interpolate.BSpline``, or of what ``splprep`` gives.

        Parameters
        ----------
        spline : BSpline with values of 2 or 3 numbers, or tck = (knots, [coefficients …], degree)
            Over its base interval.

        Returns
        -------
        Curve
            The same at every parameter.
        """
        from ._friends import curve_from_scipy

        return curve_from_scipy(spline)

    @classmethod
    def from_geomdl(cls, entry: Any) -> "Curve":
        """The curve of a geomdl object or of the dictionary of its JSON exchange.

        Parameters
        ----------
        entry : dict or geomdl curve
            Of one curve.

        Returns
        -------
        Curve
            The same at every parameter.
        """
        from ._friends import from_geomdl

        (one,) = from_geomdl(entry)
        if not isinstance(one, Curve):
            raise ValueError("entry: holds a surface")
        return one


def scalar_spline(f: Any) -> Tuple[int, Floats, Floats]:
    """Degree, knots and coefficients of a scalar spline."""
    if hasattr(f, "t") and hasattr(f, "c") and hasattr(f, "k"):
        return int(f.k), finite("f", f.t, None), finite("f", f.c, None)
    try:
        degree, knots, values = f
    except (TypeError, ValueError):
        raise ValueError("f: a BSpline, or (degree, knots, coefficients), is needed") from None
    return whole("f", degree), finite("f", knots, None), finite("f", values, None)


def _remade(degree: int, knots: Floats, points: Floats, weights: Optional[Floats], periodic: bool) -> Curve:
    return Curve(degree, knots, points, weights, periodic=periodic)
