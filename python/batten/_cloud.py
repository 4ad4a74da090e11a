# SPDX-License-Identifier: MIT
"""Point clouds."""
from __future__ import annotations

from typing import Any, Dict, List, NamedTuple, Optional, Tuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._arrays import Floats, doubles, is_path, path_bytes, plain, whole


class Statistics(NamedTuple):
    """What a cloud says of itself before any fit.

    Attributes
    ----------
    spacing : float
        Mean distance of neighbours, in the data's units.
    noise : float
        Standard deviation along the normal, in the data's units.
    outliers : ndarray of bool, shape (N,)
        Points off the surface of the points around them.
    """

    spacing: float
    noise: float
    outliers: NDArray[np.bool_]


class Cloud:
    """N points with optional normals, weights, colours and parameters. It never changes.

    Parameters
    ----------
    points : array_like of shape (N, 3), or (N, 2) for points of the plane
        In the data's units, within ±1e18. Doubles and floats are taken as they lie in memory, strided or not, and copied once.
    normals : array_like of shape (N, 3), optional
        Zero where there is none.
    weights : array_like of shape (N,), optional
        Positive.
    colours : array_like of uint8, shape (N, 3), optional
        0 … 255.
    parameters : array_like of shape (N, 2), of curves (N,), optional
        Where the points belong on a surface or curve.

    Raises
    ------
    ValueError
        Naming what is not finite, too far, or of another shape.
    """

    __slots__ = ("_points", "__weakref__")
    _points: _core.Points

    def __init__(
        self,
        points: ArrayLike,
        *,
        normals: Optional[ArrayLike] = None,
        weights: Optional[ArrayLike] = None,
        colours: Optional[ArrayLike] = None,
        parameters: Optional[ArrayLike] = None,
    ) -> None:
        given = {"normals": normals, "weights": weights, "colours": colours, "parameters": parameters}
        object.__setattr__(self, "_points", _points_of("points", points, **given))

    @classmethod
    def _of(cls, points: _core.Points) -> "Cloud":
        made = object.__new__(cls)
        object.__setattr__(made, "_points", points)
        return made

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError(f"Cloud: {name} can't be set; make a new cloud")

    def __len__(self) -> int:
        return self._points.size

    def __array__(self, dtype: Any = None) -> NDArray[Any]:
        return self.points if dtype is None else np.asarray(self.points, dtype=dtype)

    def __repr__(self) -> str:
        parts = [name for name in ("normals", "weights", "colours", "parameters") if getattr(self, name) is not None]
        held = " with " + ", ".join(parts) if parts else ""
        return f"<Cloud: {len(self)} points{' of the plane' if self.dimension == 2 else ''}{held}>"

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Cloud):
            return NotImplemented
        mine, theirs = self._arrays(), other._arrays()
        return mine.keys() == theirs.keys() and all(np.array_equal(mine[k], theirs[k]) for k in mine)

    def __hash__(self) -> int:
        return hash((len(self), self.points.tobytes()))

    def __reduce__(self) -> Tuple[Any, ...]:
        return _remade, ({name: np.array(array) for name, array in self._arrays().items()},)

    def _arrays(self) -> Dict[str, NDArray[Any]]:
        names = ("points", "normals", "weights", "colours", "parameters")
        return {name: getattr(self, name) for name in names if getattr(self, name) is not None}

    @property
    def dimension(self) -> int:
        """2 for points of the plane, else 3."""
        return self._points.dimension

    @property
    def points(self) -> Floats:
        """World coordinates, shape (N, dimension). Read-only; no copy unless the points lie far from zero, where they
        are kept relative to `origin`, or in the plane."""
        return self._points.points

    @property
    def origin(self) -> Tuple[float, float, float]:
        """What the points are kept relative to: a round number where they lie far from zero."""
        return self._points.origin

    @property
    def normals(self) -> Optional[Floats]:
        """Normals, shape (N, 3), or None. Read-only; no copy."""
        return self._points.normals

    @property
    def weights(self) -> Optional[Floats]:
        """Weights, shape (N,), or None. Read-only; no copy."""
        return self._points.weights

    @property
    def colours(self) -> Optional[NDArray[np.uint8]]:
        """Colours, shape (N, 3), or None. Read-only; no copy."""
        return self._points.colours

    @property
    def parameters(self) -> Optional[Floats]:
        """Given parameters, shape (N, 2), or None. Read-only; no copy."""
        return self._points.parameters

    @property
    def info(self) -> Dict[str, Any]:
        """Of the files it was read from: files, fields, points_in_file, non_finite, filtered."""
        names = ("files", "fields", "points_in_file", "non_finite", "filtered")
        return {name: getattr(self._points, name) for name in names}

    def pick(self, which: ArrayLike) -> "Cloud":
        """Some of the points, with their attributes.

        Parameters
        ----------
        which : array_like of int, or of bool, shape (N,)
            Indices in the order wanted, or a mask.

        Returns
        -------
        Cloud
            Of these points.
        """
        indices = np.asarray(which)
        if indices.dtype.kind == "b":
            if indices.shape != (len(self),):
                raise ValueError(f"which: a mask of shape ({len(self)},) is needed, not {indices.shape}")
            indices = np.flatnonzero(indices)
        if indices.ndim != 1 or indices.dtype.kind not in "iu" and indices.size:
            raise ValueError("which: indices or a mask are needed")
        if indices.size and (indices.min() < 0 or indices.max() >= len(self)):
            raise ValueError(f"which: indices are not all in [0, {len(self)})")
        return Cloud._of(_core.pick(self._points, indices.tolist()))

    def statistics(self, *, threads: int = 0, seed: int = 1) -> Statistics:
        """Spacing, noise and outliers.

        Parameters
        ----------
        threads : int
            0: all cores.
        seed : int
            Chooses the points from which spacing and noise are estimated.

        Returns
        -------
        Statistics
            spacing and noise in the data's units, outliers (N,).
        """
        if len(self) == 0:
            raise ValueError("statistics: there are no points")
        return Statistics(*_core.statistics(self._points, whole("threads", threads, 0), whole("seed", seed, 0)))

    def parts(self, *, threads: int = 0) -> List[NDArray[np.int64]]:
        """The connected parts: objects of a scene, islands, what was scanned beside.

        Parameters
        ----------
        threads : int
            0: all cores.

        Returns
        -------
        list of ndarray of int64
            Indices of the points of each, by falling number; pieces of fewer than 30 points are left out.
        """
        if len(self) == 0:
            raise ValueError("parts: there are no points")
        return _core.parts(self._points, whole("threads", threads, 0))

    def write(self, path: Any, *, format: str = "") -> None:
        """Writes a PLY, PCD, XYZ or CSV file, whole or not at all.

        Parameters
        ----------
        path : path-like
            The extension says the format.
        format : str
            A word, where it does not.
        """
        _core.write_cloud(self._points, path_bytes("path", path), str(format))


