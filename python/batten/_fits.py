# SPDX-License-Identifier: MIT
"""Points in, geometry and report out."""
from __future__ import annotations

from typing import Any, Callable, Dict, Iterable, List, Optional, Sequence, Tuple, Union, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._arrays import Path, finite, is_path, number, one_of, path_bytes, plain, whole
from ._cloud import Cloud, cloud_of, from_file
from ._curve import Curve
from ._geometry import Geometry, _body_of
from ._optimize import ResidualTerm, checked_terms
from ._progress import callback
from ._results import Comparison, CurveFit, PrimitiveFit, SolidFit, SurfaceFit
from ._surface import Surface

Progress = Union[Callable[[str, float], Any], bool, None]
Terms = Iterable[ResidualTerm]
Free = Union[str, Iterable[str], None]


def _keywords(cloud: Cloud, shift: Any, unit: Any, command: str, options: Dict[str, Any]) -> Dict[str, Any]:
    """What the library is told: None is the library's own choice."""
    one_of("unit", unit, _core.units())
    if isinstance(shift, str):
        one_of("shift", shift, ("local",))
        shift = cloud.origin
    elif shift is not None:
        shift = finite("shift", shift, 3).tolist()
    return {**options, "shift": shift, "unit": unit, "command": command}


def fit_surface(
    points: Any,
    *,
    tolerance: Optional[float] = None,
    degree: Union[int, Tuple[int, int]] = 3,
    control_points: Optional[Tuple[int, int]] = None,
    max_control_points: int = 20000,
    smoothing: Union[float, str, None] = None,
    loss: Optional[str] = None,
    loss_scale: Optional[float] = None,
    optimize: Free = None,
    terms: Optional[Callable[[Surface], Terms]] = None,
    base: Optional[str] = None,
    closed: Optional[str] = None,
    trim: Optional[str] = None,
    boundary: Sequence[Geometry] = (),
    boundary_tolerance: float = 0,
    meet: Any = None,
    symmetric: Union[str, ArrayLike, None] = None,
    domain: Optional[ArrayLike] = None,
    thin: Optional[float] = None,
    keep_outliers: bool = False,
    snap: bool = False,
    normals: Optional[ArrayLike] = None,
    weights: Optional[ArrayLike] = None,
    parameters: Optional[ArrayLike] = None,
    given_parameters: Optional[bool] = None,
    side_of_normals: Optional[bool] = None,
    shift: Union[str, ArrayLike, None] = None,
    unit: str = "mm",
    seed: int = 1,
    threads: int = 0,
    progress: Progress = None,
) -> SurfaceFit:
    """Fits a NURBS surface to scattered points, from the points alone.

    Sets outliers aside, finds parameters over a plane or by flattening, chooses the knots by cross-validation, refines
    where a tolerance is given, optimizes control points and parameters jointly where it pays, and trims the surface to
    its points. The interpreter's lock is released meanwhile; Ctrl-C raises KeyboardInterrupt.

    Parameters
    ----------
    points : array_like of shape (N, 3), Cloud, path-like or a sequence of paths
        In the data's units. Doubles and floats are taken as they lie in memory and copied once.
    tolerance : float, optional
        Orthogonal distance in the data's units that points shall keep.
    degree : int or (int, int)
        In u and v, 1 … 25.
    control_points : (int, int), optional
        Chosen by cross-validation when None.
    max_control_points : int
        In all.
    smoothing : float or {'auto', 'cross-validation', 'noise'}, optional
        Fairness relative to the data, 1e-4 when None; or who chooses it.
    loss : {'auto', 'none', 'huber', 'cauchy', 'tukey', 'truncated'}, optional
        None: robust if outliers are found.
    loss_scale : float, optional
        Standard deviation of inliers, in the data's units; estimated when None.
    optimize : str or iterable of {'parameters', 'weights', 'knots'}, optional
        What is free in the joint stage besides the control points; None: where it pays; 'none': never.
    terms : callable, optional
        ``terms(start) -> list of ResidualTerm``: terms of your own in the joint stage. `start` is the surface that the
        stage begins from; in its coordinates values come, too.
    base : {'auto', 'plane', 'sheet', 'revolution', 'sphere', 'torus', 'wing'}, optional
        Where parameters come from.
    closed : {'auto', 'none', 'u', 'v', 'uv'}, optional
        Directions that close without a seam.
    trim : {'auto', 'none'}, optional
        Whether the surface is trimmed to the outline and holes of its points.
    boundary : sequence of Curve or Surface
        Curves that edges meet, or neighbours that they meet with their tangent planes; four at most.
    boundary_tolerance : float
        The distance an edge may keep from its curve, in the data's units.
    meet : array_like of shape (K, 3) or Cloud, optional
        Points met exactly; where the cloud has normals with the tangent plane.
    symmetric : {'x', 'y', 'z'} or array_like of shape (4,), optional
        The surface is its own mirror image in this plane, a x + b y + c z + d = 0.
    domain : array_like of shape (4,), optional
        u0, v0, u1, v1 along the axes of the base, lengths in the data's units.
    thin : float, optional
        Side of the cubes of which each gives one point to the fit, in the data's units.
    keep_outliers : bool
        Fits them like any other point.
    snap : bool
        Takes the plane, sphere, cylinder, cone or torus that explains the points as well.
    normals : array_like of shape (N, 3), optional
        Of the points: the surface's normal looks to their side.
    weights : array_like of shape (N,), optional
        Of the points, positive.
    parameters : array_like of shape (N, 2), optional
        u and v of the points: taken as they are.
    given_parameters, side_of_normals : bool, optional
        Whether the cloud's own parameters and normals are taken; None: those that are given here.
    shift : array_like of shape (3,) or 'local', optional
        Subtracted from the coordinates of the result; 'local': the cloud's origin.
    unit : str
        Of the data, for files and the report: 'mm', 'm', 'inch' …
    seed : int
        Chooses samples.
    threads : int
        0: all cores.
    progress : callable or bool, optional
        ``progress(stage, fraction)`` of the whole fit, up to 50 times a second; where it returns False the best so far
        is returned. True: a bar.

    Returns
    -------
    SurfaceFit
        surface, parameters (N, 2), residuals (N,), outliers (N,), report.

    Raises
    ------
    FitRefused
        Points that can't carry a surface.
    ReadError
        A file that can't be used.
    ValueError
        Naming the keyword.
    """
    cloud = cloud_of(
        "points",
        points,
        read_parameters=given_parameters is True,
        faces=None if given_parameters is True else "flat",
        normals=normals,
        weights=weights,
        parameters=parameters,
    )
    options: Dict[str, Any] = {
        "tolerance": tolerance,
        "degree": degree,
        "control_points": control_points,
        "max_control_points": max_control_points,
        "smoothing": smoothing,
        "loss": loss,
        "loss_scale": loss_scale,
        "optimize": optimize,
        "terms": None if terms is None else lambda body: checked_terms(_called("terms", terms)(Surface._of(body))),
        "base": base,
        "closed": closed,
        "trim": trim,
        "boundary": [_body_of("boundary", one) for one in _sequence("boundary", boundary)],
        "boundary_tolerance": boundary_tolerance,
        "meet": None if meet is None else cloud_of("meet", meet)._points,
        "symmetric": _mirror(symmetric),
        "domain": None if domain is None else finite("domain", domain, 4).tolist(),
        "thin": thin,
        "keep_outliers": keep_outliers,
        "snap": snap,
        "given_parameters": parameters is not None if given_parameters is None else given_parameters,
        "side_of_normals": normals is not None if side_of_normals is None else side_of_normals,
        "seed": seed,
        "threads": threads,
    }
    if options["given_parameters"] is True and cloud.parameters is None:
        raise ValueError("given_parameters: the points have none")
    if terms is not None:
        _called("terms", terms)
    with callback(progress) as tell:
        values = _keywords(cloud, shift, unit, "batten.fit_surface", options)
        return SurfaceFit(_core.fit_surface(cloud._points, values, tell))


