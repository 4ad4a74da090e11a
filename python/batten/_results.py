# SPDX-License-Identifier: MIT
"""What a fit or a comparison gives."""
from __future__ import annotations

import json
import warnings
from typing import Any, Dict, List, NamedTuple, Optional, Tuple

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._arrays import Floats, Path, path_bytes, whole
from ._cloud import Cloud
from ._curve import Curve
from ._errors import DoubtWarning
from ._files import path_as, write_as
from ._geometry import Geometry, wrap, wrap_all
from ._surface import Surface

# Of the view in a notebook: a page of a few megabytes.
NOTEBOOK_POINTS = 20000
NOTEBOOK_TRIANGLES = 20000


class Uncertainty(NamedTuple):
    """Of places of a fitted shape; arrays of one number for each.

    Attributes
    ----------
    sigma : ndarray of float
        Standard deviations along the normal by the noise of the points, in the data's units.
    bias : ndarray of float
        By how much fairness moved the shape along the normal, to first order.
    support : ndarray of float
        Share of the data in what is known there, 0 … 1; below 0.5 fairness decides.
    """

    sigma: Floats
    bias: Floats
    support: Floats


class Fit:
    """The result of a fit: geometry, arrays that share its memory, and its report."""

    __slots__ = ("_fit", "_report", "_file", "__weakref__")

    def __init__(self, fit: _core.Fit) -> None:
        self._fit = fit
        self._report: Optional[Dict[str, Any]] = None
        self._file = ""
        for words in fit.doubts:
            warnings.warn(words, DoubtWarning, stacklevel=3)

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {self._fit.line}>"

    @property
    def geometry(self) -> Geometry:
        """The curve or surface, in the coordinates of the points less `shift`."""
        return wrap(self._fit.bodies[0])

    @property
    def ok(self) -> bool:
        """Whether the tolerance asked for is kept, or without one the surface keeps to its points, and nothing in `report["doubt"]`."""
        return self._fit.ok

    @property
    def parameters(self) -> Floats:
        """Parameters of every point's foot, shape (N, 2), of curves (N,). Read-only; no copy."""
        return self._fit.parameters

    @property
    def residuals(self) -> Floats:
        """Orthogonal distance of every point, shape (N,), in the data's units; of surfaces signed along the normal.
        Read-only; no copy."""
        return self._fit.residuals

    @property
    def outliers(self) -> NDArray[np.bool_]:
        """Which points were set aside, shape (N,). Read-only; no copy."""
        return self._fit.outliers

    @property
    def points(self) -> Cloud:
        """The cloud that was fitted."""
        return Cloud._of(self._fit.points)

    @property
    def shift(self) -> Tuple[float, float, float]:
        """What was subtracted from the coordinates of the geometry."""
        return self._fit.shift

    @property
    def report(self) -> Dict[str, Any]:
        """The report, as ``batten fit … --report report.json`` writes it: errors, input, geometry, rounds, how it
        ended, seconds, warnings."""
        if self._report is None:
            self._report = json.loads(self._fit.report(self._file))
        return self._report

    @property
    def warnings(self) -> List[str]:
        """Sentences for people."""
        return self._fit.warnings

    @property
    def rms(self) -> float:
        """Root mean square of the distances that are judged, in the data's units."""
        return self._fit.rms

    def _write(self, path: Path, format: str, unit: Optional[str], name: str, schema: str = "ap214") -> None:
        write_as(wrap_all(self._fit.bodies), path, format, unit or self._fit.unit, name, schema)
        self._file, self._report = str(path), None

    def to_step(self, path: Path, *, unit: Optional[str] = None, name: str = "", schema: str = "ap214") -> None:
        """Writes the geometry as STEP, whole or not at all.

        Parameters
        ----------
        path : path-like
            Ending in .step or .stp.
        unit : str, optional
            Of the coordinates; that of the fit.
        name : str
            Of the product and its face or curve.
        schema : str
            'ap214' or 'ap242'.
        """
        self._write(path, "step", unit, name, schema)

    def to_iges(self, path: Path, *, unit: Optional[str] = None, name: str = "") -> None:
        """Writes the geometry as IGES, whole or not at all.

        Parameters
        ----------
        path : path-like
            Ending in .iges or .igs.
        unit : str, optional
            Of the coordinates; that of the fit.
        name : str
            A name property.
        """
        self._write(path, "iges", unit, name)

    def to_json(self, path: Path, *, unit: Optional[str] = None, name: str = "") -> None:
        """Writes the geometry as JSON; numbers read back bit by bit.

        Parameters
        ----------
        path : path-like
            Ending in .json.
        unit : str, optional
            Of the coordinates; that of the fit.
        name : str
            Kept in the file.
        """
        self._write(path, "json", unit, name)

    def to_html(self, path: Path, *, beside: Optional[Path] = None) -> None:
        """Writes the report as a page that any browser shows: figures, warnings, and the points and the geometry in 3D.

        Parameters
        ----------
        path : path-like
            Some 3 MB and more.
        beside : path-like, optional
            A page of an earlier report in the same unit, to be shown beside this one on one scale.
        """
        other = b""
        if beside is not None:
            with open(path_bytes("beside", beside), "rb") as file:
                other = file.read()
            if not other:
                raise ValueError("beside: holds nothing: give a page that to_html or --report wrote")
        _core.write_text(path_bytes("path", path), self._fit.page(150000, 150000, other))

    def to_report(self, path: Path) -> None:
        """Writes the report as JSON.

        Parameters
        ----------
        path : path-like
            Any extension.
        """
        _core.write_text(path_bytes("path", path), self._fit.report(self._file))

    def uncertainty(self, places: Any = None) -> Uncertainty:
        """How sure the shape of a curve or surface fit is; see the guide, "How sure it is".

        Parameters
        ----------
        places : array_like of shape (K, 2), or (K,) of a curve, optional
            Parameters; those of the points' feet when None.

        Returns
        -------
        Uncertainty
            `sigma`, `bias` and `support` of every place.

        Raises
        ------
        ValueError
            The fit has none: exact shapes, interpolation, grids, no freedom left.
        """
        rows = self._fit.uncertainty(None if places is None else self._places(places))
        return Uncertainty(rows[:, 0], rows[:, 1], rows[:, 2])

    def covariance(self, places: Any) -> Floats:
        """How the shape moves together: covariances of its displacements along the normal, by the noise of the points.

        With rows J of derivatives of numbers that are read off the shape, ``J @ covariance @ J.T`` is theirs.

        Parameters
        ----------
        places : array_like of shape (K, 2), or (K,) of a curve
            Parameters.

        Returns
        -------
        ndarray of float, shape (K, K)
            On its diagonal the squares of `uncertainty`'s ``sigma``.

        Raises
        ------
        ValueError
            The fit has none: exact shapes, interpolation, grids, no freedom left.
        """
        return self._fit.covariance(self._places(places))

    def _places(self, places: Any) -> Floats:
        at = np.ascontiguousarray(places, dtype=float)
        width = 2 if isinstance(self, SurfaceFit) else 1
        at = at.reshape(-1, 1) if at.ndim == 1 and width == 1 else at
        if at.ndim != 2 or at.shape[1] != width:
            raise ValueError(f"places: an array of shape (K, {width}) is needed, not {np.shape(places)}")
        if not np.isfinite(at).all():
            raise ValueError("places: parameters must be finite")
        return at

    def to_residuals(self, path: Path) -> None:
        """Writes every point with its distance, as PLY coloured by it, or as CSV.

        Parameters
        ----------
        path : path-like
            Ending in .ply or .csv.
        """
        self._fit.write_residuals(path_bytes("path", path))

    def to_certificate(self, path: Path) -> None:
        """Writes proved bounds of the distance of every point, which ``batten-verify`` proves anew; see the guide, "Proof".

        Parameters
        ----------
        path : path-like
            JSON, under any name.
        """
        self._fit.write_certificate(path_bytes("path", path))

    def _repr_html_(self) -> str:
        import html

        page = html.escape(self._fit.page(NOTEBOOK_POINTS, NOTEBOOK_TRIANGLES, b""), quote=True)
        return f'<iframe srcdoc="{page}" style="width:100%;height:640px;border:0" title="{html.escape(repr(self))}"></iframe>'

    def plot(self, ax: Any = None, *, colours: bool = True, knots: bool = True, points: bool = True) -> Any:
        """Draws the points, the geometry and its knots with matplotlib.

        Parameters
        ----------
        ax : matplotlib axes, optional
            With projection '3d' unless the curve is a plane one; made when absent.
        colours : bool
            Points are coloured by their distance.
        knots : bool
            Draws knot lines, of curves knots.
        points : bool
            Draws the points, 20000 at most.

        Returns
        -------
        matplotlib axes
            What was drawn on.
        """
        from ._plots import plot_fit

        return plot_fit(self, ax, colours, knots, points)

    def plot_residuals(self, ax: Any = None, *, bins: int = 60) -> Any:
        """Draws a histogram of the residuals of the points that count, with the tolerance.

        Parameters
        ----------
        ax : matplotlib axes, optional
            Made when absent.
        bins : int
            How many bars.

        Returns
        -------
        matplotlib axes
            What was drawn on.
        """
        from ._plots import plot_residuals

        return plot_residuals(self, ax, whole("bins", bins, 1))


