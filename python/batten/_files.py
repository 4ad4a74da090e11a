# SPDX-License-Identifier: MIT
"""Clouds, geometry and meshes from and to files."""
from __future__ import annotations

import os
import warnings
from typing import Any, Dict, Iterable, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike

from . import _core
from ._arrays import Path, doubles, finite, is_path, number, one_of, path_bytes, plain
from ._cloud import Cloud, cloud_of
from ._errors import ReadWarning
from ._geometry import Geometry, _body_of, wrap_all
from ._progress import callback
from ._surface import Mesh


class Shapes(List[Geometry]):
    """The curves and surfaces of a file: a list, with what else the file says.

    Attributes
    ----------
    names : list of str
        Of each; empty where the file gives none.
    unit : str
        Of the coordinates; empty where the file does not say.
    remarks : list of str
        What was not quite as it should be.
    """

    names: List[str]
    unit: str
    remarks: List[str]


class Sewing(NamedTuple):
    """What sewing made of surfaces.

    Attributes
    ----------
    surfaces : int
        That were to be sewn.
    solids, shells, loose : int
        Closed shells, open ones, and surfaces left by themselves.
    invalid : int
        Of the loose ones those that would have come out as no valid shape.
    shared_edges, free_edges : int
        Edges of two surfaces, and of one alone.
    largest_gap : float
        Between surfaces along a shared edge, in the data's units.
    nearest_gap : float or None
        Least distance from a free edge to another one.
    watertight : bool
        A solid at least, and no free edge.
    """

    surfaces: int
    solids: int
    shells: int
    loose: int
    invalid: int
    shared_edges: int
    free_edges: int
    largest_gap: float
    nearest_gap: Optional[float]
    watertight: bool


def read_cloud(
    path: Union[Path, Sequence[Path]],
    *,
    format: str = "",
    columns: Optional[Mapping[str, Union[int, str]]] = None,
    parameters: bool = False,
    faces: Optional[str] = None,
    where: Union[Mapping[str, float], Iterable[Tuple[str, float]], None] = None,
    las_classes: Sequence[int] = (),
    box: Optional[ArrayLike] = None,
    projection: Optional[str] = None,
    progress: Any = None,
) -> Cloud:
    """Reads points: PCD, PLY, LAS, text of any name, and the vertices of OBJ, STL, OFF and GLB.

    Parameters
    ----------
    path : path-like, or a sequence of them
        Several files become one cloud.
    format : str
        A word where the extension does not tell: 'ply', 'pcd', 'las', 'text' …
    columns : mapping, optional
        Roles x y z u v nx ny nz w red green blue to columns, by number from 1 or by name.
    parameters : bool
        Takes u and v by their names from PCD and PLY, too.
    faces : {'sampled', 'flat', 'measured'}, optional
        Of a mesh whose vertices do not stand for its surface also points on its triangles, after the vertices: 'sampled';
        'flat': where all edges are flat or sharp, as fit_surface takes a path; 'measured': on long triangles of any mesh too,
        as compare does.
    where : mapping of str to float, optional
        Only rows whose column holds exactly the value; all of them must.
    las_classes : sequence of int
        Only points of these classes; LAS alone.
    box : array_like of shape (6,), optional
        Only points within xmin, ymin, zmin, xmax, ymax, zmax, in the data's units.
    projection : {'local', 'local=LON,LAT', 'none'}, optional
        'local': x and y are longitude and latitude in degrees and become metres from the middle of the points, or from the
        one given, as they do by themselves where the columns are named so; 'none': they stay.
    progress : callable or bool, optional
        ``progress(stage, fraction)``; True: a bar.

    Returns
    -------
    Cloud
        Of the finite points, in the order of the files.

    Raises
    ------
    ReadError
        With file and line.
    """
    paths = [path] if is_path(path) else list(path) if isinstance(path, (list, tuple)) else [path]
    if not paths:
        raise ValueError("path: there is none")
    rows = list(where.items() if isinstance(where, Mapping) else where or ())
    options: Dict[str, Any] = {
        "format": str(format),
        "columns": {str(role): str(column) for role, column in (columns or {}).items()},
        "parameters": bool(parameters),
        "faces": None if faces is None else one_of("faces", faces, ("sampled", "flat", "measured")),
        "where": [(str(column), float(value)) for column, value in rows],
        "las_classes": [int(one) for one in las_classes],
        "box": None if box is None else finite("box", box, 6).tolist(),
        "projection": projection,
    }
    with callback(progress) as tell:
        points = _core.read_cloud([path_bytes("path", one) for one in paths], options, tell)
    for remark in points.remarks:
        warnings.warn(remark, ReadWarning, stacklevel=2)
    return Cloud._of(points)


def write_cloud(points: Any, path: Path, *, format: str = "", **attributes: Any) -> None:
    """Writes points as PLY, PCD, XYZ or CSV, whole or not at all.

    Parameters
    ----------
    points : Cloud or array_like of shape (N, 3) or (N, 2)
        In the data's units.
    path : path-like
        The extension says the format.
    format : str
        A word where it does not.
    **attributes : array_like
        normals, weights, colours, parameters as Cloud takes them.

    Raises
    ------
    WriteError
        Naming the file.
    """
    cloud_of("points", points, **attributes).write(path, format=format)