def fit_curve(
    points: Any,
    *,
    tolerance: Optional[float] = None,
    degree: int = 3,
    control_points: Optional[int] = None,
    max_control_points: int = 2000,
    parameterization: Optional[str] = None,
    parameters: Optional[ArrayLike] = None,
    order: Optional[str] = None,
    closed: Union[str, bool, None] = None,
    corners: bool = True,
    distance: Optional[str] = None,
    smoothing: Union[float, str, None] = None,
    loss: Optional[str] = None,
    loss_scale: Optional[float] = None,
    optimize: Free = None,
    terms: Optional[Callable[[Curve], Terms]] = None,
    component: Optional[int] = None,
    method: str = "global",
    through: Optional[ArrayLike] = None,
    tangents: Optional[ArrayLike] = None,
    weights: Optional[ArrayLike] = None,
    shift: Union[str, ArrayLike, None] = None,
    unit: str = "mm",
    seed: int = 1,
    threads: int = 0,
    progress: Progress = None,
) -> CurveFit:
    """Fits a NURBS curve to points along it, in order or not, open or closed.

    Parameters
    ----------
    points : array_like of shape (N, 3) or (N, 2), Cloud, path-like or a sequence of paths
        In the data's units; two columns are a plane curve.
    tolerance : float, optional
        Distance in the data's units; the curve then has as few control points as keep it.
    degree : int
        1 … 25.
    control_points : int, optional
        Chosen by the data, or the tolerance, when None.
    max_control_points : int
        The most.
    parameterization : {'chord', 'centripetal', 'uniform', 'foley', 'universal', 'given'}, optional
        Where parameters come from; 'given' where `parameters` are.
    parameters : array_like of shape (N,), optional
        Of the points.
    order : {'auto', 'given', 'unordered'}, optional
        Where the order of the points comes from.
    closed : {'auto', 'yes', 'no'} or bool, optional
        Whether the curve closes.
    corners : bool
        Found and kept; else the curve is smooth.
    distance : {'auto', 'parameter', 'point', 'tangent', 'squared'}, optional
        What is minimised.
    smoothing : float or {'auto', 'cross-validation', 'noise'}, optional
        Fairness relative to the data, 1e-10 when None; or who chooses it.
    loss : {'auto', 'none', 'huber', 'cauchy', 'tukey', 'truncated'}, optional
        None: Tukey's where there are outliers.
    loss_scale : float, optional
        Standard deviation of good points, in the data's units.
    optimize : str or iterable of {'parameters', 'weights', 'knots'}, optional
        What is free in the joint stage; None: where it pays; 'none': never.
    terms : callable, optional
        ``terms(start) -> list of ResidualTerm``, `start` the curve from which the joint stage begins.
    component : int, optional
        Of several separate curves the one of this number by length, from 1.
    method : {'global', 'local-parabolic', 'local-conic', 'local-cubic'}
        Local ones go piece by piece through the points in their order or, but for parabolas, within the tolerance; they
        take `closed` ('yes'), `corners` and `tolerance` only.
    through : array_like of shape (k, 3) or (k, 2), optional
        Points that the curve meets exactly.
    tangents : array_like of shape (k, 6) or (k, 4), optional
        Points that it meets exactly with the directions beside them.
    weights : array_like of shape (N,), optional
        Of the points, positive.
    shift : array_like of shape (3,) or 'local', optional
        Subtracted from the coordinates of the result.
    unit : str
        Of the data.
    seed : int
        Chooses samples.
    threads : int
        0: all cores.
    progress : callable or bool, optional
        ``progress(stage, fraction)``, or True for a bar.

    Returns
    -------
    CurveFit
        curve, parameters (N,), residuals (N,), outliers (N,), report.

    Raises
    ------
    FitRefused
        Points that can't carry a curve, or belong to several.
    ReadError
        A file that can't be used.
    ValueError
        Naming the keyword.
    """
    if one_of("method", method, ("global", "local-parabolic", "local-conic", "local-cubic")) != "global":
        others = (degree != 3, control_points, parameterization, parameters, order, distance, smoothing, loss, optimize, terms, component)
        if any(given is not None and given is not False for given in (*others, through, tangents)):
            raise ValueError(f"method: {method!r} takes closed, corners and tolerance only")
        return _fit_locally(points, method, tolerance, closed, corners, shift, unit)
    if through is not None or tangents is not None:
        if terms is not None or component is not None or optimize not in (None, "none"):
            raise ValueError("through, tangents: not beside terms, component or optimize")
        places = _places(through, tangents)
    else:
        places = None
    chosen = "" if component is None else str(whole("component", component, 1))
    names = locals()
    kept = {name: names[name] for name in _CURVE_KEYWORDS}
    kept["places"] = places
    return _fit_curves(points, "batten.fit_curve", chosen, terms, parameters, weights, shift, unit, progress, kept)[0]