class SurfaceFit(Fit):
    """The result of fitting a surface."""

    __slots__ = ()

    @property
    def surface(self) -> Surface:
        """The surface, in the coordinates of the points less `shift`."""
        return Surface._of(self._fit.bodies[0])

    def to_mesh(self, path: Path, *, tolerance: Optional[float] = None, format: str = "") -> None:
        """Writes triangles as STL, OBJ, PLY or GLB.

        Parameters
        ----------
        path : path-like
            The extension says the format.
        tolerance : float, optional
            Of the chords, in the data's units; 1e-3 of the size.
        format : str
            Where the extension does not tell.
        """
        self.surface.to_mesh(path, tolerance=tolerance, format=format, unit=self._fit.unit)


class CurveFit(Fit):
    """The result of fitting a curve."""

    __slots__ = ()

    @property
    def curve(self) -> Curve:
        """The curve, in the coordinates of the points less `shift`."""
        return Curve._of(self._fit.bodies[0])


class PrimitiveFit(Fit):
    """The result of fitting a line, circle, plane, sphere, cylinder, cone or torus."""

    __slots__ = ()

    @property
    def kind(self) -> str:
        """Which it is."""
        return str(self.numbers["kind"])

    @property
    def numbers(self) -> Dict[str, Any]:
        """Its radius, axis, centre …, lengths in the data's units and angles in radians, with standard deviations and
        covariance, as under ``geometry``, ``primitive`` in the report."""
        return dict(self.report["geometry"]["primitive"])

    @property
    def form(self) -> Optional[Dict[str, Any]]:
        """Flatness, roundness, sphericity or cylindricity, by least squares and by the minimum zone, as under ``form`` in
        the report; None of lines, cones and tori."""
        found = self.report.get("form")
        return None if found is None else dict(found)