def read_geometry(path: Path, *, format: str = "", unit: str = "", strict: bool = False) -> Shapes:
    """Reads curves and surfaces: STEP, IGES, B-rep of OpenCASCADE, JSON of geomdl's form.

    Parameters
    ----------
    path : path-like
        The extension says the format.
    format : str
        'step', 'iges', 'brep' or 'json' where it does not.
    unit : str
        What coordinates are turned into; the file's own when empty.
    strict : bool
        Raises for one face or curve that can't be read; else the rest is read, with a ReadWarning.

    Returns
    -------
    Shapes
        A list of Curve and Surface, with names, unit and remarks.

    Raises
    ------
    ReadError
        With file and line.
    """
    return _shapes(_core.read_geometry(path_bytes("path", path), str(format), str(unit), bool(strict)))


def _shapes(contents: Tuple[List[_core.Body], List[str], str, List[str], List[str]]) -> Shapes:
    bodies, names, unit, remarks, unread = contents
    for reason in unread:
        warnings.warn(reason, ReadWarning, stacklevel=3)
    shapes = Shapes(wrap_all(bodies))
    shapes.names, shapes.unit, shapes.remarks = names, unit, remarks
    return shapes


def write_geometry(
    geometry: Union[Geometry, Sequence[Geometry]],
    path: Path,
    *,
    format: str = "",
    unit: str = "mm",
    names: Optional[Sequence[str]] = None,
    schema: str = "ap214",
    sew: Optional[float] = None,
) -> Optional[Sewing]:
    """Writes curves and surfaces as STEP, IGES, B-rep or JSON, whole or not at all.

    Parameters
    ----------
    geometry : Curve, Surface or a sequence of them
        In this order.
    path : path-like
        The extension says the format.
    format : str
        'step', 'iges', 'brep' or 'json' where it does not.
    unit : str
        Of the coordinates: declared, never scaled.
    names : sequence of str, optional
        Of each; B-rep keeps none.
    schema : str
        Of STEP: 'ap214' or 'ap242'.
    sew : float, optional
        STEP and B-rep: surfaces whose edges are within this distance, in the data's units, become shells, closed ones
        solids.

    Returns
    -------
    Sewing or None
        What sewing came to; None where nothing was to be sewn.

    Raises
    ------
    WriteError
        Naming the file.
    ValueError
        Naming the keyword.
    """
    if sew is not None:
        sew = number("sew", sew)
        if not 0 <= sew < float("inf"):
            raise ValueError(f"sew: {sew} is not a distance")
    shapes = [geometry] if isinstance(geometry, Geometry) else list(geometry)
    bodies = [_body_of("geometry", one) for one in shapes]
    if not bodies:
        raise ValueError("geometry: there is none")
    labels = [] if names is None else [str(name) for name in names]
    if labels and len(labels) != len(bodies):
        raise ValueError(f"names: {len(labels)} for {len(bodies)} geometries")
    report = _core.write_geometry(bodies, path_bytes("path", path), labels, str(format), str(unit), str(schema), sew)
    return None if report is None else Sewing(*report)


ENDINGS = {"step": (".step", ".stp"), "iges": (".iges", ".igs"), "json": (".json",)}


def path_as(path: Path, format: str) -> bytes:
    """The path of a file of that format, which its name has to say: programs go by it."""
    given = path_bytes("path", path)
    if not os.fsdecode(given).lower().endswith(ENDINGS[format]):
        raise ValueError(f"path: {path!r} does not end in {' or '.join(ENDINGS[format])}")
    return given


def write_as(shapes: Sequence[Geometry], path: Path, format: str, unit: str, name: str, schema: str = "ap214") -> None:
    """Writes the shapes under one name in the format of a method."""
    path_as(path, format)
    write_geometry(shapes, path, format=format, unit=unit, names=[name] * len(shapes) if name else None, schema=schema)


def write_mesh(
    mesh: Union[Mesh, Tuple[ArrayLike, ArrayLike]],
    path: Path,
    *,
    format: str = "",
    unit: str = "mm",
    deviations: Optional[ArrayLike] = None,
) -> None:
    """Writes triangles as STL, OBJ, PLY or GLB, whole or not at all.

    Parameters
    ----------
    mesh : Mesh, or (vertices, faces)
        Vertices (V, 3) in the data's units, faces (F, 3) of indices.
    path : path-like
        The extension says the format.
    format : str
        'stl', 'obj', 'ply' or 'glb' where it does not.
    unit : str
        Of the coordinates: GLB is in metres.
    deviations : array_like of shape (V,), optional
        Signed, in the data's units: vertices are coloured by them; not in STL.

    Raises
    ------
    WriteError
        Naming the file.
    """
    try:
        parts = tuple(mesh)
    except TypeError:
        parts = ()
    if len(parts) not in (2, 4):
        raise ValueError("mesh: (vertices, faces) are needed")
    faces = plain("faces", parts[1])
    if faces.dtype.kind == "f":
        raise ValueError("faces: whole numbers are needed")
    extra = parts[2:] if len(parts) == 4 else (None, None)
    arrays = (
        finite("vertices", parts[0], None, 3),
        np.ascontiguousarray(faces, dtype=np.int32),
        None if extra[0] is None else doubles("parameters", extra[0], None, 2),
        None if extra[1] is None else doubles("normals", extra[1], None, 3),
        None if deviations is None else doubles("deviations", deviations, None),
    )
    _core.write_meshes([arrays], path_bytes("path", path), str(format), str(unit))