def _fit_locally(points: Any, method: str, tolerance: Any, closed: Any, corners: Any, shift: Any, unit: Any) -> CurveFit:
    cloud, _ = _in_order(points, None, None)
    options = {
        "method": method,
        "tolerance": tolerance,
        "closed": closed is True or closed == "yes",
        "corners": bool(corners),
    }
    values = _keywords(cloud, shift, unit, "batten.fit_curve", options)
    return CurveFit(_core.fit_locally(cloud._points, values))


def _places(through: Any, tangents: Any) -> List[List[float]]:
    """Points, and points with directions, as three or six numbers each."""
    places = []
    for name, value, parts in (("through", through, 1), ("tangents", tangents, 2)):
        if value is None:
            continue
        rows = finite(name, value)
        if rows.ndim != 2 or rows.shape[1] not in (2 * parts, 3 * parts):
            raise ValueError(f"{name}: an array of shape (k, {3 * parts}) or (k, {2 * parts}) is needed, not {rows.shape}")
        width = rows.shape[1] // parts
        flat = np.zeros((len(rows), parts, 3))
        flat[:, :, :width] = rows.reshape(-1, parts, width)
        places += flat.reshape(len(rows), -1).tolist()
    return places


_CURVE_KEYWORDS = (
    "tolerance degree control_points max_control_points parameterization order closed corners distance smoothing loss "
    "loss_scale optimize seed threads"
).split()