class Solid(NamedTuple):
    """A solid: faces that share their edges and vertices, their normals outwards.

    Attributes
    ----------
    faces : list of Surface
        Bicubic, with continuous tangent planes over every edge.
    edges : list of Curve
        Each of two faces; of one at the border of a shell.
    vertices : ndarray of shape (V, 3)
        Where edges end.
    genus : int
        How many handles: 0 of a ball, 1 of a torus.
    volume : float or None
        Enclosed, in the data's units to the third; None of an open shell.
    area : float
        Of all faces, in the data's units squared.
    """

    faces: List[Surface]
    edges: List[Curve]
    vertices: Floats
    genus: int
    volume: Optional[float]
    area: float


class SolidFit(Fit):
    """The result of fitting a watertight solid, or an open shell."""

    __slots__ = ()
    _fit: _core.Solid

    def __init__(self, fit: _core.Solid) -> None:
        super().__init__(fit)

    def __repr__(self) -> str:
        s = self.summary
        words = f"{s['faces']} faces, {s['edges']} edges, {s['vertices']} vertices"
        words = f"watertight, {words}, genus {s['genus']}" if s["watertight"] else f"open, {words}"
        return f"<SolidFit: {words}; {self._fit.line}>"

    @property
    def solid(self) -> Solid:
        """The solid, in the coordinates of the points less `shift`."""
        s = self._fit.summary()
        edges = [Curve._of(body) for body in self._fit.edges]
        return Solid(self.faces, edges, self._fit.vertices, s["genus"], s["volume"], s["area"])

    @property
    def faces(self) -> List[Surface]:
        """The faces of the solid, their normals outwards."""
        return [Surface._of(body) for body in self._fit.bodies]

    @property
    def owners(self) -> NDArray[np.int32]:
        """The number of the face each point's foot is on, shape (N,). Read-only; no copy."""
        return self._fit.owners

    @property
    def control_mesh(self) -> Tuple[Floats, NDArray[np.int32]]:
        """Vertices (V, 3) and faces (F, 4) of the Catmull-Clark surface that was fitted, which has the layout's faces.
        Read-only; no copy."""
        return self._fit.control_mesh

    @property
    def summary(self) -> Dict[str, Any]:
        """What ``batten fit solid`` says of it: faces, edges, vertices, genus, bodies, extraordinary vertices of the
        layout, watertight, volume, area; gap and angle, the greatest distance and the greatest angle in radians at
        which faces meet; rms and max of the distances; warnings."""
        return self._fit.summary()

    def to_step(self, path: Path, *, unit: Optional[str] = None, schema: str = "ap214") -> None:  # type: ignore[override]
        """Writes a MANIFOLD_SOLID_BREP, of an open shell a SHELL_BASED_SURFACE_MODEL, whole or not at all: first it is
        found closed but for these borders, valid and the same when read back.

        Parameters
        ----------
        path : path-like
            Ending in .step or .stp.
        unit : str, optional
            Of the coordinates; that of the fit.
        schema : str
            'ap214' or 'ap242'.
        """
        self._fit.write_step(path_as(path, "step"), str(unit or self._fit.unit), str(schema))
        self._file, self._report = str(path), None


class Comparison(Fit):
    """Distances of points from geometries that are there already."""

    __slots__ = ()

    @property
    def geometries(self) -> List[Geometry]:
        """What the points were compared with."""
        return wrap_all(self._fit.bodies)

    @property
    def distances(self) -> Floats:
        """The residuals: distance of every point, shape (N,), in the data's units; from surfaces signed along the
        normal. Read-only; no copy."""
        return self._fit.residuals

    @property
    def owners(self) -> NDArray[np.int32]:
        """Of several geometries the number of the one each point is nearest to, shape (N,); empty where there is one.
        Read-only; no copy."""
        return self._fit.owners
