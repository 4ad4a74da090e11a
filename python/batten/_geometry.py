# SPDX-License-Identifier: MIT
"""What curves and surfaces have in common."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Dict, List, NamedTuple, Optional, Sequence, Tuple, Type, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._arrays import Floats, Path, finite, number, one_of, whole

if TYPE_CHECKING:
    from ._cloud import Cloud

Self = TypeVar("Self", bound="Geometry")


class Closest(NamedTuple):
    """The nearest places of a curve or surface to N points.

    Attributes
    ----------
    parameters : ndarray of shape (N, 2), curves (N,)
        Where they are in the domain.
    points : ndarray of shape (N, 3)
        The places themselves; of plane curves z = 0.
    distances : ndarray of shape (N,)
        How far off the points are, in the data's units, not negative.
    lower_bounds : ndarray of shape (N,)
        Nothing of the shape is nearer than this.
    certified : ndarray of bool, shape (N,)
        Whether the distance is proved to be the least, to rounding.
    """

    parameters: Floats
    points: Floats
    distances: Floats
    lower_bounds: Floats
    certified: NDArray[np.bool_]


class Knot(NamedTuple):
    """A knot inside the domain, and how smooth the shape is across it.

    Attributes
    ----------
    at : float
        Its parameter.
    multiplicity : int
        How often it stands in the knot vector.
    guaranteed : int
        Degree less multiplicity.
    actual : int
        The highest order to which derivatives agree, as measured.
    """

    at: float
    multiplicity: int
    guaranteed: int
    actual: int


class Removal(NamedTuple):
    """What is left when knots or degrees are taken away.

    Attributes
    ----------
    shape : Curve or Surface
        The new shape.
    removed : int
        How many went.
    error : float
        No point moved by more, in the data's units.
    """

    shape: Any
    removed: int
    error: float


class Geometry:
    """A NURBS curve or surface: a value that never changes. ``==`` compares every number, ``hash`` agrees with it,
    and pickle and copy keep all."""

    __slots__ = ("_body", "__weakref__")
    _body: _core.Body

    @classmethod
    def _of(cls: Type[Self], body: _core.Body) -> Self:
        made = object.__new__(cls)
        object.__setattr__(made, "_body", body)
        return made

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError(f"{type(self).__name__}: {name} can't be set; every operation gives a new shape")

    def __delattr__(self, name: str) -> None:
        raise AttributeError(f"{type(self).__name__}: {name} can't be deleted")

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Geometry):
            return NotImplemented
        return bool(self._body == other._body)

    def __hash__(self) -> int:
        return hash(self._body)

    def __copy__(self: Self) -> Self:
        return self

    def __deepcopy__(self: Self, memo: Dict[int, Any]) -> Self:
        return self

    @property
    def dimension(self) -> int:
        """Of space: 2 for plane curves, else 3."""
        return self._body.dimension

    @property
    def rational(self) -> bool:
        """Whether weights differ."""
        return self._body.rational()

    @property
    def control_points(self) -> Floats:
        """Control points, Euclidean, in the data's units: shape (n, m, 3), of curves (n, 2) or (n, 3). Read-only; the
        memory is the shape's own."""
        return self._body.control_points()

    @property
    def weights(self) -> Floats:
        """Weights, shape (n, m), of curves (n,); ones where the shape is not rational. Read-only; no copy."""
        return self._body.weights()

    @property
    def bounding_box(self) -> Tuple[Floats, Floats]:
        """Lower and upper corner of the smallest box, shape (dimension,) each; of a trimmed surface that of the part
        inside its trims."""
        return _core.bounding_box(self._body)

    @property
    def curvature_range(self) -> Optional[Tuple[float, float]]:
        """Least and greatest curvature, one over the data's units, infinite at cusps and tips: of curves not negative,
        of surfaces of the principal curvatures. None where there is none."""
        return _core.curvature_range(self._body)

    def closest(self, points: ArrayLike, *, threads: int = 0) -> Closest:
        """The nearest places to points, over the whole shape, or the part inside its trims.

        Parameters
        ----------
        points : array_like of shape (N, 3), or (N, 2) for points at z = 0
            In the data's units.
        threads : int
            0: all cores.

        Returns
        -------
        Closest
            Parameters, places, distances (N,) and what is proved of them.
        """
        array = finite("points", points)
        single = array.ndim == 1
        if single:
            array = array.reshape(1, -1)
        if array.ndim != 2 or array.shape[1] not in (2, 3):
            raise ValueError(f"points: an array of shape (N, 3) is needed, not {np.shape(points)}")
        found = Closest(*_core.closest(self._body, array, whole("threads", threads, 0)))
        return Closest(*(part[0] for part in found)) if single else found

    def transform(self: Self, matrix: ArrayLike) -> Self:
        """The image under (x, y, z, 1) ↦ matrix · (x, y, z, 1), divided by the last coordinate.

        Parameters
        ----------
        matrix : array_like of shape (4, 4)
            Affine or perspective; of plane curves it must map z = 0 onto itself.

        Returns
        -------
        Curve or Surface
            Of the same kind.
        """
        return self._of(_core.transform(self._body, finite("matrix", matrix, 4, 4)))

    def translate(self: Self, shift: ArrayLike) -> Self:
        """Moved by a vector.

        Parameters
        ----------
        shift : array_like of shape (3,), plane curves (2,)
            In the data's units.

        Returns
        -------
        Curve or Surface
            Of the same kind.
        """
        vector = np.zeros(3)
        given = finite("shift", shift, None)
        if given.size not in (self.dimension, 3):
            raise ValueError(f"shift: {self.dimension} numbers are needed, not {given.size}")
        vector[: given.size] = given
        return self.transform(_core.translation(vector))

    def rotate(self: Self, axis: ArrayLike, angle: float, *, center: ArrayLike = (0, 0, 0)) -> Self:
        """Turned about an axis, right-handed.

        Parameters
        ----------
        axis : array_like of shape (3,)
            Of any length.
        angle : float
            Radians.
        center : array_like of shape (3,)
            A point of the axis.

        Returns
        -------
        Curve or Surface
            Of the same kind.
        """
        middle = finite("center", center, 3)
        turn = _core.rotation(finite("axis", axis, 3), number("angle", angle))
        there, back = _core.translation(middle), _core.translation(-middle)
        return self.transform(there @ turn @ back)

    def scale(self: Self, factors: ArrayLike, *, center: ArrayLike = (0, 0, 0)) -> Self:
        """Scaled about a point.

        Parameters
        ----------
        factors : float or array_like of shape (3,)
            One, or one for each coordinate; negative ones mirror.
        center : array_like of shape (3,)
            What stays in place.

        Returns
        -------
        Curve or Surface
            Of the same kind.
        """
        middle = finite("center", center, 3)
        each = finite("factors", factors)
        if each.shape not in ((), (3,)):
            raise ValueError("factors: one number or three are needed")
        matrix = np.diag(np.append(np.broadcast_to(each, 3), 1.0))
        return self.transform(_core.translation(middle) @ matrix @ _core.translation(-middle))

    def remove_knots(self: Self, tolerance: float) -> Removal:
        """All knots taken away that the tolerance allows, the one that moves the shape least first.

        Parameters
        ----------
        tolerance : float
            In the data's units, not negative.

        Returns
        -------
        Removal
            Shape, number of knots, and the bound of the deviation.
        """
        body, removed, error = _core.remove_knots(self._body, number("tolerance", tolerance))
        return Removal(self._of(body), removed, error)

    def classify(self, tolerance: float = 1e-9) -> Tuple[str, Dict[str, Any]]:
        """What exact shape it lies on.

        Parameters
        ----------
        tolerance : float
            How far off it may be, relative to its size.

        Returns
        -------
        name : str
            ``'line'``, ``'circle'``, … ``'plane'``, ``'cylinder'``, … or ``'free'``.
        numbers : dict
            Its radius, axis, centre …: lengths in the data's units, angles in radians.
        """
        return _core.classify(self._body, number("tolerance", tolerance))

    def join_quality(
        self,
        other: "Geometry",
        *,
        position_tolerance: Optional[float] = None,
        angle_tolerance: float = 1e-6,
        curvature_tolerance: float = 1e-5,
        derivative_tolerance: float = 1e-6,
    ) -> Dict[str, Any]:
        """How smoothly two curves or two surfaces meet.

        Parameters
        ----------
        other : Curve or Surface
            Of the same kind and dimension.
        position_tolerance : float, optional
            The widest gap, in the data's units; 1e-9 of the size.
        angle_tolerance : float
            Radians.
        curvature_tolerance, derivative_tolerance : float
            Relative to the greater of the two.

        Returns
        -------
        dict
            ``C`` and ``G`` (−1 … 2), ``position_gap``, ``angle_gap``, ``curvature_gap``, ``at``.
        """
        return _core.joint(
            self._body,
            _body_of("other", other),
            None if position_tolerance is None else number("position_tolerance", position_tolerance),
            number("angle_tolerance", angle_tolerance),
            number("curvature_tolerance", curvature_tolerance),
            number("derivative_tolerance", derivative_tolerance),
        )

    def sample(self, count: int = 1000, *, noise: float = 0, outliers: float = 0, seed: int = 1) -> "Cloud":
        """Points spread evenly over the shape, as if measured.

        Parameters
        ----------
        count : int
            How many, outliers included.
        noise : float
            Standard deviation in every coordinate, in the data's units.
        outliers : float
            The fraction, 0 … 1, that lies anywhere in the bounding box.
        seed : int
            The same seed gives the same points.

        Returns
        -------
        Cloud
            Of `count` points.
        """
        from ._cloud import Cloud

        count, seed = whole("count", count, 1), whole("seed", seed, 0)
        return Cloud._of(_core.sample(self._body, count, number("noise", noise), number("outliers", outliers), seed))

    def to_step(self, path: Path, *, unit: str = "mm", name: str = "", schema: str = "ap214") -> None:
        """Writes a STEP file, whole or not at all.

        Parameters
        ----------
        path : path-like
            Ending in .step or .stp.
        unit : str
            Of the coordinates, declared: 'mm', 'm', 'inch' …
        name : str
            Of the product and its face or curve.
        schema : str
            'ap214' or 'ap242'.
        """
        from ._files import write_as

        write_as([self], path, "step", unit, name, schema)

    def to_iges(self, path: Path, *, unit: str = "mm", name: str = "") -> None:
        """Writes an IGES file, whole or not at all.

        Parameters
        ----------
        path : path-like
            Ending in .iges or .igs.
        unit : str
            Of the coordinates, declared.
        name : str
            A name property.
        """
        from ._files import write_as

        write_as([self], path, "iges", unit, name)

    def to_json(self, path: Path, *, unit: str = "mm", name: str = "") -> None:
        """Writes a JSON file of the form that geomdl reads; numbers read back bit by bit.

        Parameters
        ----------
        path : path-like
            Ending in .json.
        unit : str
            Of the coordinates.
        name : str
            Kept in the file.
        """
        from ._files import write_as

        write_as([self], path, "json", unit, name)

    def to_geomdl(self) -> Dict[str, Any]:
        """The dictionary that geomdl's JSON exchange holds.

        Returns
        -------
        dict
            ``{"shape": {"type": …, "count": 1, "data": […]}}``
        """
        import json

        entry: Dict[str, Any] = json.loads(self._body.json())
        return entry


def _body_of(name: str, value: Any) -> _core.Body:
    if isinstance(value, Geometry):
        return value._body
    raise ValueError(f"{name}: a Curve or Surface is needed, not {type(value).__name__}")


def wrap(body: _core.Body) -> Geometry:
    from ._curve import Curve
    from ._surface import Surface

    return Surface._of(body) if body.is_surface else Curve._of(body)


def wrap_all(bodies: Sequence[_core.Body]) -> List[Geometry]:
    return [wrap(body) for body in bodies]


def direction_of(value: Any) -> str:
    return one_of("direction", value, ("u", "v"))