def fit_curves(points: Any, **options: Any) -> List[CurveFit]:
    """Fits a curve to every separate component of the points, longest first.

    Parameters
    ----------
    points : array_like of shape (N, 3) or (N, 2), Cloud, path-like or a sequence of paths
        In the data's units.
    **options
        As fit_curve takes them, but `component`.

    Returns
    -------
    list of CurveFit
        Points of the other components are no outliers of a curve; its report leaves them out.

    Raises
    ------
    FitRefused
        Points that can't carry curves.
    ValueError
        Naming the keyword.
    """
    own = {name: options.pop(name, None) for name in ("terms", "parameters", "weights", "shift", "progress")}
    unit = options.pop("unit", "mm")
    unknown = sorted(set(options) - set(_CURVE_KEYWORDS))
    if unknown:
        raise TypeError(f"fit_curves() got an unexpected keyword argument '{unknown[0]}'")
    return _fit_curves(
        points, "batten.fit_curves", "all", own["terms"], own["parameters"], own["weights"], own["shift"], unit, own["progress"], options
    )


def _fit_curves(
    points: Any,
    command: str,
    component: str,
    terms: Any,
    parameters: Any,
    weights: Any,
    shift: Any,
    unit: Any,
    progress: Any,
    options: Dict[str, Any],
) -> List[CurveFit]:
    cloud, options["parameterization"] = _in_order(points, options.get("parameterization"), parameters, weights)
    if isinstance(options.get("closed"), (bool, np.bool_)):
        options["closed"] = "yes" if options["closed"] else "no"
    if terms is not None:
        _called("terms", terms)
        options["terms"] = lambda body: checked_terms(terms(Curve._of(body)))
    with callback(progress) as tell:
        values = _keywords(cloud, shift, unit, command, options)
        return [CurveFit(fit) for fit in _core.fit_curves(cloud._points, values, component, tell)]


def fit_primitive(
    points: Any,
    kind: str = "auto",
    *,
    tolerance: Optional[float] = None,
    loss: Optional[str] = None,
    loss_scale: Optional[float] = None,
    weights: Optional[ArrayLike] = None,
    shift: Union[str, ArrayLike, None] = None,
    unit: str = "mm",
    seed: int = 1,
    threads: int = 0,
    progress: Progress = None,
) -> PrimitiveFit:
    """Fits an exact line, circle, plane, sphere, cylinder, cone or torus, with standard deviations.

    Parameters
    ----------
    points : array_like of shape (N, 3), or (N, 2) for lines and circles, Cloud, path-like or a sequence of paths
        In the data's units.
    kind : {'auto', 'line', 'circle', 'plane', 'sphere', 'cylinder', 'cone', 'torus'}
        'auto': the simplest that the points do not reject.
    tolerance : float, optional
        In the data's units; only judged.
    loss : {'auto', 'none', 'huber', 'cauchy', 'tukey', 'truncated'}, optional
        None: none for lines and circles; of surfaces outliers are left out.
    loss_scale : float, optional
        Standard deviation of inliers, in the data's units.
    weights : array_like of shape (N,), optional
        Of the points, positive.
    shift : array_like of shape (3,) or 'local', optional
        Subtracted from the coordinates of the result.
    unit : str
        Of the data.
    seed : int
        Chooses samples.
    threads : int
        0: all cores.
    progress : callable or bool, optional
        ``progress(stage, fraction)``, or True for a bar.

    Returns
    -------
    PrimitiveFit
        geometry, kind, numbers, parameters (N, 2) or (N,), residuals (N,), outliers (N,), report.

    Raises
    ------
    FitRefused
        Points to which no such shape fits.
    ValueError
        Naming the keyword.
    """
    cloud = cloud_of("points", points, weights=weights)
    options = {
        "kind": kind,
        "tolerance": tolerance,
        "loss": loss,
        "loss_scale": loss_scale,
        "seed": seed,
        "threads": threads,
    }
    with callback(progress) as tell:
        values = _keywords(cloud, shift, unit, "batten.fit_primitive", options)
        return PrimitiveFit(_core.fit_primitive(cloud._points, values, tell))