def _points_of(name: str, points: Any, normals: Any = None, weights: Any = None, colours: Any = None, parameters: Any = None) -> _core.Points:
    rgb = None
    if colours is not None:
        rgb = plain("colours", colours)
        if rgb.size and (rgb.min() < 0 or rgb.max() > 255 or rgb.dtype.kind == "f"):
            raise ValueError("colours: whole numbers from 0 to 255 are needed")
        rgb = np.ascontiguousarray(rgb, dtype=np.uint8)
    return _core.points_from_arrays(
        name,
        rows_of(name, points),
        None if normals is None else doubles("normals", normals, None, 3),
        None if weights is None else doubles("weights", weights, None),
        rgb,
        None if parameters is None else doubles("parameters", parameters),
    )


def rows_of(name: str, points: Any) -> NDArray[Any]:
    """Points as rows, whatever holds them: columns or fields x, y, z where there are any."""
    columns = getattr(points, "columns", None)  # a table of pandas or polars
    if columns is not None and {"x", "y"} <= set(columns):
        points = np.column_stack([np.asarray(points[c]) for c in "xyz" if c in set(columns)])
    elif isinstance(points, np.ndarray) and points.dtype.names and {"x", "y"} <= set(points.dtype.names):
        points = np.column_stack([points[c] for c in "xyz" if c in points.dtype.names])
    array = plain(name, points)
    if array.ndim != 2 or array.shape[1] not in (2, 3):
        raise ValueError(f"{name}: an array of shape (N, 3), or (N, 2), is needed, not {array.shape}")
    if array.dtype not in (np.float32, np.float64) or not array.dtype.isnative:
        array = np.ascontiguousarray(array, dtype=np.float64)
    return array


def from_file(points: Any) -> bool:
    """Whether points are a path or several."""
    return is_path(points) or isinstance(points, (list, tuple)) and len(points) > 0 and all(map(is_path, points))


def cloud_of(name: str, points: Any, *, read_parameters: bool = False, faces: Optional[str] = None, **attributes: Any) -> Cloud:
    """A cloud from what users give: a Cloud, a path or several, or anything like an array."""
    given = {key: value for key, value in attributes.items() if value is not None}
    if from_file(points):
        if given:
            raise ValueError(f"{', '.join(given)}: not beside a path; the file's own are taken")
        from ._files import read_cloud

        return read_cloud(points, parameters=read_parameters, faces=faces)
    if isinstance(points, Cloud):
        if not given:
            return points
        return Cloud(points.points, **{**{k: v for k, v in points._arrays().items() if k != "points"}, **given})
    return Cloud._of(_points_of(name, points, **given))


def _remade(arrays: Dict[str, Any]) -> Cloud:
    return Cloud(arrays.pop("points"), **arrays)
