# SPDX-License-Identifier: MIT
"""To and from the shapes of other packages, each imported when it is asked for."""
from __future__ import annotations

import json
from typing import Any, List, Sequence, Union

import numpy as np

from . import _core
from ._arrays import finite
from ._curve import Curve
from ._geometry import Geometry, _body_of
from ._surface import Mesh, Surface


def curve_to_scipy(curve: Curve) -> Any:
    from scipy.interpolate import BSpline

    if curve.rational:
        raise ValueError("to_scipy: scipy has no rational splines")
    return BSpline(np.array(curve.knots), np.array(curve.control_points), curve.degree)


def curve_from_scipy(spline: Any) -> Curve:
    if hasattr(spline, "t") and hasattr(spline, "c") and hasattr(spline, "k"):
        knots, values, degree = np.asarray(spline.t), np.asarray(spline.c), int(spline.k)
        if getattr(spline, "axis", 0):
            values = np.moveaxis(values, spline.axis, 0)
    else:
        try:
            if len(spline) == 2:  # splprep: (tck, u)
                spline = spline[0]
            knots, coefficients, degree = spline
            values = np.column_stack([np.asarray(c) for c in coefficients])
        except (TypeError, ValueError):
            raise ValueError("spline: a BSpline or (knots, coefficients, degree) is needed") from None
    if values.ndim != 2 or values.shape[1] not in (2, 3):
        raise ValueError("spline: values of two or three numbers are needed")
    count = len(knots) - degree - 1
    return Curve(degree, knots, values[:count])


def surface_to_scipy(surface: Surface) -> Any:
    import scipy.interpolate

    if not hasattr(scipy.interpolate, "NdBSpline"):
        raise ImportError(f"to_scipy: NdBSpline is in scipy 1.12 and later, this is {scipy.__version__}")
    if surface.rational:
        raise ValueError("to_scipy: scipy has no rational splines")
    knots = (np.array(surface.knots_u), np.array(surface.knots_v))
    return scipy.interpolate.NdBSpline(knots, np.array(surface.control_points), surface.degree)


def surface_from_scipy(spline: Any) -> Surface:
    if hasattr(spline, "t") and hasattr(spline, "c") and hasattr(spline, "k"):  # NdBSpline
        knots_u, knots_v = (np.asarray(t) for t in spline.t)
        degree = spline.k if np.ndim(spline.k) else (spline.k, spline.k)
        return Surface((int(degree[0]), int(degree[1])), knots_u, knots_v, spline.c)
    if hasattr(spline, "tck") and hasattr(spline, "degrees"):
        knots_x, knots_y, heights = spline.tck[:3]
        p, q = spline.degrees
        n, m = len(knots_x) - p - 1, len(knots_y) - q - 1
        x = [np.mean(knots_x[i + 1 : i + p + 1]) for i in range(n)]  # with these as control points the spline is x
        y = [np.mean(knots_y[j + 1 : j + q + 1]) for j in range(m)]
        points = np.stack(np.meshgrid(x, y, indexing="ij") + [np.reshape(heights, (n, m))], axis=-1)
        return Surface((p, q), knots_x, knots_y, points)
    raise ValueError("spline: an NdBSpline or a BivariateSpline is needed")


def from_geomdl(entry: Any) -> List[Geometry]:
    """The curves and surfaces of geomdl: its objects, or the dictionary of its JSON exchange.

    Parameters
    ----------
    entry : dict, str, or geomdl curve or surface
        ``{"shape": …}``, one entry of its data, JSON text, or an object with control points, knots and degrees.

    Returns
    -------
    list of Curve and Surface
        In their order.

    Raises
    ------
    ReadError
        Naming the field that is wrong.
    """
    from ._files import _shapes

    if isinstance(entry, str):
        return _shapes(_core.geometry_from_json(entry, "geomdl"))
    if isinstance(entry, dict):
        if "shape" not in entry:
            kind = "surface" if "degree_u" in entry else "curve"
            entry = {"shape": {"type": kind, "count": 1, "data": [entry]}}
        return _shapes(_core.geometry_from_json(json.dumps(entry, default=_plain), "geomdl"))
    if hasattr(entry, "knotvector_u"):
        n, m = entry.ctrlpts_size_u, entry.ctrlpts_size_v
        points = finite("entry", entry.ctrlpts, None, 3).reshape(n, m, 3)
        weights = getattr(entry, "weights", None)
        w = None if not weights else finite("entry", weights, None).reshape(n, m)
        return [Surface((entry.degree_u, entry.degree_v), entry.knotvector_u, entry.knotvector_v, points, w)]
    if hasattr(entry, "knotvector") and hasattr(entry, "ctrlpts"):
        weights = getattr(entry, "weights", None)
        return [Curve(entry.degree, entry.knotvector, finite("entry", entry.ctrlpts), weights or None)]
    raise ValueError(f"entry: {type(entry).__name__} is nothing of geomdl's")


def to_geomdl(geometry: Union[Geometry, Sequence[Geometry]]) -> Any:
    """Several curves or surfaces as the dictionary that geomdl's JSON exchange holds.

    Parameters
    ----------
    geometry : Curve, Surface or a sequence of them
        Of one kind, for geomdl to read it.

    Returns
    -------
    dict
        ``{"shape": {"type": …, "count": …, "data": […]}}``
    """
    shapes = [geometry] if isinstance(geometry, Geometry) else list(geometry)
    return json.loads(_core.geometry_to_json([_body_of("geometry", one) for one in shapes]))


def _plain(value: Any) -> Any:
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    raise TypeError(f"{type(value).__name__} has no JSON")


def to_trimesh(mesh: Mesh) -> Any:
    import trimesh

    return trimesh.Trimesh(mesh.vertices, mesh.faces, vertex_normals=mesh.normals, process=False)


def to_pyvista(mesh: Mesh) -> Any:
    import pyvista

    faces = np.column_stack([np.full(len(mesh.faces), 3), mesh.faces]).ravel()
    poly = pyvista.PolyData(mesh.vertices, faces)
    poly.point_data["Normals"] = mesh.normals
    return poly