def fit_solid(
    points: Any,
    *,
    layout: Any = None,
    faces: Optional[int] = None,
    genus: Optional[int] = None,
    open: bool = False,
    most_invented: float = 0.15,
    tolerance: Optional[float] = None,
    smoothing: Union[float, str, None] = None,
    max_iterations: int = 40,
    keep_outliers: Optional[bool] = None,
    merge_faces: bool = True,
    normals: Optional[ArrayLike] = None,
    weights: Optional[ArrayLike] = None,
    shift: Union[str, ArrayLike, None] = None,
    unit: str = "mm",
    seed: int = 1,
    threads: int = 0,
    progress: Progress = None,
) -> SolidFit:
    """Fits one watertight solid of smooth faces to the points of a whole body, or a shell to an open scan.

    One subdivision surface over a layout of quadrilaterals is fitted to all points and turned into bicubic faces with
    continuous tangent planes that share their edges.

    Parameters
    ----------
    points : array_like of shape (N, 3), Cloud, path-like or a sequence of paths, or (vertices, faces)
        All round the body, in the data's units. Of a mesh, or a file that holds faces, the faces say what the body is;
        small holes are closed. Points alone get a Poisson reconstruction.
    layout : (array_like of shape (V, 3), array_like of int, shape (F, 4)) or path-like, optional
        A closed mesh of quadrilaterals near the points, counter-clockwise seen from outside; made when None.
    faces : int, optional
        About how many quadrilaterals the layout that is made has, 6 … 20000; None: chosen by points left out, at most
        one for 8 points, and 2500.
    genus : int, optional
        How many handles the solid has, of all bodies together: 0 of a ball, 1 of a ring; another one is refused.
    open : bool
        The borders of an open scan stay, and what comes out is a shell that ends at them; not beside `layout` or
        `genus`.
    most_invented : float
        Points alone are refused where more than this share of the area, in [0, 1], has none within three spacings.
    tolerance : float, optional
        Distance in the data's units: faces with points beyond it get finer control points, if
        points left out ask for them. Without it those that miss points by more than noise do.
    smoothing : float or 'auto', optional
        Fairness relative to the data, with the layout's control points alone; None: by points left out.
    max_iterations : int
        Steps, where smoothing is given.
    keep_outliers : bool, optional
        All points count; None: where a layout is made of a mesh.
    merge_faces : bool
        As few faces as the layout allows; else one for each of its own.
    normals : array_like of shape (N, 3), optional
        Of the points, all outwards or all inwards; a mesh has its own.
    weights : array_like of shape (N,), optional
        Of the points, positive.
    shift : array_like of shape (3,) or 'local', optional
        Subtracted from the coordinates of the result.
    unit : str
        Of the data.
    seed : int
        Chooses samples.
    threads : int
        0: all cores.
    progress : callable or bool, optional
        ``progress(stage, fraction)`` with the stages 'layout', 'prepare' and 'fit', or True for a bar. Where it
        returns False there is no result.

    Returns
    -------
    SolidFit
        solid, residuals (N,), parameters (N, 2) on the faces `owners`, outliers (N,), summary, report, to_step.

    Raises
    ------
    FitRefused
        Points that do not go all round, a mesh that is open or not manifold, a layout that is no closed mesh of
        quadrilaterals or lies elsewhere, faces that come out folded.
    ReadError
        A file that can't be used.
    ValueError
        Naming the keyword.
    """
    if layout is not None and faces is not None:
        raise ValueError("faces: not beside layout, which has its own")
    if faces is not None and not 6 <= whole("faces", faces) <= 20000:
        raise ValueError(f"faces: {faces} is not in [6, 20000]")
    if genus is not None:
        whole("genus", genus, 0)
    if open and (layout is not None or genus is not None):
        raise ValueError("open: not beside layout or genus, which are of closed solids")
    if not 0 <= number("most_invented", most_invented) <= 1:
        raise ValueError(f"most_invented: {most_invented} is not in [0, 1]")
    mesh = _mesh_of("points", points)
    if mesh is not None:
        if normals is not None:
            raise ValueError("normals: not beside faces, which have their own")
        cloud = cloud_of("points", mesh[0], weights=weights)
    else:
        cloud = cloud_of("points", points, normals=normals, weights=weights)
        if layout is None and from_file(points):
            paths = [points] if is_path(points) else list(points)
            mesh = _core.read_faces(path_bytes("points", paths[0]), False) if len(paths) == 1 else None
    if is_path(layout):
        path = path_bytes("layout", layout)
        try:
            quads = _core.read_faces(path, True)
        except ValueError as error:
            raise ValueError(f"layout: {error}") from None
    else:
        quads = _mesh_of("layout", layout)
        if layout is not None and quads is None:
            raise ValueError("layout: (vertices, faces) or a path are needed")
    options = {
        "faces": faces,
        "genus": genus,
        "open": bool(open),
        "most_invented": float(most_invented),
        "tolerance": tolerance,
        "smoothing": smoothing,
        "max_iterations": max_iterations,
        "keep_outliers": keep_outliers,
        "merge_faces": merge_faces,
        "seed": seed,
        "threads": threads,
    }
    with callback(progress) as tell:
        values = _keywords(cloud, shift, unit, "batten.fit_solid", options)
        return SolidFit(_core.fit_solid(cloud._points, values, mesh, quads, tell))


def _mesh_of(name: str, given: Any) -> Optional[Tuple[NDArray[np.float64], NDArray[np.int32], NDArray[np.int32]]]:
    """Vertices, corners of all faces and their numbers, of (vertices, faces) or what has both; None of what is no mesh."""
    if hasattr(given, "vertices") and hasattr(given, "faces"):  # a Mesh, or trimesh's
        vertices, faces = given.vertices, given.faces
    elif isinstance(given, tuple) and len(given) == 2 and not any(map(is_path, given)):
        vertices, faces = given
    else:
        return None
    try:
        rows = plain(f"{name}: faces", faces)
        lists = [rows] if rows.ndim == 2 else None
    except ValueError:  # of several sizes
        if not isinstance(faces, (list, tuple)):
            raise
        lists = [plain(f"{name}: faces", [face]) for face in faces]
    if lists is None or any(one.ndim != 2 or one.dtype.kind == "f" for one in lists):
        raise ValueError(f"{name}: faces as rows of indices are needed")
    if any(one.size and not 0 <= one.min() <= one.max() < 2**31 for one in lists):
        raise ValueError(f"{name}: an index is not of a vertex")
    sizes = np.concatenate([np.full(len(one), one.shape[1], dtype=np.int32) for one in lists])
    corners = np.concatenate([np.ascontiguousarray(one, dtype=np.int32).reshape(-1) for one in lists])
    return finite(f"{name}: vertices", vertices, None, 3), corners, sizes


def fit_grid(
    points: Any,
    shape: Optional[Tuple[int, int]] = None,
    *,
    method: Optional[str] = None,
    tolerance: Optional[float] = None,
    control_points: Optional[Tuple[int, int]] = None,
    degree: Union[int, Tuple[int, int]] = 3,
    parameterization: Optional[str] = None,
    parameters: Optional[Tuple[ArrayLike, ArrayLike]] = None,
    closed: Optional[str] = None,
    shift: Union[str, ArrayLike, None] = None,
    unit: str = "mm",
    threads: int = 0,
    progress: Progress = None,
) -> SurfaceFit:
    """Fits a surface to points measured in rows and columns: through them, or near them.

    Parameters
    ----------
    points : array_like of shape (n, m, 3), or (n m, 3), Cloud or path-like with `shape`
        In the data's units; rows go with u. A cell that is not finite is missing.
    shape : (int, int), optional
        n and m, where the points do not tell.
    method : {'auto', 'interpolate', 'local', 'least-squares'}, optional
        'auto': through all points, or as tolerance or control_points say.
    tolerance : float, optional
        In the data's units, kept between the points, too.
    control_points : (int, int), optional
        Least squares with these.
    degree : int or (int, int)
        In u and v.
    parameterization : {'auto', 'chord', 'centripetal', 'uniform'}, optional
        Of rows and columns.
    parameters : (array_like of shape (n,), array_like of shape (m,)), optional
        u of the rows and v of the columns, increasing.
    closed : {'auto', 'none', 'u', 'v', 'uv'}, optional
        Directions that close.
    shift : array_like of shape (3,) or 'local', optional
        Subtracted from the coordinates of the result.
    unit : str
        Of the data.
    threads : int
        0: all cores.
    progress : callable or bool, optional
        ``progress(stage, fraction)``, or True for a bar.

    Returns
    -------
    SurfaceFit
        Its arrays have a row for each cell that is there, row after row.

    Raises
    ------
    FitRefused
        Points that are no grid, or carry no surface.
    ValueError
        Naming the keyword.
    """
    missing: Optional[NDArray[np.bool_]] = None
    if from_file(points) or isinstance(points, Cloud):
        cloud = cloud_of("points", points)
        if shape is None:
            raise ValueError("shape: rows and columns are needed")
        rows, columns = _shape(shape)
        holes = cloud._points.missing
        if holes and holes[-1] < rows * columns:
            missing = np.zeros(rows * columns, dtype=bool)
            missing[holes] = True
    else:
        array = plain("points", points)
        if array.ndim == 3 and array.shape[2] == 3:
            rows, columns = array.shape[:2]
            if shape is not None and _shape(shape) != (rows, columns):
                raise ValueError(f"shape: {shape!r} is not that of the points, ({rows}, {columns})")
            array = array.reshape(-1, 3)
        elif array.ndim == 2 and array.shape[1] == 3 and shape is not None:
            rows, columns = _shape(shape)
        else:
            raise ValueError(f"points: an array of shape (n, m, 3) is needed, or (n m, 3) and shape, not {array.shape}")
        there = np.isfinite(array).all(axis=1)
        if array.shape[0] != rows * columns:
            raise ValueError(f"shape: {rows} x {columns} are not the {array.shape[0]} points")
        if not there.all():
            missing = ~there
            array = array[there]
        cloud = Cloud(array)
    lines = None
    if parameters is not None:
        try:
            first, second = parameters
        except (TypeError, ValueError):
            raise ValueError("parameters: those of the rows and those of the columns are needed") from None
        lines = (finite("parameters", first, None), finite("parameters", second, None))
        if parameterization is not None:
            raise ValueError("parameterization: not beside parameters")
    options = {
        "rows": rows,
        "columns": columns,
        "method": method,
        "tolerance": tolerance,
        "control_points": control_points,
        "degree": degree,
        "parameterization": parameterization,
        "closed": closed,
        "threads": threads,
    }
    with callback(progress) as tell:
        values = _keywords(cloud, shift, unit, "batten.fit_grid", options)
        return SurfaceFit(_core.fit_grid(cloud._points, values, missing, lines, tell))


def interpolate_curve(
    points: Any,
    *,
    degree: int = 3,
    parameterization: Optional[str] = None,
    parameters: Optional[ArrayLike] = None,
    closed: bool = False,
    start_tangent: Optional[ArrayLike] = None,
    end_tangent: Optional[ArrayLike] = None,
    spline: Optional[str] = None,
    start_curvature: Union[float, ArrayLike, None] = None,
    end_curvature: Union[float, ArrayLike, None] = None,
    tolerance: Optional[float] = None,
    shift: Union[str, ArrayLike, None] = None,
    unit: str = "mm",
) -> CurveFit:
    """The curve through all points, in their order.

    Parameters
    ----------
    points : array_like of shape (N, 3) or (N, 2), Cloud or path-like
        In the data's units.
    degree : int
        1 … 25.
    parameterization : {'chord', 'centripetal', 'uniform', 'foley', 'universal', 'x'}, optional
        Where parameters come from; 'x': the curve is a function y(x).
    parameters : array_like of shape (N,), optional
        Of the points.
    closed : bool
        Periodic, as smooth at the seam as elsewhere.
    start_tangent, end_tangent : array_like of shape (3,) or (2,), optional
        Directions at the ends.
    spline : {'natural', 'clamped', 'curvature', 'not-a-knot', 'periodic'}, optional
        A cubic spline with a knot at every point, and its ends.
    start_curvature, end_curvature : float or array_like of shape (3,), optional
        At the ends of a spline, one over the radius: positive turning left; in space the vector towards the centre.
    tolerance : float, optional
        That the report counts by.
    shift : array_like of shape (3,) or 'local', optional
        Subtracted from the coordinates of the result.
    unit : str
        Of the data.

    Returns
    -------
    CurveFit
        curve, and the parameters (N,) at which it meets the points.

    Raises
    ------
    FitRefused
        Points that no curve of the degree goes through.
    ValueError
        Naming the keyword.
    """
    of_x = isinstance(parameterization, str) and parameterization == "x"
    if of_x and parameters is not None:
        raise ValueError("parameterization: not beside parameters")
    cloud, parameterization = _in_order(points, None if of_x else parameterization, parameters)
    options = {
        "degree": degree,
        "parameterization": parameterization,
        "function_of_x": of_x,
        "spline": spline,
        "start_curvature": _curvature("start_curvature", start_curvature),
        "end_curvature": _curvature("end_curvature", end_curvature),
        "closed": closed or spline == "periodic",
        "start_tangent": _tangent("start_tangent", start_tangent),
        "end_tangent": _tangent("end_tangent", end_tangent),
        "tolerance": tolerance,
    }
    values = _keywords(cloud, shift, unit, "batten.interpolate_curve", options)
    return CurveFit(_core.interpolate_curve(cloud._points, values))


def fit_parts(points: Any, **options: Any) -> List[SurfaceFit]:
    """Fits a surface to every connected part of a cloud, by falling number of points.

    Parameters
    ----------
    points : array_like of shape (N, 3), Cloud or path-like
        In the data's units.
    **options
        As fit_surface takes them; normals, weights and parameters come from the cloud.

    Returns
    -------
    list of SurfaceFit
        Of the parts that carry a surface; their points are in ``fit.points``.

    Raises
    ------
    FitRefused
        Where no part does.
    """
    cloud = cloud_of("points", points)
    fits, refused = [], None
    from ._errors import FitRefused

    for part in cloud.parts(threads=options.get("threads", 0)):
        try:
            fits.append(fit_surface(cloud.pick(part), **options))
        except FitRefused as error:
            refused = error
    if not fits:
        raise refused or FitRefused("no part of the cloud has points enough for a surface")
    return fits


def compare(
    geometry: Union[Geometry, Sequence[Geometry], str, Any],
    points: Any,
    *,
    tolerance: Optional[float] = None,
    align: Optional[str] = None,
    datums: Sequence[int] = (),
    profile: Union[float, Tuple[float, float], None] = None,
    certify: bool = False,
    unit: str = "mm",
    seed: int = 1,
    threads: int = 0,
    progress: Progress = None,
) -> Comparison:
    """Orthogonal distances of points from curves and surfaces, certified, trims kept.

    Parameters
    ----------
    geometry : Curve, Surface, a sequence of them, or path-like
        Of several each point belongs to the nearest.
    points : array_like of shape (N, 3) or (N, 2), Cloud, path-like or a sequence of paths
        In the same units and coordinates.
    tolerance : float, optional
        By which points are counted, in the data's units.
    align : {"best", "datum"}, optional
        Move the points first by a rigid motion of least squares: to all surfaces, or to those of ``datums`` one after the
        other. ``report["alignment"]`` has the motion, ``points`` are moved.
    datums : sequence of int
        Indices of the datum surfaces, primary first.
    profile : float or (float, float), optional
        Profile tolerance: T is the zone -T/2 … T/2 along the normals. ``report["profile"]`` has the decision.
    certify : bool
        Prove bounds of every distance, and that there are no folds: ``report["certified"]``.
    unit : str
        Of the data.
    seed : int
        Chooses samples.
    threads : int
        0: all cores.
    progress : callable or bool, optional
        ``progress(stage, fraction)``, or True for a bar.

    Returns
    -------
    Comparison
        distances (N,), parameters (N, 2) or (N,), owners, report, ok.

    Raises
    ------
    ReadError
        A file that can't be used.
    ValueError
        Naming the keyword.
    """
    names: List[str] = []
    if is_path(geometry):
        from ._files import read_geometry

        shapes = read_geometry(cast(Path, geometry))
        names, geometry = shapes.names, shapes
    bodies = [_body_of("geometry", one) for one in ([geometry] if isinstance(geometry, Geometry) else _sequence("geometry", geometry))]
    cloud = cloud_of("points", points, faces="measured")
    options: Dict[str, Any] = {"tolerance": tolerance, "align": align, "certify": certify, "seed": seed, "threads": threads}
    if align is not None:
        one_of("align", align, ("best", "datum"))
    datums = list(datums)
    if (align == "datum") != bool(datums):
        raise ValueError("datums: indices of surfaces go with align='datum', and only with it")
    if datums:
        options["datums"] = datums
    if profile is not None:
        zone = (-profile / 2, profile / 2) if isinstance(profile, (int, float)) else profile
        options["profile"] = [float(x) for x in zone]
        if not (len(options["profile"]) == 2 and options["profile"][0] < options["profile"][1]):
            raise ValueError(f"profile: {profile!r} is neither a positive number nor (low, high) with low below high")
    with callback(progress) as tell:
        values = _keywords(cloud, None, unit, "batten.compare", options)
        return Comparison(_core.compare(bodies, cloud._points, values, names, tell))


def cloud_parts(points: Any, *, threads: int = 0) -> List[NDArray[np.int64]]:
    """The connected parts of a cloud.

    Parameters
    ----------
    points : array_like of shape (N, 3), Cloud or path-like
        In the data's units.
    threads : int
        0: all cores.

    Returns
    -------
    list of ndarray of int64
        Indices of the points of each, by falling number.
    """
    return cloud_of("points", points).parts(threads=threads)


def _in_order(points: Any, parameterization: Any, parameters: Any, weights: Any = None) -> Tuple[Cloud, Any]:
    """The points of a curve, and where their parameters come from."""
    given = isinstance(parameterization, str) and parameterization == "given"
    cloud = cloud_of("points", points, read_parameters=given, weights=weights, parameters=parameters)
    if parameters is not None:
        if parameterization is not None and not given:
            raise ValueError("parameterization: not beside parameters")
        return cloud, "given"
    if given and cloud.parameters is None:
        raise ValueError("parameterization: 'given' needs parameters")
    return cloud, parameterization


def _sequence(name: str, value: Any) -> List[Any]:
    if isinstance(value, Geometry):
        return [value]
    try:
        return list(value)
    except TypeError:
        raise ValueError(f"{name}: a sequence is needed, not {type(value).__name__}") from None


def _shape(shape: Any) -> Tuple[int, int]:
    try:
        rows, columns = shape
    except (TypeError, ValueError):
        raise ValueError(f"shape: {shape!r} are not two numbers") from None
    return whole("shape", rows, 2), whole("shape", columns, 2)


def _curvature(name: str, value: Any) -> Optional[List[float]]:
    if value is None:
        return None
    given = finite(name, value).reshape(-1)
    if given.size not in (1, 3):
        raise ValueError(f"{name}: one number in the plane, three in space are needed")
    return [float(x) for x in given]


def _tangent(name: str, value: Any) -> Optional[List[float]]:
    if value is None:
        return None
    given = finite(name, value, None)
    if given.size not in (2, 3):
        raise ValueError(f"{name}: two or three numbers are needed")
    return [float(x) for x in given] + [0.0] * (3 - given.size)


def _mirror(symmetric: Any) -> Optional[List[float]]:
    if symmetric is None:
        return None
    if isinstance(symmetric, str):
        axis = one_of("symmetric", symmetric, ("x", "y", "z"))
        return [float(axis == one) for one in "xyz"] + [0.0]
    return [float(x) for x in finite("symmetric", symmetric, 4)]


def _called(name: str, value: Any) -> Any:
    if not callable(value):
        raise ValueError(f"{name}: {value!r} is not callable")
    return value
